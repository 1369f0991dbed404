//! Weights as a person or a file gives them: a number for each target, or names with numbers.

mod json;
mod names;
mod parse;

pub use names::{TargetNames, UnknownTarget};

/// Weights of some or all targets of a mesh.
///
/// In JSON it is a list of numbers, or an object with names and numbers. [`WeightList::parse`] reads further forms.
///
/// ```
/// use morph_collision_models::weight_list::{TargetNames, WeightList};
///
/// let names = ["jawOpen".to_owned(), "mouthSmileLeft".to_owned()];
/// let names = TargetNames::new(&names);
/// let weights = WeightList::parse("jawOpen=1").unwrap();
/// assert_eq!(names.resolve(&weights, vec![0.0, 0.25]), Ok(vec![1.0, 0.25]));
/// assert!(names.resolve(&WeightList::parse("jawOpn=1").unwrap(), vec![0.0; 2]).is_err());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum WeightList {
    /// One weight per target. An empty list stands for weights that are not given.
    All(Vec<f32>),
    /// Names of targets with their weights. A name may also be the index of a target. All other targets keep the weight they have.
    Named(Vec<(String, f32)>),
}

impl Default for WeightList {
    fn default() -> Self {
        Self::All(Vec::new())
    }
}

impl WeightList {
    /// Whether no weights are given.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        match self {
            Self::All(weights) => weights.is_empty(),
            Self::Named(weights) => weights.is_empty(),
        }
    }

    /// The numbers, in order.
    pub fn values(&self) -> impl Iterator<Item = f32> {
        let (all, named) = match self {
            Self::All(weights) => (weights.as_slice(), &[][..]),
            Self::Named(weights) => (&[][..], weights.as_slice()),
        };
        all.iter().copied().chain(named.iter().map(|(_, weight)| *weight))
    }
}
