//! How commands open model files: how much memory they may take, which paths they may refer to, and which mesh the flags name.

use std::path::Path;

use clap::Args;
use morph_collision_testkit::gltf_read::{GltfFile, ReadOptions};
use morph_collision_testkit::inspect::MeshError;
use morph_collision_testkit::memory::{self, MemoryBudget};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::printable::Printable;

use crate::error::CliError;

/// How far commands trust the files they read.
#[derive(Debug, Args)]
pub(crate) struct FileArgs {
    /// Most memory that a file, or all models of a scene together, may take, including the trees built from them: a number and B,
    /// KiB, MiB, GiB or TiB.
    ///
    /// Files can claim far more memory than they store, so it is counted, on the high side, before it is allocated. 1GiB by
    /// default.
    #[arg(long, value_name = "SIZE", value_parser = size)]
    memory_limit: Option<u64>,
    /// Allow devices and pipes, and buffers anywhere: absolute paths, `..`, `file:` URIs, symbolic links.
    ///
    /// Without it, a model's buffers have to be regular files in its own directory or below.
    #[arg(long)]
    allow_any_path: bool,
}

impl FileArgs {
    pub(crate) fn memory_limit(&self) -> u64 {
        self.memory_limit.unwrap_or(memory::DEFAULT_LIMIT)
    }

    /// Refuses file options when no file is named.
    pub(crate) fn refuse_without_files(&self) -> Result<(), CliError> {
        for (flag, given) in [
            ("--memory-limit", self.memory_limit.is_some()),
            ("--allow-any-path", self.allow_any_path),
        ] {
            if given {
                let reason = "no model is named, so it has no effect; name a model or leave it out".to_owned();
                return Err(CliError::Flag { flag, reason });
            }
        }
        Ok(())
    }

    /// Opens a model file.
    pub(crate) fn open(&self, model: &Path) -> Result<GltfFile, CliError> {
        self.open_within(model, &MemoryBudget::new(self.memory_limit()))
    }

    /// Opens a model file that shares a budget with others.
    pub(crate) fn open_within(&self, model: &Path, budget: &MemoryBudget) -> Result<GltfFile, CliError> {
        let options = ReadOptions {
            memory_limit: self.memory_limit(),
            any_path: self.allow_any_path,
        };
        Ok(GltfFile::open_within(model, &options, budget.clone())?)
    }

    /// Opens a model file and reads its mesh `mesh`, an index given by `flag`.
    pub(crate) fn open_mesh(
        &self,
        model: &Path,
        mesh: usize,
        flag: &'static str,
    ) -> Result<(GltfFile, MorphMesh), CliError> {
        let file = self.open(model)?;
        let count = file.mesh_count();
        if mesh >= count {
            return Err(CliError::Flag {
                flag,
                reason: format!("{} has no mesh {mesh}, only {count}", model.display()),
            });
        }
        let mesh = read_mesh(&file, mesh)?;
        Ok((file, mesh))
    }
}

/// Reads a mesh that takes part in collisions, with its skin but without the clips of its weights.
pub(crate) fn read_mesh(file: &GltfFile, index: usize) -> Result<MorphMesh, CliError> {
    let found = file.mesh(index)?;
    found
        .check_triangles()
        .map_err(|reason| mesh_error(file, index, reason))?;
    let mut mesh = found.mesh;
    mesh.skin = file.skin(index)?;
    Ok(mesh)
}

/// Counts `bytes` for data derived from a mesh against the file's memory budget.
pub(crate) fn count_memory(
    file: &GltfFile,
    index: usize,
    bytes: u64,
    what: impl FnOnce() -> String,
) -> Result<(), CliError> {
    let taken = file.budget().take(bytes, 1, what);
    taken.map_err(|over| mesh_error(file, index, over.into()))
}

/// Adds the clips of a mesh. All of them have to be valid.
pub(crate) fn read_clips(file: &GltfFile, index: usize, mesh: &mut MorphMesh) -> Result<(), CliError> {
    let clips = file.clips(index, mesh.targets.len());
    if let Some(broken) = clips.broken.into_iter().next() {
        return Err(broken.into());
    }
    mesh.animations = clips.clips;
    Ok(())
}

/// Finds the clips of a given name that move the mesh's weights and its joints: indices into [`MorphMesh::animations`] and into
/// the skeleton's clips.
pub(crate) fn find_clip(mesh: &MorphMesh, name: &str) -> Result<[Option<usize>; 2], String> {
    let of_joints = mesh.skin.as_ref().map_or(&[][..], |skin| &skin.skeleton.clips);
    let found = [
        mesh.animations.iter().position(|clip| clip.name == name),
        of_joints.iter().position(|clip| clip.name == name),
    ];
    if found != [None, None] {
        return Ok(found);
    }
    let of_weights = mesh.animations.iter().map(|clip| &clip.name);
    let mut known: Vec<&String> = of_weights.chain(of_joints.iter().map(|clip| &clip.name)).collect();
    known.sort();
    known.dedup();
    let known: Vec<String> = known
        .into_iter()
        .map(|name| format!("\"{}\"", Printable(name)))
        .collect();
    let known = if known.is_empty() {
        "none".to_owned()
    } else {
        known.join(", ")
    };
    Err(format!(
        "there is no clip \"{}\" of the mesh; it has {known}",
        Printable(name)
    ))
}

fn mesh_error(file: &GltfFile, mesh: usize, reason: MeshError) -> CliError {
    CliError::Mesh {
        file: file.path().to_owned(),
        mesh,
        name: file.mesh_name(mesh),
        reason,
    }
}

fn size(text: &str) -> Result<u64, String> {
    const UNITS: [(&str, u64); 5] = [
        ("KiB", 1 << 10),
        ("MiB", 1 << 20),
        ("GiB", 1 << 30),
        ("TiB", 1 << 40),
        ("B", 1),
    ];
    let wrong = || "expected a whole number and B, KiB, MiB, GiB or TiB, such as 4GiB".to_owned();
    let unit = |(unit, bytes): (&str, u64)| {
        let at = text.len().checked_sub(unit.len())?;
        let (number, end) = text.split_at_checked(at)?;
        end.eq_ignore_ascii_case(unit).then_some((number, bytes))
    };
    let (number, bytes) = UNITS.into_iter().find_map(unit).unwrap_or((text, 1));
    let number: u64 = number.trim_end().parse().map_err(|_| wrong())?;
    number.checked_mul(bytes).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_numbers_with_a_unit() {
        for (text, bytes) in [
            ("17", 17),
            ("17B", 17),
            ("3KiB", 3072),
            ("2mib", 2 << 20),
            ("4 GiB", 4 << 30),
            ("0", 0),
            ("1TiB", 1 << 40),
        ] {
            assert_eq!(size(text), Ok(bytes), "{text}");
        }
        for text in ["", "GiB", "-1", "1.5GiB", "1GB", "99999999999999TiB", "1é"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
