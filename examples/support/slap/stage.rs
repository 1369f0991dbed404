//! Draws the slaps: lines along the ways of the hands, marks where they hit, and colours.

use bevy::ecs::entity::EntityHashMap;
use bevy::gizmos::config::{DefaultGizmoConfigGroup, GizmoConfigStore};
use bevy::prelude::*;

use super::{Mark, Moment, Role, Side, TICK, Tally};
use crate::app::STEP;
use crate::view::clock::{Clock, Pending};
use crate::view::stage::Notes;

/// The joint whose way is drawn: where the fingers begin.
const KNUCKLE: &str = "middle_01_r";

/// Keeps the game's time, and draws.
pub fn plugin(app: &mut App) {
    app.add_systems(Startup, bring_ways_to_front)
        .add_systems(PreUpdate, keep_time)
        .add_systems(Update, (wait, color, draw_marks, write_notes))
        .add_systems(PostUpdate, draw_ways.after(TransformSystems::Propagate));
}

/// Waits until the models are there.
fn wait(roots: Query<Entity, Added<Role>>, mut commands: Commands) {
    for root in &roots {
        commands.entity(root).insert(Pending);
    }
}

fn keep_time(clock: Res<Clock>, mut moment: ResMut<Moment>) {
    let now = Moment {
        tick: (clock.frame * STEP.as_secs_f64() / TICK.as_secs_f64() + 1e-3) as u32,
        started: clock.started,
    };
    moment.set_if_neq(now);
}

/// Colours for the one who slaps, and the one who is slapped.
fn color(
    drawn: Query<(Entity, &MeshMaterial3d<StandardMaterial>), Added<MeshMaterial3d<StandardMaterial>>>,
    roots: Query<&Role>,
    parents: Query<&ChildOf>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    for (entity, material) in &drawn {
        let Some(role) = parents.iter_ancestors(entity).find_map(|root| roots.get(root).ok()) else {
            continue;
        };
        let base_color = match role {
            Role::Slaps => Color::srgb(0.5, 0.63, 0.7),
            Role::IsSlapped => Color::srgb(0.87, 0.7, 0.61),
        };
        let Some(material) = materials.get(&material.0) else {
            continue;
        };
        let material = StandardMaterial {
            base_color,
            perceptual_roughness: 0.65,
            ..material.clone()
        };
        let material = materials.add(material);
        commands.entity(entity).insert(MeshMaterial3d(material));
    }
}

/// A red spot on the skin, and a pin that points out of it.
fn draw_marks(
    marks: Query<Entity, Added<Mark>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
    mut commands: Commands,
) {
    const PIN: f32 = 0.15;
    for mark in &marks {
        let red = materials.add(StandardMaterial {
            base_color: Color::srgb(0.9, 0.05, 0.05),
            unlit: true,
            ..default()
        });
        commands
            .entity(mark)
            .insert(Visibility::default())
            .with_children(|mark| {
                let spot = Mesh3d(meshes.add(Cylinder::new(0.02, 0.012)));
                mark.spawn((spot, MeshMaterial3d(red.clone()), Pickable::IGNORE));
                let pin = Mesh3d(meshes.add(Cylinder::new(0.004, PIN)));
                let place = Transform::from_xyz(0.0, 0.5 * PIN, 0.0);
                mark.spawn((pin, MeshMaterial3d(red), place, Pickable::IGNORE));
            });
    }
}

/// Ways are drawn over the heads that they lead through.
fn bring_ways_to_front(mut gizmos: ResMut<GizmoConfigStore>) {
    let (ways, _) = gizmos.config_mut::<DefaultGizmoConfigGroup>();
    ways.depth_bias = -1.0;
}

/// Draws the way of each hand from the tick before to this one.
fn draw_ways(
    moment: Res<Moment>,
    joints: Query<(Entity, &Name, &GlobalTransform)>,
    actors: Query<&Role>,
    parents: Query<&ChildOf>,
    mut ways: Local<EntityHashMap<(u32, Vec3, Vec3)>>,
    mut gizmos: Gizmos,
) {
    const POINT: f32 = 0.012;
    for (entity, name, place) in &joints {
        let is_slap = || {
            let role = parents.iter_ancestors(entity).find_map(|root| actors.get(root).ok());
            role == Some(&Role::Slaps)
        };
        if name.as_str() != KNUCKLE || !is_slap() {
            continue;
        }
        let now = place.translation();
        let (tick, start, end) = ways.entry(entity).or_insert((moment.tick, now, now));
        if std::mem::replace(tick, moment.tick) != moment.tick {
            *start = *end;
        }
        *end = now;
        let color = Color::srgb(0.1, 0.3, 0.6);
        gizmos.line(*start, *end, color);
        for point in [*start, *end] {
            gizmos.sphere(Isometry3d::from_translation(point), POINT, color);
        }
    }
}

fn write_notes(tally: Res<Tally>, mut notes: ResMut<Notes>) {
    let felt = |side: Side| format!("{} of {} slaps", tally.felt[side as usize], tally.slaps);
    let last = tally.last[Side::Continuous as usize];
    let hit = last.and_then(|felt| Some((felt.share?, felt.speed)));
    let unknown = || "not yet".to_owned();
    notes.0 = vec![
        ("felt, left", felt(Side::Discrete)),
        ("felt, right", felt(Side::Continuous)),
        (
            "hit after",
            hit.map_or_else(unknown, |(share, _)| format!("{:.1} % of a frame", 100.0 * share)),
        ),
        (
            "hand at",
            hit.map_or_else(unknown, |(_, speed)| format!("{speed:.1} m/s")),
        ),
    ];
}
