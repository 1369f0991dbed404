//! The camera, and the projection of triangles into the picture.

use glam::{DVec2, DVec3};

/// Directions from the middle of the scene to the eye.
pub(super) const EYES: [DVec3; 10] = [
    DVec3::new(0.5, 0.45, 1.0),
    DVec3::new(-0.5, 0.45, 1.0),
    DVec3::new(1.0, 0.45, 0.5),
    DVec3::new(-1.0, 0.45, 0.5),
    DVec3::new(0.5, 0.45, -1.0),
    DVec3::new(-0.5, 0.45, -1.0),
    DVec3::new(0.1, 1.0, 0.5),
    DVec3::new(0.5, -0.45, 1.0),
    DVec3::new(-0.5, -0.45, 1.0),
    DVec3::new(0.1, -1.0, 0.5),
];

/// The eye's distance from the middle of the scene, in radii of the scene.
const DISTANCE: f64 = 4.0;
/// The part of the picture that the scene fills.
const FILLED: f64 = 0.9;
/// The direction towards the light along the camera's axes (right, up, backwards), of length 1.
const LIGHT: DVec3 = DVec3::new(-3.0 / 7.0, 6.0 / 7.0, 2.0 / 7.0);

/// A perspective camera.
#[derive(Clone, Copy, Debug)]
pub(super) struct Camera {
    size: [usize; 2],
    /// The middle of the scene in world space.
    middle: DVec3,
    /// Half the diagonal of the scene's box.
    radius: f64,
    right: DVec3,
    up: DVec3,
    backward: DVec3,
    /// The middle of the scene on the plane at distance 1 from the eye.
    center: DVec2,
    /// Pixels per unit on that plane.
    scale: f64,
}

impl Camera {
    /// A camera in the direction `eye` from the middle of finite points that keeps all of them in the picture. `y` is up.
    pub(super) fn fit(points: impl Iterator<Item = DVec3> + Clone, eye: DVec3, size: [usize; 2]) -> Self {
        let (low, high) = bounds(points.clone()).unwrap_or_default();
        let radius = 0.5 * (high - low).length();
        let backward = eye.normalize();
        let right = DVec3::Y.cross(backward).normalize();
        let mut camera = Self {
            size,
            middle: 0.5 * (low + high),
            radius: if radius > 0.0 { radius } else { 1.0 },
            right,
            up: backward.cross(right),
            backward,
            center: DVec2::ZERO,
            scale: 1.0,
        };
        let on_plane = points.map(|point| camera.on_plane(point));
        if let Some((low, high)) = bounds(on_plane.map(|(place, _)| place.extend(0.0))) {
            // A single point has no extent.
            let extent = (high - low).truncate().max(DVec2::splat(1e-6));
            let size = DVec2::new(size[0] as f64, size[1] as f64);
            camera.center = (0.5 * (low + high)).truncate();
            camera.scale = FILLED * (size / extent).min_element();
        }
        camera
    }

    /// The size of its picture.
    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Projects a triangle: `x` to the right, `y` downward in pixels, `z` larger where it is nearer.
    pub(super) fn triangle(&self, corners: [DVec3; 3]) -> [DVec3; 3] {
        corners.map(|corner| {
            let (place, nearness) = self.on_plane(corner);
            let offset = (place - self.center) * self.scale;
            let [width, height] = self.size.map(|side| 0.5 * side as f64);
            DVec3::new(width + offset.x, height - offset.y, nearness)
        })
    }

    /// How much light a triangle gets, 0 to 1, whichever side is seen.
    pub(super) fn light(&self, corners: [DVec3; 3]) -> f32 {
        let [a, b, c] = corners.map(|corner| self.of_scene(corner));
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let to_eye = DVec3::Z * DISTANCE - a;
        let facing = if normal.dot(to_eye) < 0.0 { -normal } else { normal };
        // Never quite dark, so that shapes facing away from the light can be told apart too.
        let toward = 0.5 + 0.5 * facing.dot(LIGHT);
        (toward * toward) as f32
    }

    /// A point along the camera's axes, relative to the middle of the scene and in units of its radius.
    fn of_scene(&self, point: DVec3) -> DVec3 {
        let offset = (point - self.middle) / self.radius;
        DVec3::new(self.right.dot(offset), self.up.dot(offset), self.backward.dot(offset))
    }

    /// A point projected to the plane at distance 1 from the eye, and one over its distance. The latter is linear over a triangle
    /// in the picture.
    fn on_plane(&self, point: DVec3) -> (DVec2, f64) {
        let point = self.of_scene(point);
        let nearness = 1.0 / (DISTANCE - point.z);
        (point.truncate() * nearness, nearness)
    }
}

/// The box around points; `None` if there are none.
fn bounds(points: impl Iterator<Item = DVec3>) -> Option<(DVec3, DVec3)> {
    points.fold(None, |bounds, point| match bounds {
        None => Some((point, point)),
        Some((low, high)) => Some((point.min(low), point.max(high))),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [960, 540];

    fn cube(center: DVec3, side: f64) -> impl Iterator<Item = DVec3> + Clone {
        let bit = |corner: u8, bit: u8| if corner & bit == 0 { -0.5 } else { 0.5 };
        (0..8u8).map(move |corner| center + side * DVec3::new(bit(corner, 1), bit(corner, 2), bit(corner, 4)))
    }

    #[test]
    fn the_whole_scene_is_in_the_picture_and_fills_it() {
        for (center, side) in [
            (DVec3::ZERO, 1.0),
            (DVec3::new(3e5, -7.0, 1e3), 1e-2),
            (DVec3::splat(1e70), 4e69),
        ] {
            for eye in EYES {
                let camera = Camera::fit(cube(center, side), eye, SIZE);
                let places = cube(center, side).map(|point| camera.triangle([point; 3])[0]);
                let (low, high) = bounds(places).unwrap();
                let margin = 0.5 * (1.0 - FILLED) * 540.0;
                assert!(low.x >= margin && high.x <= 960.0 - margin, "{low} {high}");
                assert!((low.y - margin).abs() < 1e-3, "{low} {high}");
                assert!((high.y - (540.0 - margin)).abs() < 1e-3, "{low} {high}");
            }
        }
    }

    #[test]
    fn y_is_up_x_is_to_the_right_and_what_is_nearer_has_more_nearness() {
        let camera = Camera::fit(cube(DVec3::ZERO, 1.0), DVec3::Z, SIZE);
        let [right, up, front] = camera.triangle([DVec3::X * 0.5, DVec3::Y * 0.5, DVec3::Z * 0.5]);
        let [middle, ..] = camera.triangle([DVec3::ZERO; 3]);
        assert!(right.x > middle.x && up.y < middle.y && front.z > middle.z);
    }

    #[test]
    fn a_point_is_in_the_middle_and_no_points_are_no_problem() {
        let camera = Camera::fit(std::iter::once(DVec3::ONE), DVec3::Z, SIZE);
        assert_eq!(camera.triangle([DVec3::ONE; 3])[0].truncate(), DVec2::new(480.0, 270.0));
        let camera = Camera::fit(std::iter::empty(), DVec3::Z, SIZE);
        assert!(camera.triangle([DVec3::ONE; 3])[0].is_finite());
    }

    #[test]
    fn both_sides_of_a_triangle_are_lit_as_the_side_that_is_seen() {
        let camera = Camera::fit(cube(DVec3::ZERO, 1.0), DVec3::new(0.0, 1.0, 1.0), SIZE);
        let roof = [DVec3::ZERO, DVec3::Z * 0.5, DVec3::X * 0.5];
        let [a, b, c] = roof;
        assert_eq!(camera.light(roof), camera.light([a, c, b]));
        assert!(camera.light(roof) > 0.9 * camera.light([DVec3::ZERO, DVec3::X * 0.5, DVec3::Y * 0.5]));
    }
}
