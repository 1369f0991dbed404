//! Colour and depth samples, and drawing triangles into them.

use glam::{DVec2, DVec3, Vec3};

/// A triangle's edges are drawn fully if it is at least this many samples high, and not at all below half of that. Otherwise
/// small triangles would show nothing but their edges.
const EDGED: f64 = 30.0;
/// Width of edges on either side, in samples.
const EDGE_WIDTH: f64 = 0.8;

/// A grid of samples: a linear colour and a depth for each.
#[derive(Clone, Debug)]
pub(super) struct Canvas {
    size: [usize; 2],
    colors: Vec<Vec3>,
    nearness: Vec<f64>,
}

impl Canvas {
    /// Fills the canvas with a background that depends on the height in the picture, from 0 at the top to 1 at the bottom.
    pub(super) fn new(size: [usize; 2], background: impl Fn(f32) -> Vec3) -> Self {
        let [width, height] = size;
        let row = |y: usize| std::iter::repeat_n(background((y as f32 + 0.5) / height as f32), width);
        Self {
            size,
            colors: (0..height).flat_map(row).collect(),
            nearness: vec![f64::NEG_INFINITY; width * height],
        }
    }

    pub(super) fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The colour of a sample; `x` and `y` are within the size.
    pub(super) fn sample(&self, x: usize, y: usize) -> Vec3 {
        self.colors.get(y * self.size[0] + x).copied().unwrap_or_default()
    }

    pub(super) fn samples(&self) -> impl Iterator<Item = Vec3> {
        self.colors.iter().copied()
    }

    /// Draws a triangle in front of everything farther away. `x` points right and `y` down, in samples; larger `z` is nearer.
    ///
    /// It covers a sample if the sample's centre is inside or on an edge, whatever the winding. `edge` is the colour along its
    /// edges. Degenerate triangles cover nothing.
    pub(super) fn fill(&mut self, corners: [DVec3; 3], color: Vec3, edge: Vec3) {
        let [a, b, c] = corners.map(DVec3::truncate);
        let area = (b - a).perp_dot(c - a);
        if !(area.is_finite() && area != 0.0) {
            return;
        }
        let sides = [c - b, a - c, b - a].map(DVec2::length);
        // The height of each corner over the opposite side.
        let heights = sides.map(|side| area.abs() / side);
        let lowest = heights.into_iter().fold(f64::INFINITY, f64::min);
        let edge = color.lerp(edge, (2.0 * lowest / EDGED - 1.0).clamp(0.0, 1.0) as f32);

        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let [width, height] = self.size;
        for y in centers(low.y, high.y, height) {
            for x in centers(low.x, high.x, width) {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let parts = [
                    (c - b).perp_dot(p - b) / area,
                    (a - c).perp_dot(p - c) / area,
                    (b - a).perp_dot(p - a) / area,
                ];
                if parts.iter().any(|&part| part < 0.0) {
                    continue;
                }
                let nearness = parts[0] * corners[0].z + parts[1] * corners[1].z + parts[2] * corners[2].z;
                let sample = y * width + x;
                if nearness <= self.nearness[sample] {
                    continue;
                }
                self.nearness[sample] = nearness;
                let mut to_edges = parts.iter().zip(heights).map(|(part, height)| part * height);
                let on_edge = to_edges.any(|distance| distance < EDGE_WIDTH);
                self.colors[sample] = if on_edge { edge } else { color };
            }
        }
    }
}

/// The samples whose centres lie between two coordinates.
fn centers(low: f64, high: f64, count: usize) -> std::ops::Range<usize> {
    // Casts saturate.
    let first = (low - 0.5).ceil() as usize;
    let end = ((high - 0.5).floor() + 1.0) as usize;
    first..end.min(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RIGHT_ANGLED: [DVec3; 3] = [
        DVec3::new(0.0, 0.0, 1.0),
        DVec3::new(4.0, 0.0, 1.0),
        DVec3::new(0.0, 4.0, 1.0),
    ];

    fn canvas() -> Canvas {
        Canvas::new([6, 5], |_| Vec3::ZERO)
    }

    fn covered(canvas: &Canvas) -> Vec<(usize, usize)> {
        let all = (0..5).flat_map(|y| (0..6).map(move |x| (x, y)));
        all.filter(|&(x, y)| canvas.sample(x, y) != Vec3::ZERO).collect()
    }

    #[test]
    fn a_triangle_covers_the_samples_whose_centres_are_in_it_whichever_way_round_it_is() {
        let [a, b, c] = RIGHT_ANGLED;
        let expected: Vec<(usize, usize)> = (0..4).flat_map(|y| (0..4 - y).map(move |x| (x, y))).collect();
        for corners in [[a, b, c], [c, b, a], [b, c, a]] {
            let mut canvas = canvas();
            canvas.fill(corners, Vec3::ONE, Vec3::ONE);
            assert_eq!(covered(&canvas), expected);
        }
        let mut large = Canvas::new([100, 100], |_| Vec3::ZERO);
        large.fill(RIGHT_ANGLED.map(|corner| corner * 16.0), Vec3::ONE, Vec3::ONE);
        let covered = large.samples().filter(|&color| color == Vec3::ONE).count();
        assert_eq!(covered, (1..=64).sum::<usize>());
    }

    #[test]
    fn what_is_nearer_hides_what_is_farther_in_any_order() {
        let far = RIGHT_ANGLED;
        let near = far.map(|corner| corner + DVec3::new(1.0, 0.0, 0.5));
        for order in [[(far, Vec3::X), (near, Vec3::Y)], [(near, Vec3::Y), (far, Vec3::X)]] {
            let mut canvas = canvas();
            for (corners, color) in order {
                canvas.fill(corners, color, color);
            }
            assert_eq!(canvas.sample(0, 0), Vec3::X, "only the far one is here");
            assert_eq!(canvas.sample(1, 0), Vec3::Y, "both are here");
            assert_eq!(canvas.sample(4, 0), Vec3::Y, "only the near one is here");
        }
    }

    #[test]
    fn a_slanted_triangle_is_cut_where_another_passes_through_it() {
        let [a, b, c] = RIGHT_ANGLED;
        // `z` goes from 0 at the left to 2 at x = 4.
        let slanted = [a, b, c].map(|corner| DVec3::new(corner.x, corner.y, 0.5 * corner.x));
        let mut canvas = canvas();
        canvas.fill([a, b, c], Vec3::X, Vec3::X);
        canvas.fill(slanted, Vec3::Y, Vec3::Y);
        assert_eq!(canvas.sample(1, 0), Vec3::X);
        assert_eq!(canvas.sample(2, 0), Vec3::Y);
    }

    #[test]
    fn edges_show_on_large_triangles_only() {
        for (side, shown) in [(100.0, true), (12.0, false)] {
            let mut canvas = Canvas::new([120, 120], |_| Vec3::ZERO);
            canvas.fill(RIGHT_ANGLED.map(|corner| corner * side / 4.0), Vec3::X, Vec3::Y);
            assert_eq!(canvas.sample(4, 0) == Vec3::Y, shown);
            assert_eq!(canvas.sample(3, 3), Vec3::X);
        }
    }

    #[test]
    fn nothing_is_drawn_outside_or_of_what_has_no_area() {
        let mut canvas = canvas();
        canvas.fill(
            RIGHT_ANGLED.map(|corner| corner - DVec3::splat(9.0)),
            Vec3::ONE,
            Vec3::ONE,
        );
        canvas.fill(RIGHT_ANGLED.map(|corner| corner * DVec3::X), Vec3::ONE, Vec3::ONE);
        canvas.fill([DVec3::NAN, DVec3::X, DVec3::Y], Vec3::ONE, Vec3::ONE);
        assert!(covered(&canvas).is_empty());
        canvas.fill(RIGHT_ANGLED.map(|corner| corner * 1e6 - 10.0), Vec3::ONE, Vec3::ONE);
        assert_eq!(covered(&canvas).len(), 30);
    }
}
