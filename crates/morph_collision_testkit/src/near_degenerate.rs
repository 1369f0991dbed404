//! Pairs of triangles that a rounded determinant would get wrong: touching, coplanar, degenerate, or off by a few units in
//! the last place.

use glam::DVec3;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Three corners.
pub type Triangle = [DVec3; 3];

/// The way in which a pair of triangles is special, exactly or almost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Corners on a grid of five points along each axis.
    Grid,
    /// A corner of one on the plane of the other.
    CornerOnFace,
    /// An edge of one through an edge of the other.
    EdgeThroughEdge,
    /// Corners or edges in common.
    Shared,
    /// All corners in one plane that is not a coordinate plane.
    Coplanar,
    /// Width between a billionth and a millionth of a billionth of the length, close to each other.
    Slivers,
    /// One is a segment or a point, on or beside the other.
    Collapsed,
    /// Small triangles far from the origin, where coordinates are coarse.
    FarOut,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 8] = [
        Self::Grid,
        Self::CornerOnFace,
        Self::EdgeThroughEdge,
        Self::Shared,
        Self::Coplanar,
        Self::Slivers,
        Self::Collapsed,
        Self::FarOut,
    ];

    /// A name for tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grid => "corners on a coarse grid",
            Self::CornerOnFace => "a corner on a face",
            Self::EdgeThroughEdge => "an edge through an edge",
            Self::Shared => "shared corners and edges",
            Self::Coplanar => "coplanar",
            Self::Slivers => "slivers",
            Self::Collapsed => "segments and points",
            Self::FarOut => "far from the origin",
        }
    }

    /// A pair of the family. Half of the pairs are moved by a few units in the last place, in one coordinate of one corner.
    pub fn pair(self, rng: &mut Pcg64Mcg) -> [Triangle; 2] {
        let [mut a, mut b] = match self {
            Self::Grid => [grid_triangle(rng), grid_triangle(rng)],
            Self::CornerOnFace => corner_on_face(rng),
            Self::EdgeThroughEdge => edge_through_edge(rng),
            Self::Shared => shared(rng),
            Self::Coplanar => coplanar(rng),
            Self::Slivers => slivers(rng),
            Self::Collapsed => collapsed(rng),
            Self::FarOut => far_out(rng),
        };
        if rng.random_bool(0.5) {
            let ulps = rng.random_range(1..4) * if rng.random_bool(0.5) { 1 } else { -1 };
            let corner = &mut b[rng.random_range(0..3_usize)];
            let axis = rng.random_range(0..3_usize);
            corner[axis] = nudged(corner[axis], ulps);
        }
        // Neither the order of corners nor that of triangles may matter.
        a.rotate_left(rng.random_range(0..3));
        b.rotate_left(rng.random_range(0..3));
        if rng.random_bool(0.5) {
            a.swap(0, 1);
        }
        if rng.random_bool(0.5) { [a, b] } else { [b, a] }
    }
}

/// A finite number moved by this many representable numbers.
pub fn nudged(value: f64, ulps: i64) -> f64 {
    let step = |value: f64| if ulps > 0 { value.next_up() } else { value.next_down() };
    (0..ulps.unsigned_abs()).fold(value, |value, _| step(value))
}

fn point(rng: &mut Pcg64Mcg) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}

fn triangle(rng: &mut Pcg64Mcg) -> Triangle {
    std::array::from_fn(|_| point(rng))
}

fn grid_triangle(rng: &mut Pcg64Mcg) -> Triangle {
    std::array::from_fn(|_| DVec3::from_array(std::array::from_fn(|_| f64::from(rng.random_range(-2..3)))))
}

/// A point of a triangle's plane: inside, on an edge, or outside.
fn in_plane_of([a, b, c]: &Triangle, rng: &mut Pcg64Mcg) -> DVec3 {
    let (y, z) = match rng.random_range(0..3) {
        0 => (rng.random_range(0.0..0.5), rng.random_range(0.0..0.5)),
        1 => (rng.random_range(-0.2..1.2), 0.0),
        _ => (rng.random_range(-0.5..1.5), rng.random_range(-0.5..1.5)),
    };
    a + (b - a) * y + (c - a) * z
}

fn corner_on_face(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    let a = triangle(rng);
    let tip = in_plane_of(&a, rng);
    let normal = (a[1] - a[0]).cross(a[2] - a[0]);
    let mut away = || {
        let step = point(rng);
        tip + step * step.dot(normal).signum()
    };
    [a, [tip, away(), away()]]
}

fn edge_through_edge(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    let a = triangle(rng);
    let at = a[0].lerp(a[1], rng.random_range(-0.1..1.1));
    let start = point(rng);
    let end = start + (at - start) * rng.random_range(1.0..3.0);
    // The third corner is beyond both, so that mostly nothing else intersects.
    let beyond = at + (at - a[2]) * rng.random_range(0.5..2.0) + point(rng) * 0.3;
    [a, [start, end, beyond]]
}

fn shared(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    let a = triangle(rng);
    let mut b = triangle(rng);
    b[..rng.random_range(1..4)].iter_mut().zip(a).for_each(|(b, a)| *b = a);
    [a, b]
}

fn coplanar(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    // Whole multiples of two whole vectors: in one plane without rounding.
    let whole =
        |rng: &mut Pcg64Mcg| DVec3::from_array(std::array::from_fn(|_| f64::from(rng.random_range(-1000..1000))));
    let (u, v) = (whole(rng), whole(rng));
    let mut corner = || u * f64::from(rng.random_range(-9..10)) + v * f64::from(rng.random_range(-9..10));
    let [a, b]: [Triangle; 2] = [0; 2].map(|_| [corner(), corner(), corner()]);
    // Sixteenths keep it exact; tenths do not quite.
    let unit = if rng.random_bool(0.5) { 1.0 / 16.0 } else { 0.1 };
    [a, b].map(|triangle| triangle.map(|p| p * unit))
}

fn slivers(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    let mut sliver = |start: DVec3| {
        let end = start + point(rng);
        let width = 10.0_f64.powf(rng.random_range(-18.0..-9.0));
        [
            start,
            end,
            start.lerp(end, rng.random_range(0.0..1.0)) + point(rng) * width,
        ]
    };
    let a = sliver(DVec3::ZERO);
    let mut b = sliver(DVec3::X * 0.1);
    let offset = in_plane_of(&a, rng) - in_plane_of(&b, rng);
    b = b.map(|corner| corner + offset);
    [a, b]
}

fn collapsed(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    let a = if rng.random_bool(0.5) {
        triangle(rng)
    } else {
        grid_triangle(rng)
    };
    let on = in_plane_of(&a, rng);
    let b = match rng.random_range(0..3) {
        0 => [on; 3],
        1 => [on, on, on + point(rng)],
        // On one line. The middle is exact only for whole numbers.
        _ => {
            let step = point(rng);
            [on - step, on, on + step]
        }
    };
    [a, b]
}

fn far_out(rng: &mut Pcg64Mcg) -> [Triangle; 2] {
    let far = point(rng) * 10.0_f64.powf(rng.random_range(6.0..13.0));
    let pair = if rng.random_bool(0.5) {
        corner_on_face(rng)
    } else {
        edge_through_edge(rng)
    };
    pair.map(|triangle| triangle.map(|corner| corner + far))
}
