//! Passes bad input to the functions that take numbers of skins.

use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{BuildOptions, JointMatrices, MorphBvh, Pose};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::door::refused;
use morph_collision_models::generated::rigs::tube;
use morph_collision_models::mesh::InfluenceSet;

/// Number of doors.
pub(super) const DOORS: u64 = 5;

/// Passes bad input to a door.
pub(super) fn knock(door: u64, rng: &mut Pcg64Mcg, bad: f32) -> Result<(), String> {
    const JOINTS: usize = 4;
    let mut mesh = tube(rng.random(), JOINTS, 3, 1);
    let slot = rng.random_range(0..4_usize);
    let names = |what: &str| format!("vertex 7, influence {slot}: {what}");
    match door % DOORS {
        0 => {
            let bad = [bad, -1.0, 1001.0][rng.random_range(0..3_usize)];
            set(&mut mesh)?.weights[7][slot] = bad;
            refused(mesh.to_model(), &[&names("the weight of joint")])
        }
        1 => {
            let set = set(&mut mesh)?;
            (set.joints[7][slot], set.weights[7][slot]) = (JOINTS as u16, 0.25);
            refused(mesh.to_model(), &[&names("joint 4 is out of range")])
        }
        2 => {
            set(&mut mesh)?.weights.truncate(9);
            refused(mesh.to_model(), &["weights of influences 0", "9 vertices"])
        }
        3 => {
            let (joint, entry) = (rng.random_range(0..JOINTS), rng.random_range(0..12_usize));
            let mut entries = Affine3A::IDENTITY.to_cols_array();
            entries[entry] = [bad, 2e34][rng.random_range(0..2_usize)];
            let mut joints = [Affine3A::IDENTITY; JOINTS];
            joints[joint] = Affine3A::from_cols_array(&entries);
            let vector = ["x axis", "y axis", "z axis", "translation"][entry / 3];
            let names = format!("joint {joint}: {vector}: coordinate {}", entry % 3);
            refused(JointMatrices::new(&joints), &[&names])
        }
        _ => {
            let model = mesh.to_model().map_err(|error| error.to_string())?;
            let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
            let others = JointMatrices::new(&[Affine3A::IDENTITY; JOINTS + 1]).map_err(|error| error.to_string())?;
            refused(pose.set_joints(&others), &["5 joints were given, 4 are needed"])
        }
    }
}

fn set(mesh: &mut morph_collision_models::mesh::MorphMesh) -> Result<&mut InfluenceSet, String> {
    let set = mesh.skin.as_mut().and_then(|skin| skin.sets.first_mut());
    set.ok_or_else(|| "a tube has influences".to_owned())
}
