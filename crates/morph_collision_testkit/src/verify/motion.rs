//! Compares contacts during motions with exact arithmetic.

use std::collections::BTreeMap;

use glam::{Affine3A, DVec3, Quat, Vec3, Vec3A};
use morph_collision::motion::{Features, MotionContact};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{Draw, Meshes, MotionSource, Situation};
use crate::motion::{ElementaryMotion, MotionKind, PointMotion, TouchGeometry, first_contact};
use crate::rivals::PoseError;

/// The features of the first body that are compared with all of the second's, of each kind and in each step.
const SAMPLE: usize = 12;
/// Contacts of a step whose times are checked.
const CHECKED: usize = 40;
/// More contacts than this are not listed. Then none can be missed.
const MOST: usize = 20_000;
/// The tolerance of times.
const TOLERANCE: f64 = 1e-6;

/// What a comparison of motions found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionCounts {
    /// Steps compared.
    pub steps: u64,
    /// Contacts found in them.
    pub contacts: u64,
    /// Pairs of features decided by exact arithmetic.
    pub pairs: u64,
    /// Pairs of features that touch, but were not found.
    pub missed: u64,
    /// Pairs of features that were found, but do not touch.
    pub spurious: u64,
    /// Pairs whose first contact is not within the time that was found.
    pub wrong_times: u64,
    /// Contacts with a point, normal, velocity or barycentric coordinates that do not fit the motion.
    pub wrong_geometry: u64,
}

/// What a contact claims. The vertex is the first feature.
#[must_use]
pub fn touch_geometry(contact: &MotionContact) -> TouchGeometry {
    let [a, b] = contact.barycentrics;
    let (side, barycentrics) = match contact.features {
        Features::FaceVertex { .. } => (-1.0, [b, a]),
        _ => (1.0, [a, b]),
    };
    TouchGeometry {
        time: [contact.time.earliest, contact.time.latest],
        point: contact.point,
        normal: contact.normal * side,
        velocity: contact.velocity * side,
        barycentrics,
    }
}

/// Compares contacts of two bodies that move from one random situation to another with exact arithmetic, for each tree.
///
/// A sample of the first body's features is compared with all of the second body's. So is a sample of the contacts that are found.
///
/// # Errors
/// A source refuses a situation.
pub fn verify_motion<S: MotionSource>(
    meshes: Meshes<'_>,
    sources: &mut [S],
    steps: u64,
    seed: u64,
    mut progress: impl FnMut(),
) -> Result<MotionCounts, PoseError> {
    let mut counts = MotionCounts::default();
    let mut ends: Vec<S> = sources.iter().map(S::resting).collect();
    for step in 0..steps {
        let mut rng = Pcg64Mcg::seed_from_u64(seed.rotate_left(32) ^ step);
        // Rounds without a search for what nearly touches.
        let round = 5 * step + [0, 2, 3][(step % 3) as usize];
        let Some(first) = sources.first_mut() else { break };
        let start = Draw::new(meshes, seed, round).situations(round, first)?.swap_remove(0);
        let other = Draw::new(meshes, !seed, round).situations(round, first)?.swap_remove(0);
        let end = moved(&start, other, start.sizes(meshes), &mut rng);
        let truth = Truth::new(meshes, [&start, &end], &sources[0]);
        let sample = truth.sample(&mut rng);
        counts.pairs += sample.len() as u64;
        for (source, at_end) in sources.iter_mut().zip(&mut ends) {
            source.set(&start)?;
            at_end.set(&end)?;
            let mut contacts = Vec::new();
            let is_cut = source.touching(at_end, TOLERANCE, MOST, &mut contacts)?;
            counts.steps += 1;
            counts.contacts += contacts.len() as u64;
            let found: BTreeMap<Features, &MotionContact> = contacts.iter().map(|c| (c.features, c)).collect();
            counts.spurious += (contacts.len() - found.len()) as u64;
            for &(features, touches) in &sample {
                match found.contains_key(&features) {
                    false if touches && !is_cut => counts.missed += 1,
                    true if !touches => counts.spurious += 1,
                    _ => {}
                }
            }
            for _ in 0..CHECKED.min(contacts.len()) {
                let contact = &contacts[rng.random_range(0..contacts.len())];
                counts.pairs += 1;
                let motion = truth.motion(contact.features);
                match motion
                    .as_ref()
                    .and_then(|motion| Some((motion, first_contact(motion)?)))
                {
                    None => counts.spurious += 1,
                    Some((motion, first)) => {
                        let time = contact.time;
                        let is_right =
                            first.is_within(time.earliest, time.latest) && time.latest - time.earliest <= TOLERANCE;
                        counts.wrong_times += u64::from(!is_right);
                        counts.wrong_geometry += u64::from(touch_geometry(contact).fault(motion).is_some());
                    }
                }
            }
        }
        progress();
    }
    Ok(counts)
}

/// The end of a motion: sometimes another shape, at a place nearby.
fn moved(start: &Situation, other: Situation, size: f64, rng: &mut Pcg64Mcg) -> Situation {
    let mut end = start.clone();
    if rng.random_bool(0.6) {
        (end.weights, end.joints) = (other.weights, other.joints);
    }
    let turns = rng.random_bool(0.4);
    let common = rng.random_bool(0.2);
    let mut by = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-0.5..0.5))) * size as f32;
    let (first, second) = (by(), by());
    let offsets = if common {
        [(first * 100.0).clamp(Vec3::splat(-1e30), Vec3::splat(1e30)); 2]
    } else {
        [first, second]
    };
    for (body, offset) in offsets.into_iter().enumerate() {
        let place = &mut end.places[body];
        if turns {
            let turn = Quat::from_rotation_y(0.3) * Quat::from_rotation_x(-0.2);
            let about = place.translation;
            *place = Affine3A::from_translation(about.into())
                * Affine3A::from_quat(turn)
                * Affine3A::from_translation((-about).into())
                * *place;
        }
        place.translation += Vec3A::from(offset);
    }
    end
}

/// Both bodies' vertices at both ends, and their features as the library numbers them.
struct Truth {
    bodies: [Vertices; 2],
}

struct Vertices {
    /// The motion of each welded vertex.
    motions: Vec<PointMotion>,
    /// The welded corners of each triangle.
    faces: Vec<[u32; 3]>,
}

impl Truth {
    fn new(meshes: Meshes<'_>, situations: [&Situation; 2], source: &impl MotionSource) -> Self {
        let bodies = [0, 1].map(|body| {
            let ends = situations.map(|situation| situation.world_vertices(meshes, body));
            let welded = source.welded_from_source(body);
            let count = welded.iter().max().map_or(0, |&last| last as usize + 1);
            let mut motions = vec![[[0.0; 3]; 2]; count];
            for (source, &vertex) in welded.iter().enumerate() {
                motions[vertex as usize] = [ends[0][source], ends[1][source]].map(|point: DVec3| point.to_array());
            }
            let corners = |face: &[u32; 3]| face.map(|vertex| welded[vertex as usize]);
            Vertices {
                motions,
                faces: meshes[body].triangles.iter().map(corners).collect(),
            }
        });
        Self { bodies }
    }

    fn motion(&self, features: Features) -> Option<ElementaryMotion> {
        let [a, b] = &self.bodies;
        let (kind, points) = match features {
            Features::VertexFace { vertex_a, triangle_b } => {
                (MotionKind::VertexFace, a.vertex_and(vertex_a, b, triangle_b))
            }
            Features::FaceVertex { triangle_a, vertex_b } => {
                (MotionKind::VertexFace, b.vertex_and(vertex_b, a, triangle_a))
            }
            Features::EdgeEdge { edge_a, edge_b } => {
                let ([p, q], [r, s]) = (edge_a.map(|v| a.at(v)), edge_b.map(|v| b.at(v)));
                (MotionKind::EdgeEdge, [p, q, r, s])
            }
            Features::AtStart(_) => return None,
        };
        Some(ElementaryMotion { kind, points })
    }

    /// Pairs of features whose boxes overlap during the motion, and whether they touch.
    fn sample(&self, rng: &mut Pcg64Mcg) -> Vec<(Features, bool)> {
        let [a, b] = &self.bodies;
        if a.faces.is_empty() || b.faces.is_empty() {
            return Vec::new();
        }
        let mut pairs = Vec::new();
        let mut try_pair = |features, own: &[PointMotion], other: &[PointMotion]| {
            if boxes_overlap(own, other) {
                pairs.push(features);
            }
        };
        for _ in 0..SAMPLE {
            let triangle_a = rng.random_range(0..a.faces.len()) as u32;
            let (face_a, corner) = (a.faces[triangle_a as usize], rng.random_range(0..3));
            let (vertex_a, edge_a) = (face_a[corner], ascending(face_a[corner], face_a[(corner + 1) % 3]));
            let face_points = face_a.map(|v| a.at(v));
            let edge_points = edge_a.map(|v| a.at(v));
            for (triangle_b, face_b) in b.faces.iter().enumerate() {
                let triangle_b = triangle_b as u32;
                let points = face_b.map(|v| b.at(v));
                try_pair(
                    Features::VertexFace { vertex_a, triangle_b },
                    &[a.at(vertex_a)],
                    &points,
                );
                for i in 0..3 {
                    let (vertex_b, next) = (face_b[i], face_b[(i + 1) % 3]);
                    try_pair(
                        Features::FaceVertex { triangle_a, vertex_b },
                        &[b.at(vertex_b)],
                        &face_points,
                    );
                    let edge_b = ascending(vertex_b, next);
                    if edge_a[0] != edge_a[1] && edge_b[0] != edge_b[1] {
                        try_pair(
                            Features::EdgeEdge { edge_a, edge_b },
                            &edge_points,
                            &edge_b.map(|v| b.at(v)),
                        );
                    }
                }
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        // Exact arithmetic takes a tenth of a millisecond for each.
        while pairs.len() > 4000 {
            let mut keep = 0;
            pairs.retain(|_| {
                keep += 1;
                keep % 2 == 0
            });
        }
        let touch = |features| self.motion(features).as_ref().and_then(first_contact).is_some();
        pairs.into_iter().map(|features| (features, touch(features))).collect()
    }
}

impl Vertices {
    fn at(&self, vertex: u32) -> PointMotion {
        self.motions[vertex as usize]
    }

    fn vertex_and(&self, vertex: u32, other: &Self, triangle: u32) -> [PointMotion; 4] {
        let [a, b, c] = other.faces[triangle as usize].map(|v| other.at(v));
        [self.at(vertex), a, b, c]
    }
}

fn ascending(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Whether the boxes around the whole motions of two sets of points overlap. Exact: no number is rounded.
fn boxes_overlap(a: &[PointMotion], b: &[PointMotion]) -> bool {
    let ends = |points: &[PointMotion], axis: usize| {
        let along = points.as_flattened().iter().map(|point| point[axis]);
        along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    };
    (0..3).all(|axis| {
        let ((low_a, high_a), (low_b, high_b)) = (ends(a, axis), ends(b, axis));
        low_a <= high_b && low_b <= high_a
    })
}

#[cfg(test)]
mod tests {
    use morph_collision::{BuildOptions, InputError};

    use super::super::{Answer, AnswerSource, ContainmentReport, Trees};
    use super::*;
    use morph_collision_models::generated::dolphin;

    /// Trees whose contacts are changed.
    struct Wrong {
        trees: Trees,
        change: fn(&mut Vec<MotionContact>),
    }

    impl AnswerSource for Wrong {
        fn set(&mut self, situation: &Situation) -> Result<(), PoseError> {
            self.trees.set(situation)
        }

        fn answer(&mut self) -> Answer {
            self.trees.answer()
        }

        fn touches(&mut self) -> bool {
            self.trees.touches()
        }

        fn containment(&mut self, body: usize) -> ContainmentReport {
            self.trees.containment(body)
        }
    }

    impl MotionSource for Wrong {
        fn resting(&self) -> Self {
            Self {
                trees: self.trees.at_rest(),
                change: self.change,
            }
        }

        fn touching(
            &mut self,
            end: &mut Self,
            tolerance: f64,
            most: usize,
            contacts: &mut Vec<MotionContact>,
        ) -> Result<bool, InputError> {
            let is_cut = self.trees.touching(&mut end.trees, tolerance, most, contacts)?;
            (self.change)(contacts);
            Ok(is_cut)
        }

        fn welded_from_source(&self, body: usize) -> &[u32] {
            self.trees.welded_from_source(body)
        }
    }

    fn counts(change: fn(&mut Vec<MotionContact>)) -> MotionCounts {
        let mesh = dolphin(0);
        let trees = Trees::build([&mesh, &mesh], &BuildOptions::default()).expect("a valid mesh");
        verify_motion([&mesh, &mesh], &mut [Wrong { trees, change }], 6, 3, || {}).expect("valid situations")
    }

    #[test]
    fn right_answers_are_right_and_wrong_ones_are_counted() {
        let right = counts(|_| {});
        assert!(right.contacts > 500 && right.pairs > 500, "{right:?}");
        assert_eq!(
            (right.missed, right.spurious, right.wrong_times, right.wrong_geometry),
            (0, 0, 0, 0),
            "{right:?}"
        );
        let every_other = counts(|contacts| {
            let mut is_kept = false;
            contacts.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        });
        assert!(every_other.missed > 0, "{every_other:?}");
        let late = counts(|contacts| {
            for contact in contacts {
                contact.time.earliest = contact.time.latest;
            }
        });
        assert!(late.wrong_times > 0, "{late:?}");
        let turned = counts(|contacts| {
            for contact in contacts {
                contact.normal = -contact.normal;
            }
        });
        assert!(turned.wrong_geometry > 0, "{turned:?}");
        let swapped = counts(|contacts| {
            for contact in contacts {
                if let Features::EdgeEdge { edge_a, edge_b } = contact.features {
                    let (edge_a, edge_b) = (edge_b, edge_a);
                    contact.features = Features::EdgeEdge { edge_a, edge_b };
                }
            }
        });
        assert!(swapped.spurious > 0, "{swapped:?}");
    }
}
