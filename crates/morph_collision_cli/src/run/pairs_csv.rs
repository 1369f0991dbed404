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
    for Hit {
        frame,
        body_a,
        body_b,
        triangles,
    } in hits
    {
        match triangles {
            Some(pair) => writeln!(out, "{frame},{body_a},{body_b},{},{}", pair.triangle_a, pair.triangle_b)?,
            None => writeln!(out, "{frame},{body_a},{body_b},,")?,
        }
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use morph_collision::TrianglePair;

    use super::*;

    #[test]
    fn a_hit_whose_triangles_were_not_asked_for_leaves_their_columns_empty() {
        let hit = |triangles| Hit {
            frame: 3,
            body_a: 0,
            body_b: 2,
            triangles,
        };
        let mut text = Vec::new();
        let hits = [
            hit(Some(TrianglePair {
                triangle_a: 7,
                triangle_b: 5,
            })),
            hit(None),
        ];
        assert!(write_rows(&mut text, &hits).is_ok());
        let expected = "frame,body_a,body_b,triangle_a,triangle_b\n3,0,2,7,5\n3,0,2,,\n";
        assert_eq!(String::from_utf8_lossy(&text), expected);
    }
}
