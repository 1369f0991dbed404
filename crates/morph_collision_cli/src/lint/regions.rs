//! Pairs of triangles that touch, grouped into connected regions.

use std::sync::Arc;

use glam::DVec3;
use morph_collision::{Body, Pose, Triangle, TrianglePair, WorldFromModel, touching_regions, triangle_contact};

use crate::touching::depth::depth;

/// Triangles that touch each other or share vertices.
#[derive(Clone, Debug, Default)]
pub(super) struct Region {
    /// Ascending.
    pub(super) triangles: Vec<u32>,
    /// Those of one side, ascending. The others touch them.
    pub(super) first_side: Vec<u32>,
    /// The number of pairs that touch.
    pub(super) pairs: usize,
    /// The farthest that any of these triangles would have to move to leave the one it touches. Below 0 if none touch: minus the distance.
    pub(super) depth: f64,
    /// The diagonal of the box around all contacts.
    pub(super) length: f64,
}

/// Groups pairs into connected regions, sorted by their first triangles.
pub(super) fn regions(pose: &mut Pose, pairs: &[TrianglePair]) -> Vec<Region> {
    let model = Arc::clone(pose.bvh().model());
    let mut body = Body::new(pose, &WorldFromModel::IDENTITY);
    let mut region = |pairs: &Vec<TrianglePair>| {
        let mut building = Building::default();
        for pair in pairs {
            if let (Some(a), Some(b)) = (body.triangle(pair.triangle_a), body.triangle(pair.triangle_b)) {
                building.add(pair, [&a, &b]);
            }
        }
        building.finish()
    };
    let mut regions: Vec<Region> = touching_regions(&model, pairs).iter().map(&mut region).collect();
    regions.sort_by(|one, other| one.triangles.cmp(&other.triangles));
    regions
}

#[derive(Default)]
struct Building {
    region: Region,
    bounds: Option<[DVec3; 2]>,
}

impl Building {
    fn add(&mut self, pair: &TrianglePair, [a, b]: [&Triangle; 2]) {
        let region = &mut self.region;
        region.triangles.extend([pair.triangle_a, pair.triangle_b]);
        region.first_side.push(pair.triangle_a);
        let depth = depth(a, b);
        region.depth = if region.pairs == 0 {
            depth
        } else {
            region.depth.max(depth)
        };
        region.pairs += 1;
        for end in triangle_contact(a, b).into_iter().flat_map(|contact| contact.segment) {
            let [low, high] = self.bounds.unwrap_or([end; 2]);
            self.bounds = Some([low.min(end), high.max(end)]);
        }
    }

    fn finish(mut self) -> Region {
        self.region.triangles.sort_unstable();
        self.region.triangles.dedup();
        self.region.first_side.sort_unstable();
        self.region.first_side.dedup();
        self.region.length = self.bounds.map_or(0.0, |[low, high]| low.distance(high));
        self.region
    }
}
