//! Turns a primitive's corners into separate triangles of the same winding.

use gltf::mesh::Mode;

/// Whether a primitive of this mode is made of triangles.
pub(super) fn is_drawn_of_triangles(mode: Mode) -> bool {
    matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
}

/// The number of triangles with `corners` corners, and whether the last one is complete.
pub(super) fn count(mode: Mode, corners: usize) -> (usize, bool) {
    match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => (0, true),
        Mode::Triangles => (corners / 3, corners.is_multiple_of(3)),
        Mode::TriangleStrip | Mode::TriangleFan => (corners.saturating_sub(2), true),
    }
}

/// The triangles of `corners` (vertex indices), without an incomplete last one.
///
/// Degenerate triangles, such as those that stitch strips together, are kept, so that a triangle's index is that of the
/// drawn one.
pub(super) fn from_corners(mode: Mode, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
        Mode::Triangles => corners.as_chunks::<3>().0.to_vec(),
        // Every second triangle of a strip has the opposite winding, so two of its corners are swapped.
        Mode::TriangleStrip => {
            let turned = |(i, window): (usize, &[u32])| match (i % 2, window) {
                (0, &[a, b, c]) => Some([a, b, c]),
                (_, &[a, b, c]) => Some([a, c, b]),
                _ => None,
            };
            corners.windows(3).enumerate().filter_map(turned).collect()
        }
        Mode::TriangleFan => {
            let Some((&hub, rim)) = corners.split_first() else {
                return Vec::new();
            };
            rim.windows(2).map(|edge| [edge[0], edge[1], hub]).collect()
        }
    }
}

/// The mode with a number; `None` if glTF does not define it.
pub(super) fn mode(mode: u32) -> Option<Mode> {
    use gltf::json::mesh::{LINE_LOOP, LINE_STRIP, LINES, POINTS, TRIANGLE_FAN, TRIANGLE_STRIP, TRIANGLES};
    Some(match mode {
        POINTS => Mode::Points,
        LINES => Mode::Lines,
        LINE_LOOP => Mode::LineLoop,
        LINE_STRIP => Mode::LineStrip,
        TRIANGLES => Mode::Triangles,
        TRIANGLE_STRIP => Mode::TriangleStrip,
        TRIANGLE_FAN => Mode::TriangleFan,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_keep_their_winding() {
        let triangles = from_corners(Mode::TriangleStrip, &[0, 1, 2, 3, 4]);
        assert_eq!(triangles, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
    }

    #[test]
    fn fans_turn_around_their_first_corner() {
        assert_eq!(from_corners(Mode::TriangleFan, &[7, 1, 2, 3]), [[1, 2, 7], [2, 3, 7]]);
    }

    #[test]
    fn too_few_corners_are_no_triangle() {
        for mode in [Mode::TriangleStrip, Mode::TriangleFan] {
            for corners in [&[][..], &[0], &[0, 1]] {
                assert!(from_corners(mode, corners).is_empty());
            }
        }
        assert_eq!(from_corners(Mode::Triangles, &[0, 1, 2, 3]), [[0, 1, 2]]);
        assert_eq!(count(Mode::Triangles, 4), (1, false));
    }

    #[test]
    fn the_count_is_that_of_the_triangles() {
        for mode in [
            Mode::Points,
            Mode::Lines,
            Mode::Triangles,
            Mode::TriangleStrip,
            Mode::TriangleFan,
        ] {
            for corners in 0..8 {
                let triangles = from_corners(mode, &vec![0; corners]);
                assert_eq!(count(mode, corners).0, triangles.len(), "{mode:?}");
            }
        }
    }
}
