//! Numbers in JSON. JSON cannot hold numbers that are not finite; serde writes `null` for them.

use serde::ser::{SerializeSeq, Serializer};

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
