//! The triangles of lists and strips of indices.

use super::error::ImportError;

/// Triangle `t` has the indices `3 t`, `3 t + 1` and `3 t + 2`. The error tells of an incomplete last triangle, which is left out.
pub(super) fn list_triangles(indices: &[u32]) -> (Vec<[u32; 3]>, Option<ImportError>) {
    let (triangles, rest) = indices.as_chunks::<3>();
    let incomplete = (!rest.is_empty()).then_some(ImportError::IncompleteTriangle(indices.len()));
    (triangles.to_vec(), incomplete)
}

/// The triangles of one or more strips with consistent winding, numbered in the order of the strip.
///
/// The largest index restarts the strip, as on the GPU. Triangles that use a vertex twice only connect strips and are never
/// drawn; they are left out and not numbered.
pub(super) fn strip_triangles(indices: &[u32], restart: Option<u32>) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for strip in indices.split(|&index| Some(index) == restart) {
        for (turn, corners) in strip.windows(3).enumerate() {
            let (a, b, c) = (corners[0], corners[1], corners[2]);
            if a != b && b != c && c != a {
                triangles.push(if turn.is_multiple_of(2) { [a, b, c] } else { [b, a, c] });
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_turn_one_way_restart_and_lose_their_stitches() {
        assert_eq!(strip_triangles(&[0, 1, 2, 3], Some(65535)), [[0, 1, 2], [2, 1, 3]]);
        let restarted = strip_triangles(&[0, 1, 2, 65535, 3, 4, 5], Some(65535));
        assert_eq!(restarted, [[0, 1, 2], [3, 4, 5]]);
        let stitched = strip_triangles(&[0, 1, 2, 2, 2, 3, 3, 4, 5], None);
        assert_eq!(stitched, [[0, 1, 2], [3, 4, 5]]);
    }

    #[test]
    fn a_list_ends_with_a_whole_triangle() {
        assert_eq!(list_triangles(&[5, 4, 3, 2, 1, 0]), (vec![[5, 4, 3], [2, 1, 0]], None));
        let incomplete = (vec![[0; 3]], Some(ImportError::IncompleteTriangle(5)));
        assert_eq!(list_triangles(&[0; 5]), incomplete);
    }
}
