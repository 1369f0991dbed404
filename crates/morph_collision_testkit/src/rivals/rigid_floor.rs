//! The cost of collision if nothing morphed: for every shape, the same tree as `morph`, over only that shape.
//!
//! A body's mesh is frozen at its weights: the blended positions become the base of a mesh without targets. Its tree has
//! the topology of the morphing one, with tight volumes that never need an update. [`Method::prepare`] builds it, so that a
//! measurement can leave that out; what remains is placing bodies and queries. No method for changing shapes can be
//! expected to be faster.
//!
//! A skinned mesh keeps its tree and its joints, because freezing its vertices would round them. It is posed completely beforehand
//! instead: every vertex is placed, and every box is tight.

use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision::{
    Aabb, Body, JointMatrices, MorphBvh, MorphModel, PairQuery, Pose, QueryStats, TreeLayout, TrianglePair,
    WeightsError, WorldFromModel,
};
use serde_json::Value;

use super::{Method, MethodOptions, PoseError, SetUpError, Wanted, push};
use morph_collision_models::mesh::MorphMesh;

/// Bodies of frozen meshes.
#[derive(Debug)]
pub(super) struct RigidFloor {
    kinds: Vec<Kind>,
    bodies: Vec<FrozenBody>,
    query: PairQuery,
    work: QueryStats,
}

/// A mesh that can be frozen.
#[derive(Debug)]
struct Kind {
    mesh: MorphMesh,
    tree: Arc<MorphBvh>,
    /// The layout of the morphing tree as JSON, because only in that form can it be applied to another mesh.
    layout: Value,
}

#[derive(Clone, Debug)]
struct FrozenBody {
    kind: usize,
    weights: Vec<f32>,
    /// Empty if the mesh is not skinned, or if no joints were given yet.
    joints: Vec<Affine3A>,
    pose: Pose,
    place: WorldFromModel,
}

impl Kind {
    fn new(index: usize, mesh: &MorphMesh, options: &MethodOptions) -> Result<Self, SetUpError> {
        let model = mesh.to_model();
        let model = model.map_err(|reason| SetUpError::Model { mesh: index, reason })?;
        let tree = Arc::new(MorphBvh::build(Arc::new(model), &options.tree));
        // Numbers, strings and lists can always be written as JSON.
        let layout = serde_json::to_value(tree.layout()).unwrap_or_default();
        Ok(Self {
            mesh: mesh.clone(),
            tree,
            layout,
        })
    }

    /// A body with the shape at these weights, which the model allows.
    fn freeze(&self, weights: &[f32]) -> Result<Pose, WeightsError> {
        let mut layout = self.layout.clone();
        let frozen = || {
            let positions = self.mesh.posed(weights);
            let model = MorphModel::from_displacements::<[Vec3; 0]>(&positions, &self.mesh.triangles, &[]).ok()?;
            layout["fingerprint"] = model.fingerprint().into();
            let layout: TreeLayout = serde_json::from_value(layout).ok()?;
            MorphBvh::from_layout(Arc::new(model), &layout).ok()
        };
        // Blended vertices may reach farther than those of a mesh may; everything else fits.
        let largest = || (0..).zip(weights).max_by(|x, y| x.1.abs().total_cmp(&y.1.abs()));
        let bvh = frozen().ok_or_else(|| {
            let (index, &value) = largest().unwrap_or((0, &0.0));
            WeightsError::TooLarge { index, value }
        })?;
        Ok(Pose::new(Arc::new(bvh)))
    }
}

impl RigidFloor {
    pub(super) fn new(meshes: &[MorphMesh], bodies: &[usize], options: &MethodOptions) -> Result<Self, SetUpError> {
        let (mut kinds, mut at_rest) = (Vec::with_capacity(meshes.len()), Vec::with_capacity(meshes.len()));
        for (kind, mesh) in meshes.iter().enumerate() {
            let frozen = Kind::new(kind, mesh, options)?;
            let weights = vec![0.0; mesh.targets.len()];
            let pose = if mesh.skin.is_some() {
                Pose::new(Arc::clone(&frozen.tree))
            } else {
                // The base was accepted before.
                let Ok(pose) = frozen.freeze(&weights) else { continue };
                pose
            };
            let place = WorldFromModel::IDENTITY;
            at_rest.push(FrozenBody {
                kind,
                weights,
                joints: Vec::new(),
                pose,
                place,
            });
            kinds.push(frozen);
        }
        Ok(Self {
            kinds,
            bodies: bodies.iter().map(|&kind| at_rest[kind].clone()).collect(),
            query: PairQuery::new(),
            work: QueryStats::default(),
        })
    }
}

impl Method for RigidFloor {
    fn prepare(&mut self, body: usize, weights: &[f32], joints: Option<&[Affine3A]>) -> Result<bool, PoseError> {
        let FrozenBody {
            kind,
            weights: own_weights,
            joints: own_joints,
            pose,
            ..
        } = &mut self.bodies[body];
        let kind = &self.kinds[*kind];
        kind.tree.model().check_weights(weights)?;
        let new_joints = joints.filter(|joints| own_joints != joints);
        if own_weights == weights && new_joints.is_none() {
            return Ok(false);
        }
        if pose.joints().is_some() {
            if let Some(joints) = new_joints {
                pose.set_joints(&JointMatrices::new(joints)?)?;
                own_joints.clear();
                own_joints.extend_from_slice(joints);
            }
            pose.set_weights(weights)?;
            // Places all vertices, too.
            pose.refit();
        } else if new_joints.is_some() {
            return Err(PoseError::NoJoints);
        } else {
            *pose = kind.freeze(weights)?;
        }
        own_weights.copy_from_slice(weights);
        Ok(true)
    }

    /// Poses the mesh here if that was not prepared.
    fn set_joints(&mut self, body: usize, world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        if self.bodies[body].joints != world_from_mesh {
            let weights = self.bodies[body].weights.clone();
            self.prepare(body, &weights, Some(world_from_mesh))?;
        }
        Ok(())
    }

    /// Freezes the mesh here if that was not prepared.
    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let place = WorldFromModel::new(*world_from_model)?;
        self.prepare(body, weights, None)?;
        self.bodies[body].place = place;
        Ok(false)
    }

    fn refit(&mut self, _: usize) {}

    fn is_lazy(&self) -> bool {
        false
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let body = &mut self.bodies[body];
        body.pose.broad_phase_bounds(&body.place)
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let Ok([a, b]) = self.bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        let (body_a, body_b) = (Body::new(&mut a.pose, &a.place), Body::new(&mut b.pose, &b.place));
        let start = pairs.len();
        match wanted {
            Wanted::All | Wanted::UpTo(_) => self
                .query
                .visit(body_a, body_b, |pair| push(wanted, pairs, start, pair)),
            Wanted::First => pairs.extend(self.query.first(body_a, body_b)),
        }
        self.work += self.query.stats();
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
