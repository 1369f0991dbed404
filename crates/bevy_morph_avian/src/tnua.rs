//! Tells the sensors of Tnua's characters how fast a surface moves.

use avian3d::prelude::{Collider, Position, Rotation};
use bevy::ecs::schedule::{InternedScheduleLabel, ScheduleLabel};
use bevy::prelude::*;
use bevy_tnua_physics_integration_layer::data_for_backends::{TnuaGhostSensor, TnuaProximitySensor, TnuaSensorOf};
use bevy_tnua_physics_integration_layer::math::{AdjustPrecision, AsF32};
use bevy_tnua_physics_integration_layer::{TnuaPipelineSystems, TnuaSystems};

use crate::plugin::MorphAvianSystems;
use crate::surface::MorphAvianVelocity;

/// Lets surfaces carry the characters of `bevy-tnua` (feature `tnua`).
///
/// Add it next to Tnua's own plugins, with the same schedule, in any order:
///
/// ```
/// # use avian3d::prelude::*;
/// # use bevy::prelude::*;
/// # use bevy_morph_avian::prelude::*;
/// # let mut app = App::new();
/// // TnuaControllerPlugin::<Controls>::new(PhysicsSchedule), TnuaAvian3dPlugin::new(PhysicsSchedule)
/// app.add_plugins(MorphTnuaPlugin::new(PhysicsSchedule));
/// ```
///
/// Between Tnua's sensors and its logic, it writes the velocity of the surface at the sensor's hit into
/// `TnuaProximitySensorOutput::entity_linvel`, where Tnua's backend has written that of the entity's body. The hit is where the ray ends.
/// For a shape (`TnuaAvian3dSensorShape`), it is the point of the surface closest to the middle of the shape. Velocities are those of the
/// last step. On a dynamic body, the output stays as it is.
///
/// Costs one closest point for each hit on a surface.
#[derive(Clone, Copy, Debug)]
pub struct MorphTnuaPlugin(InternedScheduleLabel);

impl MorphTnuaPlugin {
    /// Takes the schedule of Tnua's plugins.
    pub fn new(schedule: impl ScheduleLabel) -> Self {
        Self(schedule.intern())
    }
}

impl Plugin for MorphTnuaPlugin {
    fn build(&self, app: &mut App) {
        let sense = write_velocities
            .in_set(TnuaSystems)
            .after(TnuaPipelineSystems::Sensors)
            .before(TnuaPipelineSystems::Logic)
            // Avian rejects schedules whose systems have an ambiguous order.
            .ambiguous_with_all();
        // Surfaces push with parts near bodies, so they must know the velocity that Tnua gives to a body.
        app.configure_sets(self.0, TnuaSystems.before(MorphAvianSystems::BeforeStep))
            .add_systems(self.0, sense);
    }
}

/// Writes the velocities of surfaces into the outputs of sensors.
fn write_velocities(
    mut sensors: Query<(&mut TnuaProximitySensor, Option<&mut TnuaGhostSensor>, &TnuaSensorOf)>,
    owners: Query<(&Position, &Rotation, Option<&Collider>)>,
    mut surfaces: MorphAvianVelocity,
) {
    for (mut sensor, mut ghosts, of) in &mut sensors {
        let Ok((position, rotation, collider)) = owners.get(of.0) else {
            continue;
        };
        let scale = collider.map_or(Vec3::ONE, Collider::scale);
        let origin = position.0 + *rotation * (scale * sensor.cast_origin.f32());
        let direction = sensor.cast_direction;
        let ghosts = ghosts.iter_mut().flat_map(|ghosts| &mut ghosts.0);
        for hit in sensor.output.iter_mut().chain(ghosts) {
            let point = origin + direction * hit.proximity.f32();
            if let Some(velocity) = surfaces.surface_velocity(hit.entity, point) {
                hit.entity_linvel = velocity.adjust_precision();
            }
        }
    }
}
