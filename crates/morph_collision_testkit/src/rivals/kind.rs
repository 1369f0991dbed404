//! The methods by name.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use thiserror::Error;

use super::blended::WeldedMesh;
use super::bottom_up::BottomUp;
use super::brute_force::BruteForce;
use super::hybrid::Hybrid;
use super::joint_boxes::JointBoxes;
use super::morph::{Follow, Morph};
use super::paper::{self, PaperOptions};
use super::parry::Parry;
use super::rigid_floor::RigidFloor;
use super::walk::Trees;
use super::{Method, MethodOptions, SetUpError};
use morph_collision_models::mesh::MorphMesh;

/// A method, by name. The [module's table](super) describes each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MethodKind {
    /// This project's method.
    #[default]
    Morph,
    /// Refits the upper half bottom-up, the lower half on demand, with this project's code.
    Hybrid,
    /// Refits every box, from the leaves up, with this project's code.
    BottomUp,
    /// This project's method over meshes frozen beforehand in every shape.
    RigidFloor,
    /// The paper's own method.
    Paper(PaperOptions),
    /// [`MethodKind::Hybrid`] as it is usually written.
    HybridScalar,
    /// [`MethodKind::BottomUp`] as it is usually written.
    BottomUpScalar,
    /// Boxes around the images of one box per joint, each around the vertices that the joint moves.
    JointBoxes,
    /// Parry's triangle mesh with updated vertices.
    ParryTriMesh,
    /// All triangles against all, by the oracle.
    BruteForce,
}

impl MethodKind {
    /// All methods; the paper's with boxes.
    pub const ALL: [Self; 10] = [
        Self::Morph,
        Self::Hybrid,
        Self::BottomUp,
        Self::RigidFloor,
        Self::Paper(PaperOptions::BOXES),
        Self::HybridScalar,
        Self::BottomUpScalar,
        Self::JointBoxes,
        Self::ParryTriMesh,
        Self::BruteForce,
    ];

    const fn name(self) -> &'static str {
        match self {
            Self::Morph => "morph",
            Self::Hybrid => "hybrid",
            Self::BottomUp => "bottom-up",
            Self::RigidFloor => "rigid-floor",
            Self::Paper(_) => "paper",
            Self::HybridScalar => "hybrid-scalar",
            Self::BottomUpScalar => "bottom-up-scalar",
            Self::JointBoxes => "joint-boxes",
            Self::ParryTriMesh => "parry-trimesh",
            Self::BruteForce => "brute-force",
        }
    }

    /// Whether it supports skinned meshes.
    #[must_use]
    pub const fn supports_skins(self) -> bool {
        !matches!(self, Self::Paper(_))
    }

    /// Whether it is meaningful only for skinned meshes; otherwise benchmarks leave it out.
    #[must_use]
    pub const fn is_for_skins(self) -> bool {
        matches!(self, Self::JointBoxes)
    }

    /// Whether it uses this project's trees, walks and kernels, so that options of our trees suit it.
    #[must_use]
    pub const fn uses_our_trees(self) -> bool {
        matches!(self, Self::Morph | Self::Hybrid | Self::BottomUp | Self::RigidFloor)
    }

    /// Whether it casts rays.
    #[must_use]
    pub const fn casts_rays(self) -> bool {
        !matches!(self, Self::RigidFloor | Self::Paper(_))
    }

    /// Builds the data per mesh, and one body for each entry of `bodies`, which is the index of its mesh.
    ///
    /// # Errors
    /// [`MorphMesh::to_model`] refuses a mesh, an option is out of range, or a body's mesh does not exist.
    // A program that always sets up the same method does not contain the others.
    #[inline(always)]
    pub fn set_up(
        self,
        meshes: &[MorphMesh],
        bodies: &[usize],
        options: &MethodOptions,
    ) -> Result<Box<dyn Method>, SetUpError> {
        if let Some(body) = bodies.iter().position(|&mesh| mesh >= meshes.len()) {
            let (mesh, meshes) = (bodies[body], meshes.len());
            return Err(SetUpError::NoSuchMesh { body, mesh, meshes });
        }
        if !self.supports_skins()
            && let Some(mesh) = meshes.iter().position(|mesh| mesh.skin.is_some())
        {
            return Err(SetUpError::Skinned { mesh, method: self });
        }
        let welded = || {
            meshes
                .iter()
                .enumerate()
                .map(|(mesh, source)| match WeldedMesh::new(source) {
                    Ok(welded) => Ok(Arc::new(welded)),
                    Err(reason) => Err(SetUpError::Model { mesh, reason }),
                })
                .collect::<Result<Vec<_>, _>>()
        };
        Ok(match self {
            Self::Morph => Box::new(Morph::new(Follow::Lazily, meshes, bodies, options)?),
            Self::Hybrid => Box::new(Morph::new(Follow::ByHalves, meshes, bodies, options)?),
            Self::BottomUp => Box::new(Morph::new(Follow::AtOnce, meshes, bodies, options)?),
            Self::RigidFloor => Box::new(RigidFloor::new(meshes, bodies, options)?),
            Self::Paper(options) => paper::set_up(&welded()?, bodies, options),
            Self::HybridScalar => Box::new(Trees::<Hybrid>::new(&welded()?, bodies, options)),
            Self::BottomUpScalar => Box::new(Trees::<BottomUp>::new(&welded()?, bodies, options)),
            Self::JointBoxes => Box::new(Trees::<JointBoxes>::new(&welded()?, bodies, options)),
            Self::ParryTriMesh => Box::new(Parry::new(&welded()?, bodies)?),
            Self::BruteForce => Box::new(BruteForce::new(&welded()?, bodies)),
        })
    }
}

impl fmt::Display for MethodKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that is not that of a [`MethodKind`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown method '{name}', expected one of: {}", MethodKind::ALL.map(MethodKind::name).join(", "))]
pub struct UnknownMethod {
    name: String,
}

impl FromStr for MethodKind {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| UnknownMethod { name: name.to_owned() })
    }
}
