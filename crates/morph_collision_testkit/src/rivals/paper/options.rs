//! The options of the paper's method.

use std::fmt;
use std::str::FromStr;

use glam::Vec3;
use thiserror::Error;

use super::slabs::Slabs;
use super::sphere::Sphere;
use morph_collision_models::mesh::MorphMesh;

/// How the paper's method bounds nodes. No answer depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct PaperOptions {
    /// The kind of volume.
    pub volume: PaperVolume,
    /// Whether there are also volumes half way between consecutive references (Sect. 5).
    pub in_betweens: bool,
}

impl PaperOptions {
    /// The setup of the paper's experiments.
    pub const BOXES: Self = Self {
        volume: PaperVolume::Aabb,
        in_betweens: false,
    };

    /// Every kind of volume, without and with in-betweens.
    pub fn all() -> impl Iterator<Item = Self> {
        PaperVolume::ALL
            .into_iter()
            .flat_map(|volume| [false, true].map(|in_betweens| Self { volume, in_betweens }))
    }
}

/// A kind of bounding volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PaperVolume {
    /// Axis-aligned boxes.
    #[default]
    Aabb,
    /// Boxes and the four space diagonals of a cube.
    Kdop14,
    /// Boxes and the six diagonals of a cube's faces.
    Kdop18,
    /// Boxes and both.
    Kdop26,
    /// Spheres.
    Sphere,
}

impl PaperOptions {
    /// Estimate of the peak memory for building a tree of a mesh, in bytes.
    ///
    /// There are at most twice as many nodes as triangles, and most targets that move a leaf move all its corners. Doubled for
    /// lists that grow.
    pub fn tree_bytes(self, mesh: &MorphMesh) -> u64 {
        let mut targets_of_vertex = vec![0; mesh.positions.len()];
        for target in &mesh.targets {
            for (count, displacement) in targets_of_vertex.iter_mut().zip(target) {
                *count += u64::from(*displacement != Vec3::ZERO);
            }
        }
        let corners = mesh.triangles.as_flattened().iter();
        let moved_corners: u64 = corners
            .filter_map(|&vertex| targets_of_vertex.get(vertex as usize))
            .sum();
        let displacements: u64 = targets_of_vertex.iter().sum();
        let volume = self.volume.bytes();
        let of_target = 2 * volume + 8 + if self.in_betweens { 2 * (volume + 8) } else { 0 };
        let of_vertices = mesh.positions.len() as u64 * 64 + displacements * 40;
        of_vertices + mesh.triangles.len() as u64 * 4 * (volume + 80) + moved_corners * 2 * of_target
    }

    /// Estimate of a body's own memory beside its tree, in bytes.
    pub fn body_bytes(self, mesh: &MorphMesh) -> u64 {
        mesh.positions.len() as u64 * 16 + mesh.triangles.len() as u64 * 2 * (self.volume.bytes() + 4)
    }
}

impl PaperVolume {
    const fn bytes(self) -> u64 {
        let bytes = match self {
            Self::Aabb => size_of::<Slabs<3>>(),
            Self::Kdop14 => size_of::<Slabs<7>>(),
            Self::Kdop18 => size_of::<Slabs<9>>(),
            Self::Kdop26 => size_of::<Slabs<13>>(),
            Self::Sphere => size_of::<Sphere>(),
        };
        bytes as u64
    }

    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Aabb, Self::Kdop14, Self::Kdop18, Self::Kdop26, Self::Sphere];

    const fn name(self) -> &'static str {
        match self {
            Self::Aabb => "aabb",
            Self::Kdop14 => "kdop14",
            Self::Kdop18 => "kdop18",
            Self::Kdop26 => "kdop26",
            Self::Sphere => "sphere",
        }
    }
}

impl fmt::Display for PaperVolume {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is not that of a [`PaperVolume`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown volume '{name}', expected one of: {}", PaperVolume::ALL.map(PaperVolume::name).join(", "))]
pub struct UnknownVolume {
    name: String,
}

impl FromStr for PaperVolume {
    type Err = UnknownVolume;

    fn from_str(name: &str) -> Result<Self, UnknownVolume> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownVolume { name: name.to_owned() })
    }
}
