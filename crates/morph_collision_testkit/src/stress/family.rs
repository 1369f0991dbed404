use std::fmt;

/// A kind of difficult input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Nothing difficult: the baseline for the others.
    Ordinary,
    /// Models of sizes from 1e-30 to 1e30.
    Scale,
    /// Bodies ten million sizes from the origin.
    FarOut,
    /// Gaps and overlaps of 1 to a million units in the last place.
    LastPlace,
    /// Sheets in one plane.
    Coplanar,
    /// Triangles a millionth as wide as they are long.
    Slivers,
    /// Triangles that are points or segments.
    ZeroArea,
    /// Separate vertices for every corner, and vertices that no triangle uses.
    Duplicated,
    /// Weights up to a million of either sign.
    LargeWeights,
    /// 256 targets.
    ManyTargets,
    /// Large displacements that almost cancel.
    Cancelling,
    /// Mirrored bodies.
    Mirrored,
    /// Sheared bodies.
    Sheared,
    /// Bodies with scale 0 along an axis or two.
    Flattened,
    /// Matrices with columns of any length and angle, including nearly dependent ones.
    NotOrthonormal,
    /// Subnormal coordinates, weights and placements.
    Denormals,
    /// NaN, infinity and values out of range, in every place that takes numbers.
    BadInput,
    /// Skinned bodies with rotated, scaled, sheared and mirrored joints.
    Skinned,
    /// Skinned bodies with joints of scale 0, or that collapse to a point.
    CollapsedJoints,
    /// Skinned bodies with weight sums from 0 to 3.
    UnnormalisedSkin,
    /// Separate triangles with random influences, up to eight per vertex, of up to 256 joints.
    RandomSkin,
    /// Skinned bodies at up to 1e5 units from the origin.
    FarJoints,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 22] = [
        Self::Ordinary,
        Self::Scale,
        Self::FarOut,
        Self::LastPlace,
        Self::Coplanar,
        Self::Slivers,
        Self::ZeroArea,
        Self::Duplicated,
        Self::LargeWeights,
        Self::ManyTargets,
        Self::Cancelling,
        Self::Mirrored,
        Self::Sheared,
        Self::Flattened,
        Self::NotOrthonormal,
        Self::Denormals,
        Self::BadInput,
        Self::Skinned,
        Self::CollapsedJoints,
        Self::UnnormalisedSkin,
        Self::RandomSkin,
        Self::FarJoints,
    ];

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ordinary => "ordinary",
            Self::Scale => "scale",
            Self::FarOut => "far-out",
            Self::LastPlace => "last-place",
            Self::Coplanar => "coplanar",
            Self::Slivers => "slivers",
            Self::ZeroArea => "zero-area",
            Self::Duplicated => "duplicated",
            Self::LargeWeights => "large-weights",
            Self::ManyTargets => "many-targets",
            Self::Cancelling => "cancelling",
            Self::Mirrored => "mirrored",
            Self::Sheared => "sheared",
            Self::Flattened => "flattened",
            Self::NotOrthonormal => "not-orthonormal",
            Self::Denormals => "denormals",
            Self::BadInput => "bad-input",
            Self::Skinned => "skinned",
            Self::CollapsedJoints => "collapsed-skin",
            Self::UnnormalisedSkin => "skin-sums",
            Self::RandomSkin => "random-skin",
            Self::FarJoints => "far-skin",
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
