//! Where the meshes of a glTF file are drawn, by brute force: morphs and skins every vertex from the file's data and the app's
//! current joints and weights. Uses nothing of the plugin.

use std::ops::Range;

use bevy::ecs::query::QueryFilter;
use bevy::math::{Affine3A, DVec3, Mat4};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices, world_vertices};

/// A primitive of the file, shown by an entity.
#[derive(Clone, Debug)]
pub struct Part {
    /// The entity.
    pub entity: Entity,
    /// Its mesh in the file.
    pub mesh: usize,
    /// The range of its triangles in that mesh.
    pub triangles: Range<usize>,
}

impl Part {
    /// The corners of its triangles, as vertex indices of the mesh.
    #[must_use]
    pub fn triangles<'a>(&self, meshes: &'a [MorphMesh]) -> &'a [[u32; 3]] {
        &meshes[self.mesh].triangles[self.triangles.clone()]
    }
}

/// The primitives of a file that entities show, in query order. They are identified by the labels of the mesh assets, such as
/// `Mesh2/Primitive0`.
///
/// Entities with other meshes are skipped.
pub fn parts<F: QueryFilter>(world: &mut World, meshes: &[MorphMesh]) -> Vec<Part> {
    let mut shown = world.query_filtered::<(Entity, &Mesh3d), F>();
    let assets = world.resource::<AssetServer>();
    let part = |(entity, mesh): (Entity, &Mesh3d)| {
        let path = assets.get_path(mesh.id())?;
        let label = path.label()?.replace("Mesh", "").replace("Primitive", "");
        let (mesh, primitive) = label.split_once('/')?;
        let (mesh, primitive): (usize, usize) = (mesh.parse().ok()?, primitive.parse().ok()?);
        let range = meshes.get(mesh)?.primitives.get(primitive)?;
        Some(Part {
            entity,
            mesh,
            triangles: range.start as usize..range.end as usize,
        })
    };
    shown.iter(world).filter_map(part).collect()
}

/// The weights that an entity's mesh is drawn with; empty for a mesh without targets.
#[must_use]
pub fn weights(world: &World, entity: Entity) -> Vec<f32> {
    match world.get::<MeshMorphWeights>(entity) {
        Some(MeshMorphWeights::Reference(source)) => world
            .get::<MorphWeights>(*source)
            .map_or_else(Vec::new, |weights| weights.weights().to_vec()),
        Some(MeshMorphWeights::Value { weights }) => weights.clone(),
        None => Vec::new(),
    }
}

/// The world positions of a mesh's vertices as an entity shows it.
///
/// # Panics
/// The entity has no [`GlobalTransform`], or weights that do not fit the mesh; or the mesh has a skin and a joint of the entity
/// is missing.
#[must_use]
pub fn vertices(world: &World, mesh: &MorphMesh, entity: Entity) -> Vec<DVec3> {
    let global = |entity: Entity| -> Affine3A {
        let place = world.get::<GlobalTransform>(entity);
        place.expect("what is drawn has a transform").affine()
    };
    let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights(world, entity));
    let Some(skin) = &mesh.skin else {
        return world_vertices(&posed, &global(entity));
    };
    let shown = world.get::<SkinnedMesh>(entity).expect("the mesh has a skin");
    let matrices = shown.joints.iter().zip(&skin.skeleton.joints).map(|(&entity, joint)| {
        let matrix = Mat4::from(global(entity)) * joint.inverse_bind;
        Affine3A::from_mat4(matrix)
    });
    skinned_vertices(&posed, &skin.sets, &matrices.collect::<Vec<_>>())
}

/// The box around points.
#[must_use]
pub fn extent<'a>(points: impl IntoIterator<Item = &'a DVec3>) -> (DVec3, DVec3) {
    let start = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    points
        .into_iter()
        .fold(start, |(min, max), &p| (min.min(p), max.max(p)))
}

/// The triangles whose boxes overlap a box: their indices and corners.
#[must_use]
pub fn near(triangles: &[[u32; 3]], vertices: &[DVec3], (min, max): (DVec3, DVec3)) -> (Vec<u32>, Vec<[u32; 3]>) {
    let overlaps = |corners: &[u32; 3]| {
        let (low, high) = extent(corners.iter().map(|&corner| &vertices[corner as usize]));
        low.cmple(max).all() && high.cmpge(min).all()
    };
    let all = (0..).zip(triangles.iter().copied());
    all.filter(|(_, corners)| overlaps(corners)).unzip()
}

/// The distance from its origin at which a ray hits a triangle, after Moeller and Trumbore. Hits at negative distances count as
/// misses.
#[must_use]
pub fn meets(origin: DVec3, direction: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    let from_a = origin - a;
    let u = from_a.dot(across) / determinant;
    let v = direction.dot(from_a.cross(ab)) / determinant;
    let distance = ac.dot(from_a.cross(ab)) / determinant;
    let is_hit = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= 0.0;
    is_hit.then_some(distance)
}
