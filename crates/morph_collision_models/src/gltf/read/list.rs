//! Lists of a file's JSON, whose elements are parsed one by one, on first use.

use std::cell::OnceCell;
use std::fmt;
use std::marker::PhantomData;

use serde::de::{DeserializeOwned, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

use super::integers;
use crate::memory::{MemoryBudget, OverBudget};
use crate::text::Printable;

/// Upper bound on the bytes that an element of a list takes, parsed or not, while the list grows.
const BYTES_PER_ELEMENT: u64 = 128;
/// Upper bound on the bytes that parsing once more takes per byte of the text: with other numbers, and to find the field at fault.
const BYTES_TO_PARSE_AGAIN: u64 = integers::MOST_GROWTH + 4;

/// A part of the file that is parsed on first use.
#[derive(Debug)]
pub(super) struct Element<T> {
    text: Box<RawValue>,
    parsed: OnceCell<Box<Result<T, ElementError>>>,
}

/// A list whose elements are parsed one by one, on first use.
#[derive(Debug)]
pub(super) struct List<T>(Vec<Element<T>>);

/// The named elements of an object in the order of the file, parsed one by one, on first use.
#[derive(Debug)]
pub(super) struct Entries<T>(Vec<(String, Element<T>)>);

/// Why an element of a list cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ElementError {
    /// The list has fewer elements.
    #[error("does not exist")]
    Missing,
    /// It does not have the form required at its place in the file. The message begins with the field, if one is at fault.
    #[error("is malformed: {0}")]
    Malformed(String),
    /// Parsing it would take too much memory.
    #[error("is too large: {0}")]
    OverBudget(OverBudget),
}

impl<T: DeserializeOwned> Element<T> {
    pub(super) fn get(&self, budget: &MemoryBudget) -> Result<&T, ElementError> {
        let parsed = match self.parsed.get() {
            Some(parsed) => parsed,
            None => {
                // A refusal is not remembered, because there may be more memory later.
                let bytes = bytes_of(self.text.get().as_bytes());
                let keep = budget.keep(bytes, 1, || "its JSON".into());
                keep.map_err(ElementError::OverBudget)?;
                let parsed = parse(self.text.get(), budget);
                if let Err(refusal @ ElementError::OverBudget(_)) = parsed {
                    return Err(refusal);
                }
                self.parsed.get_or_init(|| Box::new(parsed))
            }
        };
        (**parsed).as_ref().map_err(Clone::clone)
    }
}

impl<'de, T> Deserialize<'de> for Element<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Ok(Self {
            text: Box::<RawValue>::deserialize(deserializer)?,
            parsed: OnceCell::new(),
        })
    }
}

impl<T> Default for List<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<'de, T> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Vec::deserialize(deserializer).map(Self)
    }
}

impl<T: DeserializeOwned> List<T> {
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    pub(super) fn indices(&self) -> std::ops::Range<usize> {
        0..self.0.len()
    }

    pub(super) fn get(&self, index: usize, budget: &MemoryBudget) -> Result<&T, ElementError> {
        self.0.get(index).ok_or(ElementError::Missing)?.get(budget)
    }
}

impl<T> Default for Entries<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T> Entries<T> {
    pub(super) fn iter(&self) -> impl Iterator<Item = &(String, Element<T>)> {
        self.0.iter()
    }
}

impl<'de, T> Deserialize<'de> for Entries<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder<T>(PhantomData<T>);
        impl<'de, T> Visitor<'de> for InOrder<T> {
            type Value = Entries<T>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut entries = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                Ok(Entries(entries))
            }
        }
        deserializer.deserialize_map(InOrder(PhantomData))
    }
}

/// Upper bound on the bytes that JSON takes once parsed: its text, and one element for each of these characters.
pub(super) fn bytes_of(json: &[u8]) -> u64 {
    let elements = json.iter().filter(|byte| matches!(byte, b',' | b'[' | b'{')).count();
    json.len() as u64 + elements as u64 * BYTES_PER_ELEMENT
}

/// Parses an element whose memory has been counted.
fn parse<T: DeserializeOwned>(text: &str, budget: &MemoryBudget) -> Result<T, ElementError> {
    if let Ok(parsed) = serde_json::from_str(text) {
        return Ok(parsed);
    }
    parse_again(text, budget).map_err(|error| match error {
        // The parser counts lines from the start of the element, which helps nobody.
        AgainError::Json(message) => ElementError::Malformed(match message.rfind(" at line ") {
            Some(end) => message[..end].to_owned(),
            None => message,
        }),
        AgainError::OverBudget(over) => ElementError::OverBudget(over),
    })
}

/// Why JSON cannot be parsed, even with integers in place of floats.
pub(super) enum AgainError {
    /// The field at fault, and what is wrong with it.
    Json(String),
    OverBudget(OverBudget),
}

/// Parses JSON that cannot be parsed as it is, with integers in place of floats without a fraction. Errors name the field.
pub(super) fn parse_again<T: DeserializeOwned>(text: &str, budget: &MemoryBudget) -> Result<T, AgainError> {
    budget.lend(|| {
        let take = budget.take(text.len() as u64, BYTES_TO_PARSE_AGAIN, || "parsing it again".into());
        take.map_err(AgainError::OverBudget)?;
        let plain = integers::written_plainly(text);
        if let Ok(parsed) = serde_json::from_str(&plain) {
            return Ok(parsed);
        }
        let mut json = serde_json::Deserializer::from_str(text);
        let parsed = serde_path_to_error::deserialize::<_, T>(&mut json);
        parsed.map_err(|error| {
            // Abridged because the parser quotes whole strings.
            let (path, message) = (abridged(&error.path().to_string()), error.inner().to_string());
            let message = abridged(&message);
            AgainError::Json(match &*path {
                "." => message,
                // It contains names from the file.
                _ => format!("{}: {message}", Printable(&path)),
            })
        })
    })
}

/// The first 200 characters of a text from a file: enough for a message, and cheap to copy.
pub(super) fn abridged(text: &str) -> String {
    match text.char_indices().nth(200) {
        None => text.to_owned(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

/// The default in place of a malformed value that is not needed to read a mesh. Of a short value, an integer may be a float.
pub(super) fn or_default<'de, D: Deserializer<'de>, T: DeserializeOwned + Default>(
    deserializer: D,
) -> Result<T, D::Error> {
    const SHORT: usize = 64;
    let text = Box::<RawValue>::deserialize(deserializer)?;
    let parsed = serde_json::from_str(text.get());
    Ok(match parsed {
        Err(_) if text.get().len() <= SHORT => serde_json::from_str(&integers::written_plainly(text.get())),
        parsed => parsed,
    }
    .unwrap_or_default())
}
