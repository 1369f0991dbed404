//! How far off approximate answers are, held against the exact ones.

use std::collections::{BTreeSet, HashMap};
use std::error::Error;

use glam::{Affine3A, Vec3};
use morph_collision::{BuildOptions, PartPair, TrianglePair};
use morph_collision_testkit::bench::{Experiment, Frame};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::rivals::{BroadPhase, Method, MethodKind, Wanted};
use parry3d::math::Pose;
use parry3d::query;
use parry3d::shape::Triangle;

use super::approximate::{ApproximateMorph, Leave};

/// Pairs of triangles in near parts whose distance is measured, of a pair of bodies in a frame.
const SAMPLES: u64 = 500;

/// How far off, over all frames.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Verdict {
    /// Pairs that intersect.
    pub(super) truth: u64,
    /// Of these, in no answer.
    pub(super) missed: u64,
    /// Pairs that do not intersect and pass for it.
    pub(super) spurious: u64,
    /// The largest error found, a length.
    pub(super) found: f64,
    /// The largest that was to be expected by what the answers say of themselves.
    pub(super) promised: f64,
}

/// Judges answers over all frames.
///
/// # Errors
/// A mesh or pose that is refused, and an answer that breaks its promise.
pub(super) fn judge(experiment: &Experiment, leave: Leave) -> Result<Verdict, Box<dyn Error>> {
    let meshes = std::slice::from_ref(&experiment.mesh);
    let of_bodies = vec![0; experiment.bodies];
    let mut exact = MethodKind::Morph.set_up(meshes, &of_bodies, &BuildOptions::default())?;
    let mut approximate = ApproximateMorph::new(experiment, leave)?;
    let mut broad_phase = BroadPhase::default();
    let mut verdict = Verdict::default();
    for (frame, step) in experiment.frames.iter().zip(&experiment.steps) {
        for (body, (weights, place)) in frame.iter().enumerate() {
            exact.set_body(body, weights, place)?;
            approximate.set_body(body, weights, place)?;
            verdict.take_shape(&experiment.mesh, weights, approximate.shape_in_use(body));
        }
        let posed = Posed::new(&experiment.mesh, frame);
        for &(a, b) in broad_phase.pairs(exact.as_mut(), experiment.bodies) {
            let (a, b) = (a as usize, b as usize);
            let mut truth = Vec::new();
            exact.collide(a, b, Wanted::All, &mut truth);
            let answer = approximate.answer(a, b);
            let listed = verdict.take_pairs(&truth, &answer.touching, &answer.near, &answer.undecided);
            verdict.take_distances(&answer.near, |pair| posed.distance(a, b, pair));
            if !listed && !matches!(leave, Leave::Displacement(_)) {
                return Err(format!("{}, step {step}: a pair is missed that is in no list", experiment.name).into());
            }
        }
    }
    if verdict.found > verdict.promised * (1.0 + 1e-4) {
        let Verdict { found, promised, .. } = verdict;
        return Err(format!("{}: off by {found}, promised was {promised}", experiment.name).into());
    }
    Ok(verdict)
}

impl Verdict {
    /// A body's shape next to the one in use.
    fn take_shape(&mut self, mesh: &MorphMesh, weights: &[f32], (in_use, displacement): (&[f32], f64)) {
        self.promised = self.promised.max(displacement);
        if displacement == 0.0 {
            return;
        }
        let off = mesh.posed(weights).into_iter().zip(mesh.posed(in_use));
        let farthest = off
            .map(|(p, q)| p.as_dvec3().distance(q.as_dvec3()))
            .fold(0.0, f64::max);
        self.found = self.found.max(farthest);
    }

    /// Counts pairs; says whether each missed pair is in an undecided part.
    fn take_pairs(
        &mut self,
        truth: &[TrianglePair],
        touching: &[TrianglePair],
        near: &[PartPair],
        undecided: &[PartPair],
    ) -> bool {
        let key = |pair: &TrianglePair| (pair.triangle_a, pair.triangle_b);
        let found: BTreeSet<_> = touching.iter().map(key).collect();
        let real: BTreeSet<_> = truth.iter().map(key).collect();
        let (near_parts, open_parts) = (Parts::new(near), Parts::new(undecided));
        let (mut in_near, mut missed, mut listed) = (0, 0, true);
        for pair in real.difference(&found) {
            if near_parts.have(*pair) {
                in_near += 1;
            } else {
                missed += 1;
                listed &= open_parts.have(*pair);
            }
        }
        let passing: u64 = near.iter().map(PartPair::pair_count).sum();
        self.truth += real.len() as u64;
        self.missed += missed;
        self.spurious += passing - in_near + found.difference(&real).count() as u64;
        listed
    }

    /// Distances of some of the pairs of triangles that pass for intersecting.
    fn take_distances(&mut self, near: &[PartPair], distance: impl Fn(TrianglePair) -> f64) {
        let each = (SAMPLES / near.len().max(1) as u64).max(1);
        for parts in near {
            self.promised = self.promised.max(parts.distance);
            let stride = (parts.pair_count() / each).max(1) as usize;
            let farthest = parts.pairs().step_by(stride).map(&distance).fold(0.0, f64::max);
            self.found = self.found.max(farthest);
        }
    }
}

/// Pairs of parts, to be searched for a pair of triangles.
struct Parts<'a> {
    parts: &'a [PartPair],
    /// The parts that hold a triangle of the first body.
    of_a: HashMap<u32, Vec<usize>>,
}

impl<'a> Parts<'a> {
    fn new(parts: &'a [PartPair]) -> Self {
        let mut of_a: HashMap<u32, Vec<usize>> = HashMap::new();
        for (index, pair) in parts.iter().enumerate() {
            for &triangle in pair.a.triangles() {
                of_a.entry(triangle).or_default().push(index);
            }
        }
        Self { parts, of_a }
    }

    fn have(&self, (a, b): (u32, u32)) -> bool {
        let holding = self.of_a.get(&a).into_iter().flatten();
        holding
            .into_iter()
            .any(|&index| self.parts[index].b.triangles().contains(&b))
    }
}

/// The bodies of a frame in world space.
struct Posed<'a> {
    mesh: &'a MorphMesh,
    vertices: Vec<Vec<Vec3>>,
}

impl<'a> Posed<'a> {
    fn new(mesh: &'a MorphMesh, frame: &Frame) -> Self {
        let world = |(weights, place): &(Vec<f32>, Affine3A)| {
            let posed = mesh.posed(weights).into_iter();
            posed.map(|vertex| place.transform_point3(vertex)).collect()
        };
        Self {
            mesh,
            vertices: frame.iter().map(world).collect(),
        }
    }

    fn triangle(&self, body: usize, triangle: u32) -> Triangle {
        let [p, q, r] = self.mesh.triangles[triangle as usize].map(|vertex| self.vertices[body][vertex as usize]);
        Triangle::new(p, q, r)
    }

    /// As far as Parry can tell, which is a lower bound on what it misses.
    fn distance(&self, a: usize, b: usize, pair: TrianglePair) -> f64 {
        let (of_a, of_b) = (self.triangle(a, pair.triangle_a), self.triangle(b, pair.triangle_b));
        let measured = query::distance(&Pose::IDENTITY, &of_a, &Pose::IDENTITY, &of_b);
        measured.map_or(0.0, |measured| f64::from(measured.distance))
    }
}
