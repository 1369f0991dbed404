//! Draws numbers, meshes and options from bytes, biased towards difficult cases.

use arbitrary::Unstructured;
use glam::{Affine3A, Vec3};
use morph_collision::BuildOptions;

use morph_collision_models::mesh::MorphMesh;

/// Bytes that are read as choices. After their end, every choice is the first one.
pub(super) struct Draw<'a>(Unstructured<'a>);

impl<'a> Draw<'a> {
    pub(super) fn new(data: &'a [u8]) -> Self {
        Self(Unstructured::new(data))
    }

    pub(super) fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or(0)
    }

    pub(super) fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    /// A number from `from` to `to`, inclusive.
    pub(super) fn among(&mut self, from: usize, to: usize) -> usize {
        self.0.int_in_range(from..=to).unwrap_or(from)
    }

    /// A small whole number.
    pub(super) fn whole(&mut self) -> i32 {
        i32::from(self.byte() as i8) / 16
    }

    pub(super) fn signed(&mut self) -> i16 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// The number moved some units in the last place away from zero or towards it; zero stays.
    pub(super) fn nudge(&mut self, value: f32) -> f32 {
        nudged(value, i32::from(self.byte() as i8))
    }

    fn bits(&mut self) -> u32 {
        self.0.arbitrary().unwrap_or(0)
    }

    pub(super) fn bits64(&mut self) -> u64 {
        self.0.arbitrary().unwrap_or(0)
    }

    /// Any `f32`, mostly from a coarse grid on which coincidences are common.
    pub(super) fn number(&mut self) -> f32 {
        match self.byte() % 10 {
            0..4 => self.whole() as f32 / 4.0,
            4 | 5 => f32::from(self.signed()) / 256.0,
            6 => self.whole() as f32 * 2_f32.powi(i32::from(self.byte() as i8)),
            7 | 8 => {
                let value = self.whole() as f32 / 4.0;
                self.nudge(value)
            }
            _ => f32::from_bits(self.bits()),
        }
    }

    pub(super) fn vector(&mut self) -> Vec3 {
        Vec3::from_array(std::array::from_fn(|_| self.number()))
    }

    /// A mesh of at most six triangles, eight vertices and four targets; it may not be valid.
    pub(super) fn mesh(&mut self) -> MorphMesh {
        self.mesh_of(8, 6)
    }

    /// A mesh of at most this many vertices and triangles, and four targets; it may not be valid.
    pub(super) fn mesh_of(&mut self, vertices: usize, triangles: usize) -> MorphMesh {
        let vertices = self.among(1, vertices);
        let positions = (0..vertices).map(|_| self.vector()).collect();
        let triangles =
            (0..self.among(1, triangles)).map(|_| std::array::from_fn(|_| self.among(0, vertices - 1) as u32));
        let mut mesh = MorphMesh::rigid("fuzz", positions, triangles.collect());
        for _ in 0..self.among(0, 4) {
            let displacement = |draw: &mut Self| if draw.flag() { draw.vector() } else { Vec3::ZERO };
            mesh.targets.push((0..vertices).map(|_| displacement(self)).collect());
        }
        mesh
    }

    pub(super) fn weights(&mut self, targets: usize) -> Vec<f32> {
        (0..targets).map(|_| self.number()).collect()
    }

    /// A translation, a placement along axes, or any affine.
    pub(super) fn place(&mut self) -> Affine3A {
        match self.byte() % 4 {
            0 => Affine3A::from_translation(self.vector()),
            1 => Affine3A::from_translation(self.vector()) * Affine3A::from_scale(self.vector()),
            _ => Affine3A::from_cols_array(&std::array::from_fn(|_| self.number())),
        }
    }

    pub(super) fn options(&mut self) -> BuildOptions {
        BuildOptions::default()
            .with_leaf_size(self.among(1, 9))
            .expect("1 to 9 are leaf sizes")
    }
}

/// A number moved some units in the last place away from zero or towards it; zero stays.
fn nudged(value: f32, by: i32) -> f32 {
    if value == 0.0 {
        return value;
    }
    f32::from_bits(value.to_bits().wrapping_add_signed(by))
}
