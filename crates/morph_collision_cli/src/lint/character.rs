//! Which meshes of a file belong together: those of one skeleton or node tree. They are searched as one.

use glam::Affine3A;
use morph_collision_testkit::gltf_read::{Drawn, GltfFile};
use morph_collision_testkit::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_testkit::skeleton::Skeleton;
use morph_collision_testkit::together::Together;

use super::LintArgs;
use super::input::{lend_clips, member, subject};
use super::members::Member;
use super::subject::Subject;
use crate::clip_files::ClipFiles;
use crate::clips::{BrokenClips, read_clips};
use crate::error::CliError;
use crate::model_file::{check_parts, count_memory, read_mesh, show_with};
use crate::output;

/// All that is drawn, one subject for each skeleton or node tree. Of a node's instances, the first one counts.
///
/// Meshes that cannot collide are left out with a warning.
///
/// # Errors
/// The meshes of a group take too much memory as one, or nothing moves any of the meshes.
pub(super) fn characters(
    args: &LintArgs,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
) -> Result<Vec<Subject>, CliError> {
    let mut subjects: Vec<Subject> = Vec::new();
    let mut any_still = false;
    for group in groups(file, args.drawn.drawn(file)?) {
        match group[..] {
            [Drawn { mesh, node, .. }] => match subject(args, clip_files, file, mesh, node, None) {
                Ok(subject) => {
                    // A mesh that nothing but its place tells from another one.
                    let is_same = |known: &Subject| known.index == mesh && known.mesh == subject.mesh;
                    if !subjects.iter().any(is_same) {
                        subjects.push(subject);
                    }
                }
                Err(error) => output::complain(format_args!("warning: left out: {error}")),
            },
            _ => match character(args, clip_files, file, &group)? {
                Group::Moves(subject) => subjects.push(*subject),
                Group::Still => any_still = true,
                Group::Empty => {}
            },
        }
    }
    match subjects.is_empty() && any_still {
        true => Err(CliError::NothingTried {
            file: file.path().to_owned(),
        }),
        false => Ok(subjects),
    }
}

/// What is drawn, by skeleton or node tree.
fn groups(file: &GltfFile, drawn: Vec<Drawn>) -> Vec<Vec<Drawn>> {
    // For each group, the topmost nodes above its meshes.
    let mut groups: Vec<(Vec<usize>, Vec<Drawn>)> = Vec::new();
    for drawn in drawn {
        if drawn.instance.is_some_and(|instance| instance > 0) {
            continue;
        }
        let mut roots = drawn.node.map_or(Vec::new(), |node| file.roots_of(drawn.mesh, node));
        let mut members = Vec::new();
        // Groups that the mesh connects become one.
        let (met, others) = groups
            .into_iter()
            .partition::<Vec<_>, _>(|(known, _)| known.iter().any(|root| roots.contains(root)));
        for (known, joined) in met {
            roots.extend(known);
            members.extend(joined);
        }
        roots.sort_unstable();
        roots.dedup();
        members.push(drawn);
        groups = others;
        groups.push((roots, members));
    }
    let mut groups: Vec<Vec<Drawn>> = groups.into_iter().map(|(_, members)| members).collect();
    groups.sort_by_key(|members| members.first().map(|first| first.mesh));
    groups
}

/// A mesh as a node shows it.
struct Part {
    mesh: MorphMesh,
    member: Member,
    left_out: usize,
    broken: BrokenClips,
    materials: Vec<Option<String>>,
    /// How its node moves; `None` for a skinned mesh.
    placement: Option<Skeleton>,
}

/// The meshes of a skeleton or node tree.
enum Group {
    /// As one.
    Moves(Box<Subject>),
    /// Nothing moves them, so nothing can be tried.
    Still,
    /// None of them can collide.
    Empty,
}

/// All meshes of a group as one.
fn character(
    args: &LintArgs,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
    group: &[Drawn],
) -> Result<Group, CliError> {
    let mut parts: Vec<Part> = Vec::with_capacity(group.len());
    // Kept while further nodes show it.
    let mut last: Option<(usize, MorphMesh)> = None;
    for (place, drawn) in group.iter().enumerate() {
        // What is left out of it depends on its skin, so it is read again for each node.
        let comes_again = !file.skips_bad() && group.get(place + 1).is_some_and(|next| next.mesh == drawn.mesh);
        let known = last.as_ref().filter(|(mesh, _)| *mesh == drawn.mesh);
        match part(args, clip_files, file, drawn, known.map(|(_, mesh)| mesh), comes_again) {
            Ok((part, whole)) => {
                parts.push(part);
                if let Some(whole) = whole {
                    last = Some((drawn.mesh, whole));
                }
            }
            Err(error) => output::complain(format_args!("warning: left out: {error}")),
        }
    }
    let moves = |part: &Part| {
        let of_joints = part.mesh.skin.as_ref().map(|skin| &skin.skeleton);
        let mut skeletons = [of_joints, part.placement.as_ref()].into_iter().flatten();
        part.mesh.targets.iter().any(|target| !target.is_empty())
            || skeletons.any(|skeleton| !skeleton.clips.is_empty())
    };
    let Some(first) = parts.first() else {
        return Ok(Group::Empty);
    };
    if !parts.iter().any(moves) {
        return Ok(Group::Still);
    }
    let index = first.member.mesh;
    if !share_a_place(&parts) {
        for part in &mut parts {
            if let Some(placement) = part.placement.take() {
                part.mesh.skin = Some(follow(placement, part.mesh.positions.len()));
            }
        }
    }
    let mut subject = Subject {
        index,
        ..Subject::default()
    };
    let mut meshes = Vec::with_capacity(parts.len());
    let mut first = 0;
    for mut part in parts {
        let name = &part.mesh.name;
        part.materials.resize(part.mesh.primitives.len(), None);
        let named =
            |material: Option<String>| Some(material.map_or_else(|| name.clone(), |own| format!("{name} {own}")));
        subject.materials.extend(part.materials.into_iter().map(named));
        part.member.first = first;
        first += part.mesh.triangles.len() as u32;
        subject.members.push(part.member);
        subject.left_out += part.left_out;
        subject.broken.add(part.broken);
        meshes.push(part.mesh);
    }
    let name = meshes.first().map(|mesh| mesh.name.clone()).unwrap_or_default();
    let together = Together::of(meshes, file.budget()).map_err(|reason| CliError::Together {
        file: file.path().to_owned(),
        mesh: index,
        name,
        reason,
    })?;
    subject.mesh = together.mesh;
    (subject.leaders, subject.clip_targets) = (together.leaders, together.clip_targets);
    for (member, targets) in subject.members.iter_mut().zip(together.targets) {
        member.targets = targets;
    }
    subject.add_expressions(file);
    Ok(Group::Moves(Box::new(subject)))
}

/// Reads a part, or takes the mesh as it was read last. Also returns the mesh as it was read, if it comes again.
fn part(
    args: &LintArgs,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
    &Drawn { mesh: index, node, .. }: &Drawn,
    known: Option<&MorphMesh>,
    comes_again: bool,
) -> Result<(Part, Option<MorphMesh>), CliError> {
    let (mut mesh, read) = match known {
        Some(known) => {
            count_memory(file, index, bytes(known), || "it once more".to_owned())?;
            let mut mesh = known.clone();
            show_with(file, index, node, &mut mesh)?;
            (mesh, None)
        }
        None => {
            let mesh = read_mesh(file, index, node)?;
            let copy = comes_again.then(|| mesh.clone());
            (mesh, copy)
        }
    };
    let mut placement = match (&mesh.skin, node) {
        (None, Some(node)) => Some(file.placement(index, node)?),
        (None, None) => Some(Skeleton::separate(1)),
        (Some(_), _) => None,
    };
    let broken = read_clips(&args.files, file, index, node, &mut mesh, placement.as_ref());
    lend_clips(args, clip_files, file, (index, node), &mut mesh, placement.as_mut())?;
    let (member, left_out) = member(file, index, node, &mut mesh)?;
    check_parts(file, index, &mesh)?;
    let part = Part {
        member,
        left_out,
        broken,
        materials: file.material_names(index),
        placement,
        mesh,
    };
    Ok((part, read))
}

/// Whether all parts are in the same space, which nothing moves.
fn share_a_place(parts: &[Part]) -> bool {
    let place = |part: &Part| -> Option<Vec<Affine3A>> {
        let placement = part.placement.as_ref().filter(|placement| placement.clips.is_empty())?;
        Some(placement.at_rest())
    };
    let first = parts.first().and_then(place);
    first.is_some() && parts.iter().all(|part| place(part) == first)
}

/// A skin whose only joint is the node that a mesh follows.
fn follow(placement: Skeleton, vertices: usize) -> MeshSkin {
    MeshSkin {
        sets: vec![InfluenceSet {
            joints: vec![[0; 4]; vertices],
            weights: vec![[1.0, 0.0, 0.0, 0.0]; vertices],
        }],
        skeleton: placement,
    }
}

/// Upper bound on the bytes of a copy of a mesh.
fn bytes(mesh: &MorphMesh) -> u64 {
    let moving = mesh.targets.iter().filter(|target| !target.is_empty()).count() as u64;
    let sets = mesh.skin.as_ref().map_or(0, |skin| skin.sets.len() as u64);
    let per_vertex = 12 + 12 * moving + 24 * sets;
    per_vertex * mesh.positions.len() as u64 + 12 * mesh.triangles.len() as u64
}
