//! A triangle mesh with morph targets and weight animations, as a file holds it: nothing welded, nothing validated.

use std::ops::Range;

use glam::Vec3;
use morph_collision::{ModelError, MorphModel};

/// A mesh with dense displacements, in model space.
///
/// Nothing here is checked: [`MorphMesh::to_model`] is the door where it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphMesh {
    /// The mesh's name; a reader makes one up where the file has none.
    pub name: String,
    /// Base positions, one per vertex.
    pub positions: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One name per target.
    pub target_names: Vec<String>,
    /// One list of displacements per target, each as long as `positions`.
    pub targets: Vec<Vec<Vec3>>,
    /// The parts (a material each, usually) as ranges of triangle indices, in order.
    pub primitives: Vec<Range<u32>>,
    /// Clips that drive the weights.
    pub animations: Vec<WeightAnimation>,
}

impl MorphMesh {
    /// A mesh of one primitive without targets.
    pub fn rigid(name: impl Into<String>, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let primitives = std::iter::once(0..triangles.len() as u32).collect();
        Self {
            name: name.into(),
            positions,
            triangles,
            primitives,
            ..Self::default()
        }
    }

    /// A mesh of one primitive from the positions of every reference; reference 0 is the base, and the others become
    /// targets named by `target_names`.
    ///
    /// References and names beyond the shorter of the two lists are dropped.
    pub fn from_references(
        name: impl Into<String>,
        references: &[Vec<Vec3>],
        triangles: Vec<[u32; 3]>,
        target_names: &[&str],
    ) -> Self {
        let base = references.first().cloned().unwrap_or_default();
        let targets: Vec<Vec<Vec3>> = references
            .iter()
            .skip(1)
            .zip(target_names)
            .map(|(reference, _)| reference.iter().zip(&base).map(|(&p, &b)| p - b).collect())
            .collect();
        let mut mesh = Self::rigid(name, base, triangles);
        mesh.target_names = target_names
            .iter()
            .take(targets.len())
            .map(ToString::to_string)
            .collect();
        mesh.targets = targets;
        mesh
    }

    /// The positions where target `target` alone has weight 1; the base for a target that does not exist.
    pub fn reference(&self, target: usize) -> Vec<Vec3> {
        match self.targets.get(target) {
            Some(displacements) => self.positions.iter().zip(displacements).map(|(&b, &d)| b + d).collect(),
            None => self.positions.clone(),
        }
    }

    /// The blended positions `base + sum of weight * displacement`, in ascending target order; missing weights are zero.
    pub fn posed(&self, weights: &[f32]) -> Vec<Vec3> {
        let mut posed = self.positions.clone();
        for (displacements, &weight) in self.targets.iter().zip(weights) {
            if weight != 0.0 {
                for (p, &d) in posed.iter_mut().zip(displacements) {
                    *p += d * weight;
                }
            }
        }
        posed
    }

    /// The immutable model the collision tree is built from.
    ///
    /// # Errors
    /// As [`MorphModel::from_displacements`]: the first bad vertex, triangle or target by index.
    pub fn to_model(&self) -> Result<MorphModel, ModelError> {
        MorphModel::from_displacements(&self.positions, &self.triangles, &self.targets)
    }
}

/// A clip: keys of one weight vector each, linear in between, looping.
///
/// Two keys at the same time are a jump; that is how stepped animation is kept.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeightAnimation {
    /// The clip's name.
    pub name: String,
    /// Key times in seconds, ascending.
    pub times: Vec<f32>,
    /// One weight vector per key.
    pub weights: Vec<Vec<f32>>,
}

impl WeightAnimation {
    /// The length of one loop in seconds: the time of the last key.
    pub fn duration(&self) -> f32 {
        self.times.last().copied().unwrap_or(0.0)
    }

    /// The weights at `time` seconds, looping; before the first key the first key holds.
    ///
    /// At the very end of a loop its beginning is returned. A clip without keys gives no weights.
    pub fn sample(&self, time: f32) -> Vec<f32> {
        let duration = self.duration();
        let wrapped = if duration > 0.0 { time.rem_euclid(duration) } else { 0.0 };
        // `rem_euclid` of a tiny negative time rounds up to the duration itself, which is the loop's beginning.
        let time = if wrapped < duration { wrapped } else { 0.0 };
        let next = self.times.partition_point(|&key| key <= time);
        let (Some(after), Some(&end)) = (self.weights.get(next), self.times.get(next)) else {
            return self.weights.last().cloned().unwrap_or_default();
        };
        let Some(previous) = next.checked_sub(1) else {
            return after.clone();
        };
        let (before, start) = (&self.weights[previous], self.times[previous]);
        let t = (time - start) / (end - start);
        before.iter().zip(after).map(|(&a, &b)| a + (b - a) * t).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip(times: &[f32], weights: &[f32]) -> WeightAnimation {
        WeightAnimation {
            name: "clip".into(),
            times: times.to_vec(),
            weights: weights.iter().map(|&w| vec![w]).collect(),
        }
    }

    #[test]
    fn sampling_is_linear_between_keys_and_loops() {
        let clip = clip(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]);
        assert_eq!(clip.sample(0.25), [0.25]);
        assert_eq!(clip.sample(1.5), [0.5]);
        assert_eq!(clip.sample(2.25), [0.25]);
        assert_eq!(clip.sample(-0.5), [0.5]);
    }

    #[test]
    fn the_first_key_holds_before_its_time() {
        assert_eq!(clip(&[1.0, 2.0], &[3.0, 5.0]).sample(0.5), [3.0]);
    }

    #[test]
    fn two_keys_at_one_time_are_a_jump() {
        let clip = clip(&[0.0, 1.0, 1.0, 2.0], &[0.0, 0.0, 1.0, 1.0]);
        assert_eq!(clip.sample(0.999), [0.0]);
        assert_eq!(clip.sample(1.0), [1.0]);
    }

    #[test]
    fn clips_of_one_key_or_none_do_not_panic() {
        assert_eq!(clip(&[0.0], &[2.0]).sample(7.0), [2.0]);
        assert!(clip(&[], &[]).sample(7.0).is_empty());
        assert_eq!(clip(&[0.0, 1.0], &[2.0, 3.0]).sample(f32::NAN), [2.0]);
    }

    #[test]
    fn posing_with_one_full_weight_gives_the_reference() {
        let references = [vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z, Vec3::X, Vec3::ONE]];
        let mesh = MorphMesh::from_references("m", &references, vec![[0, 1, 2]], &["up"]);
        assert_eq!(mesh.posed(&[1.0]), references[1]);
        assert_eq!(mesh.reference(0), references[1]);
    }
}
