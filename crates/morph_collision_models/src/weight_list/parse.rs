//! Weights from text.

use super::WeightList;
use crate::text::Printable;

impl WeightList {
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
}
