//! Known findings that are accepted, in a JSON file.

use std::io::{self, Read, Write};
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::report::FindingReport;
use crate::error::CliError;
use crate::output::printable_json;

const VERSION: u32 = 1;
/// A finding is accepted if it is at most this many times as deep as when it was recorded.
const DEEPER: f64 = 1.1;

/// The file.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Baseline {
    version: u32,
    accepted: Vec<Accepted>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Accepted {
    /// The mesh's name.
    mesh: String,
    /// What it was found with, such as `target jawOpen`.
    found_with: String,
    depth: f64,
    triangles: Vec<u32>,
}

impl Baseline {
    /// Reads a file of at most `limit` bytes.
    pub(super) fn read(path: &Path, limit: u64) -> Result<Self, CliError> {
        let fail = |reason: String| CliError::Flag {
            flag: "--baseline",
            reason: format!("{}: {reason}", path.display()),
        };
        let mut text = String::new();
        let read = std::fs::File::open(path).and_then(|file| file.take(limit).read_to_string(&mut text));
        read.map_err(|error| fail(error.to_string()))?;
        if text.len() as u64 >= limit {
            return Err(fail("is larger than the memory limit; raise --memory-limit".to_owned()));
        }
        let baseline: Self = serde_json::from_str(&text).map_err(|error| fail(error.to_string()))?;
        match baseline.version {
            VERSION => Ok(baseline),
            version => Err(fail(format!(
                "has version {version}, but this program reads version {VERSION}"
            ))),
        }
    }

    pub(super) fn new<'a>(findings: impl Iterator<Item = (&'a str, &'a FindingReport)>) -> Self {
        let accepted = |(mesh, finding): (&str, &FindingReport)| Accepted {
            mesh: mesh.to_owned(),
            found_with: finding.found_with.clone(),
            depth: finding.depth,
            triangles: finding.triangles.clone(),
        };
        Self {
            version: VERSION,
            accepted: findings.map(accepted).collect(),
        }
    }

    /// Whether a finding is known: the same mesh and source, a common triangle, and hardly deeper.
    pub(super) fn accepts(&self, mesh: &str, finding: &FindingReport) -> bool {
        self.accepted.iter().any(|accepted| {
            accepted.mesh == mesh
                && accepted.found_with == finding.found_with
                && finding.depth <= accepted.depth * DEEPER
                && accepted
                    .triangles
                    .iter()
                    .any(|triangle| finding.triangles.binary_search(triangle).is_ok())
        })
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(printable_json(&serde_json::to_string(self)?).as_bytes())
    }
}
