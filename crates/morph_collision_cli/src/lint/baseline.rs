//! Known findings that are accepted, in a JSON file.

use std::io::{self, Write};
use std::path::Path;

use morph_collision_models::memory::MemoryBudget;
use serde::{Deserialize, Serialize};

use super::members::MeshTriangles;
use super::report::FindingReport;
use crate::error::CliError;
use crate::files::model::FileArgs;
use crate::files::text::TextFile;
use crate::output::printable_json;

const VERSION: u32 = 2;
/// A finding is accepted if it is deeper by at most this share of the depth when it was recorded.
const DEEPER: f64 = 0.1;

/// The file.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Baseline {
    version: u32,
    accepted: Vec<Accepted>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Accepted {
    /// What it was found with, such as `target jawOpen`.
    found_with: String,
    depth: f64,
    meshes: Vec<MeshTriangles>,
}

impl Baseline {
    /// Reads a file within a budget, which then lacks the memory for it.
    pub(super) fn read(path: &Path, files: &FileArgs, budget: &MemoryBudget) -> Result<Self, CliError> {
        let flag = "--baseline";
        let file = TextFile { flag, path };
        let text = file.read(files, budget)?;
        file.take(budget, bytes_of(text.as_bytes()), 1, "its findings")?;
        let baseline: Self = serde_json::from_str(&text).map_err(|error| file.error(error))?;
        match baseline.version {
            VERSION => Ok(baseline),
            version => Err(file.error(format_args!(
                "has version {version}, but this program reads version {VERSION}; write it again with --write-baseline"
            ))),
        }
    }

    pub(super) fn new<'a>(findings: impl Iterator<Item = &'a FindingReport>) -> Self {
        let accepted = |finding: &FindingReport| Accepted {
            found_with: finding.found_with.clone(),
            depth: finding.depth,
            meshes: finding.meshes.clone(),
        };
        Self {
            version: VERSION,
            accepted: findings.map(accepted).collect(),
        }
    }

    /// Whether a finding is known: the same source, a common triangle of a mesh of the same name, and hardly deeper.
    pub(super) fn accepts(&self, finding: &FindingReport) -> bool {
        self.accepted.iter().any(|accepted| {
            accepted.found_with == finding.found_with
                && finding.depth <= accepted.depth + DEEPER * accepted.depth.abs()
                && accepted
                    .meshes
                    .iter()
                    .any(|known| finding.meshes.iter().any(|mesh| overlap(known, mesh)))
        })
    }

    pub(super) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(printable_json(&serde_json::to_string(self)?).as_bytes())
    }
}

/// An upper bound on the memory that the findings of a text take. A list that grows takes three times the size of its elements for a moment,
/// and a list of one element takes room for four.
fn bytes_of(text: &[u8]) -> u64 {
    let of_element = size_of::<Accepted>().max(size_of::<MeshTriangles>()) as u64;
    let bytes = |&byte: &u8| match byte {
        b'{' => 4 * of_element,
        // The smallest block that a string or a list of numbers takes.
        b'[' | b':' => 48,
        // A number.
        b',' => 16,
        // What has escapes is copied into a buffer that grows.
        _ => 4,
    };
    text.iter().map(bytes).sum()
}

/// Whether two meshes have the same name and a triangle in common.
fn overlap(one: &MeshTriangles, other: &MeshTriangles) -> bool {
    let is_in_other = |triangle| other.triangles.binary_search(triangle).is_ok();
    one.name == other.name && one.triangles.iter().any(is_in_other)
}
