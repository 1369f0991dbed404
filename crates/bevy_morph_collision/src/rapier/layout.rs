//! What is known of a mesh whatever its pose.

use std::sync::{Arc, Weak};

use bevy::prelude::Resource;
use morph_collision::{MorphBvh, MorphModel};

/// No vertex.
pub(super) const NONE: u32 = u32::MAX;

/// How the triangles of a mesh lie; shared by all that show it.
pub(super) struct MeshLayout {
    /// Where each triangle stands in the order of its tree, in which neighbours are near each other.
    pub(super) order: Vec<u32>,
    /// For each edge of a triangle, from a corner to the next, the third corner of the triangle on its other side; [`NONE`] if
    /// there is no such triangle, or several.
    pub(super) across: Vec<[u32; 3]>,
    /// Whether every edge has two triangles that run along it in opposite directions: the surface has an inside.
    pub(super) closed: bool,
}

impl MeshLayout {
    fn of(bvh: &MorphBvh) -> Self {
        let mut order = vec![0; bvh.model().triangle_count()];
        let triangles = bvh.subtrees(usize::MAX).into_iter().flatten();
        for (place, &triangle) in (0..).zip(triangles) {
            order[triangle as usize] = place;
        }
        let (across, closed) = across(bvh.model());
        Self { order, across, closed }
    }
}

/// What is on the other sides of edges, and whether the surface is closed.
fn across(model: &MorphModel) -> (Vec<[u32; 3]>, bool) {
    let mut across = vec![[NONE; 3]; model.triangle_count()];
    let mut edges = Vec::with_capacity(3 * across.len());
    for triangle in 0..across.len() {
        let corners = model.triangle(triangle);
        for edge in 0..3 {
            let (a, b) = (corners[edge], corners[(edge + 1) % 3]);
            edges.push((a.min(b), a.max(b), triangle, edge));
        }
    }
    edges.sort_unstable();
    let mut closed = true;
    for same in edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
        let &[(_, _, one, one_edge), (_, _, other, other_edge)] = same else {
            closed = false;
            continue;
        };
        closed &= model.triangle(one)[one_edge] != model.triangle(other)[other_edge];
        let third = |triangle: usize, edge: usize| model.triangle(triangle)[(edge + 2) % 3];
        across[one][one_edge] = third(other, other_edge);
        across[other][other_edge] = third(one, one_edge);
    }
    (across, closed)
}

/// The layouts of all trees that are in use.
#[derive(Resource, Default)]
pub(super) struct MeshLayouts(Vec<(Weak<MorphBvh>, Weak<MeshLayout>)>);

impl MeshLayouts {
    pub(super) fn of(&mut self, bvh: &Arc<MorphBvh>) -> Arc<MeshLayout> {
        self.0.retain(|(_, layout)| layout.strong_count() > 0);
        let known = self.0.iter().find(|(of, _)| of.as_ptr() == Arc::as_ptr(bvh));
        if let Some(layout) = known.and_then(|(_, layout)| layout.upgrade()) {
            return layout;
        }
        let layout = Arc::new(MeshLayout::of(bvh));
        self.0.push((Arc::downgrade(bvh), Arc::downgrade(&layout)));
        layout
    }
}
