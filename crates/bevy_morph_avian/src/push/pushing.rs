//! How a surface pushes: with parts near colliders that may move.

use std::sync::Arc;

use avian3d::dynamics::joints::joint_graph::JointGraph;
use avian3d::prelude::{SleepTimer, Sleeping, WakeBody};
use bevy::ecs::entity::hash_map::EntityHashMap;
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_morph_physics::moving::MovingSurface;
use bevy_morph_physics::push::{Budget, Drive, Expelling, NearbyParts, Passage, SolidSurface, StepParams};
use bevy_morph_physics::shape::MeshLayout;
use parry3d::bounding_volume::{Aabb, BoundingVolume};

use super::material::ContactMaterial;
use super::movers::{Mover, Movers};
use super::part::{MorphAvianPart, PartBodies, PartBody, remove};

/// The parts with which a surface pushes.
pub(crate) struct Pushing {
    near: NearbyParts<Entity, Entity, PartBody>,
    expelling: Expelling<Entity>,
    passage: Passage<Entity, Entity>,
    material: Option<ContactMaterial>,
    // Scratch memory.
    meeting: Vec<u32>,
}

/// Which bodies are asleep, or about to fall asleep.
#[derive(SystemParam)]
pub(crate) struct Sleep<'w, 's> {
    asleep: Query<'w, 's, (), With<Sleeping>>,
    timers: Query<'w, 's, &'static mut SleepTimer, Without<MorphAvianPart>>,
}

/// The surroundings of a surface that pushes.
pub(crate) struct Surroundings<'a, 'w, 's> {
    pub(crate) movers: &'a Movers,
    /// The body on which the surface is.
    pub(crate) body: Option<Entity>,
    /// Whether something needs to know what the surface touches.
    pub(crate) listens: bool,
    pub(crate) joints: &'a JointGraph,
    pub(crate) sleep: &'a mut Sleep<'w, 's>,
    /// The speed at which bodies are driven out of solid surfaces.
    pub(crate) expel_speed: f32,
    /// The velocity changes of the bodies that are driven out.
    pub(crate) expelled: &'a mut EntityHashMap<Vec3>,
}

impl Pushing {
    pub(crate) fn new(layout: Arc<MeshLayout>) -> Self {
        Self {
            near: NearbyParts::new(layout),
            expelling: Expelling::default(),
            passage: Passage::default(),
            material: None,
            meeting: Vec::new(),
        }
    }

    pub(crate) fn is_idle(&self) -> bool {
        self.near.is_idle()
    }

    /// Whether triangles near a collider matter in the step.
    pub(crate) fn is_awake(&self) -> bool {
        self.near.is_awake()
    }

    /// Whether the surface has parts for a collider.
    pub(crate) fn is_near(&self, collider: Entity) -> bool {
        self.near.knows(collider)
    }

    /// The entities of the surface's parts.
    pub(crate) fn parts(&self) -> impl Iterator<Item = Entity> {
        self.near.parts().filter_map(|part| part.entity)
    }

    /// Removes all parts from the world. Avian wakes up what slept on them.
    pub(crate) fn stop(&mut self, commands: &mut Commands) {
        self.expelling.stop();
        self.near.stop(|part| remove(part, commands));
        self.material = None;
    }

    /// Prepares the coming step: everything that may touch the surface will touch parts that move like it.
    ///
    /// Returns how many parts had to be blended.
    pub(crate) fn prepare(
        &mut self,
        moving: &mut MovingSurface,
        params: &StepParams,
        surroundings: &mut Surroundings,
        bodies: &mut PartBodies,
    ) -> u32 {
        if surroundings.movers.is_empty() && self.is_idle() {
            return 0;
        }
        self.near.begin(moving);
        self.passage.begin();
        self.expelling.begin(None);
        let bounds = moving.bounds();
        let bounds = Aabb::new(bounds.min, bounds.max).loosened(params.prediction);
        self.update_material(bodies);

        let (mut blended, mut searching) = (0, Vec::new());
        let mut meeting = std::mem::take(&mut self.meeting);
        for mover in surroundings.movers.meeting(&bounds, &mut meeting) {
            let nearby = &mover.nearby;
            if !mover.layers.interacts_with(bodies.material.layers)
                || !(mover.pushed || mover.listens || surroundings.listens)
                || surroundings.filters_out(nearby.body)
            {
                continue;
            }
            if self.near.sleeps_on(nearby, moving) {
                self.expelling.keep(nearby.collider);
                continue;
            }
            self.near.search(nearby, moving, params);
            searching.push(mover);
        }
        let stays = self.near.stays(moving);
        if !searching.is_empty() && !stays {
            self.near
                .reserve_triangles(moving, |body| surroundings.sleep.asleep.contains(body));
        }
        for mover in searching {
            let nearby = &mover.nearby;
            self.drive_out(mover, moving, params, surroundings);
            if !stays {
                blended += self.near.push(nearby, moving, params, bodies);
            }
            if bodies.material.hooks.is_none()
                && let Some((shape, flight)) = &mover.flight
            {
                let grounds = self.near.grounds(nearby, moving, params);
                self.passage
                    .watch(nearby.collider, nearby.body, shape.as_ref(), flight, &grounds);
            }
            // A slowly carried body is not at rest.
            if !stays
                && self.near.moves_near(nearby.collider)
                && !nearby.asleep
                && let Ok(mut timer) = surroundings.sleep.timers.get_mut(nearby.body)
            {
                timer.0 = 0.0;
            }
        }
        self.meeting = meeting;
        let commands = &mut *bodies.commands;
        self.expelling.forget();
        self.near.forget(|part| remove(part, commands));
        for body in self.near.take_to_wake() {
            commands.queue_silenced(WakeBody(body));
        }
        blended
    }

    /// After a step, returns the bodies that have passed through the surface, and how they must be moved back. `end` returns where
    /// the middle of a collider is now, and `is_blocked` whether something static or kinematic is between two points, besides
    /// the surface.
    pub(crate) fn move_back(
        &mut self,
        moving: &mut MovingSurface,
        budget: &mut Budget,
        end: impl Fn(Entity) -> Option<Vec3>,
        is_blocked: impl Fn(Entity, Vec3, Vec3) -> bool,
    ) -> HashMap<Entity, Vec3> {
        self.passage.move_back(moving, budget, end, is_blocked)
    }

    /// Drives a body out of the surface if the surface is solid and the body is inside.
    fn drive_out(
        &mut self,
        mover: &Mover,
        moving: &mut MovingSurface,
        params: &StepParams,
        surroundings: &mut Surroundings,
    ) {
        let outward = {
            let posed = moving.surface.lock();
            posed.outward().filter(|_| posed.is_solid())
        };
        let (Some(enclosed), Some(outward)) = (&mover.enclosed, outward) else {
            return;
        };
        let travelled = moving.travelled_before();
        let drive = Drive {
            limit: surroundings.expel_speed,
            dt: params.dt,
        };
        let exit = moving.at_start(|pose, world_from_model| {
            let solid = SolidSurface {
                pose,
                world_from_model,
                travelled,
                outward: f64::from(outward),
            };
            self.expelling.exit(mover.nearby.collider, enclosed, solid, drive)
        });
        let Some(exit) = exit else { return };
        // The body's other colliders and other surfaces may drive it too.
        let expelled = surroundings.expelled.entry(mover.nearby.body).or_default();
        *expelled += exit.change_of(mover.velocity + *expelled, moving);
    }

    fn update_material(&mut self, bodies: &mut PartBodies) {
        if self.material == Some(bodies.material) {
            return;
        }
        self.material = Some(bodies.material);
        for part in self.near.parts().filter_map(|part| part.entity) {
            bodies.material.apply_to(bodies.commands.entity(part));
        }
    }
}

impl Surroundings<'_, '_, '_> {
    /// Whether the surface ignores a body: because it is on that body, or because a joint between them disables contacts.
    fn filters_out(&self, body: Entity) -> bool {
        let Some(own) = self.body else { return false };
        own == body
            || self
                .joints
                .joints_between(own, body)
                .any(|joint| joint.collision_disabled)
    }
}
