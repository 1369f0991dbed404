//! The families that need more than a few lines.

use glam::{Affine3A, Mat3, Vec3};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::Case;
use super::case::{scaled, weighted};
use super::parts::{blobs, overlapping, rotation, turned, vector, weights};
use crate::verify::Situation;
use morph_collision_models::generated::{degenerate, rigid};

/// Two bodies that touch in one face or one point, one of them then moved in or out by 1 to a million steps
/// of `f32`.
pub(super) fn last_place(rng: &mut Pcg64Mcg, index: u64) -> Case {
    let axis = rng.random_range(0..3_usize);
    let (meshes, weights, mut translation) = if index.is_multiple_of(2) {
        let [half_a, half_b] = [(); 2].map(|()| vector(rng, 0.5..=2.0));
        let mut translation = Vec3::ZERO;
        translation[axis] = half_a[axis] + half_b[axis];
        let boxes = [rigid::box_mesh(half_a), rigid::box_mesh(half_b)];
        (boxes, [Vec::new(), Vec::new()], translation)
    } else {
        let meshes = blobs(rng, 4);
        let weights = weights(rng, &meshes, -0.5..=1.0);
        let [posed_a, posed_b] = [0, 1].map(|body| meshes[body].posed(&weights[body]));
        let highest = posed_a.iter().max_by(|p, q| p[axis].total_cmp(&q[axis])).copied();
        let lowest = posed_b.iter().min_by(|p, q| p[axis].total_cmp(&q[axis])).copied();
        let translation = highest.unwrap_or_default() - lowest.unwrap_or_default();
        (meshes, weights, translation)
    };
    let places = 10.0_f32.powf(rng.random_range(0.0..=6.0)) as i32;
    let off = if rng.random_bool(0.1) {
        0
    } else if rng.random_bool(0.5) {
        places
    } else {
        -places
    };
    translation[axis] = f32::from_bits(translation[axis].to_bits().wrapping_add_signed(off));
    let mut at = [Affine3A::IDENTITY, Affine3A::from_translation(translation)];
    if rng.random_bool(0.2) {
        at.iter_mut()
            .for_each(|place| place.translation += glam::Vec3A::splat(1000.0));
    }
    let situation = Situation {
        weights,
        places: at,
        ..Situation::default()
    };
    Case { meshes, situation }
}

/// Sheets in one plane: on a common grid, or tilted together.
pub(super) fn coplanar(rng: &mut Pcg64Mcg) -> Case {
    let meshes = [0, 1].map(|_| degenerate::coplanar_sheets(rng.random(), 4));
    let mut eighths = |limit: i32| rng.random_range(-limit..=limit) as f32 / 8.0;
    let weights = [0, 1].map(|_| vec![eighths(8)]);
    let shift = Affine3A::from_translation(Vec3::new(eighths(8), eighths(8), 0.0));
    let common = match rng.random_range(0..3_i32) {
        0 => Affine3A::IDENTITY,
        1 => Affine3A::from_mat3(rotation(rng)),
        _ => Affine3A::from_translation(Vec3::new(0.0, 0.0, rng.random_range(-9.0..9.0))),
    };
    let places = [common, common * shift];
    let situation = Situation {
        weights,
        places,
        ..Situation::default()
    };
    Case { meshes, situation }
}

/// Blobs whose triangles share no vertices, with distant vertices that no triangle uses.
pub(super) fn duplicated(rng: &mut Pcg64Mcg) -> Case {
    let meshes = blobs(rng, 4).map(|blob| {
        let mut mesh = degenerate::duplicated_vertices(&blob);
        for _ in 0..rng.random_range(0..20_usize) {
            let mut wild = || vector(rng, -1e3..=1e3);
            mesh.positions.push(wild());
            mesh.targets.iter_mut().for_each(|target| target.push(wild()));
        }
        mesh
    });
    weighted(rng, meshes, -0.5..=1.0)
}

/// Pairs of targets that cancel each other, except for rounding.
pub(super) fn cancelling(rng: &mut Pcg64Mcg) -> Case {
    let strength = 10.0_f32.powf(rng.random_range(2.0..=6.0));
    let meshes = blobs(rng, 4).map(|mut mesh| {
        let targets = std::mem::take(&mut mesh.targets);
        for target in targets {
            let large: Vec<Vec3> = target.iter().map(|d| *d * strength).collect();
            let back = large.iter().zip(&target).map(|(&d, &small)| small * 0.1 - d).collect();
            mesh.targets.extend([large, back]);
        }
        mesh.target_names = (0..mesh.targets.len()).map(|k| format!("target_{k}")).collect();
        mesh
    });
    // Both targets of a pair have the same weight.
    let weights = weights(rng, &meshes, 0.1..=1.0).map(|mut weights| {
        weights
            .as_chunks_mut()
            .0
            .iter_mut()
            .for_each(|[large, back]| *back = *large);
        weights
    });
    let situation = Situation {
        weights,
        ..Situation::default()
    };
    turned(rng, meshes, situation)
}

/// Any columns: of very different lengths, or almost in one plane.
pub(super) fn any_columns(rng: &mut Pcg64Mcg) -> Mat3 {
    let [x, y, mut z] = [(); 3].map(|()| vector(rng, -1.0..=1.0));
    if rng.random_bool(0.5) {
        z = x * 0.5 - y + z * 10.0_f32.powf(rng.random_range(-9.0..=0.0));
    }
    let mut length = || 10.0_f32.powf(rng.random_range(-3.0..=3.0));
    Mat3::from_cols(x * length(), y * length(), z * length())
}

/// Subnormal models, weights and placements, separately and together.
pub(super) fn denormals(rng: &mut Pcg64Mcg, index: u64) -> Case {
    let exponent = rng.random_range(-44.0..=-37.0_f32);
    let tiny = 10.0_f32.powf(exponent);
    let small_model = index % 4 != 1;
    let Case { meshes, mut situation } = scaled(rng, if small_model { tiny } else { 1.0 });
    if index % 4 == 2 {
        situation
            .weights
            .iter_mut()
            .flatten()
            .for_each(|weight| *weight *= tiny);
    }
    if index % 4 == 1 || index % 4 == 3 {
        for place in &mut situation.places {
            *place = Affine3A::from_mat3(rotation(rng) * Mat3::from_diagonal(Vec3::splat(tiny)));
        }
    }
    overlapping(rng, meshes, situation)
}
