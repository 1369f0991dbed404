//! The walk of a ray: nearest boxes first.

use super::{NodeRef, Refit, Trees};
use crate::rivals::cast::{BoxRay, CastHit, CastRay, keep_nearest};
use crate::rivals::tree::Child;

impl<R: Refit> Trees<R> {
    pub(super) fn cast_at(&mut self, body: usize, ray: &CastRay) -> Option<CastHit> {
        let Self { bodies, work, .. } = self;
        let body = &mut bodies[body];
        work.nodes_blended += body.refit.open(0, &body.posed);
        let root = body.root();
        let Some(in_model) = ray.in_model(&body.body.affine) else {
            let mut nearest = None;
            for triangle in 0..body.body.mesh.triangles.len() as u32 {
                work.triangle_tests += 1;
                if let Some(t) = ray.meets(&body.world_triangle(triangle), f64::INFINITY) {
                    keep_nearest(&mut nearest, triangle, t);
                }
            }
            return nearest;
        };
        let boxes = BoxRay::new(&in_model, &body.box_of(root));
        let mut nearest: Option<CastHit> = None;
        let limit = |nearest: &Option<CastHit>| nearest.map_or(f32::INFINITY, |hit| (hit.t as f32).next_up());
        let mut stack = vec![(0.0_f32, root)];
        while let Some((enter, node)) = stack.pop() {
            if enter > limit(&nearest) {
                continue;
            }
            match node.child {
                Child::Leaf(leaf) => {
                    for index in 0..body.refit.tree().leaf(leaf).len() {
                        let triangle = body.refit.tree().leaf(leaf)[index];
                        work.triangle_tests += 1;
                        let corners = body.world_triangle(triangle);
                        if let Some(t) = ray.meets(&corners, nearest.map_or(f64::INFINITY, |hit| hit.t)) {
                            keep_nearest(&mut nearest, triangle, t);
                        }
                    }
                }
                Child::Group(group) => {
                    work.nodes_blended += body.refit.open(group as usize, &body.posed);
                    let children = body.refit.tree().groups[group as usize].children();
                    work.node_tests += children.len() as u64;
                    let (enter, mask) = boxes.enter(body.refit.boxes(group as usize), limit(&nearest));
                    let first = stack.len();
                    for (lane, &child) in children.iter().enumerate() {
                        if mask >> lane & 1 == 1 {
                            let node = NodeRef {
                                child,
                                group,
                                lane: lane as u8,
                            };
                            stack.push((enter[lane], node));
                        }
                    }
                    stack[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
                }
            }
        }
        nearest
    }
}
