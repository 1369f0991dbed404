//! Compares the filter of patches with the oracle: it rejects no intersecting pair, accepts no pair that is apart, and leaves few
//! pairs undecided.

use std::ops::ControlFlow;

use fearless_simd::Level;
use glam::{Affine3A, DVec3, Mat3A, Vec3, Vec3A};
use morph_collision_testkit::near_degenerate::Family;
use morph_collision_testkit::oracle;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{Patch, Row};
use crate::bounds::{LANES, WorldFromModel, levels, with_simd};
use crate::exact::Triangle;
use crate::query::two_bodies::Neighbourhood;
use crate::tree::{in_lanes, put};

/// One to eight triangles in model space, and their transform.
struct PlacedTriangles {
    posed: Vec<[Vec3; 3]>,
    world_from_model: WorldFromModel,
}

impl PlacedTriangles {
    fn patch(&self, level: Level, neighbourhood: &Neighbourhood) -> Patch {
        let mut patch = Patch::default();
        for (lane, corners) in in_lanes(&self.posed) {
            for (corner, point) in corners.into_iter().enumerate() {
                put(&mut patch.corners, lane, corner, point);
            }
        }
        with_simd!(level, simd => {
            neighbourhood.placement(&self.world_from_model).place(simd, &mut patch.corners);
            patch.measure(simd, self.posed.len());
        });
        patch
    }

    /// The corners in world space as `docs/numerics.md` defines them, three per triangle.
    fn world(&self) -> Vec<DVec3> {
        let (m, t) = (self.world_from_model.linear(), self.world_from_model.translation());
        let placed = |p: DVec3| {
            DVec3::from_array(std::array::from_fn(|row| {
                ((m.x_axis[row] * p.x + m.y_axis[row] * p.y) + m.z_axis[row] * p.z) + t[row]
            }))
        };
        self.posed.iter().flatten().map(|p| placed(p.as_dvec3())).collect()
    }
}

/// The triangle pairs of two patches: one row per triangle of the first, one bit per triangle of the second.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Pairs {
    near: [u8; LANES],
    meet: [u8; LANES],
}

/// Counts pairs by whether they intersect and by what the filter says.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    intersecting: usize,
    apart: usize,
    turned_away: usize,
    /// Intersecting pairs that the filter accepts.
    met: usize,
}

impl Tally {
    /// Compares every pair of triangles. All kernels must agree, and must say nothing wrong.
    fn judge(&mut self, a: &PlacedTriangles, b: &PlacedTriangles, neighbourhood: &Neighbourhood, about: &str) {
        let mut first = None;
        for &level in levels() {
            let (patch_a, patch_b) = (a.patch(level, neighbourhood), b.patch(level, neighbourhood));
            let mut pairs = Pairs::default();
            let found = |row: Row| {
                assert!(row.near != 0, "{about}");
                (pairs.near[row.lane], pairs.meet[row.lane]) = (row.near, row.meet);
                ControlFlow::Continue(())
            };
            let flow = with_simd!(level, simd => {
                let masks = patch_a.overlaps(simd, &patch_b);
                patch_a.compare(simd, &patch_b, masks, |_, near| near, found)
            });
            assert!(flow.is_continue());
            assert_eq!(*first.get_or_insert(pairs), pairs, "{about}: kernels differ");
        }
        let pairs = first.unwrap_or_default();
        let (world_a, world_b) = (a.world(), b.world());
        let intersecting = oracle::intersecting_pairs(&world_a, &numbered(a), &world_b, &numbered(b));
        for i in 0..LANES {
            for j in 0..LANES {
                let [near, meets] = [pairs.near, pairs.meet].map(|rows| rows[i] >> j & 1 == 1);
                assert!(near || !meets, "{about}: {i} and {j}");
                if i >= a.posed.len() || j >= b.posed.len() {
                    assert!(!near, "{about}: {i} and {j}, of which one is no triangle");
                } else if intersecting.binary_search(&(i as u32, j as u32)).is_ok() {
                    self.intersecting += 1;
                    assert!(near, "{about}: {i} and {j} intersect and are turned away");
                    self.met += usize::from(meets);
                } else {
                    assert!(!meets, "{about}: {i} and {j} are apart and said to meet");
                    self.apart += 1;
                    self.turned_away += usize::from(!near);
                }
            }
        }
    }

    fn share(&self) -> f64 {
        self.turned_away as f64 / self.apart as f64
    }
}

/// The corners of each triangle as indices into [`PlacedTriangles::world`].
fn numbered(placed: &PlacedTriangles) -> Vec<[u32; 3]> {
    (0..placed.posed.len() as u32)
        .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
        .collect()
}

fn vector(rng: &mut Pcg64Mcg) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}

/// A power of two with an exponent from `-most` to `most`.
fn power(rng: &mut Pcg64Mcg, most: i32) -> f32 {
    2_f32.powi(rng.random_range(-most..=most))
}

/// A random linear map: ordinary, mirrored, strongly sheared, flattened, or the identity.
fn linear(rng: &mut Pcg64Mcg) -> Mat3A {
    let columns = || -> [Vec3; 3] { [Vec3::X, Vec3::Y, Vec3::Z] };
    let [x, y, z] = match rng.random_range(0..9) {
        0 => columns(),
        1 => columns().map(|_| vector(rng)),
        2 => [Vec3::X, Vec3::NEG_Y, Vec3::Z],
        3 => columns().map(|axis| -axis + vector(rng) * 0.5),
        4 => [Vec3::X, Vec3::X * 1000.0 + Vec3::Y, vector(rng)],
        5 => columns().map(|axis| axis * rng.random_range(1e-6..1.0)),
        6 => [vector(rng), vector(rng), Vec3::ZERO],
        7 => [vector(rng); 3],
        _ => columns().map(|axis| axis * power(rng, 20)),
    };
    Mat3A::from_cols(x.into(), y.into(), z.into())
}

fn world_from(linear: Mat3A, translation: DVec3) -> WorldFromModel {
    let place = Affine3A {
        matrix3: linear,
        translation: Vec3A::ZERO,
    };
    let place = WorldFromModel::new(place).unwrap();
    place.at(place.translation() + translation)
}

/// A neighbourhood for bodies of about a size in world space; its size and origin are wrong about half the time.
fn neighbourhood(rng: &mut Pcg64Mcg, near: DVec3, size: f64) -> Neighbourhood {
    let size = size
        * match rng.random_range(0..6) {
            0..3 => 1.0,
            3 => 1e6,
            4 => 1e-6,
            _ => 10_f64.powf(rng.random_range(-12.0..12.0)),
        };
    let origin = match rng.random_range(0..4) {
        0 | 1 => near,
        2 => DVec3::ZERO,
        _ => near + vector(rng).as_dvec3() * size * 1e6,
    };
    Neighbourhood::new(origin, size)
}

/// The same triangles, rotated and scaled in model space without rounding; the transform undoes it.
fn turned(rng: &mut Pcg64Mcg, posed: &[[Vec3; 3]], linear: Mat3A, translation: DVec3) -> PlacedTriangles {
    let scale = power(rng, 6);
    let first = rng.random_range(0..3_usize);
    let signs: [f32; 3] = std::array::from_fn(|_| if rng.random_bool(0.5) { 1.0 } else { -1.0 });
    let axes = [first, (first + 1) % 3, (first + 2) % 3];
    let turn = |p: Vec3| Vec3::from_array(std::array::from_fn(|i| p[axes[i]] * signs[i] * scale));
    let column = |i: usize| linear.col(axes[i]) * (signs[i] / scale);
    PlacedTriangles {
        posed: posed.iter().map(|triangle| triangle.map(turn)).collect(),
        world_from_model: world_from(Mat3A::from_cols(column(0), column(1), column(2)), translation),
    }
}

/// Up to eight pairs of a family, as two nearby patches of a given size. Some are far from their model's origin.
fn situation(rng: &mut Pcg64Mcg, family: Family, size: f32) -> ([PlacedTriangles; 2], Neighbourhood) {
    let linear = linear(rng);
    let shift = if rng.random_bool(0.3) {
        (vector(rng) * 1e6).round()
    } else {
        Vec3::ZERO
    };
    let pairs: Vec<_> = (0..rng.random_range(1..=LANES)).map(|_| family.pair(rng)).collect();
    let mut posed = [0, 1].map(|side| -> Vec<[Vec3; 3]> {
        let corners = |pair: &[Triangle; 2]| pair[side].map(|p| p.as_vec3() + shift);
        pairs.iter().map(corners).collect()
    });
    // Within the limits of a pose, also after `turned`.
    let reach = posed
        .iter()
        .flatten()
        .flatten()
        .fold(1.0, |reach, p| p.abs().max_element().max(reach));
    let size = size.min(1e37 / 64.0 / reach);
    let stretch = [linear.x_axis, linear.y_axis, linear.z_axis].map(Vec3A::length);
    let world_size = f64::from(size) * f64::from(stretch.into_iter().fold(0.0, f32::max));
    let translation = match rng.random_range(0..3) {
        0 => DVec3::ZERO,
        1 => vector(rng).as_dvec3() * world_size,
        _ => vector(rng).as_dvec3() * world_size * 1e6,
    };
    for point in posed.iter_mut().flatten().flatten() {
        *point *= size;
    }
    let [posed, mut others] = posed;
    // Patches of different lengths.
    others.truncate(rng.random_range(1..=LANES));
    let b = turned(rng, &others, linear, translation);
    let a = PlacedTriangles {
        posed,
        world_from_model: world_from(linear, translation),
    };
    let near = a.world_from_model.transform_point(a.posed[0][0]);
    let near = if rng.random_bool(0.5) { near } else { translation };
    let neighbourhood = neighbourhood(rng, near, world_size);
    ([a, b], neighbourhood)
}

fn judge_families(seed: u64, cases: usize, mut size: impl FnMut(&mut Pcg64Mcg) -> f32) {
    for family in Family::ALL {
        let mut rng = Pcg64Mcg::seed_from_u64(seed);
        let mut tally = Tally::default();
        for case in 0..cases {
            let size = size(&mut rng);
            let ([a, b], neighbourhood) = situation(&mut rng, family, size);
            let about = format!("{}, case {case}, size {size}", family.name());
            tally.judge(&a, &b, &neighbourhood, &about);
            tally.judge(&b, &a, &neighbourhood, &about);
        }
        println!("{}: {tally:?}", family.name());
        assert!(tally.intersecting > cases && tally.turned_away > cases, "{tally:?}");
    }
}

#[test]
fn no_intersecting_pair_is_turned_away_about_size_one() {
    judge_families(1, 400, |_| 1.0);
}

#[test]
fn no_intersecting_pair_is_turned_away_from_tiny_to_huge() {
    judge_families(2, 400, |rng| 10_f32.powf(rng.random_range(-30.0..30.0)));
}

#[test]
fn triangles_of_all_sizes_in_one_patch_are_turned_away_only_where_they_are_apart() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    let mut tally = Tally::default();
    for case in 0..2000 {
        let mut posed = || -> Vec<[Vec3; 3]> {
            (0..rng.random_range(1..=LANES))
                .map(|_| {
                    let size = power(&mut rng, 12);
                    let start = vector(&mut rng) * size * rng.random_range(0.0..0.5);
                    std::array::from_fn(|_| start + vector(&mut rng) * size)
                })
                .collect()
        };
        let [a, b] = [posed(), posed()].map(|posed| PlacedTriangles {
            posed,
            world_from_model: WorldFromModel::IDENTITY,
        });
        let size = f64::from(power(&mut rng, 20));
        let neighbourhood = neighbourhood(&mut rng, DVec3::ZERO, size);
        tally.judge(&a, &b, &neighbourhood, &format!("case {case}"));
    }
    println!("{tally:?}");
    assert!(tally.intersecting > 1000 && tally.turned_away > 1000, "{tally:?}");
}

#[test]
fn places_at_the_ends_of_f32_turn_nothing_away_that_intersects() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let mut tally = Tally::default();
    for case in 0..300 {
        let family = Family::ALL[case % Family::ALL.len()];
        let scale = if case % 2 == 0 { f32::MAX } else { f32::MIN_POSITIVE };
        let size = [1e-45_f32, 1e-38, 1.0, 1e23][rng.random_range(0..4_usize)];
        let world_from_model = world_from(Mat3A::from_diagonal(Vec3::splat(scale)), DVec3::ZERO);
        let mut posed = [Vec::new(), Vec::new()];
        for _ in 0..4 {
            for (posed, triangle) in posed.iter_mut().zip(family.pair(&mut rng)) {
                posed.push(triangle.map(|p| p.as_vec3() * size));
            }
        }
        let [a, b] = posed.map(|posed| PlacedTriangles {
            posed,
            world_from_model,
        });
        for neighbourhood_size in [0.0, 5e-324, 1e-300, 1e-38, 1.0, 1e38, 1e300, f64::MAX, f64::INFINITY] {
            let origin = vector(&mut rng).as_dvec3() * f64::from(f32::MAX);
            for origin in [DVec3::ZERO, origin] {
                let neighbourhood = Neighbourhood::new(origin, neighbourhood_size);
                tally.judge(&a, &b, &neighbourhood, &format!("case {case}, {neighbourhood_size}"));
            }
        }
    }
    assert!(tally.intersecting > 1000, "{tally:?}");
}

#[test]
fn beyond_the_range_of_f32_products_only_boxes_turn_away() {
    // Boxes overlap, but the planes are far apart for their size.
    let low = [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 1.0)];
    let high = low.map(|p| p + Vec3::new(0.0, -0.25, 0.25));
    let [a, b] = [low, high].map(|triangle| PlacedTriangles {
        posed: vec![triangle],
        world_from_model: WorldFromModel::IDENTITY,
    });
    let mut turned_away = |size: f64| {
        let mut tally = Tally::default();
        tally.judge(&a, &b, &Neighbourhood::new(DVec3::ZERO, size), "");
        tally.turned_away
    };
    assert_eq!([1.0, 1e-5, 1e-7, 1e-60].map(&mut turned_away), [1, 1, 0, 0]);
}

#[test]
fn every_number_of_triangles_has_rows_and_bits_of_its_own() {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let through: Vec<[Vec3; 3]> = (0..LANES)
        .map(|_| [Vec3::NEG_Z, Vec3::Z, Vec3::X + vector(&mut rng) * 0.1])
        .collect();
    for level in levels() {
        for of_a in 1..=LANES {
            for of_b in 1..=LANES {
                let [a, b] = [of_a, of_b].map(|count| {
                    let placed = PlacedTriangles {
                        posed: through[..count].to_vec(),
                        world_from_model: WorldFromModel::IDENTITY,
                    };
                    placed.patch(*level, &Neighbourhood::default())
                });
                let mut near = [0; LANES];
                let found = |row: Row| {
                    near[row.lane] = row.near;
                    ControlFlow::Continue(())
                };
                let flow = with_simd!(*level, simd => {
                    let masks = a.overlaps(simd, &b);
                    a.compare(simd, &b, masks, |_, near| near, found)
                });
                assert!(flow.is_continue());
                let all = u8::MAX >> (LANES - of_b);
                let expected: [u8; LANES] = std::array::from_fn(|i| if i < of_a { all } else { 0 });
                assert_eq!(near, expected, "{of_a} and {of_b}");
            }
        }
    }
}

/// Judges eight triangles at a time, in the neighbourhood that a query would choose.
fn judge_all(a: &[[Vec3; 3]], b: &[[Vec3; 3]]) -> Tally {
    let mut tally = Tally::default();
    let neighbourhood = Neighbourhood::new(DVec3::ZERO, 2.0);
    let world_from_model = WorldFromModel::IDENTITY;
    for a in a.chunks(LANES).map(<[_]>::to_vec) {
        let a = PlacedTriangles {
            posed: a,
            world_from_model,
        };
        for b in b.chunks(LANES).map(<[_]>::to_vec) {
            tally.judge(
                &a,
                &PlacedTriangles {
                    posed: b,
                    world_from_model,
                },
                &neighbourhood,
                "",
            );
        }
    }
    tally
}

#[test]
fn nearly_all_random_triangles_are_decided() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    let mut soup = || -> Vec<[Vec3; 3]> { (0..200).map(|_| std::array::from_fn(|_| vector(&mut rng))).collect() };
    let tally = judge_all(&soup(), &soup());
    println!("random triangles: {:.5} of {tally:?}", tally.share());
    assert!(tally.intersecting > 1000 && tally.share() > 0.999, "{tally:?}");
    assert!(tally.met as f64 > 0.99 * tally.intersecting as f64, "{tally:?}");
}

#[test]
fn nearly_all_pairs_of_two_surfaces_that_are_apart_are_turned_away() {
    // Two interpenetrating waves; the boxes of nearby triangles overlap.
    let sheet = |phase: f32, lift: f32| -> Vec<[Vec3; 3]> {
        const CELLS: usize = 10;
        let point = |i: usize, j: usize| {
            let (x, y) = (i as f32 * 0.1 - 0.5, j as f32 * 0.1 - 0.5);
            Vec3::new(x, y, lift + 0.1 * (3.0 * x + phase).sin() * (2.0 * y + phase).cos())
        };
        (0..CELLS * CELLS)
            .flat_map(|cell| {
                let (i, j) = (cell / CELLS, cell % CELLS);
                let [p, q, r, s] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                [[p, q, r], [p, r, s]]
            })
            .collect()
    };
    let mut near = Tally::default();
    for lift in [0.0, 0.001, 0.01] {
        let (a, b) = (sheet(0.0, 0.0), sheet(0.3, lift));
        // Count only pairs whose boxes overlap.
        for a in &a {
            let hull = |t: &[Vec3; 3]| crate::bounds::Aabb::from_points(*t);
            let b: Vec<_> = b.iter().copied().filter(|b| hull(a).overlaps(&hull(b))).collect();
            let tally = judge_all(&[*a], &b);
            near.intersecting += tally.intersecting;
            near.apart += tally.apart;
            near.turned_away += tally.turned_away;
            near.met += tally.met;
        }
    }
    println!("two surfaces: {:.5} of {near:?}", near.share());
    assert!(near.intersecting > 100 && near.apart > 1000, "{near:?}");
    assert!(near.share() > 0.999, "{near:?}");
}
