//! Weights in JSON: a list of numbers, or an object with names and numbers.

use std::fmt;

use serde::de::{Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde::ser::{SerializeMap, Serializer};
use serde::{Deserialize, Serialize};

use super::WeightList;
use super::names::UnknownTarget;

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
