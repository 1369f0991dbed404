//! Builds scenes from model files: bodies, clips, placements and times.

use std::path::{Path, PathBuf};

use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::printable::Printable;
use morph_collision_testkit::scenes::{BodyState, Scene, SceneBody};
use morph_collision_testkit::skeleton::Skeleton;

use crate::clips::{ClipChoice, clip_names};
use crate::error::CliError;
use crate::model_file::{FileArgs, MeshChoice, STANDARD, read_clips, read_mesh};
use crate::output;

/// A model file and which of its meshes: `FILE`, `FILE#MESH` or `FILE#all`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct ModelSpec {
    pub(crate) file: PathBuf,
    pub(crate) meshes: Meshes,
}

/// Which meshes of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Meshes {
    One(MeshChoice),
    /// All that can collide.
    All,
}

impl ModelSpec {
    /// Splits the name of a mesh from a file's name, unless a file has the whole name.
    pub(crate) fn parse(text: &str, default: &Meshes) -> Self {
        let (file, meshes) = match text.rsplit_once('#') {
            Some((file, "all")) if !Path::new(text).exists() => (file, Meshes::All),
            Some((file, mesh)) if !Path::new(text).exists() => (file, Meshes::One(MeshChoice(mesh.to_owned()))),
            _ => (text, default.clone()),
        };
        Self {
            file: file.into(),
            meshes,
        }
    }
}

/// A body to be: a mesh of a file, as a node shows it.
pub(crate) struct Candidate {
    pub(crate) body: SceneBody,
    pub(crate) mesh: MorphMesh,
    placement: Option<Skeleton>,
    /// The names of the animations that move it.
    clips: Vec<String>,
}

impl Candidate {
    /// The animations that move it.
    pub(crate) fn clips(&self) -> &[String] {
        &self.clips
    }

    /// The length of a loop of one of its clips in seconds, and the clip's name; `None` if it has no such clip.
    pub(crate) fn clip(&self, file: &GltfFile, name: &str) -> Result<(String, f32), String> {
        let choice = ClipChoice::find(name, file, &self.mesh, self.placement.as_ref())?;
        Ok((name.to_owned(), choice.duration(&self.mesh, self.placement.as_ref())))
    }
}

/// The bodies of a model's file. With `nodes`, there is one body for each node that shows a mesh, and it stands where the node does;
/// otherwise one for each mesh, in its own space.
pub(crate) fn candidates(
    spec: &ModelSpec,
    nodes: bool,
    files: &FileArgs,
) -> Result<(GltfFile, Vec<Candidate>), CliError> {
    let file = files.open(&spec.file)?;
    let is_one = matches!(spec.meshes, Meshes::One(_));
    let meshes = match &spec.meshes {
        Meshes::One(mesh) => {
            let index = mesh.find(&file);
            vec![index.map_err(|reason| CliError::NoUsableMesh {
                file: spec.file.clone(),
                reason,
            })?]
        }
        Meshes::All => (0..file.mesh_count()).collect(),
    };
    let mut found = Vec::new();
    for index in meshes {
        // What is kept of a mesh is needed for names and lengths of clips only.
        let mesh = match read_mesh(&file, index) {
            Ok(mesh) => mesh,
            Err(error) if is_one => return Err(error),
            Err(error) => {
                output::complain(format_args!("warning: left out: {error}"));
                continue;
            }
        };
        let mut shown: Vec<Option<usize>> = file.nodes_of(index).map(Some).collect();
        if !nodes || shown.is_empty() {
            shown = vec![None];
        } else if mesh.skin.is_some() {
            // Joints place a skinned mesh, so all nodes that show it with its skin show the same.
            shown.truncate(1);
        }
        for node in shown {
            let mut mesh = mesh.clone();
            mesh.default_weights = file.default_weights(index, node, mesh.targets.len())?;
            read_clips(&file, index, &mut mesh)?;
            let placement = match node {
                Some(node) if mesh.skin.is_none() => Some(file.placement(index, node)?),
                _ => None,
            };
            let body = SceneBody {
                model: spec.file.clone(),
                mesh: index,
                node: node.filter(|_| placement.is_some()),
                name: Some(node.map_or_else(|| mesh.name.clone(), |node| file.node_name(node))),
                comment: None,
            };
            let clips = clip_names(&file, &mesh, placement.as_ref());
            found.push(Candidate {
                body,
                mesh,
                placement,
                clips,
            });
        }
    }
    if found.is_empty() {
        return Err(CliError::NoUsableMesh {
            file: spec.file.clone(),
            reason: "it has no mesh that can collide".to_owned(),
        });
    }
    Ok((file, found))
}

/// Makes names unique by adding numbers, so that reports can refer to bodies by name.
pub(crate) fn number_names(bodies: &mut [SceneBody]) {
    for index in 1..bodies.len() {
        let (before, rest) = bodies.split_at_mut(index);
        let Some(name) = rest[0].name.clone() else { continue };
        let same = before.iter().filter(|body| {
            let other = body.name.as_deref().unwrap_or_default();
            other == name
                || other
                    .strip_suffix(')')
                    .is_some_and(|start| start.starts_with(&format!("{name} (")))
        });
        let same = same.count();
        if same > 0 {
            rest[0].name = Some(format!("{name} ({})", same + 1));
        }
    }
}

/// Times that frames stand for: `frames` of them, `fps` a second.
pub(crate) fn frame_count(seconds: f32, fps: f32) -> usize {
    // A clip's end is its beginning, so it needs no frame, and neither does an end that is late only by rounding. Casts saturate.
    ((f64::from(seconds) * f64::from(fps) - 1e-3).ceil() as usize).max(1)
}

/// A scene's frames: every body plays its clip.
pub(crate) fn frames_of_clips(clips: &[Option<String>], frames: usize, fps: f32) -> Vec<Vec<BodyState>> {
    let state = |frame: usize, clip: &Option<String>| BodyState {
        clip: clip.clone(),
        time: clip.as_ref().map(|_| (frame as f64 / f64::from(fps)) as f32),
        ..BodyState::default()
    };
    (0..frames)
        .map(|frame| clips.iter().map(|clip| state(frame, clip)).collect())
        .collect()
}

/// A scene in which no path is relative to a scene file, because there is none.
pub(crate) fn scene_of(bodies: Vec<SceneBody>, frames: Vec<Vec<BodyState>>) -> Scene {
    Scene {
        bodies,
        frames,
        ..Scene::default()
    }
}

/// Checks that all models are files, because a scene holds their names.
pub(crate) fn check_stdin(models: &[ModelSpec]) -> Result<(), CliError> {
    if models.iter().any(|spec| spec.file == Path::new(STANDARD)) {
        return Err(CliError::NoUsableMesh {
            file: STANDARD.into(),
            reason: "a scene needs the names of its models, so they cannot come from standard input".to_owned(),
        });
    }
    Ok(())
}

/// A name in quotes, safe to print.
pub(crate) fn quoted(name: &str) -> String {
    format!("\"{}\"", Printable(name))
}
