//! Closed tubes: rings of corners between two poles. Bodies and fins are made of them.

use glam::DVec3;

/// Vertices and outward triangles of separate closed pieces, one after the other.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Pieces {
    /// Adds the tube `start`, `rings[0]`, `rings[1]`, .., `end`: `2 * corners * rings` triangles.
    ///
    /// All rings have the same number of corners and the same orientation. Either orientation works; the winding is made
    /// outward.
    pub(super) fn add_tube<const N: usize>(&mut self, start: DVec3, rings: &[[DVec3; N]], end: DVec3) {
        let first = self.positions.len() as u32;
        let corners = N as u32;
        let corner = |ring: u32, side: u32| first + 1 + ring * corners + side % corners;
        let last = first + 1 + rings.len() as u32 * corners;
        self.positions.push(start);
        self.positions.extend(rings.iter().flatten());
        self.positions.push(end);

        let begin = self.triangles.len();
        for side in 0..corners {
            self.triangles.push([first, corner(0, side), corner(0, side + 1)]);
        }
        for ring in 1..rings.len() as u32 {
            for side in 0..corners {
                let (a, b) = (corner(ring - 1, side), corner(ring - 1, side + 1));
                let (c, d) = (corner(ring, side + 1), corner(ring, side));
                self.triangles.extend([[a, d, c], [a, c, b]]);
            }
        }
        for side in 0..corners {
            let ring = rings.len() as u32 - 1;
            self.triangles.push([last, corner(ring, side + 1), corner(ring, side)]);
        }
        let added = &mut self.triangles[begin..];
        if signed_volume(&self.positions, added) < 0.0 {
            for triangle in added {
                triangle.swap(1, 2);
            }
        }
    }
}

/// The volume inside the triangles, positive if they face outward.
fn signed_volume(positions: &[DVec3], triangles: &[[u32; 3]]) -> f64 {
    let volume = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    triangles.iter().map(volume).sum()
}
