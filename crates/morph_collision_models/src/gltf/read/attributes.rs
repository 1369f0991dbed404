//! The attributes of a primitive that meshes need.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// Positions, and any number of sets of influences. The numbers are indices of accessors, or of attributes of a Draco stream.
#[derive(Debug, Default)]
pub(super) struct Attributes {
    pub(super) positions: Option<usize>,
    /// Whether it has normals.
    pub(super) has_normals: bool,
    /// `JOINTS_n` and `WEIGHTS_n`, by `n`.
    pub(super) influences: Influences,
}

pub(super) type Influences = BTreeMap<usize, [Option<usize>; 2]>;

impl Attributes {
    /// Whether joints move its vertices.
    pub(super) fn are_bound(&self) -> bool {
        let first = self.influences.get(&0);
        first.is_some_and(|set| set.iter().all(Option::is_some))
    }
}

impl<'de> Deserialize<'de> for Attributes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Named;
        impl<'de> Visitor<'de> for Named {
            type Value = Attributes;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut attributes = Attributes::default();
                while let Some(name) = map.next_key::<String>()? {
                    if name == "POSITION" {
                        attributes.positions = map.next_value()?;
                    } else if let Some((set, part)) = influence(&name) {
                        attributes.influences.entry(set).or_default()[part] = map.next_value()?;
                    } else {
                        attributes.has_normals |= name == "NORMAL";
                        map.next_value::<IgnoredAny>()?;
                    }
                }
                Ok(attributes)
            }
        }
        deserializer.deserialize_map(Named)
    }
}

/// The set of an attribute, and 0 for joints or 1 for weights.
fn influence(name: &str) -> Option<(usize, usize)> {
    let joints = name.strip_prefix("JOINTS_").map(|set| (set, 0));
    let (digits, part) = joints.or_else(|| name.strip_prefix("WEIGHTS_").map(|set| (set, 1)))?;
    let set: usize = digits.parse().ok()?;
    // Neither "+1" nor "01".
    (set.to_string() == digits).then_some((set, part))
}
