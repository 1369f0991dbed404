use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// The kind of bounding volume a tree is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum VolumeKind {
    /// Axis-aligned boxes, in model space.
    #[default]
    Aabb,
    /// Boxes with their corners cut off: 7 slabs.
    Kdop14,
    /// Boxes with their edges cut off: 9 slabs.
    Kdop18,
    /// Boxes with corners and edges cut off: 13 slabs.
    Kdop26,
    /// Spheres.
    Sphere,
}

impl VolumeKind {
    /// All kinds, cheapest boxes first.
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

impl fmt::Display for VolumeKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// How a node's triangles are shared out among its children.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
#[non_exhaustive]
pub enum Split {
    /// The paper's: at the middle of the node's extents along its longest axes, all three for eight children.
    Midpoint,
    /// Surface-area heuristic on the partition shape, binned.
    Sah,
    /// Surface-area heuristic summed over the base and the targets: one tree good for all.
    #[default]
    PoseSah,
}

impl Split {
    /// All rules.
    pub const ALL: [Self; 3] = [Self::Midpoint, Self::Sah, Self::PoseSah];

    const fn name(self) -> &'static str {
        match self {
            Self::Midpoint => "midpoint",
            Self::Sah => "sah",
            Self::PoseSah => "pose-sah",
        }
    }
}

impl fmt::Display for Split {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// A name that [`VolumeKind`] or [`Split`] does not know.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("unknown name '{name}', expected one of: {expected}")]
pub struct UnknownName {
    name: String,
    expected: String,
}

fn parse<T: Copy + fmt::Display>(name: &str, all: &[T]) -> Result<T, UnknownName> {
    all.iter()
        .copied()
        .find(|kind| kind.to_string() == name)
        .ok_or_else(|| UnknownName {
            name: name.to_owned(),
            expected: all.iter().map(T::to_string).collect::<Vec<_>>().join(", "),
        })
}

impl FromStr for VolumeKind {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        parse(name, &Self::ALL)
    }
}

impl FromStr for Split {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        parse(name, &Self::ALL)
    }
}

/// The shape on which triangles are put together.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum PartitionShape {
    /// All weights zero.
    #[default]
    Base,
    /// One target at weight 1.
    Target(usize),
    /// The mean of the base and of every target at weight 1.
    Average,
    /// Any weights.
    Weights(Vec<f32>),
}
