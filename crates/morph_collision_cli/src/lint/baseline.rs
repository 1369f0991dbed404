//! Known findings that are accepted, in a JSON file.

use std::io::{self, Read, Write};
use std::path::Path;

use morph_collision_models::gltf::read::{LFS_POINTER, is_lfs_pointer};
use serde::{Deserialize, Serialize};

use super::members::MeshTriangles;
use super::report::FindingReport;
use crate::error::CliError;
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
        if is_lfs_pointer(text.as_bytes()) {
            return Err(fail(LFS_POINTER.to_owned()));
        }
        let baseline: Self = serde_json::from_str(&text).map_err(|error| fail(error.to_string()))?;
        match baseline.version {
            VERSION => Ok(baseline),
            version => Err(fail(format!(
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

/// Whether two meshes have the same name and a triangle in common.
fn overlap(one: &MeshTriangles, other: &MeshTriangles) -> bool {
    let is_in_other = |triangle| other.triangles.binary_search(triangle).is_ok();
    one.name == other.name && one.triangles.iter().any(is_in_other)
}
