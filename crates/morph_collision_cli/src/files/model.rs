//! How commands open models and scenes: how much memory they may take, which paths they may refer to, and which mesh is meant.

use std::convert::Infallible;
use std::path::Path;
use std::str::FromStr;
use std::{fmt, io};

use clap::Args;
use morph_collision::ModelError;
use morph_collision_models::gltf::read::{GltfFile, ReadOptions};
use morph_collision_models::inspect::MeshError;
use morph_collision_models::left_out::LeftOut;
use morph_collision_models::memory::{self, MemoryBudget};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::mesh::Unweighted;
use morph_collision_models::scenes::Scene;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use super::warned_clips::WarnedClips;
use crate::error::CliError;
use crate::files::drawn::note_if_not_drawn;
use crate::messages;
use crate::messages::progress;

/// The name of stdin and stdout on the command line.
pub(crate) const STANDARD: &str = "-";

/// How far commands trust the files they read.
#[derive(Clone, Debug, Default, Args)]
pub struct FileArgs {
    /// The most memory that a file may take with everything that is built from it; for a scene, the scene and all its files together.
    ///
    /// A number and B, KiB, MiB, GiB or TiB; 1GiB by default. Files can claim far more memory than they store, so memory is estimated, on
    /// the high side, before it is allocated.
    #[arg(long, value_name = "SIZE", help_heading = "Files")]
    memory_limit: Option<Size>,
    /// Read devices, pipes, and buffers outside the model's folder.
    ///
    /// Without this option, all files must be regular files, and a model's buffers must be in its folder or below: no absolute paths, `..`,
    /// `file:` URIs, or symbolic links that lead elsewhere. The models and clips that a scene names may be anywhere in any case, so look into
    /// a scene that you did not write.
    #[arg(long, help_heading = "Files")]
    allow_any_path: bool,
    /// Leave out bad triangles instead of refusing their mesh.
    ///
    /// Bad are triangles with a corner that is no vertex, or whose vertex has a position, a displacement or a joint weight that is not a
    /// number or too large, or a weight of a joint that does not exist. Targets that a primitive lacks do not move it. Every output says how
    /// much is left out. The other triangles are numbered without those that are left out.
    #[arg(long, help_heading = "Files")]
    skip_bad: bool,
    /// What the user was told about clips.
    #[arg(skip)]
    pub(crate) told: WarnedClips,
}

impl FileArgs {
    pub(crate) fn memory_limit(&self) -> u64 {
        self.memory_limit.unwrap_or_default().0
    }

    /// All of the limit.
    pub(crate) fn budget(&self) -> MemoryBudget {
        MemoryBudget::new(self.memory_limit())
    }

    /// Whether devices and pipes are read.
    pub(super) fn allows_any_path(&self) -> bool {
        self.allow_any_path
    }

    /// Refuses file options when no file is named.
    ///
    /// # Errors
    /// One is given.
    pub fn refuse_without_files(&self) -> Result<(), CliError> {
        for (flag, given) in [
            ("--memory-limit", self.memory_limit.is_some()),
            ("--allow-any-path", self.allow_any_path),
            ("--skip-bad", self.skip_bad),
        ] {
            if given {
                let reason = "no model is named, so it has no effect; name a model or leave it out".to_owned();
                return Err(CliError::Flag { flag, reason });
            }
        }
        Ok(())
    }

    /// Opens a model file; `-` is stdin.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn open(&self, model: &Path) -> Result<GltfFile, CliError> {
        self.open_within(model, &self.budget())
    }

    /// Opens a model file that shares a budget with others.
    pub(crate) fn open_within(&self, model: &Path, budget: &MemoryBudget) -> Result<GltfFile, CliError> {
        let options = ReadOptions {
            memory_limit: self.memory_limit(),
            any_path: self.allow_any_path,
            skip_bad: self.skip_bad,
        };
        if model == Path::new(STANDARD) {
            progress::doing("reading a model from standard input");
            return Ok(GltfFile::read_from(
                io::stdin().lock(),
                model,
                &options,
                budget.clone(),
            )?);
        }
        progress::doing(format!("reading {}", model.display()));
        GltfFile::open_within(model, &options, budget.clone()).map_err(|error| {
            if has_extension(model, &["json"]) && Scene::read_within(model, false, &self.budget()).is_ok() {
                return CliError::NotAModel { file: model.to_owned() };
            }
            error.into()
        })
    }

    /// Opens a model file and reads one of its meshes, which `flag` names.
    ///
    /// # Errors
    /// It cannot be read, or there is no such mesh.
    pub fn open_mesh(
        &self,
        model: &Path,
        mesh: &MeshChoice,
        flag: &'static str,
    ) -> Result<(GltfFile, usize, MorphMesh), CliError> {
        let file = self.open(model)?;
        let index = mesh.find(&file).map_err(|reason| CliError::Flag { flag, reason })?;
        note_if_not_drawn(&file, index);
        let mesh = read_mesh(&file, index, None)?;
        Ok((file, index, mesh))
    }

    /// Reads a scene file; `-` is stdin, and then the paths of models are relative to the current directory. `budget` is for
    /// all that is made of it, too.
    pub(crate) fn read_scene(&self, scene: &Path, budget: &MemoryBudget) -> Result<Scene, CliError> {
        if scene == Path::new(STANDARD) {
            progress::doing("reading a scene from standard input");
            return Ok(Scene::read_from(io::stdin().lock(), scene, budget)?);
        }
        if has_extension(scene, &["glb", "gltf"]) {
            return Err(CliError::NotAScene { file: scene.to_owned() });
        }
        progress::doing(format!("reading {}", scene.display()));
        Ok(Scene::read_within(scene, self.allow_any_path, budget)?)
    }
}

/// Whether a file's name ends in one of these.
pub(crate) fn has_extension(file: &Path, extensions: &[&str]) -> bool {
    file.extension()
        .is_some_and(|found| extensions.iter().any(|extension| found.eq_ignore_ascii_case(extension)))
}

/// A mesh of a file, by index or by name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshChoice(pub String);

impl Default for MeshChoice {
    fn default() -> Self {
        Self("0".to_owned())
    }
}

impl fmt::Display for MeshChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl FromStr for MeshChoice {
    type Err = Infallible;

    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(Self(text.to_owned()))
    }
}

impl MeshChoice {
    /// Its index.
    pub(crate) fn find(&self, file: &GltfFile) -> Result<usize, String> {
        let count = file.mesh_count();
        let path = file.path().display();
        if let Ok(index) = self.0.parse::<usize>() {
            if index < count {
                return Ok(index);
            }
            return Err(format!("{path} has no mesh {index}; it has {}", in_all(count)));
        }
        let names: Vec<String> = (0..count).map(|index| file.mesh_name(index)).collect();
        let mut same = names.iter().enumerate().filter(|(_, name)| **name == self.0);
        match (same.next(), same.next()) {
            (Some((index, _)), None) => Ok(index),
            (Some((first, _)), Some((second, _))) => Err(format!(
                "meshes {first} and {second} of {path} are both named \"{}\"; give an index",
                Printable(&self.0)
            )),
            (None, _) => Err(format!(
                "{path} has no mesh named \"{}\"; it has {}{}",
                Printable(&self.0),
                in_all(count),
                suggestion(&self.0, names.iter().map(String::as_str))
            )),
        }
    }
}

/// How many meshes there are, and their indices.
fn in_all(count: usize) -> String {
    match count {
        0 => "none".to_owned(),
        1 => "one, mesh 0".to_owned(),
        _ => format!("{count}, meshes 0 to {}", count - 1),
    }
}

/// Reads a mesh that takes part in collisions, as a node shows it, or else its main node: with its skin and its default weights, but without
/// the clips of its weights.
///
/// # Errors
/// It cannot be read.
pub fn read_mesh(file: &GltfFile, index: usize, node: Option<usize>) -> Result<MorphMesh, CliError> {
    let mut found = file.mesh(index)?;
    found
        .check_triangles()
        .map_err(|reason| mesh_error(file, index, reason))?;
    show_with(file, index, node, &mut found.mesh)?;
    let left_out = LeftOut::of(file, &mut found).map_err(|reason| mesh_error(file, index, reason.into()))?;
    if let Some(left_out) = left_out {
        messages::warn_left_out(file.path(), index, &found.mesh.name, left_out);
    }
    Ok(found.mesh)
}

/// Gives a mesh the skin and the default weights with which a node shows it.
pub(crate) fn show_with(
    file: &GltfFile,
    index: usize,
    node: Option<usize>,
    mesh: &mut MorphMesh,
) -> Result<(), CliError> {
    mesh.skin = file.skin(index, node)?;
    mesh.default_weights = file.default_weights(index, node, mesh.targets.len())?;
    Ok(())
}

/// Refuses a mesh with bad triangles or vertices, which would refuse all meshes that it is joined with.
///
/// # Errors
/// What is wrong with the first of them.
pub(crate) fn check_parts(file: &GltfFile, index: usize, mesh: &MorphMesh) -> Result<(), CliError> {
    let bad = mesh.bad_parts();
    match bad.map(|bad| bad.first().cloned()) {
        Ok(None) => Ok(()),
        Ok(Some(reason)) | Err(reason) => Err(mesh_error(file, index, reason.into())),
    }
}

/// Leaves out the triangles of a skinned mesh that have a vertex without joint weights, and says so.
///
/// # Errors
/// No triangle is left.
pub fn leave_out_unweighted(
    file: &GltfFile,
    index: usize,
    mesh: &mut MorphMesh,
) -> Result<Option<Unweighted>, CliError> {
    let unweighted = mesh.leave_out_unweighted();
    if let Some(unweighted) = &unweighted {
        let (path, name) = (file.path().display(), Printable(&mesh.name));
        messages::complain(format_args!("warning: {path}: mesh {index} \"{name}\": {unweighted}"));
        if mesh.triangles.is_empty() {
            return Err(mesh_error(file, index, ModelError::NoTriangles.into()));
        }
    }
    Ok(unweighted)
}

/// Counts `bytes` for data derived from a mesh against the file's memory budget.
///
/// # Errors
/// It has no room for them.
pub fn count_memory(file: &GltfFile, index: usize, bytes: u64, what: impl FnOnce() -> String) -> Result<(), CliError> {
    let taken = file.budget().take(bytes, 1, what);
    taken.map_err(|over| mesh_error(file, index, over.into()))
}

fn mesh_error(file: &GltfFile, mesh: usize, reason: MeshError) -> CliError {
    CliError::Mesh {
        file: file.path().to_owned(),
        mesh,
        name: file.mesh_name(mesh),
        reason,
    }
}

/// A number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size(u64);

const UNITS: [(&str, u64); 5] = [
    ("TiB", 1 << 40),
    ("GiB", 1 << 30),
    ("MiB", 1 << 20),
    ("KiB", 1 << 10),
    ("B", 1),
];

impl Default for Size {
    fn default() -> Self {
        Self(memory::DEFAULT_LIMIT)
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected a whole number and B, KiB, MiB, GiB or TiB, such as 4GiB".to_owned();
        let unit = |(unit, bytes): (&str, u64)| {
            let at = text.len().checked_sub(unit.len())?;
            let (number, end) = text.split_at_checked(at)?;
            end.eq_ignore_ascii_case(unit).then_some((number, bytes))
        };
        let (number, bytes) = UNITS.into_iter().find_map(unit).unwrap_or((text, 1));
        let number: u64 = number.trim_end().parse().map_err(|_| wrong())?;
        number.checked_mul(bytes).map(Self).ok_or_else(wrong)
    }
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
            assert_eq!(text.parse(), Ok(Size(bytes)), "{text}");
        }
        for text in ["", "GiB", "-1", "1.5GiB", "1GB", "99999999999999TiB", "1é"] {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
        assert_eq!("1GiB".parse(), Ok(Size::default()));
    }
}
