//! Meshes that joints move.
//!
//! - `joints`: where joints put a mesh, in all circumstances.
//! - `instances`: several meshes and skeletons at once.
//! - `formats`: the supported formats of meshes and skeletons.
//! - `surface`: hits, picks and anchors on a skinned surface.
//! - `gizmos`: debug drawing of skinned meshes.
//! - `bounds`: the `Aabb` that Bevy uses for culling.
//! - `characters`: real models, compared with brute force.
//! - `torture`: random lives of meshes and joints.
//! - `turned`: the `Aabb` of turned characters.

mod bounds;
mod characters;
mod formats;
mod gizmos;
mod instances;
mod joints;
mod surface;
mod torture;
mod turned;

use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::VertexAttributeValues;
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use crate::support::{Edits, bevy_mesh, cube};

/// A mesh each of whose vertices follows one joint.
pub(crate) fn boned(mesh: &MorphMesh, joint_of: impl Fn(Vec3) -> u16) -> Mesh {
    let joints: Vec<[u16; 4]> = mesh.positions.iter().map(|&p| [joint_of(p), 0, 0, 0]).collect();
    let weights = vec![[1.0_f32, 0.0, 0.0, 0.0]; joints.len()];
    bevy_mesh(mesh)
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_INDEX, VertexAttributeValues::Uint16x4(joints))
        .with_inserted_attribute(Mesh::ATTRIBUTE_JOINT_WEIGHT, weights)
}

/// A cube with sides of 1 around the origin. The side at -X follows joint 0, the side at +X
/// joint 1.
fn limb() -> Mesh {
    boned(&cube(), |p| u16::from(p.x > 0.0))
}

pub(crate) fn add(app: &mut App, mesh: Mesh) -> Handle<Mesh> {
    app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh)
}

/// Joints at some places.
pub(crate) fn spawn_joints<const N: usize>(app: &mut App, places: [Vec3; N]) -> [Entity; N] {
    places.map(|place| app.spawn(Transform::from_translation(place)))
}

/// A skeleton of joints that were all at the origin in the bind pose.
pub(crate) fn skeleton(app: &mut App, joints: &[Entity]) -> SkinnedMesh {
    let poses = vec![Mat4::IDENTITY; joints.len()];
    let mut assets = app.world_mut().resource_mut::<Assets<SkinnedMeshInverseBindposes>>();
    SkinnedMesh {
        inverse_bindposes: assets.add(SkinnedMeshInverseBindposes::from(poses)),
        joints: joints.to_vec(),
    }
}

/// A collider far away, with a skeleton.
pub(crate) fn spawn_skinned(app: &mut App, mesh: &Handle<Mesh>, skin: SkinnedMesh) -> Entity {
    let far = Transform::from_xyz(100.0, 200.0, 300.0);
    app.spawn((Mesh3d(mesh.clone()), skin, MorphCollider::default(), far))
}

/// A limb with joints at the origin and at `stretch` along x.
fn spawn_limb(app: &mut App, stretch: f32) -> (Entity, [Entity; 2]) {
    let mesh = add(app, limb());
    let joints = spawn_joints(app, [Vec3::ZERO, Vec3::X * stretch]);
    let skin = skeleton(app, &joints);
    (spawn_skinned(app, &mesh, skin), joints)
}

pub(crate) fn put(app: &mut App, entity: Entity, place: Transform) {
    app.insert(entity, place);
}

/// The box around a collider's vertices as spatial queries see them; `None` if it takes no part.
fn extent(app: &mut App, collider: Entity) -> Option<(Vec3, Vec3)> {
    let vertices = move |spatial: MorphSpatialQuery| spatial.posed_vertices(collider);
    let vertices = app.world_mut().run_system_once(vertices).unwrap()?;
    let hull = |pick: fn(Vec3, Vec3) -> Vec3| vertices.iter().copied().reduce(pick);
    hull(Vec3::min).zip(hull(Vec3::max))
}

/// The extent along x.
fn along_x(app: &mut App, collider: Entity) -> Option<(f32, f32)> {
    extent(app, collider).map(|(min, max)| (min.x, max.x))
}
