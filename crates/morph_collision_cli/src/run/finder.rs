//! What a replay needs of bodies, and this library's own.

use glam::DVec3;
use morph_collision::batch::Wanted;
use morph_collision::{Aabb, PairQuery, QueryStats, TrianglePair};
use morph_collision_models::mesh::MorphMesh;

use crate::cast::posed::Posed;
use crate::cast::{SetUp, Shape, Source};
use crate::error::AnyError;
use crate::options::tree::TreeArgs;

/// Poses the bodies of a scene, and finds the triangles in which they intersect.
pub trait PairFinder {
    /// Sets a body's weights, joints and placement.
    ///
    /// # Errors
    /// They do not fit the body, or are out of range.
    fn set(&mut self, body: usize, shape: &Shape) -> Result<(), AnyError>;

    /// A conservative box around a body in world space.
    fn world_bounds(&mut self, body: usize) -> Aabb;

    /// Appends the pairs of triangles in which two bodies intersect, in any order and at most as many as wanted.
    fn find(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>);

    /// The vertices of a body, which has this mesh and this shape, in world space.
    fn vertices(&mut self, body: usize, mesh: &MorphMesh, shape: &Shape) -> Vec<DVec3>;

    /// The work done since set-up.
    fn work(&self) -> QueryStats;
}

/// Bodies with this library's trees.
#[derive(Debug)]
pub(super) struct Own {
    bodies: Vec<Posed>,
    query: PairQuery,
    work: QueryStats,
}

/// Sets up [`Own`].
pub(super) struct OwnTrees<'a>(pub(super) &'a TreeArgs);

impl SetUp for OwnTrees<'_> {
    type Bodies = Own;

    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64) {
        self.0.bytes(mesh)
    }

    fn set_up(&self, source: &Source<'_>) -> Result<Own, AnyError> {
        Ok(Own {
            bodies: self.0.set_up(source)?,
            query: PairQuery::new(),
            work: QueryStats::default(),
        })
    }
}

impl PairFinder for Own {
    fn set(&mut self, body: usize, shape: &Shape) -> Result<(), AnyError> {
        Ok(self.bodies[body].set(shape)?)
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        self.bodies[body].broad_phase_bounds()
    }

    fn find(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let Ok([first, second]) = self.bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        let (first, second) = (first.body(), second.body());
        match wanted {
            Wanted::First => pairs.extend(self.query.first(first, second)),
            _ => {
                self.query.up_to(first, second, wanted.limit(), pairs);
            }
        }
        self.work += self.query.stats();
    }

    fn vertices(&mut self, body: usize, _: &MorphMesh, _: &Shape) -> Vec<DVec3> {
        self.bodies[body].vertices()
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
