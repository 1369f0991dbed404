use thiserror::Error;

use super::{PartitionShape, Split, VolumeKind};

/// How to build a [`MorphBvh`](crate::MorphBvh).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct BuildOptions {
    /// The kind of bounding volume.
    pub volume: VolumeKind,
    /// Children of a node at most: 2, 4 or 8.
    pub arity: usize,
    /// A node with at most this many triangles becomes a leaf; 1 to 255.
    pub leaf_size: usize,
    /// How triangles are shared out among children.
    pub split: Split,
    /// The shape that [`Split::Midpoint`] and [`Split::Sah`] look at, and on which [`Split::PoseSah`] places its planes.
    pub shape: PartitionShape,
    /// The scales of the references that volumes are blended from, positive: at scale 1 a volume is tight at each
    /// reference, at larger ones less so, but for larger sums of weights. Interval arithmetic is always there beside them.
    pub scales: Vec<f32>,
    /// Whether references are reflected, too, which tightens volumes under negative weights.
    pub reflected: bool,
    /// Tight volumes half way between consecutive references (the paper's Sect. 5).
    pub in_betweens: bool,
    /// Whether leaves have tables. Without, their volumes are fitted to their blended vertices, tightly: less memory, more
    /// time where many leaves are looked at but few of their triangles.
    pub leaf_tables: bool,
    /// Whether tables are kept in 16 bits per number, rounded outward: half the bytes, a little more time.
    pub compact: bool,
}

impl BuildOptions {
    /// The paper's setting: boxes, eight children, one triangle per leaf, split at the middle of the extents.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            leaf_size: 1,
            split: Split::Midpoint,
            ..Self::default()
        }
    }

    /// Sets [`BuildOptions::volume`].
    #[must_use]
    pub fn with_volume(mut self, volume: VolumeKind) -> Self {
        self.volume = volume;
        self
    }

    /// Sets [`BuildOptions::arity`].
    #[must_use]
    pub fn with_arity(mut self, arity: usize) -> Self {
        self.arity = arity;
        self
    }

    /// Sets [`BuildOptions::leaf_size`].
    #[must_use]
    pub fn with_leaf_size(mut self, leaf_size: usize) -> Self {
        self.leaf_size = leaf_size;
        self
    }

    /// Sets [`BuildOptions::split`].
    #[must_use]
    pub fn with_split(mut self, split: Split) -> Self {
        self.split = split;
        self
    }

    /// Sets [`BuildOptions::shape`].
    #[must_use]
    pub fn with_shape(mut self, shape: PartitionShape) -> Self {
        self.shape = shape;
        self
    }

    /// Sets [`BuildOptions::scales`].
    #[must_use]
    pub fn with_scales(mut self, scales: impl Into<Vec<f32>>) -> Self {
        self.scales = scales.into();
        self
    }

    /// Sets [`BuildOptions::reflected`].
    #[must_use]
    pub fn with_reflected(mut self, reflected: bool) -> Self {
        self.reflected = reflected;
        self
    }

    /// Sets [`BuildOptions::in_betweens`].
    #[must_use]
    pub fn with_in_betweens(mut self, in_betweens: bool) -> Self {
        self.in_betweens = in_betweens;
        self
    }

    /// Sets [`BuildOptions::leaf_tables`].
    #[must_use]
    pub fn with_leaf_tables(mut self, leaf_tables: bool) -> Self {
        self.leaf_tables = leaf_tables;
        self
    }

    /// Sets [`BuildOptions::compact`].
    #[must_use]
    pub fn with_compact(mut self, compact: bool) -> Self {
        self.compact = compact;
        self
    }

    /// Chooses [`BuildOptions::scales`] and [`BuildOptions::reflected`] for the weights a model will have: samples of its own
    /// animations, say, one weight vector each.
    ///
    /// Weights that sum to at most 1 are bounded best by the references themselves, larger sums by references scaled up
    /// to about half the sum (measured on captured faces, see `docs/performance.md`). Without samples nothing changes.
    #[must_use]
    pub fn fitted_to<W: AsRef<[f32]>>(mut self, samples: impl IntoIterator<Item = W>) -> Self {
        let mut sums = Vec::new();
        let mut negative = false;
        for sample in samples {
            let weights = sample.as_ref();
            sums.push(weights.iter().copied().filter(|w| *w > 0.0).sum::<f32>());
            // Exporters leave weights like -1e-7 behind, which are not worth a table.
            negative |= weights.iter().any(|w| *w < -0.05);
        }
        sums.retain(|sum| sum.is_finite());
        sums.sort_by(f32::total_cmp);
        if let Some(&median) = sums.get(sums.len() / 2) {
            let scale = if median <= 1.01 {
                1.0
            } else {
                (0.5 * median).max(1.0).log2().round().exp2()
            };
            self.scales = vec![scale.min(1024.0)];
            self.reflected = negative;
        }
        self
    }

    pub(super) fn check(&self, targets: usize) -> Result<(), BuildError> {
        if ![2, 4, 8].contains(&self.arity) {
            return Err(BuildError::Arity(self.arity));
        }
        if !(1..=255).contains(&self.leaf_size) {
            return Err(BuildError::LeafSize(self.leaf_size));
        }
        if let Some(&scale) = self.scales.iter().find(|s| !(1e-3..=1e6).contains(*s)) {
            return Err(BuildError::Scale(scale));
        }
        match &self.shape {
            PartitionShape::Target(target) if *target >= targets => Err(BuildError::NoSuchTarget {
                target: *target,
                targets,
            }),
            PartitionShape::Weights(weights) if weights.len() != targets => Err(BuildError::ShapeWeights {
                given: weights.len(),
                expected: targets,
            }),
            PartitionShape::Weights(weights) => match weights.iter().position(|w| !w.is_finite()) {
                Some(index) => Err(BuildError::ShapeWeight {
                    index,
                    value: weights[index],
                }),
                None => Ok(()),
            },
            _ => Ok(()),
        }
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            volume: VolumeKind::Aabb,
            arity: 8,
            leaf_size: 8,
            split: Split::PoseSah,
            shape: PartitionShape::Base,
            scales: vec![1.0],
            reflected: false,
            in_betweens: false,
            leaf_tables: true,
            compact: false,
        }
    }
}

/// Why a tree cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// [`BuildOptions::arity`] is not 2, 4 or 8.
    #[error("arity is {0}, it must be 2, 4 or 8")]
    Arity(usize),
    /// [`BuildOptions::leaf_size`] is 0 or above 255.
    #[error("leaf_size is {0}, it must be from 1 to 255")]
    LeafSize(usize),
    /// A scale is not a number between 0.001 and a million.
    #[error("scale {0} is not between 0.001 and 1000000")]
    Scale(f32),
    /// [`PartitionShape::Target`] names a target that is not there.
    #[error("partition shape: there is no target {target}, the mesh has {targets}")]
    NoSuchTarget {
        /// The target.
        target: usize,
        /// How many there are.
        targets: usize,
    },
    /// [`PartitionShape::Weights`] has not one weight per target.
    #[error("partition shape: {given} weights were given, the mesh has {expected} targets")]
    ShapeWeights {
        /// How many were given.
        given: usize,
        /// How many targets there are.
        expected: usize,
    },
    /// A weight of [`PartitionShape::Weights`] is NaN or infinite.
    #[error("partition shape: weight {index} is {value}, not a finite number")]
    ShapeWeight {
        /// The target.
        index: usize,
        /// Its weight.
        value: f32,
    },
}
