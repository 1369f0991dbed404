//! An independent implementation of signed distances. For a triangle, it searches for the smallest.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec2, DVec3, Quat, Vec3};
use morph_collision::{ConvexHull, PlacedShape, Shape};

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
            shape: shape.clone(),
            placed: PlacedShape::new(shape, rotation, translation).unwrap(),
            rotation: DMat3::from_quat(DQuat::from_xyzw(x, y, z, w).normalize()),
            translation: translation.as_dvec3(),
        }
    }

    /// The signed distance of a point: the usual formulas in the shape's own space.
    pub(crate) fn of_point(&self, point: DVec3) -> f64 {
        let p = self.rotation.transpose() * (point - self.translation);
        match self.shape.clone() {
            Shape::Ball { radius } => p.length() - f64::from(radius),
            Shape::Capsule { half_length, radius } => {
                let beyond = (p.y.abs() - f64::from(half_length)).max(0.0);
                DVec3::new(p.x, beyond, p.z).length() - f64::from(radius)
            }
            Shape::Cuboid { half_extents } => of_box(p, half_extents.as_dvec3()),
            Shape::RoundCuboid {
                half_extents,
                border_radius,
            } => of_box(p, half_extents.as_dvec3()) - f64::from(border_radius),
            Shape::Cylinder { half_height, radius } => of_trapezium(p, half_height, [radius; 2]),
            Shape::Cone { half_height, radius } => of_trapezium(p, half_height, [radius, 0.0]),
            Shape::ConicalFrustum {
                half_height,
                bottom_radius,
                top_radius,
            } => of_trapezium(p, half_height, [bottom_radius, top_radius]),
            Shape::ConvexHull(hull) => of_hull(p, &hull),
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

fn of_box(p: DVec3, half: DVec3) -> f64 {
    let q = p.abs() - half;
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

/// The signed distance from a solid of revolution whose outline is a trapezium: as a polygon in the plane, by the nearest edge and a sign.
fn of_trapezium(p: DVec3, half_height: f32, radii: [f32; 2]) -> f64 {
    let (h, [low, high]) = (f64::from(half_height), radii.map(f64::from));
    let p = DVec2::new(p.x.hypot(p.z), p.y);
    if h == 0.0 {
        return DVec2::new((p.x - low.max(high)).max(0.0), p.y).length();
    }
    let corners = [
        DVec2::new(-low, -h),
        DVec2::new(low, -h),
        DVec2::new(high, h),
        DVec2::new(-high, h),
    ];
    let mut nearest = f64::INFINITY;
    let mut is_inside = true;
    for (i, a) in corners.into_iter().enumerate() {
        let along = corners[(i + 1) % 4] - a;
        let t = (p - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
        nearest = nearest.min(p.distance(a + along * t.clamp(0.0, 1.0)));
        is_inside &= along.perp_dot(p - a) >= 0.0;
    }
    if is_inside { -nearest } else { nearest }
}

/// Inside, from the planes of the faces; outside, from those faces that see the point.
fn of_hull(p: DVec3, hull: &ConvexHull) -> f64 {
    let mut highest = f64::NEG_INFINITY;
    let mut nearest = f64::INFINITY;
    for face in hull.faces() {
        let corners = face.map(|i| hull.points()[i as usize]);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let height = normal.dot(p - a);
        highest = highest.max(height);
        if height > 0.0 {
            nearest = nearest.min(of_face(p, &corners, normal, height));
        }
    }
    if highest <= 0.0 { highest } else { nearest }
}

fn of_face(p: DVec3, &[a, b, c]: &[DVec3; 3], normal: DVec3, height: f64) -> f64 {
    let edges = [[a, b], [b, c], [c, a]];
    if edges.iter().all(|[q, r]| (r - q).cross(p - q).dot(normal) >= 0.0) {
        return height;
    }
    let of_edge = |[q, r]: [DVec3; 2]| {
        let t = (p - q).dot(r - q) / q.distance_squared(r);
        p.distance(q + (r - q) * t.clamp(0.0, 1.0))
    };
    edges.map(of_edge).into_iter().fold(f64::INFINITY, f64::min)
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

fn tetrahedron(size: f32) -> Arc<ConvexHull> {
    let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z].map(|corner| (corner - 0.2) * size);
    Arc::new(ConvexHull::new(&corners).unwrap())
}

/// A hull of 12 points, and a smaller copy inside that does not count.
fn pebble(size: f32) -> Arc<ConvexHull> {
    let point = |i: u32| {
        let (i, turn) = (i as f32, 2.4 * i as f32);
        let y = (i + 0.5) / 6.0 - 1.0;
        let around = (1.0 - y * y).sqrt();
        Vec3::new(around * turn.cos(), 0.5 * y, around * turn.sin()) * size
    };
    let points: Vec<Vec3> = (0..12).flat_map(|i| [point(i) * 0.5, point(i)]).collect();
    Arc::new(ConvexHull::new(&points).unwrap())
}

/// A wedge that does not contain the origin.
fn beside(size: f32) -> ConvexHull {
    let corners = [
        Vec3::new(1.0, 0.1, 0.0),
        Vec3::new(2.0, 0.2, 0.1),
        Vec3::new(1.2, 0.5, -0.1),
        Vec3::new(1.1, 0.3, 0.6),
        Vec3::new(1.7, 0.4, 0.5),
    ];
    ConvexHull::new(&corners.map(|corner| corner * size)).unwrap()
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
        Shape::RoundCuboid {
            half_extents: Vec3::new(0.3, 0.0, 0.2) * radius,
            border_radius: 0.2 * radius,
        },
        Shape::Cylinder {
            half_height: 0.5 * radius,
            radius: 0.3 * radius,
        },
        Shape::Cylinder {
            half_height: 0.0,
            radius: 0.9 * radius,
        },
        Shape::Cylinder {
            half_height: 0.9 * radius,
            radius: 0.0,
        },
        Shape::Cylinder {
            half_height: 20.0 * radius,
            radius: 15.0 * radius,
        },
        Shape::Cone {
            half_height: 0.6 * radius,
            radius: 0.5 * radius,
        },
        Shape::Cone {
            half_height: 0.05 * radius,
            radius: 3.0 * radius,
        },
        Shape::ConicalFrustum {
            half_height: 0.4 * radius,
            bottom_radius: 0.2 * radius,
            top_radius: 0.7 * radius,
        },
        Shape::ConvexHull(tetrahedron(0.7 * radius)),
        Shape::ConvexHull(pebble(1.2 * radius)),
        // Beside its own origin, and mirrored.
        Shape::ConvexHull(Arc::new(beside(radius).scaled(Vec3::new(-0.5, 2.0, 1.25)).unwrap())),
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
            all.push(Twin::new(shape.clone(), turns[(i + j) % 2], middle + offset * radius));
        }
    }
    all
}

/// A point in a triangle, from 2D coordinates.
pub(crate) fn in_triangle([a, b, c]: &[DVec3; 3], at: DVec2) -> DVec3 {
    a + (b - a) * at.x + (c - a) * at.y
}
