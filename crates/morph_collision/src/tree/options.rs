//! How a tree is built.

use crate::input_error::{InputError, check_number};

/// How to build a [`MorphBvh`](crate::MorphBvh). Options affect speed and memory, never an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BuildOptions {
    #[cfg_attr(feature = "serde", serde(deserialize_with = "deserialize_leaf_size"))]
    leaf_size: usize,
}

impl BuildOptions {
    /// The maximum number of triangles in a leaf. Nodes with at most this many triangles become leaves.
    #[must_use]
    pub fn leaf_size(&self) -> usize {
        self.leaf_size
    }

    /// Sets the leaf size; the default is 8.
    ///
    /// # Errors
    /// [`InputError::BadNumber`] unless `leaf_size` is from 1 to 255.
    pub fn with_leaf_size(mut self, leaf_size: usize) -> Result<Self, InputError> {
        let is_good = (1..=255).contains(&leaf_size);
        check_number("leaf_size", leaf_size as f64, is_good, "a whole number from 1 to 255")?;
        self.leaf_size = leaf_size;
        Ok(self)
    }
}

impl Default for BuildOptions {
    fn default() -> Self {
        // Fills one patch of eight lanes. docs/measurements/leaves.md has the times of other sizes.
        Self { leaf_size: 8 }
    }
}

#[cfg(feature = "serde")]
fn deserialize_leaf_size<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    let leaf_size = serde::Deserialize::deserialize(deserializer)?;
    let options = BuildOptions::default().with_leaf_size(leaf_size);
    options.map(|_| leaf_size).map_err(serde::de::Error::custom)
}
