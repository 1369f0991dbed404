//! The options that choose one mesh of a file and its shape.

use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

use clap::Args;
use glam::Affine3A;
use morph_collision::{BuildOptions, JointMatrices, MorphBvh, Pose};
use morph_collision_models::gltf::read::{GltfFile, LFS_POINTER, is_lfs_pointer};
use morph_collision_models::inspect::MeshError;
use morph_collision_models::memory::{FileFault, open_file, read_at_most};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::weight_list::{TargetNames, WeightList};

use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::{ClipChoice, read_clips};
use crate::files::model::{FileArgs, MeshChoice, STANDARD, count_memory};
use crate::messages::progress;
use crate::options::expression::ExpressionArg;
use crate::options::frame_times::time_in_clip;

/// Which mesh of a model, and in which shape.
#[derive(Debug, Args)]
pub(crate) struct ShapeArgs {
    /// The mesh: its index in the file, or its name.
    #[arg(long, value_name = "MESH", default_value_t)]
    pub(crate) mesh: MeshChoice,
    /// Weights of the targets: NAME=W,NAME=W,.. or one number per target, or @FILE to read them from a file, @- from standard input.
    ///
    /// Targets that are not named keep the weight of the clip, or without a clip the file's default weight. A file has lines of
    /// NAME=W or NAME,W, or it is JSON: {"NAME": W} or [W, W]. An index can stand for a name. `inspect` lists the names.
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub(crate) weights: Option<WeightArg>,
    /// Add the weights of a VRM expression: NAME, or NAME=STRENGTH. Can be repeated. --weights are set afterwards.
    #[arg(long, value_name = "NAME=S", allow_hyphen_values = true)]
    pub(crate) expression: Vec<ExpressionArg>,
    /// Name of an animation in the file, or its index. It moves the joints and sets the weights.
    ///
    /// FILE#NAME is an animation of another file, such as a library without meshes: a .glb or .gltf file and the name or index of one of its
    /// animations, or FILE alone if it has only one. What it animates is found by the names of nodes, and weights by the names of targets; names
    /// that the model does not have are listed. Its values are used as they are, so both files should have the same rest pose.
    #[arg(long, value_name = "NAME")]
    pub(crate) clip: Option<String>,
    /// The time in the animation, in seconds. Its first pose holds before the beginning, and its last pose after the end.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.0,
        requires = "clip",
        value_parser = seconds,
        allow_hyphen_values = true
    )]
    pub(crate) time: f32,
    /// Play the animation in a loop: --time may be in any repetition, and the end is the beginning.
    #[arg(long = "loop", requires = "clip")]
    pub(crate) is_loop: bool,
}

/// The value of `--weights`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WeightArg(pub(crate) WeightList);

/// More than enough for a line per target.
const LARGEST_WEIGHT_FILE: u64 = 16 << 20;

impl FromStr for WeightArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some(file) = text.strip_prefix('@') else {
            return WeightList::parse(text).map(Self);
        };
        let named = |error: String| format!("{file}: {error}");
        let read = if file == STANDARD {
            read_at_most(std::io::stdin().lock(), None, LARGEST_WEIGHT_FILE)
        } else {
            let opened = open_file(Path::new(file), false);
            opened.and_then(|(file, length)| read_at_most(file, length, LARGEST_WEIGHT_FILE))
        };
        let bytes = read.map_err(|fault| match fault {
            FileFault::NotRegular => named(format!("{fault}; pipe it to standard input and write @-")),
            FileFault::Io(_) | FileFault::TooLong { .. } => named(fault.to_string()),
        })?;
        if is_lfs_pointer(&bytes) {
            return Err(named(LFS_POINTER.to_owned()));
        }
        let text = String::from_utf8(bytes).map_err(|error| named(error.to_string()))?;
        WeightList::parse(&text).map(Self).map_err(named)
    }
}

/// A finite number.
pub(crate) fn seconds(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| number.is_finite());
    number.ok_or_else(|| "expected a finite number".to_owned())
}

/// A mesh in a shape.
pub(crate) struct ShapedMesh {
    /// Its index in the file.
    pub(crate) index: usize,
    pub(crate) mesh: MorphMesh,
    pub(crate) pose: Pose,
}

impl ShapedMesh {
    /// The weights that are not zero, in words.
    pub(crate) fn weights_in_words(&self) -> String {
        /// At most this many are listed.
        const MOST: usize = 8;
        let named = self.mesh.target_names.iter().zip(self.pose.weights());
        let active: Vec<String> = named
            .filter(|(_, weight)| **weight != 0.0)
            .map(|(name, &weight)| format!("{name} {}", short(weight)))
            .collect();
        match (self.mesh.targets.len(), active.len()) {
            (0, _) => "no targets".to_owned(),
            (targets, 0) => format!("all {targets} weights 0"),
            (targets, count) if count > MOST => {
                let shown = active[..MOST].join(", ");
                format!("{count} of {targets} weights not 0: {shown}, ...")
            }
            (targets, count) => format!("{count} of {targets} weights not 0: {}", active.join(", ")),
        }
    }
}

/// A number in a few characters: 0.25, but 1e-42 instead of 41 zeros.
fn short(number: f32) -> String {
    match number.abs() {
        0.0 | 1e-4..1e7 => number.to_string(),
        _ => format!("{number:e}"),
    }
}

impl ShapeArgs {
    /// Reads the mesh and poses it.
    pub(crate) fn read(&self, model: &Path, files: &FileArgs) -> Result<ShapedMesh, CliError> {
        let (file, index, mut mesh) = files.open_mesh(model, &self.mesh, "--mesh")?;
        count_memory(&file, index, mesh.tree_bytes(), || "its tree".into())?;
        let mut clips = ClipChoice::default();
        if let Some(name) = &self.clip {
            let broken = read_clips(files, &file, index, None, &mut mesh, None);
            let mut clip_files = ClipFiles::new(files, file.budget(), Path::new(""));
            let lent = clip_files.lend(name, &file, (index, None), &mut mesh, None);
            lent.map_err(|reason| CliError::Flag { flag: "--clip", reason })?;
            clip_files.warn();
            let found = clip_files.find(name, &file, &mesh, None, &broken);
            clips = found.map_err(|error| CliError::Flag {
                flag: "--clip",
                reason: error.reason(),
            })?;
        }
        let seconds = time_in_clip(self.time, clips.duration(&mesh, None), self.is_loop);
        let weights = self.weights_of(&file, index, &mesh, clips, seconds)?;
        progress::doing(format!("building the tree of {} triangles", mesh.triangles.len()));
        let tree = build(&mesh).map_err(|reason| CliError::Mesh {
            file: model.to_owned(),
            mesh: index,
            name: mesh.name.clone(),
            reason,
        })?;
        progress::doing("asking");
        let mut pose = Pose::new(Arc::new(tree));
        pose.set_weights(&weights).map_err(|error| CliError::Flag {
            flag: match (&self.weights, self.expression.is_empty()) {
                (Some(_), _) => "--weights",
                (None, false) => "--expression",
                (None, true) => "--clip",
            },
            reason: error.to_string(),
        })?;
        if let Some(joints) = joints(&mesh, clips, seconds) {
            let joints = JointMatrices::new(&joints);
            let set = joints.and_then(|joints| pose.set_joints(&joints));
            set.map_err(|reason| CliError::Pose {
                file: model.to_owned(),
                mesh: index,
                name: mesh.name.clone(),
                reason,
            })?;
        }
        Ok(ShapedMesh { index, mesh, pose })
    }

    fn weights_of(
        &self,
        file: &GltfFile,
        index: usize,
        mesh: &MorphMesh,
        clips: ClipChoice,
        seconds: f32,
    ) -> Result<Vec<f32>, CliError> {
        let mut others = match clips.weights {
            Some(clip) => mesh.animations[clip].sample(seconds),
            None => mesh.weights_at_rest(),
        };
        for expression in &self.expression {
            if !expression.add(file, index, None, &mut others)? {
                return Err(expression.moves_nothing("this mesh"));
            }
        }
        let Some(WeightArg(list)) = &self.weights else {
            return Ok(others);
        };
        let weights = TargetNames::new(&mesh.target_names).resolve(list, others);
        weights.map_err(|error| CliError::Flag {
            flag: "--weights",
            reason: error.to_string(),
        })
    }
}

fn joints(mesh: &MorphMesh, clips: ClipChoice, seconds: f32) -> Option<Vec<Affine3A>> {
    let skeleton = &mesh.skin.as_ref()?.skeleton;
    let clip = clips.joints.map(|clip| &skeleton.clips[clip]);
    Some(skeleton.world_from_mesh(clip, seconds))
}

fn build(mesh: &MorphMesh) -> Result<MorphBvh, MeshError> {
    Ok(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn weights_that_are_too_long_are_refused_and_not_cut() -> std::io::Result<()> {
        let file = tempfile::NamedTempFile::new()?;
        let read = || format!("@{}", file.path().display()).parse::<WeightArg>();
        file.as_file().write_all(b"jaw=1\n")?;
        let jaw = WeightList::Named(vec![("jaw".to_owned(), 1.0)]);
        assert_eq!(read(), Ok(WeightArg(jaw)));
        file.as_file().set_len(LARGEST_WEIGHT_FILE + 1)?;
        let error = read().expect_err("it is too long");
        assert!(error.contains("longer than 16.0 MiB"), "{error}");
        Ok(())
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_no_file_of_weights() {
        let error = "@/dev/zero".parse::<WeightArg>().expect_err("it is a device");
        assert!(error.contains("not a regular file") && error.contains("@-"), "{error}");
    }
}
