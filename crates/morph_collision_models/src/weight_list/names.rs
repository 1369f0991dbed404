//! The names of targets.

use std::collections::{HashMap, HashSet};

use thiserror::Error;

use super::WeightList;
use crate::text::{Printable, suggestion};

/// A name that does not name a target.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum UnknownTarget {
    /// No target has this name or index.
    #[error("there is no target \"{}\" among the {count}{suggestion}", Printable(name))]
    Missing {
        /// The name.
        name: String,
        /// The number of targets.
        count: usize,
        /// The end of the message: targets with similar names.
        suggestion: String,
    },
    /// Several targets have this name.
    #[error(
        "targets {first} and {second} are both named \"{}\"; give an index instead of the name, as in {first}=0.5",
        Printable(name)
    )]
    Ambiguous {
        /// The name.
        name: String,
        /// The first target with it.
        first: usize,
        /// The second.
        second: usize,
    },
    /// The same target is given twice.
    #[error("target \"{}\" is given twice", Printable(.0))]
    Twice(String),
}

/// The names of a mesh's targets, for quick look-ups.
#[derive(Debug)]
pub struct TargetNames<'a> {
    names: &'a [String],
    /// The first target with each name, and the second if there is one.
    by_name: HashMap<&'a str, (usize, Option<usize>)>,
}

impl<'a> TargetNames<'a> {
    /// The names in the order of the targets.
    #[must_use]
    pub fn new(names: &'a [String]) -> Self {
        let mut by_name = HashMap::with_capacity(names.len());
        for (target, name) in names.iter().enumerate() {
            let (first, second) = by_name.entry(name.as_str()).or_insert((target, None));
            if *first != target {
                second.get_or_insert(target);
            }
        }
        Self { names, by_name }
    }

    /// The targets of named weights, in the order given; none for a full list.
    ///
    /// # Errors
    /// A name that does not name a target, or a target that is named twice.
    pub fn targets(&self, list: &WeightList) -> Result<Vec<(usize, f32)>, UnknownTarget> {
        let WeightList::Named(named) = list else {
            return Ok(Vec::new());
        };
        let mut found = Vec::with_capacity(named.len());
        let mut seen = HashSet::with_capacity(named.len());
        for (name, weight) in named {
            let target = self.find(name)?;
            if !seen.insert(target) {
                return Err(UnknownTarget::Twice(name.clone()));
            }
            found.push((target, *weight));
        }
        Ok(found)
    }

    /// One weight per target: those of the list, and for all other targets those of `others`. A full list is returned as it is, whatever
    /// its length.
    ///
    /// # Errors
    /// See [`TargetNames::targets`].
    pub fn resolve(&self, list: &WeightList, others: Vec<f32>) -> Result<Vec<f32>, UnknownTarget> {
        if let WeightList::All(weights) = list
            && !weights.is_empty()
        {
            return Ok(weights.clone());
        }
        let mut weights = others;
        weights.resize(self.names.len(), 0.0);
        for (target, weight) in self.targets(list)? {
            weights[target] = weight;
        }
        Ok(weights)
    }

    /// The target with this name or, if there is none, with this index.
    fn find(&self, name: &str) -> Result<usize, UnknownTarget> {
        match self.by_name.get(name) {
            Some(&(first, None)) => return Ok(first),
            Some(&(first, Some(second))) => {
                return Err(UnknownTarget::Ambiguous {
                    name: name.to_owned(),
                    first,
                    second,
                });
            }
            None => {}
        }
        let index = name.parse().ok().filter(|index| *index < self.names.len());
        index.ok_or_else(|| UnknownTarget::Missing {
            name: name.to_owned(),
            count: self.names.len(),
            suggestion: suggestion(name, self.names.iter().map(String::as_str)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_and_unknown_ones_get_the_nearest() {
        let names = ["jawOpen", "same", "7", "same", "tail"].map(str::to_owned);
        let resolve = |text: &str| {
            let list = WeightList::parse(text).expect("it can be parsed");
            TargetNames::new(&names)
                .resolve(&list, vec![0.5; 5])
                .map_err(|error| error.to_string())
        };
        assert_eq!(resolve("tail=1,7=2,0=3"), Ok(vec![3.0, 0.5, 2.0, 0.5, 1.0]));
        assert_eq!(resolve("1,2"), Ok(vec![1.0, 2.0]), "callers check the length");
        for (text, parts) in [
            (
                "jawOpn=1",
                &["no target \"jawOpn\" among the 5", "did you mean \"jawOpen\"?"][..],
            ),
            ("9=1", &["no target \"9\""]),
            ("same=1", &["targets 1 and 3", "as in 1=0.5"]),
            ("tail=1,4=1", &["\"4\" is given twice"]),
        ] {
            let error = resolve(text).expect_err(text);
            for part in parts {
                assert!(error.contains(part), "{text:?}: {error}");
            }
        }
        let rest = TargetNames::new(&names).resolve(&WeightList::default(), vec![0.25; 5]);
        assert_eq!(rest, Ok(vec![0.25; 5]));
    }
}
