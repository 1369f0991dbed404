//! Draws influences and joint matrices from bytes.

use glam::{Affine3A, Mat3, Mat3A, Quat, Vec3};

use super::draw::Draw;
use morph_collision_models::mesh::{InfluenceSet, MeshSkin, MorphMesh};
use morph_collision_models::skeleton::Skeleton;

/// The most joints of a mesh.
const MOST_JOINTS: usize = 6;
/// The most influences of a vertex.
const SLOTS: usize = 16;

impl Draw<'_> {
    /// A mesh of at most 24 triangles, 14 vertices, four targets and six joints; it may not be valid.
    pub(super) fn skinned_mesh(&mut self) -> MorphMesh {
        let joints = self.among(1, MOST_JOINTS);
        let mut sets = vec![InfluenceSet::default(); self.among(1, SLOTS / 4)];
        let mut mesh = self.mesh_of(14, 24);
        for _ in &mesh.positions {
            let slots = self.influences(joints);
            for (set, slots) in sets.iter_mut().zip(slots.chunks(4)) {
                set.joints.push(std::array::from_fn(|slot| slots[slot].0));
                set.weights.push(std::array::from_fn(|slot| slots[slot].1));
            }
        }
        mesh.skin = Some(MeshSkin {
            sets,
            skeleton: Skeleton::separate(joints),
        });
        mesh
    }

    /// The influences of a vertex: one, two that sum to 1, several that almost do, or arbitrary ones.
    fn influences(&mut self, joints: usize) -> [(u16, f32); SLOTS] {
        let mut slots = [(0, 0.0); SLOTS];
        let joint = |draw: &mut Self| draw.among(0, joints - 1) as u16;
        match self.byte() % 8 {
            0..3 => slots[0] = (joint(self), 1.0),
            3 | 4 => {
                let share = f32::from(self.byte()) / 256.0;
                slots[0] = (joint(self), share);
                slots[1] = (joint(self), 1.0 - share);
            }
            5 => {
                let used = self.among(1, SLOTS);
                let parts: Vec<_> = (0..used).map(|_| (joint(self), f32::from(self.byte()) + 1.0)).collect();
                let sum: f32 = parts.iter().map(|part| part.1).sum();
                for (slot, (joint, part)) in slots.iter_mut().zip(parts) {
                    *slot = (joint, part / sum);
                }
            }
            _ => {
                for _ in 0..self.among(0, 4) {
                    slots[self.among(0, SLOTS - 1)] = (joint(self), self.number().abs().min(1000.0));
                }
            }
        }
        slots
    }

    /// Changes some or all joint matrices, arbitrarily or only a little. They may not be valid.
    pub(super) fn joints(&mut self, joints: &mut [Affine3A]) {
        match self.byte() % 8 {
            // Time passes, but nothing moves.
            0 => {}
            // The skeleton moves as a whole.
            1 => {
                let place = self.place();
                joints.iter_mut().for_each(|joint| *joint = place * *joint);
            }
            2 => {
                let joint = self.among(0, joints.len() - 1);
                joints[joint] = self.joint(joints);
            }
            _ => {
                for joint in 0..joints.len() {
                    joints[joint] = self.joint(joints);
                }
            }
        }
    }

    /// A joint's matrix, sometimes derived from an existing one.
    fn joint(&mut self, others: &[Affine3A]) -> Affine3A {
        let other = others[self.among(0, others.len() - 1)];
        match self.byte() % 12 {
            0 => Affine3A::IDENTITY,
            1 => other,
            // Off by some units in the last place.
            2 => Affine3A::from_cols_array(&other.to_cols_array().map(|entry| self.nudge(entry))),
            3 => Affine3A::from_translation(self.vector()) * other,
            // A rotation from four whole numbers.
            4 | 5 => {
                let [x, y, z, w] = [(); 4].map(|()| self.whole() as f32);
                let turn = Quat::from_xyzw(x, y, z, w);
                let turn = if turn.length_squared() > 0.0 {
                    turn.normalize()
                } else {
                    Quat::IDENTITY
                };
                Affine3A::from_rotation_translation(turn, self.vector())
            }
            6 => other * Affine3A::from_scale(self.vector()),
            // Mirrored along one of its axes.
            7 => other * Affine3A::from_scale(Vec3::ONE.with_x(-1.0)),
            8 => {
                let [x, y, z] = self.vector().to_array();
                other * Affine3A::from_mat3(Mat3::from_cols(Vec3::X, Vec3::new(x, 1.0, 0.0), Vec3::new(y, z, 1.0)))
            }
            // Scale 0.
            9 => Affine3A {
                matrix3: Mat3A::ZERO,
                translation: self.vector().into(),
            },
            // Flattened to a sheet or a line.
            10 => {
                let mut scale = Vec3::ONE;
                scale[self.among(0, 2)] = 0.0;
                scale[self.among(0, 2)] = 0.0;
                other * Affine3A::from_scale(scale)
            }
            _ => Affine3A::from_cols_array(&std::array::from_fn(|_| self.number())),
        }
    }
}
