//! The file of pairs: `frame,body_a,body_b,triangle_a,triangle_b`.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::replay::Hit;
use crate::error::CliError;

/// A CSV file, created but not yet written.
pub(crate) struct PairsFile {
    path: PathBuf,
    file: File,
}

impl PairsFile {
    /// Creates the file or empties it.
    pub(crate) fn create(path: &Path) -> Result<Self, CliError> {
        match File::create(path) {
            Ok(file) => Ok(Self {
                path: path.into(),
                file,
            }),
            Err(reason) => Err(CliError::Write {
                file: path.into(),
                reason,
            }),
        }
    }

    /// Writes a header and one line per hit, in the order given.
    pub(crate) fn write(self, hits: &[Hit]) -> Result<(), CliError> {
        write_rows(BufWriter::new(self.file), hits).map_err(|reason| CliError::Write {
            file: self.path,
            reason,
        })
    }
}

fn write_rows(mut out: impl Write, hits: &[Hit]) -> io::Result<()> {
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
    out.flush()
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
