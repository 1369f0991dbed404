//! A bound on how far vertices have moved, computed from the boxes of trees and joints without blending any vertex.
//!
//! New weights move a vertex from `p` to `q`. The map to the world was `A` and is now `B`. So the vertex moves by
//! `(B - A) p + B (q - p)` in the world.
//!
//! - The first term is largest at a corner of a box around `p`.
//! - For the second term there is a box around `q - p`, from the intervals of the targets whose weights differ, and a bound on how
//!   much `B` stretches a vector.
//!
//! A vertex under joints moves by the weighted sum of these displacements over its joints.

use std::ops::Range;
use std::sync::Arc;

use fearless_simd::Level;
use glam::{DMat3, DVec3};

use super::blend::blend_change;
use super::instance::Pose;
use super::posed::Posed;
use crate::bounds::{Aabb, Box64, BoxLanes, WorldFromModel, with_simd};
use crate::exact::largest;
use crate::tree::{ChildKind, GroupTables};

/// The number of levels visited below the root's children. Not measured: more levels make the bound smaller, but cost more.
const LEVELS: usize = 2;

impl Pose {
    /// Returns a bound on the distance between any vertex and the same vertex in another pose of the mesh, rounding included.
    /// Infinite for poses of different trees.
    ///
    /// Distances are in model space; for a skinned mesh, in world space. See
    /// [`Body::displacement_from`](crate::Body::displacement_from) for placed bodies and for the cost.
    #[must_use]
    pub fn displacement_from_pose(&self, before: &mut Self) -> f64 {
        let place = WorldFromModel::IDENTITY;
        displacement(before, &place, self, &place, 0.0..f64::INFINITY)
    }
}

/// A bound on the distance between any vertex of a body and the same vertex of the body as it was before.
///
/// `wanted` saves work outside the range that matters: if the bound is at most its start, the start is returned, and if the bound is
/// more than its end, any larger number may be returned.
pub(crate) fn displacement(
    before: &mut Pose,
    from: &WorldFromModel,
    now: &Pose,
    to: &WorldFromModel,
    wanted: Range<f64>,
) -> f64 {
    if !Arc::ptr_eq(&now.bvh, &before.bvh) {
        return f64::INFINITY;
    }
    let enough = wanted.start;
    let same_weights = before.weights.all() == now.weights.all();
    let bound = if now.skinning.is_some() {
        if same_weights && before.joints() == now.joints() {
            return enough;
        }
        under_joints(before, now, wanted).unwrap_or(f64::INFINITY)
    } else {
        if same_weights && from.is_same_map(to) {
            return enough;
        }
        placed(before, from, now, to, wanted)
    };
    known(bound).max(enough)
}

fn placed(before: &mut Pose, from: &WorldFromModel, now: &Pose, to: &WorldFromModel, wanted: Range<f64>) -> f64 {
    let motion = Motion {
        linear: to.linear() - from.linear(),
        translation: to.translation() - from.translation(),
    };
    let mut posed = before.posed_at(from);
    let group = posed.top_group();
    let slot = posed.open(group);
    let boxes = *posed.boxes(slot);
    let magnitude = posed.bounds().magnitude().as_dvec3();
    let change = Change {
        weights: [posed.weights.all(), now.weights.all()],
        stretch: stretch(&to.linear()),
        level: posed.level,
    };
    let moved = change.of_group(posed.tables.group(group));
    let children = posed.topology.group(group).children();
    let magnitudes = (0..children.len()).map(|lane| moved.get(lane).magnitude().as_dvec3());
    let farther = magnitude + magnitudes.fold(DVec3::ZERO, DVec3::max);
    let rounding = (from.placement_error(magnitude) + to.placement_error(farther)).length();

    let mut farthest = wanted.start;
    for (lane, child) in children.iter().enumerate() {
        let by_targets = change.length(&moved.get(lane));
        let by_place = rounding + motion.of_box(&Box64::of(&boxes.get(lane)), farthest - rounding - by_targets);
        let bound = known(by_place + by_targets);
        if by_place > wanted.end {
            return bound;
        }
        if bound <= farthest {
            continue;
        }
        match child.kind() {
            ChildKind::Group(below) => {
                let wanted = farthest..wanted.end;
                farthest = change.refine(&posed, below, LEVELS, by_place, wanted);
            }
            ChildKind::Leaf(_) => farthest = bound,
        }
        if farthest > wanted.end {
            break;
        }
    }
    farthest
}

fn under_joints(before: &mut Pose, now: &Pose, wanted: Range<f64>) -> Option<f64> {
    let (_, skinning) = now.skinning.as_ref()?;
    let (to, error) = (&skinning.joints, skinning.error_with(now.bvh.model(), &now.weights));
    let skin = now.bvh.model().skin()?;
    let mut posed = before.posed();
    let tree = posed.skin_tree()?;
    let (tables, skinning) = posed.skin.as_mut()?;
    let (from, rounding) = (skinning.joints.clone(), 3_f64.sqrt() * (error + skinning.error()));
    let parts = skinning.joint_boxes(tree)?;
    let sum = skin.max_sum().max(1e-3) * (1.0 + 1e-9);
    let enough = (wanted.start - rounding) / sum;
    let mut farthest = enough;
    for ((joints, tables), boxes) in tables.joints.tables().zip(parts.iter()) {
        let change = Change {
            weights: [posed.weights.all(), now.weights.all()],
            stretch: 1.0,
            level: posed.level,
        };
        let moved = tables.map(|tables| change.of_group(tables));
        for (lane, &joint) in joints.iter().enumerate() {
            let (from, to) = (from.columns(joint), to.columns(joint));
            let [x, y, z, translation] = std::array::from_fn(|column| to[column] - from[column]);
            let motion = Motion {
                linear: DMat3::from_cols(x, y, z),
                translation,
            };
            let by_targets = match moved.map_or(0.0, |moved| change.length(&moved.get(lane))) {
                0.0 => 0.0,
                length => length * stretch(&DMat3::from_cols(to[0], to[1], to[2])),
            };
            let by_joint = motion.of_box(&boxes.get(lane), farthest - by_targets);
            farthest = farthest.max(known(by_joint + by_targets));
            if farthest > enough && sum * farthest + rounding > wanted.end {
                return Some(f64::INFINITY);
            }
        }
    }
    // Return the start itself: computed back from `farthest`, it would be rounded and could exceed the start.
    Some(if farthest <= enough {
        wanted.start
    } else {
        sum * farthest + rounding
    })
}

/// A change of weights, and the map to the world that follows it.
struct Change<'a> {
    /// Before and now.
    weights: [&'a [f32]; 2],
    /// A bound on the factor by which the map to the world lengthens a vector.
    stretch: f64,
    level: Level,
}

impl Change<'_> {
    /// Boxes around the displacements in each child of a group.
    fn of_group(&self, tables: GroupTables<'_>) -> BoxLanes {
        let mut moved = BoxLanes::default();
        with_simd!(self.level, simd => blend_change(simd, tables, self.weights, &mut moved));
        moved
    }

    /// A bound on the lengths, in the world, of displacements in a box.
    fn length(&self, moved: &Aabb) -> f64 {
        self.stretch * moved.magnitude().as_dvec3().length() * (1.0 + 1e-9)
    }

    /// A bound for the vertices of a group, given that the change of the map moves them by at most `by_place`.
    fn refine(&self, posed: &Posed<'_>, group: usize, levels: usize, by_place: f64, wanted: Range<f64>) -> f64 {
        let mut farthest = wanted.start;
        let moved = self.of_group(posed.tables.group(group));
        for (lane, child) in posed.topology.group(group).children().iter().enumerate() {
            let bound = known(by_place + self.length(&moved.get(lane)));
            if bound <= farthest {
                continue;
            }
            farthest = match child.kind() {
                ChildKind::Group(below) if levels > 1 => {
                    self.refine(posed, below, levels - 1, by_place, farthest..wanted.end)
                }
                _ => bound,
            };
            if farthest > wanted.end {
                break;
            }
        }
        farthest
    }
}

/// The difference of two maps: it takes a point to the vector by which the point moves.
struct Motion {
    linear: DMat3,
    translation: DVec3,
}

impl Motion {
    /// A bound on how far points of a box move: a simple one if it is at most `enough`, otherwise the distance that the corners move
    /// at most.
    fn of_box(&self, bounds: &Box64, enough: f64) -> f64 {
        let Box64 { center, half } = *bounds;
        let reach = self.linear.abs() * (center.abs() + half) + self.translation.abs();
        let rounding = 32.0 * f64::EPSILON * reach.element_sum();
        let middle = self.linear * center + self.translation;
        let simple = (middle.abs() + self.linear.abs() * half).length() + rounding;
        if simple <= enough {
            return simple;
        }
        let [x, y, z] = [
            self.linear.x_axis * half.x,
            self.linear.y_axis * half.y,
            self.linear.z_axis * half.z,
        ];
        let corners = [x + y + z, x + y - z, x - y + z, x - y - z];
        let ends = corners.map(|corner| [middle + corner, middle - corner]);
        let farthest = largest(ends.into_iter().flatten().map(DVec3::length_squared));
        // `largest` drops NaN; `simple` keeps it.
        if simple.is_finite() {
            farthest.sqrt() * (1.0 + 1e-9) + rounding
        } else {
            f64::INFINITY
        }
    }
}

/// A bound on the factor by which a map lengthens a vector: the square root of the largest eigenvalue of `m^T m`, bounded by its
/// row sums. The bound is exact if the axes stay orthogonal.
fn stretch(m: &DMat3) -> f64 {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    let [xy, xz, yz] = [x.dot(y).abs(), x.dot(z).abs(), y.dot(z).abs()];
    let sums = [
        x.length_squared() + xy + xz,
        y.length_squared() + xy + yz,
        z.length_squared() + xz + yz,
    ];
    largest(sums).sqrt() * (1.0 + 1e-9)
}

/// The bound, or infinity if an overflow made it NaN.
fn known(bound: f64) -> f64 {
    if bound.is_nan() { f64::INFINITY } else { bound }
}
