//! What is searched as one: a mesh, a mesh and its garment, or all meshes of a character.

use std::collections::BTreeMap;

use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::gltf::read::{Expression, GltfFile};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::text::Printable;
use serde::Serialize;

use super::members::Member;
use crate::files::clips::BrokenClips;
use crate::messages;

/// A mesh to try.
#[derive(Debug, Default)]
pub(super) struct Subject {
    /// The index in the file of its first mesh.
    pub(super) index: usize,
    /// All of its meshes as one.
    pub(super) mesh: MorphMesh,
    /// The names of its primitives' materials.
    pub(super) materials: Vec<Option<String>>,
    /// The first triangle of the garment.
    pub(super) garment_from: Option<u32>,
    /// The file's meshes in it, one after the other.
    pub(super) members: Vec<Member>,
    /// The number of triangles that are left out because no joint moves one of their vertices.
    pub(super) left_out: usize,
    /// The clips that cannot be played.
    pub(super) broken: BrokenClips,
    /// For each target, the first of those that move together.
    pub(super) leaders: Vec<usize>,
    /// For each clip of weights, the targets whose weights it has.
    pub(super) clip_targets: Vec<Vec<usize>>,
    /// The named mixtures of its targets that the file has.
    pub(super) expressions: Vec<NamedMixture>,
}

/// One of several meshes that are searched as one.
#[derive(Debug, Serialize)]
pub(super) struct JoinedMesh {
    pub(super) mesh: usize,
    pub(super) name: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) node: Option<usize>,
}

/// An expression as weights of a subject's targets.
#[derive(Debug)]
pub(super) struct NamedMixture {
    pub(super) name: String,
    /// Whether it is only ever shown at full strength.
    pub(super) is_binary: bool,
    weights: Vec<(usize, f32)>,
}

impl Subject {
    /// One mesh.
    pub(super) fn of_one(index: usize, mesh: MorphMesh, member: Member) -> Self {
        let all: Vec<usize> = (0..mesh.targets.len()).collect();
        Self {
            index,
            clip_targets: vec![all.clone(); mesh.animations.len()],
            leaders: all,
            members: vec![member],
            mesh,
            ..Self::default()
        }
    }

    /// The first of each of the targets that move together, if they move anything.
    pub(super) fn moving(&self) -> Vec<usize> {
        let mut moving: Vec<usize> = (0..self.mesh.targets.len())
            .filter(|&target| !self.mesh.targets[target].is_empty())
            .map(|target| self.leaders[target])
            .collect();
        moving.sort_unstable();
        moving.dedup();
        moving
    }

    /// Sets the weight of a target and of those that move with it.
    pub(super) fn set(&self, weights: &mut [f32], target: usize, weight: f32) {
        for (other, &leader) in self.leaders.iter().enumerate() {
            if leader == target {
                weights[other] = weight;
            }
        }
    }

    /// Whether a target has the same weight as the one that it moves with.
    pub(super) fn follows(&self, target: usize, weights: &[f32]) -> bool {
        self.leaders[target] != target && weights[self.leaders[target]] == weights[target]
    }

    /// The weights at a time of all clips of the name of one of them; those at rest without a clip.
    pub(super) fn weights_in_clip(&self, clip: Option<usize>, seconds: f32) -> Vec<f32> {
        let mut weights = self.mesh.weights_at_rest();
        let name = clip.and_then(|clip| Some(&self.mesh.animations.get(clip)?.name));
        let clips = self.mesh.animations.iter().zip(&self.clip_targets);
        for (clip, targets) in clips.filter(|(clip, _)| Some(&clip.name) == name) {
            for (&target, weight) in targets.iter().zip(clip.sample(seconds)) {
                weights[target] = weight;
            }
        }
        weights
    }

    /// The length in seconds of all clips of the name of one of them.
    pub(super) fn seconds_of_weights(&self, clip: Option<usize>) -> f32 {
        let clips = &self.mesh.animations;
        let name = clip.and_then(|clip| Some(&clips.get(clip)?.name));
        let same = clips.iter().filter(|clip| Some(&clip.name) == name);
        same.map(WeightAnimation::duration).fold(0.0, f32::max)
    }

    /// The meshes that it consists of, if there are several.
    pub(super) fn joined(&self) -> Vec<JoinedMesh> {
        let joined = |member: &Member| JoinedMesh {
            mesh: member.mesh,
            name: member.name.clone(),
            node: member.node,
        };
        match &self.members[..] {
            [_] => Vec::new(),
            members => members.iter().map(joined).collect(),
        }
    }

    /// Finds the expressions of the file that move it.
    pub(super) fn add_expressions(&mut self, file: &GltfFile) {
        let expressions = file.expressions();
        let mixtures = expressions.iter().map(|expression| self.mixture(expression));
        self.expressions = mixtures.filter(|mixture| !mixture.weights.is_empty()).collect();
    }

    fn mixture(&self, expression: &Expression) -> NamedMixture {
        let mut weights = BTreeMap::new();
        for member in &self.members {
            let mut of_mesh: BTreeMap<usize, f32> = BTreeMap::new();
            let is_meant = |node: Option<usize>| node.is_none_or(|node| member.node.is_none_or(|own| own == node));
            let binds = expression.binds.iter();
            for bind in binds.filter(|bind| bind.mesh == member.mesh && is_meant(bind.node)) {
                if let Some(&target) = member.targets.get(bind.target) {
                    *of_mesh.entry(target).or_default() += bind.weight;
                } else {
                    messages::complain(format_args!(
                        "warning: left out: the expression \"{}\" moves target {} of mesh {}, which has {}",
                        Printable(&expression.name),
                        bind.target,
                        member.mesh,
                        messages::counted(member.targets.len(), "target", "targets")
                    ));
                }
            }
            // A target of several meshes is one of the subject.
            for (target, weight) in of_mesh {
                weights.entry(target).or_insert(weight);
            }
        }
        NamedMixture {
            name: expression.name.clone(),
            is_binary: expression.is_binary,
            weights: weights.into_iter().collect(),
        }
    }
}

impl NamedMixture {
    /// Adds its weights at a strength.
    pub(super) fn add(&self, strength: f32, weights: &mut [f32]) {
        for &(target, weight) in &self.weights {
            weights[target] += strength * weight;
        }
    }
}
