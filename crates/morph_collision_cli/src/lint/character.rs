//! Which meshes of a file belong together: those of one skeleton or node tree. They are searched as one.

use std::collections::{HashMap, HashSet};

use glam::Affine3A;
use morph_collision_models::gltf::read::{DrawnMesh, GltfFile};
use morph_collision_models::mesh::Together;
use morph_collision_models::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_models::skeleton::Skeleton;

use super::members::Member;
use super::one_mesh::{lend_clips, member, subject};
use super::options::LintOptions;
use super::subject::Subject;
use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::clips::{BrokenClips, read_clips};
use crate::files::model::{check_parts, count_memory, read_mesh, show_with};
use crate::messages;

/// All that is drawn, one subject for each skeleton or node tree. Of a node's instances, the first one counts.
///
/// Meshes that cannot collide are left out with a warning.
///
/// # Errors
/// The meshes of a group take too much memory as one, or nothing moves any of the meshes.
pub(super) fn characters(
    options: &LintOptions,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
) -> Result<Vec<Subject>, CliError> {
    let mut subjects: Vec<Subject> = Vec::new();
    // The subjects of one mesh, by its index.
    let mut alone: HashMap<usize, Vec<usize>> = HashMap::new();
    let mut refused = Refused::default();
    let mut any_still = false;
    let groups = groups(file, options.drawn.drawn(file)?);
    let is_only = groups.len() == 1;
    for group in groups {
        match group[..] {
            [DrawnMesh { mesh, node, .. }] => {
                let known = alone.entry(mesh).or_default();
                if known.iter().any(|&known| shows_the_same(file, &subjects[known], node)) {
                    continue;
                }
                // Most meshes that are read twice are dropped, and what they took is free again.
                let budget = file.budget();
                let (read, left) = budget.lend(|| {
                    let read = subject(options, clip_files, file, mesh, node, None);
                    let read = read.and_then(|subject| match is_only {
                        true => Ok(subject),
                        false => check_parts(file, mesh, &subject.mesh).map(|()| subject),
                    });
                    (read, budget.left())
                });
                match read {
                    Ok(subject) if known.iter().any(|&known| subjects[known].mesh == subject.mesh) => {}
                    Ok(subject) => {
                        let taken = budget.left().saturating_sub(left);
                        count_memory(file, mesh, taken, || "it".to_owned())?;
                        known.push(subjects.len());
                        subjects.push(subject);
                    }
                    Err(error) => refused.log(&error),
                }
            }
            _ => match character(options, clip_files, file, &group, &mut refused)? {
                Group::Moves(subject) => subjects.push(*subject),
                Group::Still => any_still = true,
                Group::Empty => {}
            },
        }
    }
    refused.finish();
    match subjects.is_empty() && any_still {
        true => Err(CliError::NothingTried {
            file: file.path().to_owned(),
        }),
        false => Ok(subjects),
    }
}

/// What is drawn, by skeleton or node tree; in the order of meshes, like `drawn`.
fn groups(file: &GltfFile, drawn: Vec<DrawnMesh>) -> Vec<Vec<DrawnMesh>> {
    let mut trees = file.trees();
    let first = drawn
        .into_iter()
        .filter(|drawn| drawn.instance.is_none_or(|instance| instance == 0));
    let rooted: Vec<(DrawnMesh, Option<usize>)> = first
        .map(|drawn| (drawn, drawn.node.and_then(|node| trees.join(drawn.mesh, node))))
        .collect();
    let mut groups: Vec<Vec<DrawnMesh>> = Vec::new();
    let mut of_tree: HashMap<usize, usize> = HashMap::new();
    for (drawn, root) in rooted {
        let next = groups.len();
        let group = root.map_or(next, |root| *of_tree.entry(trees.of_root(root)).or_insert(next));
        if group == next {
            groups.push(Vec::new());
        }
        groups[group].push(drawn);
    }
    groups
}

/// Whether a node shows the mesh of a subject as the subject has it. It is not read for that, so this is known only of a mesh without joints.
fn shows_the_same(file: &GltfFile, known: &Subject, node: Option<usize>) -> bool {
    let (index, mesh) = (known.index, &known.mesh);
    let targets = mesh.targets.len();
    mesh.skin.is_none()
        && file.budget().lend(|| {
            let weights = file.default_weights(index, node, targets);
            weights.is_ok_and(|weights| weights == mesh.default_weights)
                && matches!(file.skin(index, node), Ok(None))
                && {
                    let clips = file.clips(index, node.or_else(|| file.main_node(index)), targets);
                    clips.broken.is_empty() && clips.clips == mesh.animations
                }
        })
}

/// At most this many meshes that are left out are named.
const MOST_REFUSED: usize = 20;

/// Says why meshes are left out, once for each reason.
#[derive(Default)]
struct Refused {
    logged: HashSet<String>,
    unlogged: usize,
}

impl Refused {
    fn log(&mut self, error: &CliError) {
        let reason = error.to_string();
        if self.logged.contains(&reason) {
            return;
        }
        if self.logged.len() == MOST_REFUSED {
            self.unlogged += 1;
            return;
        }
        messages::complain(format_args!("warning: left out: {reason}"));
        self.logged.insert(reason);
    }

    fn finish(self) {
        if self.unlogged > 0 {
            let more = messages::counted(self.unlogged, "more mesh", "more meshes");
            messages::complain(format_args!(
                "warning: left out: {more}, for reasons that are not listed"
            ));
        }
    }
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
    options: &LintOptions,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
    group: &[DrawnMesh],
    refused: &mut Refused,
) -> Result<Group, CliError> {
    let mut parts: Vec<Part> = Vec::with_capacity(group.len());
    // Kept while further nodes show it.
    let mut last: Option<(usize, MorphMesh)> = None;
    for (place, drawn) in group.iter().enumerate() {
        // What is left out of it depends on its skin, so it is read again for each node.
        let comes_again = !file.skips_bad() && group.get(place + 1).is_some_and(|next| next.mesh == drawn.mesh);
        let known = last.as_ref().filter(|(mesh, _)| *mesh == drawn.mesh);
        match part(
            options,
            clip_files,
            file,
            drawn,
            known.map(|(_, mesh)| mesh),
            comes_again,
        ) {
            Ok((part, whole)) => {
                parts.push(part);
                if let Some(whole) = whole {
                    last = Some((drawn.mesh, whole));
                }
            }
            Err(error) => refused.log(&error),
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
                part.mesh.skin = Some(rigid_skin(placement, part.mesh.positions.len()));
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
    options: &LintOptions,
    clip_files: &mut ClipFiles<'_>,
    file: &GltfFile,
    &DrawnMesh { mesh: index, node, .. }: &DrawnMesh,
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
    let broken = read_clips(&options.files, file, index, node, &mut mesh, placement.as_ref());
    lend_clips(options, clip_files, file, (index, node), &mut mesh, placement.as_mut())?;
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
fn rigid_skin(placement: Skeleton, vertices: usize) -> MeshSkin {
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
