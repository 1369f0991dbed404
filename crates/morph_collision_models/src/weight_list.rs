//! Weights as a person or a file gives them: a number for each target, or names with numbers.

use std::collections::{HashMap, HashSet};
use std::fmt;

use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};
use thiserror::Error as ThisError;

use crate::text::{Printable, suggestion};

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

/// A name that does not name a target.
#[derive(Clone, Debug, PartialEq, Eq, ThisError)]
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

    /// Reads weights from text, in one of these forms:
    ///
    /// - `0.5,0,1`: one number per target;
    /// - `jawOpen=1,mouthSmileLeft=0.5`;
    /// - several lines of `name=number` or `name,number`. A first line `name,weight` (also `target`, `value`) is skipped, and so are empty
    ///   lines and those that begin with `#`;
    /// - JSON: `[0.5, 0, 1]` or `{"jawOpen": 1}`.
    ///
    /// # Errors
    /// A message that says what is wrong, and on which line if there are several.
    pub fn parse(text: &str) -> Result<Self, String> {
        let text = text.trim_start_matches('\u{feff}').trim();
        if text.starts_with(['{', '[']) {
            return serde_json::from_str(text).map_err(|error| error.to_string());
        }
        let lines = text.lines().map(str::trim).enumerate();
        let lines: Vec<_> = lines
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'))
            .collect();
        if let [(_, line)] = lines[..]
            && !line.contains('=')
            && named(line).is_none()
        {
            return numbers(line).map(Self::All);
        }
        let mut weights = Vec::new();
        for (position, &(index, line)) in lines.iter().enumerate() {
            let at = |reason: String| match lines.len() {
                1 => reason,
                _ => format!("line {}: {reason}", index + 1),
            };
            if let Some(pair) = named(line) {
                weights.push(pair);
            } else if line.contains('=') {
                for pair in line.split(',') {
                    weights.push(assigned(pair).map_err(at)?);
                }
            } else if position > 0 || !is_header(line) {
                return Err(at(format!("expected name=number, found \"{}\"", Printable(line))));
            }
        }
        match weights.is_empty() {
            true => Err("no weights are given".to_owned()),
            false => Ok(Self::Named(weights)),
        }
    }
}

/// Whether a line names the columns of a table. Any other word in place of a number is a mistake.
fn is_header(line: &str) -> bool {
    let words = line.split_once(',').map(|(name, value)| [name, value].map(str::trim));
    words.is_some_and(|[name, value]| {
        let is_one_of = |word: &str, known: &[&str]| known.iter().any(|known| word.eq_ignore_ascii_case(known));
        is_one_of(name, &["name", "target", "shape"]) && is_one_of(value, &["weight", "value"])
    })
}

/// `name=number`. The last `=` counts, because names may contain it.
fn assigned(pair: &str) -> Result<(String, f32), String> {
    let expected = || format!("expected name=number, found \"{}\"", Printable(pair.trim()));
    let (name, number) = pair.rsplit_once('=').ok_or_else(expected)?;
    let number = number.trim().parse().map_err(|_| expected())?;
    Ok((unquoted(name), number))
}

/// `name,number`, a row of a table; `None` for anything else. A name that contains a comma is in quotes.
fn named(line: &str) -> Option<(String, f32)> {
    let (name, number) = line.rsplit_once(',')?;
    let number = unquoted(number).parse().ok()?;
    let name = name.trim();
    let is_name = name.starts_with('"') || !(name.contains([',', '=']) || name.parse::<f32>().is_ok());
    is_name.then(|| (unquoted(name), number))
}

fn unquoted(name: &str) -> String {
    let name = name.trim();
    let inside = name.strip_prefix('"').and_then(|name| name.strip_suffix('"'));
    inside.map_or_else(|| name.to_owned(), |inside| inside.replace("\"\"", "\""))
}

fn numbers(list: &str) -> Result<Vec<f32>, String> {
    let number = |(index, text): (usize, &str)| {
        let text = text.trim();
        let wrong = || format!("number {index} is \"{}\"", Printable(text));
        text.parse().map_err(|_| wrong())
    };
    list.split(',').enumerate().map(number).collect()
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

impl Serialize for WeightList {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All(weights) => weights.serialize(serializer),
            Self::Named(weights) => {
                let mut map = serializer.serialize_map(Some(weights.len()))?;
                for (name, weight) in weights {
                    map.serialize_entry(name, weight)?;
                }
                map.end()
            }
        }
    }
}

impl<'de> Deserialize<'de> for WeightList {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct List;
        impl<'de> Visitor<'de> for List {
            type Value = WeightList;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of numbers, or an object with the names of targets and numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<WeightList, A::Error> {
                let mut weights = Vec::new();
                while let Some(weight) = list.next_element()? {
                    weights.push(weight);
                }
                Ok(WeightList::All(weights))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<WeightList, A::Error> {
                let mut weights: Vec<(String, f32)> = Vec::new();
                while let Some((name, weight)) = map.next_entry()? {
                    weights.push((name, weight));
                }
                let mut names: Vec<&str> = weights.iter().map(|(name, _)| name.as_str()).collect();
                names.sort_unstable();
                if let Some(twice) = names.windows(2).find(|pair| pair[0] == pair[1]) {
                    return Err(A::Error::custom(UnknownTarget::Twice(twice[0].to_owned())));
                }
                Ok(WeightList::Named(weights))
            }
        }
        deserializer.deserialize_any(List)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(weights: &[f32]) -> Result<WeightList, String> {
        Ok(WeightList::All(weights.to_vec()))
    }

    fn some(weights: &[(&str, f32)]) -> Result<WeightList, String> {
        let weights = weights.iter().map(|&(name, weight)| (name.to_owned(), weight));
        Ok(WeightList::Named(weights.collect()))
    }

    #[test]
    fn every_form_is_read() {
        for text in [
            "0.5,-1",
            " 0.5 , -1 ",
            "[0.5, -1]",
            "\u{feff}[0.5,-1]",
            "# two\n0.5,-1\n",
        ] {
            assert_eq!(WeightList::parse(text), all(&[0.5, -1.0]), "{text}");
        }
        assert_eq!(WeightList::parse("1"), all(&[1.0]));
        for text in [
            "jawOpen=1,a=-0.5",
            "jawOpen = 1, a = -0.5",
            "jawOpen=1\n\n# the other\na=-0.5\n",
            "jawOpen,1\r\na,-0.5\r\n",
            "target,weight\njawOpen,1\n\"a\",-0.5",
            "Name, Value\njawOpen,\"1\"\na,-0.5",
            r#"{"jawOpen": 1, "a": -0.5}"#,
        ] {
            assert_eq!(
                WeightList::parse(text),
                some(&[("jawOpen", 1.0), ("a", -0.5)]),
                "{text}"
            );
        }
        assert_eq!(WeightList::parse("a=b=1"), some(&[("a=b", 1.0)]));
        assert_eq!(WeightList::parse("\"a, b\",1"), some(&[("a, b", 1.0)]));
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, parts) in [
            ("", &["no weights are given"][..]),
            ("1,x,3", &["number 1 is \"x\""]),
            ("1;2", &["number 0 is \"1;2\""]),
            ("jawOpen=wide", &["expected name=number", "jawOpen=wide"]),
            ("jawOpen=1,smile", &["expected name=number", "\"smile\""]),
            ("a=1\nb", &["line 2", "\"b\""]),
            ("name,weight", &["number 0 is \"name\""]),
            ("jawOpen,l.0\na,0.5", &["line 1", "jawOpen,l.0"]),
            ("{\"a\": \"x\"}", &["expected f32", "line 1"]),
            ("{\"a\": 1, \"a\": 2}", &["\"a\" is given twice"]),
            ("[1, 2", &["line 1"]),
        ] {
            let error = WeightList::parse(text).expect_err(text);
            for part in parts {
                assert!(error.contains(part), "{text:?}: {error}");
            }
        }
    }

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

    #[test]
    fn json_comes_back_the_same() -> serde_json::Result<()> {
        for list in [
            WeightList::All(vec![0.1, -2.0]),
            WeightList::Named(vec![("b".into(), 0.1), ("a".into(), 1.0)]),
        ] {
            assert_eq!(
                serde_json::from_str::<WeightList>(&serde_json::to_string(&list)?)?,
                list
            );
        }
        Ok(())
    }
}
