//! Integers that are written as floats, such as `5126.0`. JSON does not tell them apart, and some exporters write only floats.

use std::borrow::Cow;

/// Upper bound on how many times longer a text becomes: `9e15` has 4 characters, and 16 as an integer.
pub(super) const MOST_GROWTH: u64 = 4;
/// Integers up to this are exact as `f64`.
const MOST: f64 = (1_u64 << 53) as f64;

/// JSON with an integer in place of every float without a fraction. Any other text gives some text.
pub(super) fn written_plainly(json: &str) -> Cow<'_, str> {
    let bytes = json.as_bytes();
    let mut plain = String::new();
    let (mut copied, mut at) = (0, 0);
    while let Some(&byte) = bytes.get(at) {
        let rest = &bytes[at..];
        let length = match byte {
            b'"' => string_length(rest),
            b'-' | b'0'..=b'9' => number_length(rest),
            _ => 1,
        };
        let end = at + length;
        // Slices end beside an ASCII character, so they are whole characters.
        let number = if byte == b'"' { None } else { json.get(at..end) };
        if let Some(integer) = number.and_then(integer) {
            plain += &json[copied..at];
            plain += &integer.to_string();
            copied = end;
        }
        at = end;
    }
    if copied == 0 {
        return Cow::Borrowed(json);
    }
    plain += &json[copied..];
    Cow::Owned(plain)
}

/// The length of a string with its quotes.
fn string_length(bytes: &[u8]) -> usize {
    let mut escaped = true;
    for (at, &byte) in bytes.iter().enumerate() {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    bytes.len()
}

fn number_length(bytes: &[u8]) -> usize {
    let part = |byte: &u8| matches!(byte, b'0'..=b'9' | b'+' | b'-' | b'.' | b'e' | b'E');
    bytes.iter().take_while(|byte| part(byte)).count()
}

/// The value of a float without a fraction. Negative zero stays a float.
fn integer(number: &str) -> Option<i64> {
    if !number.contains(['.', 'e', 'E']) {
        return None;
    }
    let value: f64 = number.parse().ok()?;
    let is_integer = value.fract() == 0.0 && value.abs() <= MOST && (value != 0.0 || value.is_sign_positive());
    is_integer.then_some(value as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_numbers_without_a_fraction_change() {
        for (json, plain) in [
            (r#"{"a":5126.0}"#, r#"{"a":5126}"#),
            ("[1.0,-2.00, 3e2,1.5e1]", "[1,-2, 300,15]"),
            ("0.0", "0"),
            ("9e15", "9000000000000000"),
        ] {
            assert_eq!(written_plainly(json), plain);
        }
        for json in [
            r#"{"1.0":"2.0","\\":"\"3.0","ü4.0":5}"#,
            "[1.5,-0.0,1e300,9.1e15,1e-3]",
            "",
            "\"1.0",
            "\"\\",
            "-e.",
            "1.0é",
        ] {
            if json != "1.0é" {
                assert_eq!(written_plainly(json), json);
            }
            let growth = written_plainly(json).len() as u64;
            assert!(growth <= MOST_GROWTH * json.len() as u64);
        }
    }
}
