//! The mass of the volume that a surface encloses.
//!
//! Engines request the mass of every collider as soon as they get it, but use it only for dynamic bodies. For a large mesh it takes several
//! milliseconds, so otherwise it is computed over several steps, one surface after another.

use bevy::math::{DMat3, DVec3};
use morph_collision::{Pose, WorldFromModel};
use parry3d::mass_properties::MassProperties;

/// How many vertices and triangles are looked at per step. Triangles are looked at three times.
const PIECE: usize = 1 << 12;

/// How many vertices and triangles may still be looked at in a step, for all surfaces whose mass nobody depends on.
///
/// Surfaces that appear together are weighed one after another, so that a crowd takes no longer in a step than one surface.
pub struct MassBudget(usize);

impl Default for MassBudget {
    fn default() -> Self {
        Self(PIECE)
    }
}

/// A volume this small, relative to what it could be, is rounding of the vertices.
const ROUNDING: f64 = 1e-6;

/// The mass of a surface for a density of 1. It is that of the pose in which it was first requested, and does not change with the
/// pose.
#[derive(Default)]
pub(crate) enum Mass {
    #[default]
    Unknown,
    InProgress(Box<MassComputation>),
    Known(MassProperties),
}

impl Mass {
    /// The mass. Until it is known, that of nothing.
    ///
    /// `start` is called if nobody has requested it yet. `at_once` says whether someone depends on it now.
    pub(crate) fn request(&mut self, at_once: bool, start: impl FnOnce() -> Self) -> MassProperties {
        if matches!(self, Self::Unknown) {
            *self = start();
        }
        match self {
            Self::InProgress(computation) if at_once || computation.work() <= PIECE => {
                self.advance(None);
            }
            _ => {}
        }
        match self {
            Self::Known(mass) => *mass,
            _ => MassProperties::default(),
        }
    }

    /// Does as much of the work as the budget allows, or all of it. Returns whether this has made the mass known.
    pub(crate) fn advance(&mut self, budget: Option<&mut MassBudget>) -> bool {
        let Self::InProgress(computation) = self else {
            return false;
        };
        let left = computation.work() - computation.processed;
        let count = match budget {
            Some(MassBudget(budget)) => {
                let count = left.min(*budget);
                *budget -= count;
                count
            }
            None => left,
        };
        computation.process(count);
        let is_done = computation.processed == computation.work();
        if is_done {
            *self = Self::Known(computation.mass());
        }
        is_done
    }
}

/// The computation of a mass: of a pose that no longer changes. Steps are those of Parry's `MassProperties::from_trimesh`, which needs
/// all vertices at once.
pub(crate) struct MassComputation {
    pose: Pose,
    collider_from_model: WorldFromModel,
    vertices: usize,
    triangles: usize,
    /// Of `work()`.
    processed: usize,
    positions: Vec<DVec3>,
    sum_of_corners: DVec3,
    /// Signed volumes between the middle of all corners and each triangle.
    volume: f64,
    /// What the sum of their amounts would be if all triangles faced the middle.
    largest_volume: f64,
    /// Their first moments, relative to the middle of all corners.
    first_moments: DVec3,
    /// The second moments relative to the center of mass.
    second_moments: DMat3,
}

impl MassComputation {
    /// Starts with a copy of a pose, and its map to the collider.
    pub(crate) fn new(pose: &Pose, collider_from_model: &WorldFromModel) -> Self {
        let bvh = pose.bvh();
        let (vertices, triangles) = (bvh.model().vertex_count(), bvh.model().triangle_count());
        let mut copy = Pose::new(bvh.clone());
        // They come from a pose of the same tree.
        let _fits = copy.set_weights(pose.weights());
        if let Some(joints) = pose.joints() {
            let _fits = copy.set_joints(joints);
        }
        Self {
            pose: copy,
            collider_from_model: *collider_from_model,
            vertices,
            triangles,
            processed: 0,
            positions: Vec::new(),
            sum_of_corners: DVec3::ZERO,
            volume: 0.0,
            largest_volume: 0.0,
            first_moments: DVec3::ZERO,
            second_moments: DMat3::ZERO,
        }
    }

    /// How many vertices and triangles have to be looked at.
    fn work(&self) -> usize {
        self.vertices + 3 * self.triangles
    }

    /// Looks at the next vertices and triangles.
    fn process(&mut self, count: usize) {
        let end = self.work().min(self.processed + count);
        if self.processed == 0 && end > 0 {
            self.positions.reserve_exact(self.vertices);
        }
        for item in self.processed..end {
            let Some(item) = item.checked_sub(self.vertices) else {
                let vertex = self.pose.vertex(item as u32).unwrap_or_default();
                self.positions.push(self.collider_from_model.transform_point(vertex));
                continue;
            };
            let (pass, triangle) = (item / self.triangles, item % self.triangles);
            let corners = self.pose.bvh().model().triangle(triangle as u32).unwrap_or_default();
            let corners = corners.map(|vertex| self.positions[vertex as usize]);
            match pass {
                0 => self.sum_of_corners += corners.iter().sum::<DVec3>(),
                1 => self.add_volume(corners),
                _ => self.add_second_moments(corners),
            }
        }
        self.processed = end;
    }

    fn middle(&self) -> DVec3 {
        self.sum_of_corners / (3 * self.triangles) as f64
    }

    fn center_of_mass(&self) -> DVec3 {
        self.middle() + self.first_moments / self.volume
    }

    fn add_volume(&mut self, corners: [DVec3; 3]) {
        let middle = self.middle();
        let [a, b, c] = corners.map(|corner| corner - middle);
        let normal = b.cross(c);
        let volume = a.dot(normal) / 6.0;
        self.volume += volume;
        self.largest_volume += a.length() * normal.length() / 6.0;
        self.first_moments += volume / 4.0 * (a + b + c);
    }

    fn add_second_moments(&mut self, corners: [DVec3; 3]) {
        let center = self.center_of_mass();
        let [a, b, c] = corners.map(|corner| corner - center);
        let volume = a.dot(b.cross(c)) / 6.0;
        let square = |v: DVec3| DMat3::from_cols(v.x * v, v.y * v, v.z * v);
        self.second_moments += (square(a) + square(b) + square(c) + square(a + b + c)) * (volume / 20.0);
    }

    /// The result. That of nothing if the pose encloses nothing, or if the numbers are too large.
    fn mass(&self) -> MassProperties {
        let is_real = self.volume.abs() > ROUNDING * self.largest_volume;
        if !is_real {
            return MassProperties::default();
        }
        let [x, y, z] = [0, 1, 2].map(|axis| self.second_moments.col(axis));
        let inertia = DMat3::from_diagonal(DVec3::splat(x.x + y.y + z.z)) - self.second_moments;
        let (sign, center) = (self.volume.signum(), self.center_of_mass().as_vec3());
        let mass = MassProperties::with_inertia_matrix(center, (sign * self.volume) as f32, (inertia * sign).as_mat3());
        let is_finite = mass.mass().is_finite() && mass.local_com.is_finite() && mass.inv_principal_inertia.is_finite();
        if is_finite { mass } else { MassProperties::default() }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use bevy::math::{Affine3A, Vec3};
    use morph_collision::{BuildOptions, MorphBvh, MorphModel};

    use super::*;

    /// A ball, or the part of it above the equator, at half the weight of a target that stretches it.
    fn ball(rings: u32, is_open: bool) -> Pose {
        let segments = 2 * rings;
        let vertex = |ring: u32, segment: u32| {
            let latitude = (ring as f32 / rings as f32 - 0.5) * std::f32::consts::PI;
            let longitude = segment as f32 / segments as f32 * std::f32::consts::TAU;
            let (x, y) = longitude.sin_cos();
            Vec3::new(x * latitude.cos(), y * latitude.cos(), latitude.sin())
        };
        let all = (0..=rings).flat_map(|ring| (0..segments).map(move |segment| (ring, segment)));
        let positions: Vec<Vec3> = all.map(|(ring, segment)| vertex(ring, segment)).collect();
        let first = if is_open { rings / 2 } else { 0 };
        let cells = (first..rings).flat_map(|ring| (0..segments).map(move |segment| (ring, segment)));
        let triangles: Vec<[u32; 3]> = cells
            .flat_map(|(ring, segment)| {
                let at = |up: u32, on: u32| (ring + up) * segments + (segment + on) % segments;
                [[at(0, 0), at(1, 0), at(0, 1)], [at(0, 1), at(1, 0), at(1, 1)]]
            })
            .collect();
        let stretch: Vec<Vec3> = positions.iter().map(|p| Vec3::new(p.x, 0.5, p.y)).collect();
        let model = MorphModel::from_displacements(&positions, &triangles, &[stretch]).unwrap();
        let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
        pose.set_weights(&[0.5]).unwrap();
        pose
    }

    fn collider_from_model() -> WorldFromModel {
        let scaled = Affine3A::from_scale(Vec3::new(1.0, 2.0, -3.0));
        WorldFromModel::new(Affine3A::from_translation(Vec3::new(0.2, 0.1, 0.4)) * scaled).unwrap()
    }

    #[test]
    fn a_mass_is_that_of_parry() {
        for is_open in [false, true] {
            let (mut pose, collider_from_model) = (ball(20, is_open), collider_from_model());
            let mut mass = Mass::InProgress(Box::new(MassComputation::new(&pose, &collider_from_model)));
            mass.advance(None);
            let Mass::Known(mass) = mass else {
                panic!("it is known now")
            };
            let count = pose.bvh().model().triangle_count() as u32;
            let corners: Vec<Vec3> = (0..count)
                .flat_map(|triangle| pose.triangle(triangle).unwrap())
                .map(|corner| collider_from_model.transform_point(corner).as_vec3())
                .collect();
            let triangles: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
            let expected = MassProperties::from_trimesh(1.0, &corners, &triangles);
            assert!(
                (mass.mass() / expected.mass() - 1.0).abs() < 1e-4,
                "{mass:?} {expected:?}"
            );
            assert!(
                mass.local_com.distance(expected.local_com) < 1e-4,
                "{mass:?} {expected:?}"
            );
            let inertia = |mass: &MassProperties| mass.reconstruct_inertia_matrix();
            let (own, parrys) = (inertia(&mass), inertia(&expected));
            for (own, parrys) in own.to_cols_array().iter().zip(parrys.to_cols_array()) {
                assert!((own - parrys).abs() < 1e-3 * expected.mass(), "{mass:?} {expected:?}");
            }
        }
    }

    #[test]
    fn a_flat_surface_has_no_mass() {
        let corners = [
            Vec3::ZERO,
            Vec3::new(1.0, 0.3, 0.7),
            Vec3::new(0.3, 1.0, 0.1),
            Vec3::new(1.3, 1.3, 0.8),
        ];
        let model = MorphModel::from_displacements::<Vec<Vec3>>(&corners, &[[0, 1, 2], [2, 1, 3]], &[]).unwrap();
        let pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
        let mut mass = Mass::InProgress(Box::new(MassComputation::new(&pose, &WorldFromModel::IDENTITY)));
        assert!(mass.advance(None));
        assert!(matches!(mass, Mass::Known(mass) if mass == MassProperties::default()));
    }

    /// How much was looked at.
    fn processed(mass: &Mass) -> Option<usize> {
        match mass {
            Mass::InProgress(computation) => Some(computation.processed),
            _ => None,
        }
    }

    #[test]
    fn a_large_mesh_is_weighed_in_pieces() {
        let pose = ball(80, false);
        let start = || Mass::InProgress(Box::new(MassComputation::new(&pose, &collider_from_model())));
        let mut at_once = Mass::default();
        let expected = at_once.request(true, start);
        assert!(expected.mass() > 0.0 && processed(&at_once).is_none());

        let mut mass = Mass::default();
        let (mut last, mut steps) = (0, 0);
        loop {
            assert_eq!(mass.request(false, start), MassProperties::default());
            assert_eq!(processed(&mass), Some(last), "requests take no time");
            steps += 1;
            if mass.advance(Some(&mut MassBudget::default())) {
                break;
            }
            let now = processed(&mass).unwrap();
            assert!(now > last && now - last <= PIECE);
            last = now;
        }
        assert!(steps > 5, "{steps}");
        assert_eq!(mass.request(false, || panic!("it is known")), expected);
        // As soon as someone depends on it, the rest is done at once.
        let mut mass = start();
        mass.advance(Some(&mut MassBudget::default()));
        assert_eq!(mass.request(true, || panic!("it is in progress")), expected);
    }

    #[test]
    fn a_crowd_is_weighed_within_one_budget() {
        let pose = ball(80, false);
        let start = || Mass::InProgress(Box::new(MassComputation::new(&pose, &collider_from_model())));
        let expected = Mass::default().request(true, start);
        let mut crowd: [Mass; 3] = std::array::from_fn(|_| start());
        let total: usize = crowd.iter().filter_map(processed).sum();
        assert_eq!(total, 0);
        let mut steps = 0;
        while !crowd.iter().all(|mass| matches!(mass, Mass::Known(_))) {
            let before: usize = crowd.iter().filter_map(processed).sum();
            let mut budget = MassBudget::default();
            for mass in &mut crowd {
                mass.advance(Some(&mut budget));
            }
            let after: usize = crowd.iter().filter_map(processed).sum();
            assert!(after <= before + PIECE);
            steps += 1;
            assert!(steps < 1000, "it never ends");
        }
        let work = 3 * MassComputation::new(&pose, &collider_from_model()).work();
        assert_eq!(steps, work.div_ceil(PIECE));
        for mut mass in crowd {
            assert_eq!(mass.request(false, || panic!("it is known")), expected);
        }
    }

    #[test]
    fn a_small_mesh_is_weighed_when_it_is_requested() {
        let pose = ball(10, false);
        let start = || Mass::InProgress(Box::new(MassComputation::new(&pose, &collider_from_model())));
        assert!(Mass::default().request(false, start).mass() > 0.0);
    }
}
