//! Several meshes as one: all parts of a character, to compare them with each other.
//!
//! [`MorphMesh::joined`] is about two meshes of different files.

use std::collections::{HashMap, HashSet};

use glam::Vec3;
use thiserror::Error;

use super::morph_mesh::MorphMesh;
use super::skin::{InfluenceSet, MeshSkin};
use crate::clip::WeightAnimation;
use crate::memory::{MemoryBudget, OverBudget};
use crate::skeleton::{Joint, JointClip, Skeleton};

/// Meshes as one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Together {
    /// The vertices, triangles and primitives of all parts follow each other. Its clips are those of all parts, one after the other, and each has
    /// only the weights of its part's targets ([`Together::clip_targets`]).
    pub mesh: MorphMesh,
    /// For each target of each part, the target of the whole.
    pub targets: Vec<Vec<usize>>,
    /// For each target of the whole, the first one of the same name. They move together, except in clips that say otherwise.
    pub leaders: Vec<usize>,
    /// For each clip of the whole, the targets whose weights it has.
    pub clip_targets: Vec<Vec<usize>>,
}

/// Why meshes cannot be joined.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TogetherError {
    /// Some are moved by joints, others are not.
    #[error("\"{0}\" is moved by joints, others are not")]
    OneSkin(String),
    /// Together they have too many vertices, triangles or joints to number.
    #[error("its {parts} meshes have too many {what} together")]
    TooMany {
        /// The number of meshes.
        parts: usize,
        /// What there is too much of.
        what: &'static str,
    },
    /// There is not enough memory for them.
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

/// A target of the whole: its name, and the first target of a part that it stands for.
struct Planned {
    name: String,
    part: usize,
    target: usize,
    leader: usize,
}

impl Together {
    /// Joins meshes in the same space, or meshes that all have joints.
    ///
    /// Targets with the same name become one target, unless their default weights or their clips differ.
    ///
    /// # Errors
    /// See [`TogetherError`].
    pub fn of(parts: Vec<MorphMesh>, budget: &MemoryBudget) -> Result<Self, TogetherError> {
        let (planned, targets) = plan(&parts);
        let vertices: usize = parts.iter().map(|part| part.positions.len()).sum();
        let triangles: usize = parts.iter().map(|part| part.triangles.len()).sum();
        let too_many = |what| TogetherError::TooMany {
            parts: parts.len(),
            what,
        };
        for (count, what) in [(vertices, "vertices"), (triangles, "triangles")] {
            u32::try_from(count).map_err(|_| too_many(what))?;
        }
        let mut moves = vec![false; planned.len()];
        for (part, targets) in parts.iter().zip(&targets) {
            for (own, &target) in part.targets.iter().zip(targets) {
                moves[target] |= !own.is_empty();
            }
        }
        let moving = moves.iter().filter(|moves| **moves).count() as u64;
        let sets = parts.iter().filter_map(|part| Some(part.skin.as_ref()?.sets.len()));
        let bytes = 12 * moving + 24 * sets.max().unwrap_or(0) as u64 + 12;
        let what = || format!("its {} meshes as one", parts.len());
        budget.take(vertices as u64, bytes, what)?;
        budget.take(triangles as u64, 12, what)?;

        let skin = skin(&parts, budget)?;
        let weights_at_rest: Vec<Vec<f32>> = parts.iter().map(MorphMesh::weights_at_rest).collect();
        let mut mesh = MorphMesh {
            name: match &parts[..] {
                [] => String::new(),
                [only] => only.name.clone(),
                [first, others @ ..] => format!("{} and {} more", first.name, others.len()),
            },
            target_names: planned.iter().map(|planned| planned.name.clone()).collect(),
            targets: moves
                .iter()
                .map(|&moves| vec![Vec3::ZERO; if moves { vertices } else { 0 }])
                .collect(),
            default_weights: planned
                .iter()
                .map(|planned| weights_at_rest[planned.part][planned.target])
                .collect(),
            skin,
            ..MorphMesh::default()
        };
        let mut clip_targets = Vec::new();
        for (part, targets) in parts.into_iter().zip(&targets) {
            let (vertex, triangle) = (mesh.positions.len() as u32, mesh.triangles.len() as u32);
            for (own, &target) in part.targets.iter().zip(targets) {
                let into = mesh.targets[target].iter_mut().skip(mesh.positions.len());
                into.zip(own).for_each(|(into, &by)| *into = by);
            }
            mesh.positions.extend(part.positions);
            // Corners that do not exist stay so, for the check of the model.
            let moved = |corner: u32| corner.saturating_add(vertex);
            let moved = |corners: [u32; 3]| corners.map(moved);
            mesh.triangles.extend(part.triangles.into_iter().map(moved));
            let ranges = part.primitives.into_iter();
            mesh.primitives
                .extend(ranges.map(|range| range.start + triangle..range.end + triangle));
            for clip in first_of_each_name(part.animations) {
                mesh.animations.push(clip);
                clip_targets.push(targets.clone());
            }
        }
        Ok(Self {
            mesh,
            leaders: planned.iter().map(|planned| planned.leader).collect(),
            targets,
            clip_targets,
        })
    }
}

/// The targets of the whole, and for each target of each part, which of them it is.
fn plan(parts: &[MorphMesh]) -> (Vec<Planned>, Vec<Vec<usize>>) {
    let mut planned: Vec<Planned> = Vec::new();
    let mut of_name: HashMap<&str, Vec<usize>> = HashMap::new();
    let clips: Vec<ClipsByName<'_>> = parts.iter().map(clips_by_name).collect();
    let mut targets: Vec<Vec<usize>> = Vec::with_capacity(parts.len());
    for (part, mesh) in parts.iter().enumerate() {
        let mut own: Vec<usize> = Vec::with_capacity(mesh.targets.len());
        let mut taken: HashSet<usize> = HashSet::new();
        for target in 0..mesh.targets.len() {
            let name = mesh.target_names.get(target).map_or("", String::as_str);
            let known = of_name.entry(name).or_default();
            let same = known.iter().copied().find(|&other| {
                let Planned {
                    part: of,
                    target: as_target,
                    ..
                } = planned[other];
                let at_rest =
                    |mesh: &MorphMesh, target: usize| mesh.default_weights.get(target).copied().unwrap_or(0.0);
                of != part
                    && !taken.contains(&other)
                    && at_rest(&parts[of], as_target) == at_rest(mesh, target)
                    && move_alike([&clips[of], &clips[part]], [as_target, target])
            });
            let number = same.unwrap_or_else(|| {
                let leader = known.first().copied().unwrap_or(planned.len());
                planned.push(Planned {
                    name: match leader == planned.len() {
                        true => name.to_owned(),
                        false => format!("{name} ({})", mesh.name),
                    },
                    part,
                    target,
                    leader,
                });
                known.push(planned.len() - 1);
                planned.len() - 1
            });
            taken.insert(number);
            own.push(number);
        }
        targets.push(own);
    }
    (planned, targets)
}

/// The first clip of each name. Later ones cannot be chosen by it.
type ClipsByName<'m> = HashMap<&'m str, &'m WeightAnimation>;

fn clips_by_name(mesh: &MorphMesh) -> ClipsByName<'_> {
    let mut clips = HashMap::new();
    for clip in &mesh.animations {
        clips.entry(&*clip.name).or_insert(clip);
    }
    clips
}

/// Whether two targets have the same weights in all clips of their meshes.
fn move_alike([one, other]: [&ClipsByName<'_>; 2], targets: [usize; 2]) -> bool {
    let same = |(name, clip): (&&str, &&WeightAnimation)| {
        let other = other.get(name);
        other.is_some_and(|other| have_same_track([clip, other], targets))
    };
    one.len() == other.len() && one.iter().all(same)
}

fn have_same_track([one, other]: [&WeightAnimation; 2], [of_one, of_other]: [usize; 2]) -> bool {
    let same = |a: &Vec<f32>, b: &Vec<f32>| a.get(of_one) == b.get(of_other);
    let same_keys = one.weights.iter().zip(&other.weights).all(|(a, b)| same(a, b));
    let tangents = one.tangents.iter().flatten().zip(other.tangents.iter().flatten());
    one.times == other.times
        && one.end == other.end
        && one.tangents.len() == other.tangents.len()
        && same_keys
        && tangents.into_iter().all(|(a, b)| same(a, b))
}

/// Without later clips of the same name.
fn first_of_each_name(mut clips: Vec<WeightAnimation>) -> Vec<WeightAnimation> {
    let mut known = HashSet::new();
    clips.retain(|clip| known.insert(clip.name.clone()));
    clips
}

/// The skin of the whole, if the parts have skins.
fn skin(parts: &[MorphMesh], budget: &MemoryBudget) -> Result<Option<MeshSkin>, TogetherError> {
    let Some(with) = parts.iter().find(|part| part.skin.is_some()) else {
        return Ok(None);
    };
    let mut sets: Vec<InfluenceSet> = Vec::new();
    let mut skeletons = Skeletons::default();
    let mut vertices = 0;
    for part in parts {
        let skin = part
            .skin
            .as_ref()
            .ok_or_else(|| TogetherError::OneSkin(with.name.clone()))?;
        skeletons.count(&skin.skeleton, parts.len(), budget)?;
        let joints = skeletons.add(&skin.skeleton).ok_or(TogetherError::TooMany {
            parts: parts.len(),
            what: "joints",
        })?;
        // A joint that does not exist stays so, for the check of the model.
        let joint = |joint: u16| joints.get(usize::from(joint)).copied().unwrap_or(u16::MAX);
        for (index, own) in skin.sets.iter().enumerate() {
            if sets.len() == index {
                sets.push(InfluenceSet::default());
            }
            let set = &mut sets[index];
            set.joints.resize(vertices, [0; 4]);
            set.weights.resize(vertices, [0.0; 4]);
            set.joints.extend(own.joints.iter().map(|joints| joints.map(joint)));
            set.weights.extend(&own.weights);
        }
        vertices += part.positions.len();
    }
    for set in &mut sets {
        set.joints.resize(vertices, [0; 4]);
        set.weights.resize(vertices, [0.0; 4]);
    }
    let skeleton = skeletons.all;
    Ok(Some(MeshSkin { sets, skeleton }))
}

/// Skeletons side by side. Joints that move alike are one joint.
#[derive(Default)]
struct Skeletons<'a> {
    all: Skeleton,
    /// Those that are in already, with their first nodes.
    added: Vec<(&'a Skeleton, u32)>,
    joints: HashMap<(u32, [u32; 16]), u16>,
    /// The place of each clip of `all`.
    clips: HashMap<&'a str, usize>,
}

impl<'a> Skeletons<'a> {
    /// The first node of a skeleton that is in already.
    fn known(&self, skeleton: &Skeleton) -> Option<u32> {
        let same = |(known, _): &&(&Skeleton, u32)| known.nodes == skeleton.nodes && known.clips == skeleton.clips;
        self.added.iter().find(same).map(|(_, first)| *first)
    }

    /// Counts the copy of a skeleton that is about to be added.
    fn count(&self, skeleton: &Skeleton, parts: usize, budget: &MemoryBudget) -> Result<(), OverBudget> {
        let what = || format!("the joints of its {parts} meshes and their clips");
        budget.take(skeleton.joints.len() as u64, 160, what)?;
        if self.known(skeleton).is_some() {
            return Ok(());
        }
        let names = skeleton.nodes.iter().map(|node| node.name.len() as u64);
        budget.take(names.sum::<u64>() + 128 * skeleton.nodes.len() as u64, 1, what)?;
        let clips = skeleton.clips.iter();
        let of_names = clips.clone().map(|clip| 128 + clip.name.len() as u64);
        let of_channels = clips.flat_map(|clip| &clip.channels);
        let of_channels =
            of_channels.map(|channel| 128 + 4 * channel.times.len() as u64 + 16 * channel.values.len() as u64);
        budget.take(of_names.chain(of_channels).sum(), 1, what)
    }

    /// Adds a skeleton; returns the new numbers of its joints, or `None` if there are too many.
    fn add(&mut self, skeleton: &'a Skeleton) -> Option<Vec<u16>> {
        let first = match self.known(skeleton) {
            Some(first) => first,
            None => self.add_nodes(skeleton)?,
        };
        let mut numbers = Vec::with_capacity(skeleton.joints.len());
        for joint in &skeleton.joints {
            let node = joint.node.checked_add(first)?;
            let key = (node, joint.inverse_bind.to_cols_array().map(f32::to_bits));
            let next = u16::try_from(self.all.joints.len())
                .ok()
                .filter(|next| *next < u16::MAX)?;
            let number = *self.joints.entry(key).or_insert(next);
            if number == next {
                let inverse_bind = joint.inverse_bind;
                self.all.joints.push(Joint { node, inverse_bind });
            }
            numbers.push(number);
        }
        Some(numbers)
    }

    fn add_nodes(&mut self, skeleton: &'a Skeleton) -> Option<u32> {
        let first = u32::try_from(self.all.nodes.len()).ok()?;
        for node in &skeleton.nodes {
            let mut node = node.clone();
            node.parent = node.parent.map(|parent| parent.saturating_add(first));
            self.all.nodes.push(node);
        }
        let mut own = HashSet::new();
        for clip in skeleton.clips.iter().filter(|clip| own.insert(&*clip.name)) {
            let place = *self.clips.entry(&clip.name).or_insert_with(|| {
                self.all.clips.push(JointClip {
                    name: clip.name.clone(),
                    channels: Vec::with_capacity(clip.channels.len()),
                    end: clip.end,
                });
                self.all.clips.len() - 1
            });
            let known = &mut self.all.clips[place];
            known.end = known.end.max(clip.end);
            known.channels.extend(clip.channels.iter().cloned().map(|mut channel| {
                channel.node = channel.node.saturating_add(first);
                channel
            }));
        }
        self.added.push((skeleton, first));
        Some(first)
    }
}
