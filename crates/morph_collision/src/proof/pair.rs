//! Two triangles and how targets move them: exact bounds on their gap, and posed corners.

use glam::{DVec3, Vec3};

use super::rounding::vertex_error;
use crate::exact::{Triangle, largest};
use crate::model::{MorphModel, WeightBox};

/// A triangle's corners at the base and their displacements.
#[derive(Clone, Debug)]
pub(super) struct TriangleMotion {
    pub(super) triangle: u32,
    pub(super) corners: [u32; 3],
    base: [Vec3; 3],
    /// The targets that move any corner, ascending, and the displacements of all corners.
    targets: Vec<(u16, [Vec3; 3])>,
    /// A bound on the rounding of its posed corners.
    error: f64,
}

/// Two triangles. Corners 0 to 2 are those of the first, 3 to 5 those of the second.
#[derive(Clone, Debug, Default)]
pub(super) struct Pair {
    base: [Vec3; 6],
    pub(super) targets: Vec<u16>,
    displacements: Vec<[Vec3; 6]>,
    error: f64,
}

/// A lower bound on the gap of two triangles, and where it comes from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gap {
    pub(super) bound: f64,
    pub(super) direction: DVec3,
    /// The corners that are closest along the direction for the worst weights.
    corners: [usize; 2],
}

impl TriangleMotion {
    pub(super) fn new(model: &MorphModel, triangle: u32, weights: &WeightBox) -> Self {
        let corners = model.corners(triangle);
        let mut targets: Vec<u16> = corners
            .iter()
            .flat_map(|&c| model.displacements(c).map(|d| d.target))
            .collect();
        targets.sort_unstable();
        targets.dedup();
        let mut moved: Vec<(u16, [Vec3; 3])> = targets.iter().map(|&target| (target, [Vec3::ZERO; 3])).collect();
        for (i, &corner) in corners.iter().enumerate() {
            for displacement in model.displacements(corner) {
                let index = targets.partition_point(|&target| target < displacement.target);
                moved[index].1[i] = displacement.delta;
            }
        }
        let base = corners.map(|corner| model.base(corner));
        let magnitude =
            |corners: &[Vec3; 3]| f64::from(corners.map(|c| c.abs().max_element()).into_iter().fold(0.0, f32::max));
        let reach = moved
            .iter()
            .map(|(target, displaced)| weights.reach(*target) * magnitude(displaced));
        let error = vertex_error(moved.len(), magnitude(&base) + reach.sum::<f64>());
        Self {
            triangle,
            corners,
            base,
            targets: moved,
            error,
        }
    }

    pub(super) fn shares_a_vertex(&self, other: &Self) -> bool {
        self.corners.iter().any(|corner| other.corners.contains(corner))
    }
}

impl Pair {
    /// Describes two triangles. Keeps the memory.
    pub(super) fn set(&mut self, a: &TriangleMotion, b: &TriangleMotion) {
        let joined = |[a, b, c]: [Vec3; 3], [d, e, f]: [Vec3; 3]| [a, b, c, d, e, f];
        self.base = joined(a.base, b.base);
        self.error = a.error + b.error;
        self.targets.clear();
        self.displacements.clear();
        let (mut i, mut j) = (0, 0);
        let still = [Vec3::ZERO; 3];
        loop {
            let (target, of_a, of_b) = match (a.targets.get(i), b.targets.get(j)) {
                (Some(&(s, of_a)), Some(&(t, of_b))) if s == t => {
                    (i, j) = (i + 1, j + 1);
                    (s, of_a, of_b)
                }
                (Some(&(s, of_a)), of_b) if of_b.is_none_or(|&(t, _)| s < t) => {
                    i += 1;
                    (s, of_a, still)
                }
                (_, Some(&(t, of_b))) => {
                    j += 1;
                    (t, still, of_b)
                }
                _ => break,
            };
            self.targets.push(target);
            self.displacements.push(joined(of_a, of_b));
        }
    }

    /// The posed triangles, as every query sees them. One weight for each of `targets`.
    pub(super) fn posed(&self, weights: &[f32]) -> [Triangle; 2] {
        let mut corners = self.base;
        for (displacements, &weight) in self.displacements.iter().zip(weights) {
            if weight != 0.0 {
                for (corner, &displacement) in corners.iter_mut().zip(displacements) {
                    // Multiplied, then added, like `MorphModel::blend_vertex`.
                    *corner += displacement * weight;
                }
            }
        }
        let [a, b, c, d, e, f] = corners.map(Vec3::as_dvec3);
        [[a, b, c], [d, e, f]]
    }

    /// The smallest gap along a direction from the first triangle to the second, over all weights in a box, rounding taken off.
    ///
    /// For two corners, the gap is linear in the weights, so its minimum is exact up to rounding.
    pub(super) fn gap(&self, direction: DVec3, weights: &[[f32; 2]]) -> Gap {
        let heights = |corners: &[Vec3; 6]| corners.map(|corner| corner.as_dvec3().dot(direction));
        let start = heights(&self.base);
        let mut gaps = [[0.0; 3]; 3];
        for (i, row) in gaps.iter_mut().enumerate() {
            for (j, gap) in row.iter_mut().enumerate() {
                *gap = start[3 + j] - start[i];
            }
        }
        for (displacements, [low, high]) in self.displacements.iter().zip(weights) {
            let (heights, low, high) = (heights(displacements), f64::from(*low), f64::from(*high));
            for (i, row) in gaps.iter_mut().enumerate() {
                for (j, gap) in row.iter_mut().enumerate() {
                    let slope = heights[3 + j] - heights[i];
                    *gap += (low * slope).min(high * slope);
                }
            }
        }
        let (mut corners, mut smallest) = ([0, 3], f64::INFINITY);
        for (i, row) in gaps.iter().enumerate() {
            for (j, &gap) in row.iter().enumerate() {
                if gap < smallest {
                    (corners, smallest) = ([i, 3 + j], gap);
                }
            }
        }
        Gap {
            bound: smallest - direction.abs().element_sum() * self.error,
            direction,
            corners,
        }
    }

    /// The difference of the closest corners for the worst weights.
    pub(super) fn difference(&self, gap: &Gap, weights: &[[f32; 2]]) -> DVec3 {
        let [i, j] = gap.corners;
        let between = |corners: &[Vec3; 6]| corners[j].as_dvec3() - corners[i].as_dvec3();
        let moved = self.displacements.iter().zip(weights).map(|(of, [low, high])| {
            let change = between(of);
            change * f64::from(if change.dot(gap.direction) > 0.0 { *low } else { *high })
        });
        between(&self.base) + moved.sum::<DVec3>()
    }

    /// How the gap between the closest corners changes with the weight of each target.
    pub(super) fn slopes(&self, gap: &Gap) -> impl Iterator<Item = f64> {
        let (direction, [i, j]) = (gap.direction, gap.corners);
        self.displacements
            .iter()
            .map(move |of| (of[j] - of[i]).as_dvec3().dot(direction))
    }

    /// How far apart each target moves two corners at most, along any direction.
    pub(super) fn differences(&self) -> impl Iterator<Item = f64> {
        self.displacements.iter().map(|[a, b, c, d, e, f]| {
            let of_first = [a, b, c];
            let pairs = of_first
                .into_iter()
                .flat_map(|i| [d, e, f].map(|j| (j.as_dvec3() - i.as_dvec3()).length()));
            largest(pairs)
        })
    }
}
