//! Turns a primitive's corners into separate triangles of the same winding.

use gltf::mesh::Mode;

/// Whether a primitive of this mode is made of triangles.
pub(super) fn is_drawn_of_triangles(mode: Mode) -> bool {
    matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)
}

/// The number of triangles with `corners` corners; `None` if a list of separate triangles ends in the middle of one.
pub(super) fn count(mode: Mode, corners: usize) -> Option<usize> {
    match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Some(0),
        Mode::Triangles => corners.is_multiple_of(3).then_some(corners / 3),
        Mode::TriangleStrip | Mode::TriangleFan => Some(corners.saturating_sub(2)),
    }
}

/// The triangles of `corners` (vertex indices); `None` if a list of separate triangles ends in the middle of one.
///
/// Degenerate triangles, such as those that stitch strips together, are kept, so that a triangle's index is that of the
/// drawn one.
pub(super) fn from_corners(mode: Mode, corners: &[u32]) -> Option<Vec<[u32; 3]>> {
    match mode {
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Some(Vec::new()),
        Mode::Triangles => {
            let (triangles, rest) = corners.as_chunks::<3>();
            rest.is_empty().then(|| triangles.to_vec())
        }
        // Every second triangle of a strip has the opposite winding, so two of its corners are swapped.
        Mode::TriangleStrip => {
            let turned = |(i, window): (usize, &[u32])| match (i % 2, window) {
                (0, &[a, b, c]) => Some([a, b, c]),
                (_, &[a, b, c]) => Some([a, c, b]),
                _ => None,
            };
            Some(corners.windows(3).enumerate().filter_map(turned).collect())
        }
        Mode::TriangleFan => {
            let Some((&hub, rim)) = corners.split_first() else {
                return Some(Vec::new());
            };
            Some(rim.windows(2).map(|edge| [edge[0], edge[1], hub]).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_keep_their_winding() {
        let triangles = from_corners(Mode::TriangleStrip, &[0, 1, 2, 3, 4]);
        assert_eq!(triangles, Some(vec![[0, 1, 2], [1, 3, 2], [2, 3, 4]]));
    }

    #[test]
    fn fans_turn_around_their_first_corner() {
        assert_eq!(
            from_corners(Mode::TriangleFan, &[7, 1, 2, 3]),
            Some(vec![[1, 2, 7], [2, 3, 7]])
        );
    }

    #[test]
    fn too_few_corners_are_no_triangle() {
        for mode in [Mode::TriangleStrip, Mode::TriangleFan] {
            for corners in [&[][..], &[0], &[0, 1]] {
                assert_eq!(from_corners(mode, corners), Some(Vec::new()));
            }
        }
        assert_eq!(from_corners(Mode::Triangles, &[0, 1, 2, 3]), None);
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
                assert_eq!(
                    count(mode, corners),
                    triangles.map(|triangles| triangles.len()),
                    "{mode:?}"
                );
            }
        }
    }
}
