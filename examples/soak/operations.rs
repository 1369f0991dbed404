//! Random changes that a game might make.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::actors::{Kind, Plays};
use crate::game::Game;
use crate::stage::Stage;

/// Anchors and casters at once.
const PROPS: usize = 6;

/// One random change.
pub(crate) fn operate(game: &mut Game, stage: &mut Stage) {
    match game.rng.random_range(0..30) {
        0..=1 => game.spawn(stage, Kind::Character),
        2..=4 => game.spawn(stage, Kind::Dolphin),
        5..=6 => game.spawn(stage, Kind::Blob),
        7..=8 => game.spawn(stage, Kind::Body),
        9..=10 => game.spawn(stage, Kind::Shape),
        11..=14 => despawn(game, stage),
        15..=17 => park(game, stage),
        18 => play(game, stage),
        19..=20 => add_prop(game, stage),
        operation => change(game, stage, operation),
    }
}

fn one_of<T: Clone>(rng: &mut Pcg64Mcg, things: &[T]) -> Option<T> {
    (!things.is_empty()).then(|| things[rng.random_range(0..things.len())].clone())
}

/// An actor other than the hill, which is the first one.
fn actor(game: &mut Game) -> Option<usize> {
    (game.actors.len() > 1).then(|| game.rng.random_range(1..game.actors.len()))
}

fn despawn(game: &mut Game, stage: &mut Stage) {
    if let Some(actor) = actor(game) {
        let actor = game.actors.remove(actor);
        stage.app.world_mut().despawn(actor.root);
    }
}

/// Lets an actor rest where it is, or go on. Its clip stops too.
fn park(game: &mut Game, stage: &mut Stage) {
    let Some(actor) = one_of(&mut game.rng, &Vec::from_iter(0..game.actors.len())) else {
        return;
    };
    let actor = &mut game.actors[actor];
    actor.is_parked ^= true;
    if let Some(mut plays) = stage.app.world_mut().get_mut::<Plays>(actor.root) {
        plays.is_paused = actor.is_parked;
    }
}

/// Another clip, from another time.
fn play(game: &mut Game, stage: &mut Stage) {
    let Some(actor) = one_of(&mut game.rng, &Vec::from_iter(0..game.actors.len())) else {
        return;
    };
    let actor = &game.actors[actor];
    let Some(model) = actor.kind.model() else { return };
    let Some(mut clip) = one_of(&mut game.rng, &stage.models[model].clips) else {
        return;
    };
    clip.from = game.rng.random_range(0.0..1.0);
    clip.is_paused = actor.is_parked;
    stage.app.world_mut().entity_mut(actor.root).insert(clip);
}

/// Something on a collider's surface, or something that casts a ray or a shape in every run.
fn add_prop(game: &mut Game, stage: &mut Stage) {
    if game.props.len() >= PROPS {
        let prop = game.props.remove(0);
        stage.app.world_mut().despawn(prop);
    }
    let Some(collider) = one_of(&mut game.rng, &colliders(stage.app.world_mut())) else {
        return;
    };
    let (rng, world) = (&mut game.rng, stage.app.world_mut());
    let mut along = || rng.random_range(-1.5..1.5_f32);
    let place = Transform::from_xyz(along(), 3.0, along());
    let prop = match rng.random_range(0..3) {
        0 => {
            let triangle = rng.random_range(0..64);
            let middle = Vec3::splat(1.0 / 3.0);
            world.spawn(MorphSurfaceAnchor::new(collider, triangle, middle))
        }
        1 => world.spawn((place, MorphRayCaster::new(Vec3::ZERO, Dir3::NEG_Y))),
        _ => {
            let ball = MorphShape::Ball { radius: 0.2 };
            world.spawn((place, MorphShapeCaster::new(ball, Vec3::ZERO, Dir3::NEG_Y)))
        }
    };
    game.props.push(prop.id());
}

/// All colliders, also disabled ones.
fn colliders(world: &mut World) -> Vec<Entity> {
    let mut colliders = world.query_filtered::<Entity, (With<MorphCollider>, Allow<Disabled>)>();
    let mut colliders: Vec<Entity> = colliders.iter(world).collect();
    colliders.sort_unstable();
    colliders
}

/// Adds, changes or removes a component of a collider.
fn change(game: &mut Game, stage: &mut Stage, operation: u32) {
    let (rng, world) = (&mut game.rng, stage.app.world_mut());
    let Some(collider) = one_of(rng, &colliders(world)) else {
        return;
    };
    game.counts.changed_components += 1;
    match operation {
        21..=22 => {
            use MorphCollisionMode::{All, Contacts, First, Passive};
            let modes = [First, First, All, Contacts, Passive];
            let mode = modes[rng.random_range(0..modes.len())];
            let (margin, tolerance) = (rng.random_range(0..2), rng.random_range(0..3));
            let mut settings = MorphCollider::new(mode)
                .with_margin(0.02 * margin as f32)
                .with_tolerance(0.01 * tolerance as f32);
            settings.continuous = rng.random_bool(0.3);
            world.entity_mut(collider).insert(settings);
        }
        23 => {
            let layers = [1, 3, 7];
            let mut layer = || layers[rng.random_range(0..layers.len())];
            let layers = MorphCollisionLayers::new(layer(), layer());
            world.entity_mut(collider).insert(layers);
        }
        24..=25 => toggle::<MorphColliderDisabled>(world, collider),
        26 => toggle::<Disabled>(world, collider),
        27 => toggle::<MorphSelfCollisions>(world, collider),
        28 => {
            let limits = [5, 8192];
            let limit = limits[rng.random_range(0..limits.len())];
            world.resource_mut::<MorphCollisionSettings>().max_triangle_pairs = limit;
        }
        _ => {
            if let Some(actor) = actor(game) {
                let root = game.actors[actor].root;
                stage.app.world_mut().entity_mut(root).insert(MorphTeleported);
            }
        }
    }
}

fn toggle<C: Component + Default>(world: &mut World, entity: Entity) {
    let mut entity = world.entity_mut(entity);
    match entity.contains::<C>() {
        true => entity.remove::<C>(),
        false => entity.insert(C::default()),
    };
}
