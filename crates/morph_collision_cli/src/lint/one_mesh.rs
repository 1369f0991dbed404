//! One mesh as a node shows it, alone or with a garment.

use std::path::Path;

use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::mesh::JoinError;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::skeleton::Skeleton;
use morph_collision_models::text::Printable;

use super::members::Member;
use super::options::LintOptions;
use super::subject::Subject;
use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::read_clips;
use crate::files::model::{count_memory, leave_out_unweighted, read_mesh};

/// One mesh as a node shows it, or else its main node; with its garment.
pub(super) fn subject(
    options: &LintOptions,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
    index: usize,
    node: Option<usize>,
    garment: Option<&Garment>,
) -> Result<Subject, CliError> {
    let mut mesh = read_mesh(file, index, node)?;
    let broken = read_clips(&options.files, file, index, node, &mut mesh, None);
    lend_clips(options, clip_files, file, (index, node), &mut mesh, None)?;
    let (member, left_out) = member(file, index, node, &mut mesh)?;
    let mut subject = Subject {
        left_out,
        broken,
        materials: file.material_names(index),
        ..Subject::of_one(index, mesh, member)
    };
    if let Some(garment) = garment {
        let bytes = joined_bytes(&subject.mesh, &garment.mesh);
        count_memory(file, index, bytes, || "it and the garment as one".to_owned())?;
        let first = subject.mesh.triangles.len() as u32;
        subject.garment_from = Some(first);
        let mut member = garment.member.clone();
        member.first = first;
        subject.members.push(member);
        // They are of different files.
        subject.members.iter_mut().for_each(|member| member.node = None);
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
        subject.leaders = (0..subject.mesh.targets.len()).collect();
        subject.clip_targets = vec![subject.leaders.clone(); subject.mesh.animations.len()];
    }
    subject.add_expressions(file);
    Ok(subject)
}

/// Adds the clips of other files that are asked for to a mesh and, if it has no joints, to the node that shows it.
pub(super) fn lend_clips(
    options: &LintOptions,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
    place: (usize, Option<usize>),
    mesh: &mut MorphMesh,
    mut placement: Option<&mut Skeleton>,
) -> Result<(), CliError> {
    for clip in &options.clip {
        let lent = clip_files.lend(clip, file, place, mesh, placement.as_deref_mut());
        lent.map_err(|reason| CliError::Flag { flag: "--clip", reason })?;
    }
    Ok(())
}

/// A mesh as the first of a subject, and how many of its triangles are left out.
pub(super) fn member(
    file: &GltfFile,
    index: usize,
    node: Option<usize>,
    mesh: &mut MorphMesh,
) -> Result<(Member, usize), CliError> {
    let unweighted = leave_out_unweighted(file, index, mesh)?;
    let left_out = unweighted.as_ref().map_or(0, |unweighted| unweighted.triangles);
    let member = Member {
        mesh: index,
        name: mesh.name.clone(),
        node: node.or_else(|| file.main_node(index)),
        targets: (0..mesh.targets.len()).collect(),
        target_names: mesh.target_names.clone(),
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
pub(super) struct Garment {
    pub(super) index: usize,
    mesh: MorphMesh,
    /// The name of the mesh and of the material of each primitive.
    materials: Vec<String>,
    member: Member,
    left_out: usize,
    /// Whether its file is the model.
    pub(super) is_in_model: bool,
}

impl Garment {
    pub(super) fn read(options: &LintOptions, path: &Path, model: &GltfFile) -> Result<Self, CliError> {
        let file = options.files.open_within(path, model.budget())?;
        let choice = options.garment_mesh.clone().unwrap_or_default();
        let found = choice.find(&file);
        let index = found.map_err(|reason| CliError::Flag {
            flag: "--garment-mesh",
            reason,
        })?;
        let mut mesh = read_mesh(&file, index, None)?;
        let (member, left_out) = member(&file, index, None, &mut mesh)?;
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
            is_in_model: same(path, &options.model),
        })
    }
}
