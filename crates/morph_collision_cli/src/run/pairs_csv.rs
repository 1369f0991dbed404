//! The CSV file of pairs: `frame,body_a,body_b,triangle_a,triangle_b`.

use std::io::{self, Write};

use super::replay::Hit;

/// Writes a header and one line per hit, in the order given.
pub(crate) fn write_rows(out: &mut dyn Write, hits: &[Hit]) -> io::Result<()> {
    writeln!(out, "frame,body_a,body_b,triangle_a,triangle_b")?;
    for hit in hits {
        let Hit {
            frame,
            body_a,
            body_b,
            pair,
        } = hit;
        writeln!(out, "{frame},{body_a},{body_b},{},{}", pair.triangle_a, pair.triangle_b)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use morph_collision::TrianglePair;

    use super::*;

    #[test]
    fn a_header_and_a_line_per_hit() {
        let hit = Hit {
            frame: 3,
            body_a: 0,
            body_b: 2,
            pair: TrianglePair {
                triangle_a: 7,
                triangle_b: 5,
            },
        };
        let mut text = Vec::new();
        assert!(write_rows(&mut text, &[hit]).is_ok());
        let expected = "frame,body_a,body_b,triangle_a,triangle_b\n3,0,2,7,5\n";
        assert_eq!(String::from_utf8_lossy(&text), expected);
    }
}
