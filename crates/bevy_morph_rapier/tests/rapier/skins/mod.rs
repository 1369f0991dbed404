//! Meshes that joints move, in physics.
//!
//! - `moving`: bodies on a limb, hit by it and carried by it.
//! - `standing`: the limb's place, its cost, and limbs on bodies.
//! - `solid`: its inside.
//! - `character`: a real character that plays its clips.

mod character;
mod moving;
mod solid;
mod standing;

use std::f32::consts::TAU;

use bevy::math::DVec3;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::parry::shape::TriMesh;
use morph_collision_models::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_models::skeleton::Skeleton;
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices};
use morph_collision_workspace::physics::bevy_mesh;

use crate::support::{app, global};

/// The height of an arm's flat top.
const TOP: f32 = 0.461_939_77;

/// A closed tube along x from -3 to 3 with flat sides above and below. Joint 0 moves the side at -x, joint 1 the side at +x, both
/// the part near the origin. Its target doubles its thickness.
fn arm_mesh() -> MorphMesh {
    const RINGS: u32 = 49;
    const SIDES: u32 = 8;
    let mut positions = Vec::new();
    for ring in 0..RINGS {
        let x = -3.0 + ring as f32 / 8.0;
        for side in 0..SIDES {
            let (sin, cos) = ((side as f32 + 0.5) * TAU / SIDES as f32).sin_cos();
            positions.push(Vec3::new(x, 0.5 * sin, 0.5 * cos));
        }
    }
    let mut triangles = Vec::new();
    for ring in 0..RINGS - 1 {
        for side in 0..SIDES {
            let at = |ring: u32, side: u32| ring * SIDES + side % SIDES;
            let [a, b] = [at(ring, side), at(ring, side + 1)];
            let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    for (ring, x, flips) in [(0, -3.0, true), (RINGS - 1, 3.0, false)] {
        let middle = positions.len() as u32;
        positions.push(Vec3::X * x);
        for side in 0..SIDES {
            let [a, b] = [side, (side + 1) % SIDES].map(|side| ring * SIDES + side);
            triangles.push(if flips { [middle, b, a] } else { [middle, a, b] });
        }
    }
    let weights = positions.iter().map(|p| {
        let share = (p.x + 0.5).clamp(0.0, 1.0);
        [1.0 - share, share, 0.0, 0.0]
    });
    let set = InfluenceSet {
        joints: vec![[0, 1, 0, 0]; positions.len()],
        weights: weights.collect(),
    };
    let thicker = positions.iter().map(|p| Vec3::new(0.0, p.y, p.z)).collect();
    let mut mesh = MorphMesh::rigid("arm", positions, triangles);
    mesh.targets = vec![thicker];
    mesh.target_names = vec!["thicker".into()];
    mesh.skin = Some(MeshSkin {
        sets: vec![set],
        skeleton: Skeleton::separate(2),
    });
    mesh
}

/// An arm in an app: its mesh, and its joints, which were at the origin in the bind pose.
struct Arm {
    mesh: MorphMesh,
    surface: Entity,
    joints: [Entity; 2],
}

impl Arm {
    /// An arm with its joints at rest, and more components on the entity of its mesh.
    fn spawn(app: &mut App, more: impl Bundle) -> Self {
        let mesh = arm_mesh();
        let world = app.world_mut();
        let joints = [(); 2].map(|()| world.spawn(Transform::default()).id());
        let influences = &mesh.skin.as_ref().unwrap().sets[0];
        let shown = bevy_mesh(&mesh)
            .with_inserted_attribute(
                Mesh::ATTRIBUTE_JOINT_INDEX,
                VertexAttributeValues::Uint16x4(influences.joints.clone()),
            )
            .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, influences.weights.clone());
        let shown = world.resource_mut::<Assets<Mesh>>().add(shown);
        let mut bind_poses = world.resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
        let skin = SkinnedMesh {
            inverse_bindposes: bind_poses.add(SkinnedMeshInverseBindposes::from(vec![Mat4::IDENTITY; 2])),
            joints: joints.to_vec(),
        };
        let weights = MeshMorphWeights::Value { weights: vec![0.0] };
        let bundle = (Mesh3d(shown), weights, skin, MorphPhysicsCollider::default(), more);
        let surface = world.spawn(bundle).id();
        Self { mesh, surface, joints }
    }

    /// Puts its joints at new places.
    fn pose(&self, app: &mut App, places: [Transform; 2]) {
        for (joint, place) in self.joints.into_iter().zip(places) {
            app.world_mut().entity_mut(joint).insert(place);
        }
    }

    /// Its true shape by the definition of a skinned vertex, as Parry's own mesh.
    fn truth(&self, app: &App) -> TriMesh {
        let weights = match app.world().get::<MeshMorphWeights>(self.surface) {
            Some(MeshMorphWeights::Value { weights }) => weights.clone(),
            _ => vec![0.0],
        };
        let posed = posed_vertices(&self.mesh.positions, &self.mesh.targets, &weights);
        let joints = self.joints.map(|joint| global(app, joint).affine());
        let placed = skinned_vertices(&posed, &self.mesh.skin.as_ref().unwrap().sets, &joints);
        let placed = placed.into_iter().map(DVec3::as_vec3).collect();
        TriMesh::new(placed, self.mesh.triangles.clone()).expect("a mesh with triangles")
    }
}

/// Both joints at one place.
fn both(place: Transform) -> [Transform; 2] {
    [place; 2]
}

fn app_with_arm() -> (App, Arm) {
    let mut app = app();
    let arm = Arm::spawn(&mut app, Transform::from_xyz(100.0, 200.0, 300.0));
    morph_collision_workspace::physics::settle(&mut app);
    (app, arm)
}
