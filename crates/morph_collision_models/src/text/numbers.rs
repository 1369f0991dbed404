//! Numbers in JSON and in text. JSON cannot hold numbers that are not finite; serde writes `null` for them.

use std::fmt;

use serde::ser::{SerializeSeq, Serializer};

/// A whole number with commas between groups of three digits.
///
/// ```
/// assert_eq!(morph_collision_models::text::Grouped(1_234_567).to_string(), "1,234,567");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grouped(pub u64);

impl fmt::Display for Grouped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = self.0.to_string();
        let mut grouped = String::with_capacity(digits.len() * 4 / 3 + 1);
        for (index, digit) in digits.chars().enumerate() {
            if index > 0 && (digits.len() - index).is_multiple_of(3) {
                grouped.push(',');
            }
            grouped.push(digit);
        }
        f.pad(&grouped)
    }
}

/// A number, or the text `inf`, `-inf` or `NaN`. A number that is exactly an `f32` is written with only the digits
/// that an `f32` needs.
///
/// Use it with `#[serde(serialize_with = "..")]`.
///
/// # Errors
/// The serializer's.
pub fn number<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if !value.is_finite() {
        return serializer.serialize_str(&value.to_string());
    }
    let narrow = *value as f32;
    if f64::from(narrow) == *value {
        serializer.serialize_f32(narrow)
    } else {
        serializer.serialize_f64(*value)
    }
}

/// A list of such numbers.
///
/// # Errors
/// The serializer's.
pub fn numbers<S: Serializer, const N: usize>(values: &[f64; N], serializer: S) -> Result<S::Ok, S::Error> {
    struct Number(f64);
    impl serde::Serialize for Number {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            number(&self.0, serializer)
        }
    }
    let mut list = serializer.serialize_seq(Some(N))?;
    for &value in values {
        list.serialize_element(&Number(value))?;
    }
    list.end()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(serde::Serialize)]
    struct Report {
        #[serde(serialize_with = "number")]
        one: f64,
        #[serde(serialize_with = "numbers")]
        three: [f64; 3],
    }

    #[test]
    fn digits_are_grouped_from_the_right() {
        for (number, text) in [(0, "0"), (999, "999"), (1000, "1,000"), (12_345_678, "12,345,678")] {
            assert_eq!(Grouped(number).to_string(), text);
        }
        assert_eq!(format!("{:>7}", Grouped(1000)), "  1,000");
    }

    #[test]
    fn what_is_not_finite_is_text_and_never_null() -> Result<(), serde_json::Error> {
        let report = |one| Report {
            one,
            three: [f64::INFINITY, f64::from(0.1_f32), 0.1],
        };
        let json = serde_json::to_string(&report(f64::NAN))?;
        assert_eq!(json, r#"{"one":"NaN","three":["inf",0.1,0.1]}"#);
        let json = serde_json::to_string(&report(f64::NEG_INFINITY))?;
        assert!(json.starts_with(r#"{"one":"-inf""#), "{json}");
        Ok(())
    }
}
