//! Which targets and joints move triangles that touch.

use std::collections::BTreeSet;
use std::sync::Arc;

use morph_collision_models::mesh::MorphMesh;

use crate::touching::Touch;

/// At most this many targets, and as many joints, are named.
const MOST: usize = 3;

/// A mesh whose targets and joints can be named.
pub(crate) struct Blame<'a> {
    mesh: &'a MorphMesh,
}

impl<'a> Blame<'a> {
    pub(crate) fn new(mesh: &'a MorphMesh) -> Self {
        Self { mesh }
    }

    /// The names of the targets that move the corners of a triangle most.
    pub(crate) fn targets_of(&self, triangle: u32, weights: &[f32]) -> Vec<String> {
        top(self.targets(&self.vertices(std::iter::once(triangle)), weights))
    }

    /// The names of the targets and of the joints that move some triangles most.
    pub(crate) fn movers_of(&self, triangles: &[u32], weights: &[f32]) -> (Vec<String>, Vec<String>) {
        let vertices = self.vertices(triangles.iter().copied());
        (top(self.targets(&vertices, weights)), top(self.joints(&vertices)))
    }

    /// The vertices of some triangles.
    fn vertices(&self, triangles: impl Iterator<Item = u32>) -> BTreeSet<u32> {
        let corners = triangles.filter_map(|triangle| self.mesh.triangles.get(triangle as usize));
        corners.flatten().copied().collect()
    }

    /// How far each target moves any of the vertices. Targets that move none are left out.
    fn targets(&self, vertices: &BTreeSet<u32>, weights: &[f32]) -> Vec<(f64, &'a str)> {
        let named = self.mesh.targets.iter().zip(&self.mesh.target_names).zip(weights);
        let moved = named
            .filter(|(_, weight)| **weight != 0.0)
            .map(|((target, name), &weight)| {
                let lengths = vertices.iter().filter_map(|&vertex| target.get(vertex as usize));
                let longest = lengths
                    .map(|displacement| displacement.as_dvec3().length())
                    .fold(0.0, f64::max);
                (longest * f64::from(weight.abs()), name.as_str())
            });
        moved.filter(|(distance, _)| *distance > 0.0).collect()
    }

    /// The sum of each joint's weights over the vertices.
    fn joints(&self, vertices: &BTreeSet<u32>) -> Vec<(f64, &'a str)> {
        let Some(skin) = &self.mesh.skin else { return Vec::new() };
        let mut sums = vec![0.0; skin.joint_count()];
        for set in &skin.sets {
            for &vertex in vertices {
                let influences = set.joints.get(vertex as usize).zip(set.weights.get(vertex as usize));
                for (&joint, &weight) in influences
                    .iter()
                    .flat_map(|(joints, weights)| joints.iter().zip(*weights))
                {
                    if let Some(sum) = sums.get_mut(usize::from(joint)) {
                        *sum += f64::from(weight);
                    }
                }
            }
        }
        let skeleton = &skin.skeleton;
        let named = skeleton.joints.iter().zip(sums).filter(|(_, sum)| *sum > 0.0);
        named
            .filter_map(|(joint, sum)| Some((sum, skeleton.nodes.get(joint.node as usize)?.name.as_str())))
            .collect()
    }
}

/// The names of the targets and of the joints that move the touching vertices most.
pub(crate) fn names(blame: &[Blame<'_>], weights: &[Arc<[f32]>], group: &[Touch]) -> (Vec<String>, Vec<String>) {
    let [a, b] = group[0].bodies;
    let (mut targets, mut joints) = (Vec::new(), Vec::new());
    for (body, other) in [(a, false), (b, true)] {
        let of_pair = |touch: &Touch| match other {
            false => touch.pair.triangle_a,
            true => touch.pair.triangle_b,
        };
        let vertices = blame[body].vertices(group.iter().map(of_pair));
        targets.extend(blame[body].targets(&vertices, &weights[body]));
        joints.extend(blame[body].joints(&vertices));
    }
    (top(targets), top(joints))
}

/// The names with the largest scores. Names that occur twice count once.
fn top(mut scores: Vec<(f64, &str)>) -> Vec<String> {
    scores.sort_by(|one, other| other.0.total_cmp(&one.0).then(one.1.cmp(other.1)));
    let mut names: Vec<String> = Vec::new();
    for (_, name) in scores {
        if names.len() < MOST && !names.iter().any(|known| known == name) {
            names.push(name.to_owned());
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use morph_collision::TrianglePair;

    use super::*;

    #[test]
    fn targets_are_sorted_by_how_far_they_move_what_touches() {
        let mut mesh = MorphMesh::rigid("m", vec![Vec3::ZERO; 4], vec![[0, 1, 2], [1, 2, 3]]);
        mesh.target_names = ["far", "near", "elsewhere", "off"].map(str::to_owned).to_vec();
        mesh.targets = vec![
            vec![Vec3::X * 2.0, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO],
            vec![Vec3::Y; 4],
            vec![Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::Z * 9.0],
            vec![Vec3::Z * 9.0; 4],
        ];
        let touch = Touch {
            bodies: [0, 0],
            pair: TrianglePair {
                triangle_a: 0,
                triangle_b: 0,
            },
        };
        let weights: Arc<[f32]> = Arc::from([-1.0, 1.0, 1.0, 0.0]);
        let (targets, joints) = names(&[Blame::new(&mesh)], &[weights], &[touch]);
        assert_eq!(targets, ["far", "near"]);
        assert!(joints.is_empty());
    }
}
