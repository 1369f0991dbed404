//! What works without physics.
//!
//! Every answer is asked for after the upper side has moved from 0.5 to 1.5, and most of them also before. What is seen where it was before does
//! not work.

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityPlugin;
use bevy::ecs::message::MessageCursor;
use bevy::ecs::system::{RunSystemOnce, SystemParam};
use bevy::picking::backend::PointerHits;
use bevy::picking::backend::ray::{RayId, RayMap};
use bevy::picking::pointer::PointerId;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_workspace::app::headless;

use super::Feature;
use super::kinds::{Kind, Subject};
use crate::log::start;
use crate::skins::put;
use crate::support::{Edits, Messages, add_mesh, app, assets, diagnostics, settle, touches};

const fn feature(name: &'static str, works: fn(Kind) -> bool) -> Feature {
    Feature { name, works }
}

pub(super) const FEATURES: [Feature; 24] = [
    feature("contact with a mesh", |kind| meets(kind, small_cube)),
    feature("contact with a `MorphShape`", |kind| meets(kind, small_ball)),
    feature("contact points with depths (`MorphCollisionMode::Contacts`)", |kind| {
        let collider = MorphCollider::new(MorphCollisionMode::Contacts);
        let (mut subject, other) = stage(kind, collider, small_cube);
        let subject_is = subject.collider;
        let contact = subject.stretched(1.0).contact(subject_is, other);
        contact.is_some_and(|contact| !contact.points.is_empty())
    }),
    feature("`margin`", margin),
    feature("`tolerance`", tolerance),
    feature("continuous collision (`continuous`)", continuous),
    feature("several colliders as one body (`MorphColliderOf`)", body),
    feature("layers", layers),
    feature("hooks (`MorphCollisionHooks`)", hooks),
    feature("`MorphSelfCollisions`", self_collisions),
    feature("rays", |kind| {
        heights(kind, |spatial, _| {
            let hit = spatial.cast_ray(ABOVE, Dir3::NEG_Y, 9.0, &any())?;
            Some(hit.point.y)
        })
    }),
    feature("batches of rays (`cast_rays`)", |kind| {
        heights(kind, |spatial, _| {
            let mut hits = vec![];
            spatial.cast_rays(&[Ray3d::new(ABOVE, Dir3::NEG_Y); 2], 9.0, &any(), &mut hits);
            Some(hits.pop()??.point.y)
        })
    }),
    feature("casts of shapes", |kind| {
        heights(kind, |spatial, _| {
            let ball = MorphShape::Ball { radius: 0.1 };
            let hit = spatial.cast_shape(&ball, ABOVE, Quat::IDENTITY, Dir3::NEG_Y, 9.0, &any())?;
            Some(hit.point.y)
        })
    }),
    feature("casts of shapes that turn (`cast_moving_shape`)", |kind| {
        heights(kind, |spatial, _| {
            let half_extents = Vec3::splat(0.1);
            let motion = MorphShapeMotion {
                translation: Vec3::NEG_Y * 9.0,
                pivot: ABOVE,
                rotation: Vec3::Y,
            };
            let cuboid = MorphShape::Cuboid { half_extents };
            let hit = spatial.cast_moving_shape(&cuboid, ABOVE, Quat::IDENTITY, &motion, &any())?;
            Some(hit.point.y)
        })
    }),
    feature("closest point of a collider (`project_point`)", |kind| {
        heights(kind, |spatial, _| {
            Some(spatial.project_point(ABOVE, 9.0, &any())?.point.y)
        })
    }),
    feature("colliders that contain a point", |kind| {
        finds(kind, |spatial, _| {
            spatial.point_intersections(Vec3::new(0.1, 1.2, 0.2), &any()).len() == 1
        })
    }),
    feature("colliders that touch a shape", |kind| {
        finds(kind, |spatial, _| {
            let ball = MorphShape::Ball { radius: 0.1 };
            let place = Vec3::new(0.1, 1.5, 0.2);
            spatial.shape_intersections(&ball, place, Quat::IDENTITY, &any()).len() == 1
        })
    }),
    feature("closest points and contacts of two colliders", |kind| {
        let (mut subject, other) = stage(kind, MorphCollider::default(), small_cube);
        let collider = subject.collider;
        let ask = move |spatial: MorphSpatialQuery| {
            let closest = spatial
                .closest_points(collider, other, 9.0)
                .map(|closest| closest.distance);
            (closest, spatial.contacts(collider, other).is_some())
        };
        let before = subject.app.world_mut().run_system_once(ask).unwrap();
        let after = subject.stretched(1.0).world_mut().run_system_once(ask).unwrap();
        before.0.is_some_and(|gap| (gap - 0.9).abs() < 1e-4) && !before.1 && after == (Some(0.0), true)
    }),
    feature("velocity of the surface", velocity),
    feature("`MorphRayCaster` and `MorphShapeCaster`", casters),
    feature("picking", picking),
    feature("`MorphSurfaceAnchor`", anchor),
    feature(
        "culling by the posed box (`MorphBoundsPlugin`, or Bevy's for rigid meshes)",
        culling,
    ),
    feature("rollback (`MorphCollisionState`)", rollback),
];

/// Above the subject, not in its middle.
const ABOVE: Vec3 = Vec3::new(0.1, 5.0, 0.2);

fn any() -> MorphQueryFilter {
    MorphQueryFilter::default()
}

/// A small cube where the upper side will be.
fn small_cube(app: &mut App) -> Entity {
    let mesh = add_mesh(app, &rigid::box_mesh(Vec3::splat(0.1)));
    let place = Transform::from_xyz(0.1, 1.5, 0.2);
    app.spawn((Mesh3d(mesh), place, MorphCollider::default()))
}

fn small_ball(app: &mut App) -> Entity {
    app.spawn((MorphShape::Ball { radius: 0.1 }, Transform::from_xyz(0.1, 1.5, 0.2)))
}

/// A subject with some components, and something else.
fn stage(kind: Kind, more: impl Bundle, other: fn(&mut App) -> Entity) -> (Subject, Entity) {
    let mut subject = Subject::new(kind, app(), (MorphCollider::default(), ()));
    subject.app.insert(subject.collider, more);
    let other = other(&mut subject.app);
    settle(&mut subject.app);
    (subject, other)
}

fn meets(kind: Kind, other: fn(&mut App) -> Entity) -> bool {
    let (mut subject, other) = stage(kind, (), other);
    let collider = subject.collider;
    assert!(!touches(&subject.app, collider, other), "it is 0.9 away");
    touches(subject.stretched(1.0), collider, other)
}

/// Whether a query finds the subject only when it is stretched.
fn finds(kind: Kind, ask: fn(&MorphSpatialQuery, Entity) -> bool) -> bool {
    let mut subject = Subject::new(kind, app(), MorphCollider::default());
    let collider = subject.collider;
    let ask = move |spatial: MorphSpatialQuery| ask(&spatial, collider);
    let before = subject.app.world_mut().run_system_once(ask).unwrap();
    let after = subject.stretched(1.0).world_mut().run_system_once(ask).unwrap();
    !before && after
}

/// Whether a query finds the height of the upper side.
fn heights(kind: Kind, ask: fn(&MorphSpatialQuery, Entity) -> Option<f32>) -> bool {
    let mut subject = Subject::new(kind, app(), MorphCollider::default());
    let collider = subject.collider;
    let ask = move |spatial: MorphSpatialQuery| ask(&spatial, collider);
    let before = subject.app.world_mut().run_system_once(ask).unwrap();
    let after = subject.stretched(1.0).world_mut().run_system_once(ask).unwrap();
    let is = |height: Option<f32>, expected: f32| height.is_some_and(|height| (height - expected).abs() < 1e-4);
    is(before, 0.5) && is(after, 1.5)
}

fn margin(kind: Kind) -> bool {
    let (mut subject, other) = stage(kind, MorphCollider::default().with_margin(0.2), small_cube);
    let collider = subject.collider;
    let far = touches(subject.stretched(0.6), collider, other);
    !far && touches(subject.stretched(0.8), collider, other)
}

fn tolerance(kind: Kind) -> bool {
    let (mut subject, other) = stage(kind, MorphCollider::default().with_tolerance(0.2), small_cube);
    let collider = subject.collider;
    let first = touches(subject.stretched(1.0), collider, other);
    let held = diagnostics(subject.stretched(1.05)).skipped_unchanged == 1;
    first && held && !touches(subject.stretched(3.0), collider, other)
}

fn continuous(kind: Kind) -> bool {
    // It is above the other one at the end of the frame, or around it.
    let (mut subject, other) = stage(kind, MorphCollider::default().with_continuous(true), small_cube);
    let mut messages = Messages::default();
    messages.read(&subject.app);
    let (starts, _) = messages.read(subject.stretched(3.0));
    // The upper side moves by 3, and the other one is 0.9 away.
    let is_then = |start: &MorphCollisionStart| {
        let (pair, latest) = (
            (start.collider1, start.collider2),
            start.impact.map(|impact| impact.latest),
        );
        let is_pair = [(subject.collider, other), (other, subject.collider)].contains(&pair);
        is_pair && latest.is_some_and(|latest| (latest - 0.3).abs() < 1e-3)
    };
    starts.len() == 1 && starts.iter().all(is_then)
}

fn body(kind: Kind) -> bool {
    // Both in one body do not meet, and the body meets a third one.
    let (mut subject, hand) = stage(kind, (), small_cube);
    let body = subject.app.spawn(Transform::default());
    for collider in [subject.collider, hand] {
        subject.app.insert(collider, MorphColliderOf { body });
    }
    let other = small_cube(&mut subject.app);
    put(&mut subject.app, hand, Transform::from_xyz(-0.1, 1.5, -0.2));
    settle(&mut subject.app);
    let collider = subject.collider;
    let collisions = subject.stretched(1.0).world().resource::<MorphCollisions>();
    collisions.contains_bodies(body, other) && !collisions.contains(collider, hand)
}

fn layers(kind: Kind) -> bool {
    let meets = |theirs: u32| {
        let (mut subject, other) = stage(kind, MorphCollisionLayers::new(1, 2), small_cube);
        subject.app.insert(other, MorphCollisionLayers::new(theirs, u32::MAX));
        let collider = subject.collider;
        touches(subject.stretched(1.0), collider, other)
    };
    meets(2) && !meets(4)
}

/// Refuses all pairs unless it is told otherwise.
#[derive(SystemParam)]
struct Refusing<'w> {
    accepts: Option<Res<'w, Accepts>>,
}

#[derive(Resource)]
struct Accepts;

impl MorphCollisionHooks for Refusing<'_> {
    fn filter_pairs(&self, _: &MorphCandidatePair, _: &mut Commands) -> bool {
        self.accepts.is_some()
    }
}

fn hooks(kind: Kind) -> bool {
    let meets = |accepts: bool| {
        let mut app = headless(&assets());
        app.add_plugins(MorphCollisionHooksPlugin::<Refusing>::default());
        start(&mut app);
        if accepts {
            app.insert_resource(Accepts);
        }
        let asks = (MorphCollider::default(), MorphActiveCollisionHooks::FILTER_PAIRS);
        let mut subject = Subject::new(kind, app, asks);
        let other = small_cube(&mut subject.app);
        settle(&mut subject.app);
        let collider = subject.collider;
        touches(subject.stretched(1.0), collider, other)
    };
    meets(true) && !meets(false)
}

fn self_collisions(kind: Kind) -> bool {
    let list = (MorphCollider::default(), MorphSelfCollisions::default());
    let mut subject = Subject::with_plate(kind, app(), Some(2.0), list);
    let collider = subject.collider;
    let regions = |app: &App| {
        let list = app.world().get::<MorphSelfCollisions>(collider);
        list.is_some_and(|list| !list.regions().is_empty())
    };
    let before = regions(&subject.app);
    !before && regions(subject.stretched(1.5))
}

fn velocity(kind: Kind) -> bool {
    let mut subject = Subject::new(kind, app(), MorphCollider::default());
    subject.app.update();
    let ask = |spatial: MorphSpatialQuery| {
        let hit = spatial.cast_ray(ABOVE, Dir3::NEG_Y, 9.0, &any())?;
        hit.velocity(&spatial)
    };
    let found = subject.stretched(0.1).world_mut().run_system_once(ask).unwrap();
    found.is_some_and(|velocity| velocity.distance(Vec3::Y * 6.0) < 1e-2)
}

fn casters(kind: Kind) -> bool {
    let mut subject = Subject::new(kind, app(), MorphCollider::default());
    let ray = MorphRayCaster::new(Vec3::ZERO, Dir3::NEG_Y);
    let shape = MorphShapeCaster::new(MorphShape::Ball { radius: 0.1 }, Vec3::ZERO, Dir3::NEG_Y);
    let caster = subject.app.spawn((ray, shape, Transform::from_translation(ABOVE)));
    let height = |app: &App| {
        let entity = app.world().entity(caster);
        let ray = entity.get::<MorphRayHits>()?.first()?.point.y;
        let shape = entity.get::<MorphShapeHits>()?.first()?.point.y;
        Some([ray, shape])
    };
    let is = |found: Option<[f32; 2]>, height: f32| {
        found.is_some_and(|found| found.iter().all(|found| (found - height).abs() < 1e-4))
    };
    subject.app.update();
    let before = is(height(&subject.app), 0.5);
    before && is(height(subject.stretched(1.0)), 1.5)
}

fn picking(kind: Kind) -> bool {
    let mut app = headless(&assets());
    app.init_resource::<RayMap>()
        .add_message::<PointerHits>()
        .add_plugins(MorphPickingPlugin);
    start(&mut app);
    let camera = app.spawn(Camera::default());
    let mut subject = Subject::new(kind, app, MorphCollider::default());
    let id = RayId::new(camera, PointerId::Mouse);
    let ray = Ray3d::new(ABOVE, Dir3::NEG_Y);
    subject.app.world_mut().resource_mut::<RayMap>().map.insert(id, ray);
    // Picking sees what the last frame drew.
    subject.stretched(1.0);
    let mut hits = MessageCursor::<PointerHits>::default();
    let read = |app: &App, hits: &mut MessageCursor<PointerHits>| -> Vec<f32> {
        let messages = hits.read(app.world().resource());
        let picks = messages.flat_map(|message| &message.picks);
        picks.map(|(_, hit)| hit.depth).collect()
    };
    read(&subject.app, &mut hits);
    subject.app.update();
    read(&subject.app, &mut hits) == [3.5]
}

fn anchor(kind: Kind) -> bool {
    let mut subject = Subject::new(kind, app(), MorphCollider::default());
    let ray = |spatial: MorphSpatialQuery| spatial.cast_ray(ABOVE, Dir3::NEG_Y, 9.0, &any());
    let hit = subject.app.world_mut().run_system_once(ray).unwrap();
    let hat = subject
        .app
        .spawn(MorphSurfaceAnchor::at(&hit.expect("all kinds are hit")));
    let height = |app: &App| {
        app.world()
            .get::<GlobalTransform>(hat)
            .map(|place| place.translation().y)
    };
    height(subject.stretched(1.0)).is_some_and(|height| (height - 1.5).abs() < 1e-4)
}

fn culling(kind: Kind) -> bool {
    let mut app = headless(&assets());
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    let mut subject = Subject::new(kind, app, ());
    let collider = subject.collider;
    let top = |app: &App| {
        let place = app.world().get::<GlobalTransform>(collider)?;
        Some(place.transform_point(app.world().get::<Aabb>(collider)?.max().into()).y)
    };
    subject.app.update();
    let before = top(&subject.app);
    subject.stretched(1.0);
    subject.app.update();
    let is = |top: Option<f32>, expected: f32| top.is_some_and(|top| (top - expected).abs() < 1e-3);
    is(before, 0.5) && is(top(&subject.app), 1.5)
}

fn rollback(kind: Kind) -> bool {
    let (mut subject, other) = stage(kind, (), small_cube);
    let collider = subject.collider;
    subject.stretched(1.0);
    MorphCollisionState::save(subject.app.world_mut());
    subject.stretched(3.0);
    let gone = !touches(&subject.app, collider, other);
    let mut messages = Messages::default();
    messages.read(&subject.app);
    subject.stretch(1.0);
    MorphCollisionState::restore(subject.app.world_mut());
    let back = touches(&subject.app, collider, other);
    // Nothing has ended in between.
    subject.app.update();
    let (starts, ends) = messages.read(&subject.app);
    gone && back && starts.is_empty() && ends.is_empty()
}
