//! Properties of a mesh that do not depend on its pose.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

use bevy::app::App;
use bevy::prelude::Resource;
use morph_collision::{MorphBvh, MorphModel, Pose};

use bevy_morph_collision::import::MorphTrees;

/// No vertex.
pub const NONE: u32 = u32::MAX;

/// How the triangles of a mesh are connected. Shared by all instances of the mesh.
pub struct MeshLayout {
    /// The position of each triangle in the order of its tree, which keeps neighbours close together.
    pub order: Vec<u32>,
    /// For each edge of a triangle, from a corner to the next, the third corner of the triangle on its other side. [`NONE`] if
    /// there is no such triangle, or more than one.
    pub across: Vec<[u32; 3]>,
    /// Whether along every edge, the same number of triangles run in either direction, so that the surface has an inside.
    pub closed: bool,
    /// If so: whether normals, by the triangles' winding, point outward (1) or inward (-1) at rest. `None` if it encloses no volume at rest.
    pub winding: Option<f32>,
}

impl MeshLayout {
    fn of(bvh: &Arc<MorphBvh>) -> Self {
        let mut order = vec![0; bvh.model().triangle_count()];
        let triangles = bvh.subtrees(usize::MAX).into_iter().flatten();
        for (index, &triangle) in (0..).zip(triangles) {
            order[triangle as usize] = index;
        }
        let (across, closed) = across(bvh.model());
        // Posing all vertices takes milliseconds, so no step does it.
        let volume = closed.then(|| volume(&mut Pose::new(bvh.clone()))).flatten();
        Self {
            order,
            across,
            closed,
            winding: volume.map(|volume| volume.signum() as f32),
        }
    }
}

/// Finds the neighbours across edges, and whether the surface is closed.
fn across(model: &MorphModel) -> (Vec<[u32; 3]>, bool) {
    let triangles: Vec<[u32; 3]> = (0..).map_while(|triangle| model.triangle(triangle)).collect();
    let mut across = vec![[NONE; 3]; triangles.len()];
    let mut edges = Vec::with_capacity(3 * across.len());
    for (triangle, corners) in triangles.iter().enumerate() {
        for edge in 0..3 {
            let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
            edges.push((a.min(b), a.max(b), triangle, edge));
        }
    }
    edges.sort_unstable();
    let mut closed = true;
    for same in edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        let (low, high) = (same[0].0, same[0].1);
        let up = same.iter().filter(|edge| triangles[edge.2][edge.3] == low).count();
        // An edge from a vertex to itself does not count.
        closed &= low == high || 2 * up == same.len();
        let &[(_, _, one, one_edge), (_, _, other, other_edge)] = same else {
            continue;
        };
        let third = |triangle: usize, edge: usize| triangles[triangle][(edge + 2) % 3];
        across[one][one_edge] = third(other, other_edge);
        across[other][other_edge] = third(one, one_edge);
    }
    (across, closed)
}

/// The part of a volume that may be rounding of vertices, relative to the volumes between a vertex and each triangle.
const ROUNDING: f64 = 1e-6;

/// Six times the volume that a pose encloses, negative if normals point inward. `None` if it does not exceed rounding errors. Joints can mirror
/// this volume, the transform does not.
pub(super) fn volume(pose: &mut Pose) -> Option<f64> {
    let origin = pose.vertex(0).unwrap_or_default().as_dvec3();
    let triangles = 0..pose.bvh().model().triangle_count() as u32;
    let volumes = triangles.filter_map(|triangle| pose.triangle(triangle)).map(|corners| {
        let [a, b, c] = corners.map(|corner| corner.as_dvec3() - origin);
        a.dot(b.cross(c))
    });
    let (volume, parts) = volumes.fold((0.0, 0.0), |(sum, parts), volume| (sum + volume, parts + volume.abs()));
    // Also false for values that are not finite.
    (volume.abs() > ROUNDING * parts).then_some(volume)
}

/// The layouts of all trees. A layout is dropped with its tree. Clones share the layouts.
///
/// A layout is computed with its tree, in the background: sorting the edges of a large mesh takes longer than a frame.
#[derive(Resource, Clone, Default)]
pub struct MeshLayouts(Arc<Mutex<Vec<(Weak<MorphBvh>, Arc<MeshLayout>)>>>);

impl MeshLayouts {
    /// Computes the layout of a new tree and keeps it as long as the tree exists.
    pub fn add(&self, bvh: &Arc<MorphBvh>) {
        let layout = Arc::new(MeshLayout::of(bvh));
        let mut layouts = self.lock();
        layouts.retain(|(of, _)| of.strong_count() > 0);
        layouts.push((Arc::downgrade(bvh), layout));
    }

    /// The layout of a tree. Every tree that is handed out has one.
    pub fn of(&self, bvh: &Arc<MorphBvh>) -> Option<Arc<MeshLayout>> {
        let layouts = self.lock();
        let known = layouts.iter().find(|(of, _)| of.as_ptr() == Arc::as_ptr(bvh));
        known.map(|(_, layout)| layout.clone())
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(Weak<MorphBvh>, Arc<MeshLayout>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Whether trees are built with layouts.
#[derive(Resource)]
struct Added;

/// From now on, computes a layout with every tree. Does nothing if called again, or if nothing builds trees.
pub fn add_to_trees(app: &mut App) {
    let world = app.world_mut();
    let Some(layouts) = world.get_resource::<MeshLayouts>().cloned() else {
        return;
    };
    if !world.contains_resource::<MorphTrees>() || world.contains_resource::<Added>() {
        return;
    }
    world.insert_resource(Added);
    let mut trees = world.resource_mut::<MorphTrees>();
    trees.on_built(move |tree| layouts.add(tree));
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;
    use morph_collision::BuildOptions;

    use super::*;

    /// The surface of a tetrahedron, limited to its first triangles.
    fn tree(triangles: usize) -> Arc<MorphBvh> {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let all = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let model = MorphModel::from_displacements::<Vec<Vec3>>(&positions, &all[..triangles], &[]).unwrap();
        Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))
    }

    #[test]
    fn closed_is_what_has_an_inside() {
        let closed = |positions: &[Vec3], triangles: &[[u32; 3]]| {
            let model = MorphModel::from_displacements::<Vec<Vec3>>(positions, triangles, &[]).unwrap();
            across(&model).1
        };
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z];
        let one = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert!(closed(&positions, &one));
        assert!(!closed(&positions, &one[1..]));
        // One triangle has the opposite winding.
        assert!(!closed(&positions, &[[0, 1, 2], one[1], one[2], one[3]]));
        // Another tetrahedron shares the edge from 0 to 1, which four triangles then use.
        let other = [[0, 6, 1], [0, 1, 5], [1, 6, 5], [0, 5, 6]];
        assert!(closed(&positions, &[one, other].concat()));
        assert!(!closed(&positions, &[&one[..], &other[1..]].concat()));
        // A triangle without area uses an edge in both directions.
        assert!(closed(&positions, &[&one[..], &[[0, 1, 1]]].concat()));
    }

    #[test]
    fn the_sides_of_a_closed_mesh_are_known_before_it_is_posed() {
        let winding = |triangles: &[[u32; 3]], height: f32| {
            let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z * height];
            let model = MorphModel::from_displacements::<Vec<Vec3>>(&positions, triangles, &[]).unwrap();
            MeshLayout::of(&Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()))).winding
        };
        let out = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(winding(&out, 1.0), Some(1.0));
        assert_eq!(winding(&out.map(|[a, b, c]| [a, c, b]), 1.0), Some(-1.0));
        assert_eq!(winding(&out, 0.0), None, "flat");
        assert_eq!(winding(&out[1..], 1.0), None, "open");
    }

    #[test]
    fn a_layout_is_computed_once_and_never_by_whoever_asks() {
        let layouts = MeshLayouts::default();
        let (one, other) = (tree(4), tree(3));
        assert!(layouts.of(&one).is_none());
        let in_background = layouts.clone();
        std::thread::scope(|scope| {
            scope.spawn(|| [&one, &other].map(|tree| in_background.add(tree)));
        });
        let [first, again] = [(); 2].map(|()| layouts.of(&one).unwrap());
        assert!(Arc::ptr_eq(&first, &again));
        assert!(first.closed && !layouts.of(&other).unwrap().closed);
        drop(one);
        layouts.add(&tree(4));
        assert_eq!(layouts.lock().len(), 2, "layouts go with their trees");
    }
}
