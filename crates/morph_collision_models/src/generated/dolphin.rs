//! The dolphin of the paper's second experiment, in four resolutions of the same shape.
//!
//! About 2 units long, with the nose towards `+X` and the back towards `+Y`. It has five closed pieces: a body of 12
//! sides, a dorsal fin, two pectoral fins and a fluke. The fins are rooted inside the body. The references bend the
//! spine. Everything is built straight first and then moved along with its place on the spine.

use glam::{DVec2, DVec3, Vec3};

use super::{grid, subdivide, tube::Pieces};
use crate::clip::WeightAnimation;
use crate::mesh::MorphMesh;

/// Corners around the body.
const SIDES: usize = 12;

/// The body's outline from beak to tail: x, height of the middle, half height, half width.
#[rustfmt::skip]
const BODY: [[f64; 4]; 18] = [
    [ 0.985, -0.062, 0.019, 0.024],
    [ 0.925, -0.058, 0.029, 0.037],
    [ 0.860, -0.052, 0.038, 0.045],
    [ 0.825, -0.034, 0.064, 0.064],
    [ 0.785, -0.014, 0.090, 0.085],
    [ 0.725, -0.002, 0.117, 0.108],
    [ 0.635,  0.000, 0.140, 0.131],
    [ 0.510,  0.000, 0.162, 0.153],
    [ 0.360,  0.000, 0.178, 0.167],
    [ 0.190,  0.000, 0.185, 0.171],
    [ 0.010,  0.002, 0.180, 0.164],
    [-0.160,  0.006, 0.166, 0.146],
    [-0.320,  0.012, 0.144, 0.119],
    [-0.465,  0.018, 0.118, 0.088],
    [-0.590,  0.021, 0.092, 0.059],
    [-0.700,  0.022, 0.067, 0.037],
    [-0.795,  0.021, 0.045, 0.023],
    [-0.870,  0.020, 0.025, 0.018],
];
const BEAK_TIP: DVec3 = DVec3::new(1.0, -0.063, 0.0);
const TAIL_END: DVec3 = DVec3::new(-0.9, 0.02, 0.0);

/// Where the spine begins to bend, and the rotation of its ends in radians.
const PIVOT: f64 = 0.3;
const TAIL_TURN: f64 = 0.95;
const HEAD_TURN: f64 = 0.16;
/// How far the pectoral fins sweep, in radians.
const PECTORAL_SWEEP: f64 = 0.3;

/// Seconds per stroke, and keys per stroke, of the clip "swim".
const PERIOD: f32 = 1.6;
const KEYS: usize = 32;

/// A dolphin of `564 * 4^level` triangles.
///
/// Model space: nose at `x = 1`, tail at about `x = -1`, `+Y` up, symmetric in `z`. The base is the neutral shape. The
/// targets `tail_down` and `tail_up` bend the spine. The clip "swim" loops through neutral, down, neutral, up with
/// weights that are never negative and never sum to more than 1.
///
/// Finer levels are midpoint subdivisions of all references, exact in `f32`, so all levels are the same surface in every
/// pose.
pub fn dolphin(level: u32) -> MorphMesh {
    let neutral = straight();
    let references = [Bend::NONE, Bend::DOWN, Bend::UP];
    let mut references = references.map(|bend| {
        let bent = neutral.parts.iter().zip(&neutral.pieces.positions);
        bent.map(|(&part, &p)| grid::snap(bend.apply(part, p)))
            .collect::<Vec<Vec3>>()
    });
    let mut triangles = neutral.pieces.triangles;
    subdivide::midpoint(&mut references, &mut triangles, level);

    let name = format!("dolphin_{}", triangles.len());
    let mut mesh = MorphMesh::from_references(name, &references, triangles, &["tail_down", "tail_up"]);
    let keys = || (0..=KEYS).map(|key| key as f32 / KEYS as f32);
    mesh.animations.push(WeightAnimation {
        name: "swim".into(),
        times: keys().map(|cycle| grid::round6(f64::from(cycle * PERIOD))).collect(),
        weights: keys().map(|cycle| swim_weights(cycle).to_vec()).collect(),
        ..WeightAnimation::default()
    });
    mesh
}

/// The weights `[tail_down, tail_up]` after `cycle` strokes; only the fraction counts.
pub fn swim_weights(cycle: f32) -> [f32; 2] {
    let stroke = (f64::from(cycle) * std::f64::consts::TAU).sin();
    [grid::round6(stroke.max(0.0)), grid::round6((-stroke).max(0.0))]
}

/// The part of a vertex; fins also move a little on their own.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Part {
    Body,
    Pectoral,
}

/// The neutral shape.
#[derive(Default)]
struct Straight {
    pieces: Pieces,
    parts: Vec<Part>,
}

impl Straight {
    fn add<const N: usize>(&mut self, part: Part, start: DVec3, rings: &[[DVec3; N]], end: DVec3) {
        self.pieces.add_tube(start, rings, end);
        self.parts.resize(self.pieces.positions.len(), part);
    }
}

fn straight() -> Straight {
    let mut dolphin = Straight::default();
    dolphin.add(Part::Body, BEAK_TIP, &BODY.map(body_ring), TAIL_END);

    let dorsal = [
        Section {
            lead: [0.12, 0.130, 0.0],
            trail: [-0.215, 0.125, 0.0],
            half: [0.0, 0.0, 0.026],
        },
        Section {
            lead: [-0.045, 0.255, 0.0],
            trail: [-0.205, 0.235, 0.0],
            half: [0.0, 0.0, 0.015],
        },
        Section {
            lead: [-0.155, 0.345, 0.0],
            trail: [-0.245, 0.325, 0.0],
            half: [0.0, 0.0, 0.008],
        },
    ];
    let root = DVec3::new(-0.06, 0.1, 0.0);
    dolphin.add(
        Part::Body,
        root,
        &dorsal.map(Section::diamond),
        DVec3::new(-0.30, 0.385, 0.0),
    );

    for side in [1.0, -1.0] {
        let mirror = |p: DVec3| p * DVec3::new(1.0, 1.0, side);
        let pectoral = [
            Section {
                lead: [0.515, -0.075, 0.105],
                trail: [0.350, -0.085, 0.105],
                half: [0.0, 0.020, 0.008],
            },
            Section {
                lead: [0.435, -0.150, 0.235],
                trail: [0.275, -0.160, 0.225],
                half: [0.0, 0.013, 0.008],
            },
            Section {
                lead: [0.315, -0.210, 0.330],
                trail: [0.205, -0.215, 0.310],
                half: [0.0, 0.008, 0.005],
            },
        ];
        let rings = pectoral.map(|section| section.diamond().map(mirror));
        let (root, tip) = (DVec3::new(0.43, -0.05, 0.06), DVec3::new(0.155, -0.24, 0.375));
        dolphin.add(Part::Pectoral, mirror(root), &rings, mirror(tip));
    }

    let fluke = [
        Section {
            lead: [-0.925, 0.02, -0.225],
            trail: [-0.985, 0.02, -0.215],
            half: [0.0, 0.006, 0.0],
        },
        Section {
            lead: [-0.855, 0.02, -0.120],
            trail: [-0.975, 0.02, -0.105],
            half: [0.0, 0.012, 0.0],
        },
        Section {
            lead: [-0.800, 0.02, 0.0],
            trail: [-0.930, 0.02, 0.0],
            half: [0.0, 0.022, 0.0],
        },
        Section {
            lead: [-0.855, 0.02, 0.120],
            trail: [-0.975, 0.02, 0.105],
            half: [0.0, 0.012, 0.0],
        },
        Section {
            lead: [-0.925, 0.02, 0.225],
            trail: [-0.985, 0.02, 0.215],
            half: [0.0, 0.006, 0.0],
        },
    ];
    let (right, left) = (DVec3::new(-1.0, 0.02, -0.295), DVec3::new(-1.0, 0.02, 0.295));
    dolphin.add(Part::Body, right, &fluke.map(Section::hexagon), left);
    dolphin
}

/// An ellipse across the body.
fn body_ring([x, middle, half_height, half_width]: [f64; 4]) -> [DVec3; SIDES] {
    std::array::from_fn(|side| {
        let (sin, cos) = (std::f64::consts::TAU * side as f64 / SIDES as f64).sin_cos();
        DVec3::new(x, middle + half_height * cos, half_width * sin)
    })
}

/// A section across a fin: leading edge, trailing edge and half the thickness between them.
#[derive(Clone, Copy)]
struct Section {
    lead: [f64; 3],
    trail: [f64; 3],
    half: [f64; 3],
}

impl Section {
    /// The point at `chord` (0 leading edge, 1 trailing edge) and `height` times the half thickness.
    fn at(&self, chord: f64, height: f64) -> DVec3 {
        let (lead, trail) = (DVec3::from(self.lead), DVec3::from(self.trail));
        lead.lerp(trail, chord) + DVec3::from(self.half) * height
    }

    fn diamond(self) -> [DVec3; 4] {
        [
            self.at(0.0, 0.0),
            self.at(0.4, 1.0),
            self.at(1.0, 0.0),
            self.at(0.4, -1.0),
        ]
    }

    fn hexagon(self) -> [DVec3; 6] {
        [
            self.at(0.0, 0.0),
            self.at(0.25, 1.0),
            self.at(0.65, 0.8),
            self.at(1.0, 0.0),
            self.at(0.65, -0.8),
            self.at(0.25, -1.0),
        ]
    }
}

/// How far a reference is bent, from -1 (tail down) to 1 (tail up).
#[derive(Clone, Copy)]
struct Bend(f64);

impl Bend {
    const NONE: Self = Self(0.0);
    const DOWN: Self = Self(-1.0);
    const UP: Self = Self(1.0);

    /// The bent position of a point of the neutral shape.
    fn apply(self, part: Part, p: DVec3) -> DVec3 {
        let p = if part == Part::Pectoral { self.sweep(p) } else { p };
        let (spine, turn) = self.spine(p.x);
        let up = DVec2::new(-turn.sin(), turn.cos());
        let carried = spine + up * p.y;
        DVec3::new(carried.x, carried.y, p.z)
    }

    /// The rotation of the spine at `x`, in radians from `+X` towards `+Y`. It grows with the square of the distance
    /// from the pivot.
    fn turn(self, x: f64) -> f64 {
        let behind = (PIVOT - x) / (PIVOT + 1.0);
        let ahead = (x - PIVOT) / (1.0 - PIVOT);
        // Raising the tail rotates it clockwise (seen with the nose to the right), and raises the head a little too.
        if behind > 0.0 {
            -self.0 * TAIL_TURN * behind * behind
        } else {
            self.0 * HEAD_TURN * ahead * ahead
        }
    }

    /// The bent position of the spine's point `(x, 0)`, and the rotation there. The spine keeps its length, so this
    /// integrates its direction from the pivot (midpoint rule, far finer than the grid the result is snapped to).
    fn spine(self, x: f64) -> (DVec2, f64) {
        const STEPS: u32 = 2000;
        let step = (x - PIVOT) / f64::from(STEPS);
        let direction = |i: u32| {
            let (sin, cos) = self.turn(PIVOT + (f64::from(i) + 0.5) * step).sin_cos();
            DVec2::new(cos, sin)
        };
        let along: DVec2 = (0..STEPS).map(direction).sum();
        (DVec2::new(PIVOT, 0.0) + along * step, self.turn(x))
    }

    /// Rotates a pectoral fin about its root, parallel to the spine, against the tail.
    fn sweep(self, p: DVec3) -> DVec3 {
        let side = p.z.signum();
        let root = DVec2::new(0.105, -0.08);
        let arm = DVec2::new(p.z.abs(), p.y) - root;
        // The root ring and everything inside the body stay in place.
        if arm.x <= 0.0 {
            return p;
        }
        let turned = root + DVec2::from_angle(-self.0 * PECTORAL_SWEEP).rotate(arm);
        DVec3::new(p.x, turned.y, turned.x * side)
    }
}
