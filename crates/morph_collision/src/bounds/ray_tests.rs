//! Tests of rays against boxes.

use glam::{Affine3A, DVec3, Vec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::{
    Aabb, Box64, BoxLanes, Kernel, Keys, LANES, LocalRay, LowerBounds, ModelPlane, PlacedBounds, RayCull,
    WorldFromModel, levels, with_simd,
};

/// Where the ray may enter boxes, at the earliest: the least limits at which they are not skipped. NaN for boxes that are always skipped.
fn bounds_of(place: &WorldFromModel, origin: DVec3, direction: DVec3, boxes: &BoxLanes) -> [f64; LANES] {
    let body = PlacedBounds::new(place, DVec3::splat(8.0));
    let cull = RayCull::new(LocalRay::new(origin, direction, &body).as_ref(), &body);
    let within = |limit: f64| {
        with_simd!(Kernel::default().level, simd => {
            cull.lower_bounds(simd, boxes, u8::MAX, cull.key(limit), &mut Keys::default())
        })
    };
    std::array::from_fn(|lane| {
        let is_within = |limit: f64| within(limit) >> lane & 1 == 1;
        if !is_within(f64::INFINITY) {
            return f64::NAN;
        }
        let (mut skipped, mut kept) = (0.0, 64.0);
        if is_within(skipped) {
            return skipped;
        }
        for _ in 0..64 {
            let middle = 0.5 * (skipped + kept);
            *(if is_within(middle) { &mut kept } else { &mut skipped }) = middle;
        }
        kept
    })
}

#[test]
fn boxes_of_infinite_size_are_never_skipped() {
    let infinite = Aabb::UNBOUNDED;
    let mut boxes = BoxLanes::default();
    boxes.set_all(&infinite);
    let turn = Affine3A::from_axis_angle(Vec3::new(0.6, 0.0, 0.8), 1.0);
    for place in [Affine3A::IDENTITY, turn, Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))] {
        let place = WorldFromModel::new(place).expect("finite");
        // Infinite boxes make bodies infinite.
        for magnitude in [DVec3::INFINITY, DVec3::ONE] {
            let body = PlacedBounds::new(&place, magnitude);
            for direction in [DVec3::X, DVec3::new(0.3, -1.0, 0.5)] {
                let local = LocalRay::new(DVec3::new(1e39, 0.0, 1.0), direction, &body);
                let cull = RayCull::new(local.as_ref(), &body);
                for &level in levels() {
                    let mut keys = [f32::NAN; LANES];
                    let within = with_simd!(level, simd => {
                        cull.lower_bounds(simd, &boxes, u8::MAX, cull.key(0.0), &mut keys)
                    });
                    assert_eq!(within, u8::MAX, "{place:?} {magnitude} {direction}");
                    assert!(keys.into_iter().all(|key| key <= cull.key(0.0)), "{keys:?}");
                }
            }
            let plane = ModelPlane::new(DVec3::X, -1e300, &body);
            assert!(plane.reaches(&Box64::of(&infinite)), "{place:?} {magnitude}");
        }
    }
}

#[test]
fn a_box_around_a_point_of_the_ray_is_entered_before_and_a_small_one_hardly_before() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for case in 0..4000 {
        let mut vector = |reach: f64| DVec3::from_array(std::array::from_fn(|_| rng.random_range(-reach..reach)));
        let turn = Affine3A::from_axis_angle(vector(1.0).normalize().as_vec3(), 1.0);
        let (mut origin, mut direction) = (vector(4.0), vector(1.0));
        let is_flat = case % 4 == 0;
        match case % 5 {
            0 => direction.y = 0.0,
            1 => direction.y = f64::from_bits(1),
            _ => {}
        }
        // A transform without an inverse, so boxes are mapped to world space. The ray is in its plane.
        let place = if is_flat {
            (origin.y, direction.y) = (0.0, 0.0);
            Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0))
        } else {
            turn
        };
        let place = WorldFromModel::new(place).expect("finite");
        let t = f64::from(case) / 1000.0;
        let world = origin + t * direction;
        let model = if is_flat {
            world
        } else {
            place.linear().inverse() * world
        };
        let mut boxes = BoxLanes::default();
        for lane in 0..LANES {
            let size = [1e-5, 0.5, 3.0][lane % 3];
            let (min, max) = ((model - size).as_vec3(), (model + size).as_vec3());
            boxes.set(lane, &Aabb { min, max });
        }
        let bounds = bounds_of(&place, origin, direction, &boxes);
        for (lane, bound) in bounds.into_iter().enumerate() {
            let size = [1e-5, 0.5, 3.0][lane % 3];
            let earliest = (t - 4.0 * size / direction.length()).max(0.0);
            assert!((earliest..=t).contains(&bound), "case {case}, lane {lane}: {bound} {t}");
        }
    }
}

#[test]
fn boxes_beside_and_behind_the_ray_are_skipped_and_touched_ones_are_not() {
    let unit = Aabb {
        min: Vec3::NEG_ONE,
        max: Vec3::ONE,
    };
    let mut boxes = BoxLanes::default();
    boxes.set_all(&unit);
    let bound = |origin, direction| bounds_of(&WorldFromModel::IDENTITY, origin, direction, &boxes)[5];
    for beside in [1.1, -1.1] {
        assert!(bound(DVec3::new(-3.0, beside, 0.0), DVec3::X).is_nan());
    }
    for touched in [1.0, -1.0] {
        let bound = bound(DVec3::new(-3.0, touched, 0.0), DVec3::X);
        assert!((1.999..=2.0).contains(&bound), "{bound}");
    }
    assert!(bound(DVec3::new(3.0, 0.0, 0.0), DVec3::X).is_nan());
    assert_eq!(bound(DVec3::ZERO, DVec3::new(0.3, -1.0, 0.2)), 0.0);
    // Flat boxes in a plane through the origin have no slack there.
    boxes.set_all(&Aabb {
        min: Vec3::new(1.0, 0.0, -1.0),
        max: Vec3::new(2.0, 0.0, 1.0),
    });
    let flat = bounds_of(&WorldFromModel::IDENTITY, DVec3::ZERO, DVec3::X, &boxes);
    assert!((0.999..=1.0).contains(&flat[0]), "{flat:?}");
    // A ray that is almost parallel to them.
    let slow = DVec3::new(1.0, f64::from_bits(1), 0.0);
    let flat = bounds_of(&WorldFromModel::IDENTITY, DVec3::ZERO, slow, &boxes);
    assert!((0.999..=1.0).contains(&flat[0]), "{flat:?}");
}
