//! Pictures without a graphics driver: bodies drawn by a small software rasteriser, touching triangles in red.
//!
//! ```text
//! bodies --view::Camera--> triangles in pixels --canvas::Canvas--> samples --average, square root--> PNG
//! ```
//!
//! Only additions, multiplications, divisions and square roots are used, so a picture has the same pixels on every machine.

mod canvas;
mod view;

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use canvas::Canvas;
use view::Camera;

/// Samples per pixel along each side.
const SAMPLES: usize = 2;
/// The size of a picture in pixels.
const SIZE: [usize; 2] = [960, 540];
/// The size of the small pictures used to choose the camera's direction.
const DRAFT: [usize; 2] = [240, 135];

/// Linear colours of the background at the top and at the bottom.
const BACKGROUND: [Vec3; 2] = [Vec3::new(0.90, 0.94, 0.98), Vec3::new(0.66, 0.72, 0.78)];
/// Linear colours of bodies, repeated in order.
const BODIES: [Vec3; 6] = [
    Vec3::new(0.08, 0.24, 0.46),
    Vec3::new(0.12, 0.42, 0.36),
    Vec3::new(0.62, 0.44, 0.14),
    Vec3::new(0.30, 0.18, 0.46),
    Vec3::new(0.24, 0.40, 0.10),
    Vec3::new(0.26, 0.30, 0.36),
];
/// The linear colour of touching triangles.
const TOUCHING: Vec3 = Vec3::new(0.86, 0.03, 0.02);
/// The factor by which edges of triangles are darkened.
const EDGE: f32 = 0.80;

/// A body in world space.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawnBody {
    /// Finite.
    pub(crate) vertices: Vec<DVec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// One flag per triangle.
    pub(crate) touching: Vec<bool>,
}

/// Rows of pixels from top to bottom, three bytes each.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Picture {
    size: [usize; 2],
    rgb: Vec<u8>,
}

impl Picture {
    /// Draws bodies from the direction that shows most of the touching triangles.
    pub(crate) fn draw(bodies: &[DrawnBody]) -> Self {
        let vertices = || bodies.iter().flat_map(|body| body.vertices.iter().copied());
        let red_pixels = |eye: DVec3| {
            let mut draft = Canvas::new(DRAFT, |_| Vec3::ZERO);
            let camera = Camera::fit(vertices(), eye, DRAFT);
            for (_, corners, touching) in triangles(bodies) {
                let color = if touching { Vec3::ONE } else { Vec3::ZERO };
                draft.fill(camera.triangle(corners), color, color);
            }
            draft.samples().filter(|&color| color == Vec3::ONE).count()
        };
        // The first one wins a tie (`max_by_key` keeps the last, so the order is reversed).
        let eye = view::EYES.into_iter().rev().max_by_key(|&eye| red_pixels(eye));
        let camera = Camera::fit(vertices(), eye.unwrap_or(DVec3::Z), SIZE.map(|side| side * SAMPLES));
        Self::of(&shade(bodies, &camera))
    }

    /// Averages samples and encodes them.
    fn of(canvas: &Canvas) -> Self {
        let size = canvas.size().map(|side| side / SAMPLES);
        let mut rgb = Vec::with_capacity(3 * size[0] * size[1]);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let mut sum = Vec3::ZERO;
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    sum += canvas.sample(SAMPLES * x + dx, SAMPLES * y + dy);
                }
                let mean = sum / (SAMPLES * SAMPLES) as f32;
                // The square root is close to the curve of sRGB, and exact everywhere.
                rgb.extend(mean.to_array().map(|linear| (255.0 * linear.sqrt()).round() as u8));
            }
        }
        Self { size, rgb }
    }

    /// Writes a PNG file.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub(crate) fn write_png(&self, out: &mut dyn Write) -> io::Result<()> {
        let [width, height] = self.size.map(|side| side as u32);
        let mut encoder = png::Encoder::new(out, width, height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        encoder.write_header()?.write_image_data(&self.rgb)?;
        Ok(())
    }
}

/// All triangles: body, corners, and whether it touches another. Triangles with indices out of range are skipped.
fn triangles(bodies: &[DrawnBody]) -> impl Iterator<Item = (usize, [DVec3; 3], bool)> {
    bodies.iter().enumerate().flat_map(|(index, body)| {
        let corners = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| body.vertices.get(vertex as usize).copied());
            Some([a?, b?, c?])
        };
        let touching = body.touching.iter().copied().chain(std::iter::repeat(false));
        body.triangles
            .iter()
            .zip(touching)
            .filter_map(move |(triangle, touching)| Some((index, corners(triangle)?, touching)))
    })
}

/// Draws flat-shaded triangles, lit from above the camera's left shoulder.
fn shade(bodies: &[DrawnBody], camera: &Camera) -> Canvas {
    let [top, bottom] = BACKGROUND;
    let mut canvas = Canvas::new(camera.size(), |height| top.lerp(bottom, height));
    for (body, corners, touching) in triangles(bodies) {
        let light = camera.light(corners);
        let color = if touching {
            // Light enough to be seen on every side.
            TOUCHING * (0.55 + 0.45 * light)
        } else {
            BODIES[body % BODIES.len()] * (0.25 + 1.25 * light)
        };
        let color = color.min(Vec3::ONE);
        canvas.fill(camera.triangle(corners), color, color * EDGE);
    }
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square in the plane `z`.
    fn square(z: f64, half: f64, touching: bool) -> DrawnBody {
        let corner = |x: f64, y: f64| DVec3::new(half * x, half * y, z);
        DrawnBody {
            vertices: vec![
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            touching: vec![touching; 2],
        }
    }

    fn is_red(pixel: &[u8]) -> bool {
        matches!(*pixel, [r, g, b] if r > 150 && g < 60 && b < 60)
    }

    fn red_pixels(picture: &Picture) -> usize {
        picture.rgb.chunks(3).filter(|pixel| is_red(pixel)).count()
    }

    #[test]
    fn touching_triangles_are_red_and_others_are_not() {
        let mut body = square(0.0, 1.0, false);
        assert_eq!(red_pixels(&Picture::draw(&[body.clone()])), 0);
        body.touching[1] = true;
        let half = red_pixels(&Picture::draw(&[body.clone()]));
        body.touching[0] = true;
        let whole = red_pixels(&Picture::draw(&[body]));
        let share = half as f64 / whole as f64;
        assert!(whole > 50_000 && (0.35..0.65).contains(&share), "{half} of {whole}");
    }

    #[test]
    fn the_side_is_drawn_that_shows_what_touches() {
        // Seen from the front, a large square hides the one that touches.
        for (z, wall) in [(-0.2, 0.0), (0.2, 0.0)] {
            let picture = Picture::draw(&[square(wall, 1.0, false), square(z, 0.2, true)]);
            assert!(red_pixels(&picture) > 2_000, "{}", red_pixels(&picture));
        }
    }

    #[test]
    fn bodies_have_colours_of_their_own() {
        let beside = |x: f64| {
            let mut body = square(0.0, 1.0, false);
            body.vertices.iter_mut().for_each(|vertex| vertex.x += x);
            body
        };
        let picture = Picture::draw(&[beside(-1.5), beside(1.5)]);
        let at = |x: usize| &picture.rgb[3 * (270 * 960 + x)..][..3];
        assert_ne!(at(200), at(760));
        assert_ne!(at(200), at(480), "the background is between them");
    }

    #[test]
    fn the_same_bodies_give_the_same_file() -> io::Result<()> {
        let file = || {
            let mut bytes = Vec::new();
            let bodies = [square(0.0, 1.0, false), square(0.3, 0.5, true)];
            Picture::draw(&bodies).write_png(&mut bytes).map(|()| bytes)
        };
        assert_eq!(file()?, file()?);
        Ok(())
    }

    #[test]
    fn collapsed_bodies_and_none_leave_the_background() {
        let nothing = Picture::draw(&[]);
        assert_eq!(nothing.rgb.len(), 3 * 960 * 540);
        assert_eq!(Picture::draw(&[square(0.0, 0.0, true)]), nothing);
        // Triangles with invalid indices are skipped.
        let broken = DrawnBody {
            triangles: vec![[0, 1, 9]],
            ..square(0.0, 1.0, true)
        };
        assert_eq!(Picture::draw(&[broken]), nothing);
    }
}
