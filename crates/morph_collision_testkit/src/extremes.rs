//! Motions that are hard on purpose: bodies that shrink to points, lines or planes, become huge, or turn inside out in one step.

use glam::{Affine3A, Quat, Vec3};

/// Two bodies at the start and at the end of a motion. They are apart at the start.
#[derive(Clone, Debug)]
pub struct Extreme {
    /// What happens, in a few words.
    pub name: &'static str,
    /// The placements of each body: at the start and at the end.
    pub places: [[Affine3A; 2]; 2],
}

const ONE: Vec3 = Vec3::ONE;
const NONE: Vec3 = Vec3::ZERO;
const LINE: Vec3 = Vec3::X;
const PLANE: Vec3 = Vec3::new(1.0, 1.0, 0.0);

/// All extremes, for two meshes with a radius of about 1 around the origin.
#[must_use]
pub fn extremes() -> Vec<Extreme> {
    let place = |scale: Vec3, x: f32| Affine3A::from_scale_rotation_translation(scale, Quat::IDENTITY, Vec3::X * x);
    let far = |place: Affine3A| Affine3A::from_translation(Vec3::new(1e4, -2e3, 5e3)) * place;
    let both = |name, start: Vec3, end: Vec3, [from, to]: [f32; 2]| Extreme {
        name,
        places: [-1.0, 1.0].map(|side| [place(start, side * from), place(end, side * to)]),
    };
    let moved = |name, extreme: Extreme, by: &dyn Fn(Affine3A) -> Affine3A| Extreme {
        name,
        places: extreme.places.map(|ends| ends.map(by)),
    };
    let one = |name, [start, end]: [Affine3A; 2], other: Affine3A| Extreme {
        name,
        places: [[start, end], [other; 2]],
    };
    let turned = Affine3A::from_translation(Vec3::X * 1.3) * Affine3A::from_rotation_y(std::f32::consts::PI);
    vec![
        both("to a point", ONE, NONE, [1.3, 0.0]),
        moved("to a point far away", both("", ONE, NONE, [1.3, 0.0]), &far),
        both("to two points", ONE, NONE, [1.3, 0.1]),
        both("to a line", ONE, LINE, [1.3, 0.4]),
        moved("to a line far away", both("", ONE, LINE, [1.3, 0.4]), &far),
        both("to a plane", ONE, PLANE, [1.3, 0.4]),
        moved("to a plane far away", both("", ONE, PLANE, [1.3, 0.4]), &far),
        both("to 1e6", ONE, ONE * 1e6, [1.3, 1.3]),
        both("to 1e10", ONE, ONE * 1e10, [1.3, 1.3]),
        both("to 1e20", ONE, ONE * 1e20, [1.3, 1.3]),
        both("to 1e37", ONE, ONE * 1e37, [1.3, 1.3]),
        both("to 1e-20", ONE, ONE * 1e-20, [1.3, 0.0]),
        both("from 1e-20", ONE * 1e-20, ONE, [1e-3, 0.8]),
        both("from two points", NONE, ONE, [1e-3, 0.8]),
        both("from a line", LINE, ONE, [1.3, 0.8]),
        both("mirrored", ONE, -ONE, [1.3, 1.3]),
        both("mirrored through each other", ONE, -ONE, [1.3, -1.3]),
        both("points through each other", NONE, NONE, [1.0, -1.0]),
        both("1e-20 through each other", ONE * 1e-20, ONE * 1e-20, [1.0, -1.0]),
        both("a plane slides over a plane", PLANE, PLANE, [1.3, 0.2]),
        both("a line slides over a line", LINE, LINE, [1.3, 0.2]),
        both("closer by a millionth", ONE, ONE, [1.3, 1.299_999]),
        one(
            "a point through a body",
            [place(NONE, -3.0), place(NONE, 3.0)],
            place(ONE, 0.0),
        ),
        one(
            "to a point inside",
            [place(ONE, -2.6), place(NONE, 0.0)],
            place(ONE, 0.0),
        ),
        one(
            "to a point on the surface",
            [place(ONE, -2.6), place(NONE, -0.9)],
            place(ONE, 0.0),
        ),
        one(
            "to a plane inside",
            [place(ONE, -2.6), place(PLANE, 0.0)],
            place(ONE, 0.0),
        ),
        one(
            "half a turn",
            [place(ONE, -1.3), turned * place(ONE, -1.3)],
            place(ONE, 1.3),
        ),
        one("by 1e20", [place(ONE, -1e20), place(ONE, 1e20)], place(ONE, 0.0)),
    ]
}
