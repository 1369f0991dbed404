//! An independent implementation of signed distances. For a triangle, it searches for the smallest.

use glam::{DMat3, DQuat, DVec2, DVec3, Quat, Vec3};
use morph_collision::{PlacedShape, Shape};

/// A shape, with the same numbers for the independent implementation.
pub(crate) struct Twin {
    pub(crate) shape: Shape,
    pub(crate) placed: PlacedShape,
    rotation: DMat3,
    translation: DVec3,
}

impl Twin {
    pub(crate) fn new(shape: Shape, rotation: Quat, translation: Vec3) -> Self {
        let [x, y, z, w] = rotation.to_array().map(f64::from);
        Self {
            shape,
            placed: PlacedShape::new(shape, rotation, translation).unwrap(),
            rotation: DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()),
            translation: translation.as_dvec3(),
        }
    }

    /// The signed distance of a point: the usual formulas in the shape's own space.
    pub(crate) fn of_point(&self, point: DVec3) -> f64 {
        let p = self.rotation.transpose() * (point - self.translation);
        match self.shape {
            Shape::Ball { radius } => p.length() - f64::from(radius),
            Shape::Capsule { half_length, radius } => {
                let beyond = (p.y.abs() - f64::from(half_length)).max(0.0);
                DVec3::new(p.x, beyond, p.z).length() - f64::from(radius)
            }
            Shape::Cuboid { half_extents } => {
                let q = p.abs() - half_extents.as_dvec3();
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
            }
            Shape::HalfSpace { normal } => p.dot(normal.as_dvec3().normalize()),
        }
    }

    /// The smallest signed distance over a triangle. The function is convex, so nested golden-section searches find its minimum.
    pub(crate) fn of_triangle(&self, [a, b, c]: &[DVec3; 3]) -> f64 {
        smallest(|s| {
            let (p, q) = (a.lerp(*b, s), a.lerp(*c, s));
            smallest(|t| self.of_point(p.lerp(q, t)))
        })
    }
}

/// The minimum over 0..=1 of a convex function.
fn smallest(f: impl Fn(f64) -> f64) -> f64 {
    const RATIO: f64 = 0.618_033_988_749_895;
    let (mut low, mut high) = (0.0, 1.0);
    let mut best = f(low).min(f(high));
    let (mut s, mut t) = (high - RATIO * (high - low), low + RATIO * (high - low));
    let (mut at_s, mut at_t) = (f(s), f(t));
    for _ in 0..64 {
        best = best.min(at_s).min(at_t);
        if at_s <= at_t {
            (high, t, at_t) = (t, s, at_s);
            s = high - RATIO * (high - low);
            at_s = f(s);
        } else {
            (low, s, at_s) = (s, t, at_t);
            t = low + RATIO * (high - low);
            at_t = f(t);
        }
    }
    best
}

/// Every kind of shape around `middle`: small and large, round and flat, around everything, and collapsed to a point.
pub(crate) fn around(middle: Vec3, radius: f32) -> Vec<Twin> {
    let turns = [
        Quat::IDENTITY,
        Quat::from_rotation_x(0.7) * Quat::from_rotation_y(2.1) * Quat::from_rotation_z(-0.4),
    ];
    let offsets = [Vec3::ZERO, Vec3::new(0.4, -0.7, 0.5), Vec3::new(-1.4, 0.3, 0.9)];
    let shapes = [
        Shape::Ball { radius: 0.25 * radius },
        Shape::Ball { radius: 20.0 * radius },
        Shape::Ball { radius: 0.0 },
        Shape::Capsule {
            half_length: 0.6 * radius,
            radius: 0.1 * radius,
        },
        Shape::Capsule {
            half_length: 9.0 * radius,
            radius: 0.01 * radius,
        },
        Shape::Cuboid {
            half_extents: Vec3::new(0.3, 0.5, 0.2) * radius,
        },
        Shape::Cuboid {
            half_extents: Vec3::new(9.0, 10.0, 11.0) * radius,
        },
        Shape::Cuboid {
            half_extents: Vec3::new(0.8, 0.0, 0.4) * radius,
        },
        Shape::Cuboid {
            half_extents: Vec3::ZERO,
        },
        Shape::HalfSpace {
            normal: Vec3::new(0.3, 2.0, -0.5),
        },
        Shape::HalfSpace { normal: Vec3::NEG_Z },
        // A segment, and a point.
        Shape::Capsule {
            half_length: 2.0 * radius,
            radius: 0.0,
        },
        Shape::Capsule {
            half_length: 0.0,
            radius: 0.0,
        },
    ];
    let mut all = Vec::new();
    for (i, shape) in shapes.into_iter().enumerate() {
        for (j, offset) in offsets.into_iter().enumerate() {
            all.push(Twin::new(shape, turns[(i + j) % 2], middle + offset * radius));
        }
    }
    all
}

/// A point in a triangle, from 2D coordinates.
pub(crate) fn in_triangle([a, b, c]: &[DVec3; 3], at: DVec2) -> DVec3 {
    a + (b - a) * at.x + (c - a) * at.y
}
