//! The meshes of a model to try, and what is said if one does not allow a shape.

use std::path::Path;

use morph_collision_testkit::gltf_read::GltfFile;
use morph_collision_testkit::joined::JoinError;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::printable::Printable;
use morph_collision_testkit::rivals::PoseError;

use super::LintArgs;
use super::members::Member;
use super::poses::Tried;
use crate::clip_files::ClipFiles;
use crate::clips::{BrokenClips, read_clips};
use crate::error::CliError;
use crate::model_file::{count_memory, leave_out_unweighted, read_mesh};
use crate::output;

/// A mesh to try.
#[derive(Debug)]
pub(super) struct Subject {
    /// Its index in the file.
    pub(super) index: usize,
    /// With the garment behind it, if there is one.
    pub(super) mesh: MorphMesh,
    /// The names of its primitives' materials.
    pub(super) materials: Vec<Option<String>>,
    /// The number of its own targets.
    pub(super) own_targets: usize,
    /// The first triangle of the garment.
    pub(super) garment_from: Option<u32>,
    /// The clips that cannot be played.
    pub(super) broken: BrokenClips,
    /// The file's meshes in it, one after the other.
    pub(super) members: Vec<Member>,
    /// The number of triangles that are left out because no joint moves one of their vertices.
    pub(super) left_out: usize,
}

/// The meshes to try. Without `--mesh`, meshes that cannot collide, or not wear the garment, are left out with a warning.
pub(super) fn subjects(args: &LintArgs, file: &GltfFile) -> Result<Vec<Subject>, CliError> {
    let indices = match &args.mesh {
        Some(choice) => {
            let found = choice.find(file);
            vec![found.map_err(|reason| CliError::Flag { flag: "--mesh", reason })?]
        }
        None => {
            let mut drawn: Vec<usize> = args.drawn.drawn(file)?.iter().map(|drawn| drawn.mesh).collect();
            drawn.dedup();
            drawn
        }
    };
    let garment = args.garment.as_ref();
    let garment = garment.map(|path| Garment::read(args, path, file)).transpose()?;
    let mut clip_files = ClipFiles::new(&args.files, file.budget(), Path::new(""));
    for clip in &args.clip {
        let opened = clip_files.open(clip, file);
        opened.map_err(|reason| CliError::Flag { flag: "--clip", reason })?;
    }
    let mut subjects = Vec::new();
    for index in indices {
        let is_garment = garment
            .as_ref()
            .is_some_and(|garment| garment.is_in_model && garment.index == index);
        if is_garment && args.mesh.is_none() {
            continue;
        }
        match subject(&mut clip_files, &args.clip, file, index, garment.as_ref()) {
            Ok(subject) => subjects.push(subject),
            Err(error) if args.mesh.is_some() => return Err(error),
            Err(error) => output::complain(format_args!("warning: left out: {error}")),
        }
    }
    clip_files.warn();
    if subjects.is_empty() {
        let reason = match garment {
            Some(_) => "it has no mesh that can wear the garment",
            None => "it has no mesh that can collide",
        };
        return Err(CliError::NoUsableMesh {
            file: args.model.clone(),
            reason: reason.to_owned(),
        });
    }
    Ok(subjects)
}

fn subject(
    clip_files: &mut ClipFiles<'_>,
    clips: &[String],
    file: &GltfFile,
    index: usize,
    garment: Option<&Garment>,
) -> Result<Subject, CliError> {
    let mut mesh = read_mesh(file, index, None)?;
    let broken = read_clips(clip_files.options(), file, index, None, &mut mesh, None);
    for clip in clips {
        let wrong = |reason| CliError::Flag { flag: "--clip", reason };
        let lent = clip_files.lend(clip, file, (index, None), &mut mesh, None);
        lent.map_err(wrong)?;
        if clip_files.has(clip) {
            let found = clip_files.find(clip, file, &mesh, None, &broken);
            found.map_err(|error| wrong(error.reason()))?;
        }
    }
    let (member, left_out) = member(file, index, &mut mesh)?;
    let mut subject = Subject {
        index,
        members: vec![member],
        left_out,
        own_targets: mesh.targets.len(),
        materials: file.material_names(index),
        garment_from: None,
        broken,
        mesh,
    };
    if let Some(garment) = garment {
        let bytes = joined_bytes(&subject.mesh, &garment.mesh);
        count_memory(file, index, bytes, || "it and the garment as one".to_owned())?;
        let first = subject.mesh.triangles.len() as u32;
        subject.garment_from = Some(first);
        subject.members.push(Member {
            first,
            ..garment.member.clone()
        });
        subject.left_out += garment.left_out;
        let joined = subject.mesh.joined(&garment.mesh);
        let told = |reason: JoinError| CliError::Flag {
            flag: "--garment",
            reason: Printable(&reason.to_string()).to_string(),
        };
        subject.mesh = joined.map_err(told)?;
        // One name for each of its own primitives, so that the garment's follow.
        let own = subject.mesh.primitives.len() - garment.mesh.primitives.len();
        subject.materials.resize(own, None);
        subject.materials.extend(garment.materials.iter().cloned().map(Some));
    }
    Ok(subject)
}

/// A mesh as the first of a subject, and how many of its triangles are left out.
fn member(file: &GltfFile, index: usize, mesh: &mut MorphMesh) -> Result<(Member, usize), CliError> {
    let unweighted = leave_out_unweighted(file, index, mesh)?;
    let left_out = unweighted.as_ref().map_or(0, |unweighted| unweighted.triangles);
    let member = Member {
        mesh: index,
        name: mesh.name.clone(),
        first: 0,
        kept: unweighted.map(|unweighted| unweighted.kept),
    };
    Ok((member, left_out))
}

/// Upper bound on the bytes of two meshes as one. Every target that moves anything has an entry for each vertex of both.
fn joined_bytes(mesh: &MorphMesh, garment: &MorphMesh) -> u64 {
    let both = |count: fn(&MorphMesh) -> usize| (count(mesh) as u64).saturating_add(count(garment) as u64);
    let (vertices, triangles) = (both(|mesh| mesh.positions.len()), both(|mesh| mesh.triangles.len()));
    let targets = both(|mesh| mesh.targets.iter().filter(|target| !target.is_empty()).count());
    let sets = both(|mesh| mesh.skin.as_ref().map_or(0, |skin| skin.sets.len()));
    let keys = both(|mesh| mesh.animations.iter().map(|clip| clip.times.len()).sum());
    let per_vertex = targets.saturating_mul(12).saturating_add(24 * sets + 12);
    let of_clips = keys.saturating_mul(both(|mesh| mesh.targets.len())).saturating_mul(12);
    vertices
        .saturating_mul(per_vertex)
        .saturating_add(12 * triangles)
        .saturating_add(of_clips)
}

/// The mesh of `--garment`.
struct Garment {
    index: usize,
    mesh: MorphMesh,
    /// The name of the mesh and of the material of each primitive.
    materials: Vec<String>,
    member: Member,
    left_out: usize,
    /// Whether its file is the model.
    is_in_model: bool,
}

impl Garment {
    fn read(args: &LintArgs, path: &Path, model: &GltfFile) -> Result<Self, CliError> {
        let file = args.files.open_within(path, model.budget())?;
        let choice = args.garment_mesh.clone().unwrap_or_default();
        let found = choice.find(&file);
        let index = found.map_err(|reason| CliError::Flag {
            flag: "--garment-mesh",
            reason,
        })?;
        let mut mesh = read_mesh(&file, index, None)?;
        let (member, left_out) = member(&file, index, &mut mesh)?;
        let materials = file.material_names(index);
        let material = |primitive: usize| match materials.get(primitive) {
            Some(Some(material)) => format!("{} {material}", mesh.name),
            _ => mesh.name.clone(),
        };
        let materials = (0..mesh.primitives.len()).map(material).collect();
        let same = |one: &Path, other: &Path| match (one.canonicalize(), other.canonicalize()) {
            (Ok(one), Ok(other)) => one == other,
            _ => one == other,
        };
        Ok(Self {
            index,
            mesh,
            materials,
            member,
            left_out,
            is_in_model: same(path, &args.model),
        })
    }
}

/// A shape in a message.
pub(super) fn shape_words(shape: &Tried, mesh: &MorphMesh) -> String {
    let source = shape.source.words(&mesh.target_names);
    match shape.moment {
        Some(moment) => format!("{source} at {moment}"),
        None => source,
    }
}

/// The error for a shape that the mesh does not allow.
pub(super) fn refused(args: &LintArgs, index: usize, mesh: &MorphMesh, shape: String, reason: PoseError) -> CliError {
    CliError::Shape {
        file: args.model.clone(),
        mesh: index,
        name: mesh.name.clone(),
        shape,
        reason: Box::new(reason),
    }
}
