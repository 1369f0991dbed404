//! Several meshes as one: all parts of a character, to compare them with each other.
//!
//! [`joined`](crate::joined) is about two meshes of different files.

use std::collections::HashMap;

use glam::Vec3;
use thiserror::Error;

use crate::memory::{MemoryBudget, OverBudget};
use crate::mesh::{MorphMesh, WeightAnimation};
use crate::skeleton::{Joint, JointClip, Skeleton};
use crate::skin::{InfluenceSet, MeshSkin};

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

        let skin = skin(&parts)?;
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
            for clip in first_of_each_name(part.animations, |clip| &clip.name) {
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
    let mut targets: Vec<Vec<usize>> = Vec::with_capacity(parts.len());
    for (part, mesh) in parts.iter().enumerate() {
        let mut own: Vec<usize> = Vec::with_capacity(mesh.targets.len());
        for target in 0..mesh.targets.len() {
            let name = mesh.target_names.get(target).map_or("", String::as_str);
            let known = of_name.entry(name).or_default();
            let same = known.iter().copied().find(|&other| {
                let Planned {
                    part: of,
                    target: as_target,
                    ..
                } = planned[other];
                of != part && !own.contains(&other) && move_alike([&parts[of], mesh], [as_target, target])
            });
            own.push(same.unwrap_or_else(|| {
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
            }));
        }
        targets.push(own);
    }
    (planned, targets)
}

/// Whether two targets have the same weights at rest and in all clips.
fn move_alike(meshes: [&MorphMesh; 2], targets: [usize; 2]) -> bool {
    let at_rest = |i: usize| meshes[i].default_weights.get(targets[i]).copied().unwrap_or(0.0);
    let of_name = |i: usize, name: &str| meshes[i].animations.iter().find(|clip| clip.name == name);
    let clips = || meshes.iter().flat_map(|mesh| &mesh.animations);
    at_rest(0) == at_rest(1)
        && clips().all(|clip| match [0, 1].map(|i| of_name(i, &clip.name)) {
            [Some(one), Some(other)] => have_same_track([one, other], targets),
            _ => false,
        })
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

/// Later clips of the same name cannot be chosen by it.
fn first_of_each_name<C>(clips: Vec<C>, name: impl Fn(&C) -> &String) -> Vec<C> {
    let mut kept: Vec<C> = Vec::with_capacity(clips.len());
    for clip in clips {
        if !kept.iter().any(|known| name(known) == name(&clip)) {
            kept.push(clip);
        }
    }
    kept
}

/// The skin of the whole, if the parts have skins.
fn skin(parts: &[MorphMesh]) -> Result<Option<MeshSkin>, TogetherError> {
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
}

impl<'a> Skeletons<'a> {
    /// Adds a skeleton; returns the new numbers of its joints, or `None` if there are too many.
    fn add(&mut self, skeleton: &'a Skeleton) -> Option<Vec<u16>> {
        let same = |(known, _): &&(&Skeleton, u32)| known.nodes == skeleton.nodes && known.clips == skeleton.clips;
        let known = self.added.iter().find(same).map(|(_, first)| *first);
        let first = match known {
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
        for mut clip in first_of_each_name(skeleton.clips.clone(), |clip| &clip.name) {
            for channel in &mut clip.channels {
                channel.node = channel.node.saturating_add(first);
            }
            let same = |known: &&mut JointClip| known.name == clip.name;
            match self.all.clips.iter_mut().find(same) {
                Some(known) => {
                    known.channels.append(&mut clip.channels);
                    known.end = known.end.max(clip.end);
                }
                None => self.all.clips.push(clip),
            }
        }
        self.added.push((skeleton, first));
        Some(first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::random::random_blob;
    use crate::models::rigs::tube;
    use crate::oracle;

    fn named(seed: u64, names: [&str; 3], weights: [f32; 3]) -> MorphMesh {
        let mut mesh = random_blob(seed, 1, 3, 0.5);
        mesh.target_names = names.map(str::to_owned).to_vec();
        mesh.animations = vec![WeightAnimation {
            name: "clip".to_owned(),
            times: vec![0.0, 1.0],
            weights: vec![vec![0.0; 3], weights.to_vec()],
            ..WeightAnimation::default()
        }];
        mesh
    }

    #[test]
    fn targets_of_a_name_are_one_unless_a_clip_moves_them_apart() -> Result<(), TogetherError> {
        let one = named(1, ["a", "b", "c"], [0.5, 1.0, 0.0]);
        let other = named(2, ["c", "b", "d"], [0.0, 0.25, 0.0]);
        let parts = vec![one.clone(), other.clone()];
        let together = Together::of(parts, &MemoryBudget::default())?;
        let b = format!("b ({})", other.name);
        assert_eq!(together.mesh.target_names, ["a", "b", "c", &b, "d"]);
        assert_eq!(together.leaders, [0, 1, 2, 1, 4]);
        assert_eq!(together.targets, [[0, 1, 2], [2, 3, 4]]);
        assert_eq!(together.clip_targets, together.targets);
        let posed = together.mesh.posed(&[0.5, 0.25, 0.75, 1.0, -0.5]);
        let (first, second) = posed.split_at(one.positions.len());
        assert_eq!(first, one.posed(&[0.5, 0.25, 0.75]));
        assert_eq!(second, other.posed(&[0.75, 1.0, -0.5]));
        assert!(together.mesh.to_model().is_ok());
        Ok(())
    }

    #[test]
    fn each_part_follows_its_own_joints() -> Result<(), TogetherError> {
        let parts = vec![tube(3, 6, 2, 1), tube(3, 6, 8, 1), tube(5, 4, 4, 1)];
        let together = Together::of(parts.clone(), &MemoryBudget::default())?;
        let skin = together.mesh.skin.as_ref().expect("the parts have skins");
        assert_eq!(skin.joint_count(), 6 + 4, "two have the same skeleton");
        let whole = oracle::skinned_vertices(&together.mesh.positions, &skin.sets, &skin.skeleton.at_rest());
        let mut expected = Vec::new();
        for part in &parts {
            let skin = part.skin.as_ref().expect("it has a skin");
            let rest = skin.skeleton.at_rest();
            expected.extend(oracle::skinned_vertices(&part.positions, &skin.sets, &rest));
        }
        assert_eq!(whole, expected);
        assert!(together.mesh.to_model().is_ok());
        let mut rigid = parts;
        rigid[1].skin = None;
        let error = Together::of(rigid, &MemoryBudget::default());
        assert!(matches!(error, Err(TogetherError::OneSkin(_))));
        Ok(())
    }

    #[test]
    fn memory_is_counted_before_it_is_taken() {
        let parts = vec![random_blob(1, 3, 4, 0.5), random_blob(2, 3, 4, 0.5)];
        let error = Together::of(parts, &MemoryBudget::new(10_000));
        assert!(matches!(error, Err(TogetherError::OverBudget(_))));
    }
}
