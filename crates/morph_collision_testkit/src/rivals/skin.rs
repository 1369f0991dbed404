//! Skinning of whole meshes, as every rival does for joints.
//!
//! World positions follow the definition, in `f64` and unfused, so that methods can be compared pair for pair. Boxes are fitted
//! to positions rounded to `f32`; the slack in comparing boxes covers that. A vertex of one joint with weight 1 uses the joint's
//! matrix directly.

use glam::{Affine3A, DVec3, Vec3, Vec3A};

use morph_collision_models::mesh::MeshSkin;

/// The influences of welded vertices, without those of weight 0.
#[derive(Debug)]
pub(super) struct WeldedSkin {
    joint_count: usize,
    influences: Vec<(u16, f32)>,
    /// `influences[starts[v]..starts[v + 1]]` are those of vertex `v`, in the order of slots.
    starts: Vec<u32>,
}

/// The columns of a joint's matrix.
type Columns = [DVec3; 4];

/// The joints of a body, and its skinned vertices.
#[derive(Clone, Debug)]
pub(super) struct SkinnedBody {
    joints: Vec<Affine3A>,
    columns: Vec<Columns>,
    /// Whether the vertices still have to be updated.
    pub(super) changed: bool,
    pub(super) world: Vec<DVec3>,
}

impl WeldedSkin {
    /// `sources` are the vertices of the mesh from which the welded ones are made.
    pub(super) fn new(skin: &MeshSkin, sources: &[usize]) -> Self {
        let mut welded = Self {
            joint_count: skin.joint_count(),
            influences: Vec::new(),
            starts: vec![0],
        };
        for &source in sources {
            let slots = skin
                .sets
                .iter()
                .flat_map(|set| set.joints[source].into_iter().zip(set.weights[source]));
            welded.influences.extend(slots.filter(|(_, weight)| *weight != 0.0));
            welded.starts.push(welded.influences.len() as u32);
        }
        welded
    }

    pub(super) fn joint_count(&self) -> usize {
        self.joint_count
    }

    pub(super) fn of(&self, vertex: usize) -> &[(u16, f32)] {
        &self.influences[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }
}

impl SkinnedBody {
    /// At rest.
    pub(super) fn new(skin: &WeldedSkin, base: &[Vec3]) -> Self {
        let joints = vec![Affine3A::IDENTITY; skin.joint_count];
        Self {
            columns: joints.iter().map(columns).collect(),
            joints,
            changed: true,
            world: base.iter().map(|p| p.as_dvec3()).collect(),
        }
    }

    /// The number of joints.
    pub(super) fn joint_count(&self) -> usize {
        self.joints.len()
    }

    /// Sets joints; their number stays the same.
    pub(super) fn set(&mut self, joints: &[Affine3A]) {
        if self.joints != joints {
            self.joints.copy_from_slice(joints);
            self.columns.clear();
            self.columns.extend(joints.iter().map(columns));
            self.changed = true;
        }
    }

    pub(super) fn joints(&self) -> &[Affine3A] {
        &self.joints
    }

    /// A vertex in world space, from its morphed position.
    #[inline]
    pub(super) fn placed(&self, skin: &WeldedSkin, vertex: usize, posed: Vec3) -> DVec3 {
        placed(skin.of(vertex), &self.columns, posed)
    }

    /// Places all vertices. Takes morphed positions and replaces them by the world positions rounded to `f32`.
    pub(super) fn place(&mut self, skin: &WeldedSkin, posed: &mut [Vec3]) {
        for (vertex, (world, posed)) in self.world.iter_mut().zip(posed).enumerate() {
            *world = placed(skin.of(vertex), &self.columns, *posed);
            *posed = world.as_vec3();
        }
        self.changed = false;
    }
}

#[inline]
fn placed(influences: &[(u16, f32)], joints: &[Columns], posed: Vec3) -> DVec3 {
    let [x, y, z, translation] = match influences {
        [(joint, 1.0)] => joints[usize::from(*joint)],
        _ => blended(influences, joints),
    };
    let p = posed.as_dvec3();
    ((x * p.x + y * p.y) + z * p.z) + translation
}

fn columns(joint: &Affine3A) -> Columns {
    let m = &joint.matrix3;
    [m.x_axis, m.y_axis, m.z_axis, joint.translation].map(Vec3A::as_dvec3)
}

#[inline]
fn blended(influences: &[(u16, f32)], joints: &[Columns]) -> Columns {
    let mut sum = [DVec3::ZERO; 4];
    for &(joint, weight) in influences {
        let weight = f64::from(weight);
        for (sum, column) in sum.iter_mut().zip(&joints[usize::from(joint)]) {
            *sum += *column * weight;
        }
    }
    sum
}
