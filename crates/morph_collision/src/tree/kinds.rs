//! The kind of volume, chosen when a tree is built and found again by every query in one `match`.

use std::sync::Arc;

use super::Tables;
use crate::bounds::{Slabs, Spheres};

/// The tables of a tree, whatever the kind of volume.
#[derive(Clone, Debug)]
pub(crate) enum AnyTables {
    Aabb(Arc<Tables<Slabs<3>>>),
    Kdop14(Arc<Tables<Slabs<7>>>),
    Kdop18(Arc<Tables<Slabs<9>>>),
    Kdop26(Arc<Tables<Slabs<13>>>),
    Sphere(Arc<Tables<Spheres>>),
}

impl AnyTables {
    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Aabb(tables) => tables.bytes(),
            Self::Kdop14(tables) => tables.bytes(),
            Self::Kdop18(tables) => tables.bytes(),
            Self::Kdop26(tables) => tables.bytes(),
            Self::Sphere(tables) => tables.bytes(),
        }
    }

    pub(super) fn local_targets(&self) -> usize {
        match self {
            Self::Aabb(tables) => tables.local_targets(),
            Self::Kdop14(tables) => tables.local_targets(),
            Self::Kdop18(tables) => tables.local_targets(),
            Self::Kdop26(tables) => tables.local_targets(),
            Self::Sphere(tables) => tables.local_targets(),
        }
    }
}
