//! Builds scenes from model files: bodies, clips, placements and times.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use morph_collision_models::gltf::read::{DrawnMesh, Extent, GltfFile};
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{BodyState, Scene, SceneBody};
use morph_collision_models::skeleton::Skeleton;
use morph_collision_models::text::Printable;

use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::{BrokenClips, ClipChoice, NoClip, clip_names, read_clips};
use crate::files::drawn::{DrawnArgs, note_if_not_drawn};
use crate::files::model::{MeshChoice, STANDARD, count_memory, read_mesh, show_with};
use crate::messages;
use crate::options::frame_times::{FrameTimes, time_in_clip};

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
    /// All that are drawn and can collide.
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

/// Upper bound on the bytes of a body to be, beside what it shares with others.
const BYTES_PER_CANDIDATE: u64 = 512;

/// A body to be: a mesh of a file, as a node shows it.
pub(crate) struct Candidate {
    pub(crate) body: SceneBody,
    /// Shared by the instances of a node.
    shown: Rc<Shown>,
}

/// A mesh as a node shows it.
struct Shown {
    /// Only its names, its clips and its skeleton; the bodies of a command are read anew.
    mesh: MorphMesh,
    placement: Option<Skeleton>,
    /// The names of the animations that move it.
    clips: Vec<String>,
    broken: BrokenClips,
}

impl Candidate {
    /// The names of its targets.
    pub(crate) fn target_names(&self) -> &[String] {
        &self.shown.mesh.target_names
    }

    /// Its weights at a time of a clip, or at rest.
    pub(crate) fn weights(&self, file: &GltfFile, clip: Option<&str>, seconds: f32) -> Vec<f32> {
        let Shown {
            mesh,
            placement,
            broken,
            ..
        } = &*self.shown;
        let choice = clip.and_then(|name| ClipChoice::find(name, file, mesh, placement.as_ref(), broken).ok());
        match choice.and_then(|choice| mesh.animations.get(choice.weights?)) {
            Some(clip) => clip.sample(seconds),
            None => mesh.weights_at_rest(),
        }
    }

    /// The animations that move it.
    pub(crate) fn clips(&self) -> &[String] {
        &self.shown.clips
    }

    /// The name of one of its clips, and the clip's length in seconds.
    pub(crate) fn clip(
        &self,
        file: &GltfFile,
        clip_files: &ClipFiles<'_>,
        name: &str,
    ) -> Result<(String, f32), NoClip> {
        let Shown {
            mesh,
            placement,
            broken,
            ..
        } = &*self.shown;
        let choice = clip_files.find(name, file, mesh, placement.as_ref(), broken)?;
        Ok((name.to_owned(), choice.duration(mesh, placement.as_ref())))
    }
}

/// The clip of each body that has one. `name` is the name of an animation, or its index.
///
/// # Errors
/// No body has such a clip, or the clip of one is broken.
pub(crate) fn clips_of(
    found: &[Candidate],
    file: &GltfFile,
    clip_files: &ClipFiles<'_>,
    name: &str,
) -> Result<Vec<Option<(String, f32)>>, NoClip> {
    let mut clips = Vec::with_capacity(found.len());
    let mut unknown = None;
    for candidate in found {
        match candidate.clip(file, clip_files, name) {
            Ok(clip) => clips.push(Some(clip)),
            Err(reason) if reason.is_broken() => return Err(reason),
            Err(reason) => {
                unknown.get_or_insert(reason);
                clips.push(None);
            }
        }
    }
    match unknown {
        Some(reason) if clips.iter().all(Option::is_none) => Err(reason),
        _ => Ok(clips),
    }
}

/// The animations that move bodies, in the order of the file. Those that cannot be played for one of the bodies are left out.
pub(crate) fn playable(found: &[Candidate], file: &GltfFile) -> Vec<String> {
    let moving: HashSet<&String> = found.iter().flat_map(Candidate::clips).collect();
    let names = file.animation_names().into_iter().enumerate();
    let is_whole = |index: usize| !found.iter().any(|candidate| candidate.shown.broken.has(index));
    let wanted = names.filter(|(index, name)| moving.contains(name) && is_whole(*index));
    wanted.map(|(_, name)| name).collect()
}

/// The bodies of a model's file. With `nodes`, there is one body for each node that shows a mesh, and for each of its instances, and it stands
/// where the node does. Otherwise a mesh without joints is one body, in its own space. `clips` are the clips that are asked for; those of other
/// files are added to the bodies.
pub(crate) fn candidates(
    spec: &ModelSpec,
    nodes: bool,
    drawn: &DrawnArgs,
    clips: &[String],
    clip_files: &mut ClipFiles<'_>,
) -> Result<(GltfFile, Vec<Candidate>), CliError> {
    let file = clip_files.options().open(&spec.file)?;
    for clip in clips {
        let opened = clip_files.open(clip, &file);
        opened.map_err(|reason| CliError::Flag { flag: "--clip", reason })?;
    }
    let is_one = matches!(spec.meshes, Meshes::One(_));
    let mut found = Vec::new();
    let wanted = wanted(spec, nodes, drawn, &file)?;
    if let Some(first) = wanted.first() {
        let bytes = wanted.len() as u64 * BYTES_PER_CANDIDATE;
        count_memory(&file, first.mesh, bytes, || {
            format!("the {} bodies of the file", wanted.len())
        })?;
    }
    for of_mesh in wanted.chunk_by(|a, b| a.mesh == b.mesh) {
        match file
            .budget()
            .lend(|| of_one_mesh(spec, nodes, &file, of_mesh, clips, clip_files))
        {
            Ok(bodies) => found.extend(bodies),
            Err(error) if is_one => return Err(error),
            Err(error) => messages::complain(format_args!("warning: left out: {error}")),
        }
    }
    if found.is_empty() {
        return Err(CliError::NoUsableMesh {
            file: spec.file.clone(),
            reason: "it draws no mesh that can collide".to_owned(),
        });
    }
    Ok((file, found))
}

/// What is taken of a file, in the order of meshes.
fn wanted(spec: &ModelSpec, nodes: bool, drawn: &DrawnArgs, file: &GltfFile) -> Result<Vec<DrawnMesh>, CliError> {
    let alone = |mesh: usize, node: Option<usize>| DrawnMesh {
        mesh,
        node,
        instance: None,
    };
    let Meshes::One(choice) = &spec.meshes else {
        return drawn.drawn(file);
    };
    let mesh = choice.find(file).map_err(|reason| CliError::NoUsableMesh {
        file: spec.file.clone(),
        reason,
    })?;
    note_if_not_drawn(file, mesh);
    if !nodes {
        return Ok(vec![alone(mesh, None)]);
    }
    let of_mesh = |extent| -> Result<Vec<DrawnMesh>, CliError> {
        let mut drawn = file.drawing(extent)?.drawn;
        drawn.retain(|drawn| drawn.mesh == mesh);
        Ok(drawn)
    };
    let mut wanted = of_mesh(Extent::DefaultScene)?;
    if wanted.is_empty() {
        wanted = of_mesh(Extent::Everything)?;
    }
    if wanted.is_empty() {
        wanted.push(alone(mesh, None));
    }
    Ok(wanted)
}

/// The bodies of a mesh, read once.
fn of_one_mesh(
    spec: &ModelSpec,
    nodes: bool,
    file: &GltfFile,
    of_mesh: &[DrawnMesh],
    clips: &[String],
    clip_files: &mut ClipFiles<'_>,
) -> Result<Vec<Candidate>, CliError> {
    let index = of_mesh[0].mesh;
    let mut mesh = read_mesh(file, index, of_mesh[0].node)?;
    // Only names, clips and skeletons are needed.
    mesh.positions = Vec::new();
    mesh.triangles = Vec::new();
    mesh.targets.iter_mut().for_each(|target| *target = Vec::new());
    let mut found: Vec<Candidate> = Vec::new();
    let mut has_one_in_own_space = false;
    for &DrawnMesh { node, instance, .. } in of_mesh {
        if let Some(1..) = instance {
            if let Some(last) = found.last().filter(|_| nodes) {
                let mut body = last.body.clone();
                body.instance = instance;
                let shown = Rc::clone(&last.shown);
                found.push(Candidate { body, shown });
            }
            continue;
        }
        let mut mesh = mesh.clone();
        show_with(file, index, node, &mut mesh)?;
        let is_in_own_space = mesh.skin.is_none() && !nodes;
        // It is not where the node is, so the node's weights and clips do not count, either.
        let node = node.filter(|_| !is_in_own_space);
        if is_in_own_space {
            if std::mem::replace(&mut has_one_in_own_space, true) {
                continue;
            }
            show_with(file, index, None, &mut mesh)?;
        }
        if let Some(skin) = &mut mesh.skin {
            skin.sets = Vec::new();
        }
        let is_placed = nodes && mesh.skin.is_none();
        let placement = node.filter(|_| is_placed);
        let mut placement = placement.map(|node| file.placement(index, node)).transpose()?;
        let broken = read_clips(clip_files.options(), file, index, node, &mut mesh, placement.as_ref());
        for clip in clips {
            let lent = clip_files.lend(clip, file, (index, node), &mut mesh, placement.as_mut());
            lent.map_err(|reason| CliError::Flag { flag: "--clip", reason })?;
        }
        let is_named = nodes || of_mesh.len() > 1 || node != file.main_node(index);
        let node = node.filter(|_| is_named);
        let body = SceneBody {
            model: spec.file.clone(),
            mesh: index,
            node,
            instance: instance.filter(|_| is_placed),
            name: Some(node.map_or_else(|| mesh.name.clone(), |node| file.node_name(node))),
            comment: None,
        };
        let clips = clip_names(file, &mesh, placement.as_ref(), &broken);
        let shown = Rc::new(Shown {
            mesh,
            placement,
            clips,
            broken,
        });
        found.push(Candidate { body, shown });
    }
    Ok(found)
}

/// Makes names unique by adding numbers, so that reports can refer to bodies by name.
pub(crate) fn number_names(bodies: &mut [SceneBody]) {
    let mut taken: HashSet<String> = HashSet::new();
    let mut next: HashMap<String, usize> = HashMap::new();
    for body in bodies {
        let Some(name) = body.name.clone() else { continue };
        if taken.insert(name.clone()) {
            continue;
        }
        let number = next.entry(name.clone()).or_insert(2);
        let numbered = loop {
            let numbered = format!("{name} ({number})");
            *number += 1;
            if taken.insert(numbered.clone()) {
                break numbered;
            }
        };
        body.name = Some(numbered);
    }
}

/// A scene's frames: every body plays its clip, given by its name and its length in seconds.
pub(crate) fn frames_of_clips(
    clips: &[Option<(String, f32)>],
    times: &FrameTimes,
    is_loop: bool,
) -> Vec<Vec<BodyState>> {
    let state = |seconds: f32, clip: &Option<(String, f32)>| BodyState {
        clip: clip.as_ref().map(|(name, _)| name.clone()),
        time: clip.as_ref().map(|(_, length)| time_in_clip(seconds, *length, is_loop)),
        ..BodyState::default()
    };
    (0..times.len())
        .map(|frame| times.seconds(frame) as f32)
        .map(|seconds| clips.iter().map(|clip| state(seconds, clip)).collect())
        .collect()
}

/// Counts the memory of frames, if a body in a frame takes `bytes`.
///
/// # Errors
/// The budget has no room for them.
pub(crate) fn take_frames(
    frames: usize,
    bodies: usize,
    bytes: u64,
    budget: &MemoryBudget,
    flag: &'static str,
) -> Result<(), CliError> {
    let states = (frames as u64).saturating_mul(bodies as u64);
    if budget.take(states, bytes, String::new).is_ok() {
        return Ok(());
    }
    let or_fewer = if flag == "--frames" {
        "lower --fps or --frames"
    } else {
        "lower --fps"
    };
    Err(CliError::Flag {
        flag,
        reason: format!(
            "{frames} frames of {bodies} bodies need more memory than the limit; {or_fewer}, or raise --memory-limit"
        ),
    })
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
