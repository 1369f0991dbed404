//! Midpoint subdivision: every triangle becomes four, and the shape stays the same.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

/// A point with a midpoint operation, in single or double precision.
pub(super) trait Point: Copy {
    fn middle(self, other: Self) -> Self;
}

impl Point for Vec3 {
    fn middle(self, other: Self) -> Self {
        (self + other) * 0.5
    }
}

impl Point for DVec3 {
    fn middle(self, other: Self) -> Self {
        (self + other) * 0.5
    }
}

/// Splits every edge in the middle, in all references alike, `levels` times.
///
/// Triangle `t` becomes the triangles `4t .. 4t + 4`: first its three corners, then its middle. Old vertices keep their
/// indices.
pub(super) fn midpoint<P: Point>(references: &mut [Vec<P>], triangles: &mut Vec<[u32; 3]>, levels: u32) {
    for _ in 0..levels {
        split(references, triangles);
    }
}

fn split<P: Point>(references: &mut [Vec<P>], triangles: &mut Vec<[u32; 3]>) {
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let mut next = references.first().map_or(0, |positions| positions.len() as u32);
    let mut finer = Vec::with_capacity(triangles.len() * 4);
    for &[a, b, c] in triangles.iter() {
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                for positions in references.iter_mut() {
                    positions.push(positions[a as usize].middle(positions[b as usize]));
                }
                next += 1;
                next - 1
            })
        };
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    *triangles = finer;
}
