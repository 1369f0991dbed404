use crate::bounds::WorldFromModel;
use crate::exact::Triangle;
use crate::pose::{AnyPosed, Pose, with_posed};
use crate::traverse::{AsBoxes, Walkable};

/// A posed mesh and where it stands, for the time of one query.
#[derive(Debug)]
pub struct Body<'a> {
    /// The shape; volumes and vertices that the query looks at are blended into its cache.
    pub pose: &'a mut Pose,
    /// The place.
    pub world_from_model: &'a WorldFromModel,
}

impl<'a> Body<'a> {
    /// A pose at a place.
    #[must_use]
    pub fn new(pose: &'a mut Pose, world_from_model: &'a WorldFromModel) -> Self {
        Self { pose, world_from_model }
    }
}

/// A triangle's corners in world space.
#[inline]
pub(super) fn world_triangle(tree: &mut impl Walkable, world_from_model: &WorldFromModel, triangle: u32) -> Triangle {
    let [a, b, c] = tree.corners(triangle);
    [
        world_from_model.transform_point(a),
        world_from_model.transform_point(b),
        world_from_model.transform_point(c),
    ]
}

/// A posed tree of any kind as one of boxes.
pub(super) fn as_boxes<'a>(posed: &'a mut AnyPosed<'_>) -> AsBoxes<'a> {
    with_posed!(posed, posed => AsBoxes(posed))
}

/// Evaluates an expression for two posed trees as walkable ones of one kind: as they are, or, where kinds differ, as boxes.
macro_rules! with_walkable_pair {
    ($a:expr, $b:expr, ($x:ident, $y:ident) => $body:expr) => {
        match ($a, $b) {
            ($crate::pose::AnyPosed::Aabb(mut $x), $crate::pose::AnyPosed::Aabb(mut $y)) => $body,
            ($crate::pose::AnyPosed::Kdop14(mut $x), $crate::pose::AnyPosed::Kdop14(mut $y)) => $body,
            ($crate::pose::AnyPosed::Kdop18(mut $x), $crate::pose::AnyPosed::Kdop18(mut $y)) => $body,
            ($crate::pose::AnyPosed::Kdop26(mut $x), $crate::pose::AnyPosed::Kdop26(mut $y)) => $body,
            ($crate::pose::AnyPosed::Sphere(mut $x), $crate::pose::AnyPosed::Sphere(mut $y)) => $body,
            (mut a, mut b) => {
                let (mut $x, mut $y) = (
                    $crate::query::body::as_boxes(&mut a),
                    $crate::query::body::as_boxes(&mut b),
                );
                $body
            }
        }
    };
}
pub(super) use with_walkable_pair;
