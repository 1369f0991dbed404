//! How a surface pushes: with parts near colliders that may move.

use std::sync::Arc;

use avian3d::dynamics::joints::joint_graph::JointGraph;
use avian3d::prelude::{SleepTimer, Sleeping, WakeBody};
use bevy::ecs::entity::hash_map::EntityHashMap;
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use parry3d::bounding_volume::{Aabb, BoundingVolume};

use super::MorphAvianPart;
use super::movers::{Mover, Movers};
use super::part::{Manners, PartBodies, PartBody, remove};
use crate::physics::expel::{Drive, Expelling};
use crate::physics::follow::Following;
use crate::physics::layout::MeshLayout;
use crate::physics::near::Nearby;
use crate::physics::part::Pace;
use crate::physics::passage::{Budget, Passage};

/// The parts with which a surface pushes.
pub(super) struct Pushing {
    near: Nearby<Entity, Entity, PartBody>,
    expelling: Expelling<Entity>,
    passage: Passage<Entity, Entity>,
    manners: Option<Manners>,
    // Scratch memory.
    meeting: Vec<u32>,
}

/// Which bodies are asleep, or about to fall asleep.
#[derive(SystemParam)]
pub(super) struct Sleep<'w, 's> {
    asleep: Query<'w, 's, (), With<Sleeping>>,
    timers: Query<'w, 's, &'static mut SleepTimer, Without<MorphAvianPart>>,
}

/// The surroundings of a surface that pushes.
pub(super) struct Around<'a, 'w, 's> {
    pub(super) movers: &'a Movers,
    /// The body on which the surface is.
    pub(super) body: Option<Entity>,
    /// Whether something needs to know what the surface touches.
    pub(super) listens: bool,
    pub(super) joints: &'a JointGraph,
    pub(super) sleep: &'a mut Sleep<'w, 's>,
    /// The speed at which bodies are driven out of solid surfaces.
    pub(super) leaving: f32,
    /// The velocity changes of the bodies that are driven out.
    pub(super) driven: &'a mut EntityHashMap<Vec3>,
}

impl Pushing {
    pub(super) fn new(layout: Arc<MeshLayout>) -> Self {
        Self {
            near: Nearby::new(layout),
            expelling: Expelling::default(),
            passage: Passage::default(),
            manners: None,
            meeting: Vec::new(),
        }
    }

    pub(super) fn is_idle(&self) -> bool {
        self.near.is_idle()
    }

    /// Whether the surface has parts for a collider.
    pub(super) fn is_near(&self, collider: Entity) -> bool {
        self.near.knows(collider)
    }

    /// The entities of the surface's parts.
    pub(super) fn parts(&self) -> impl Iterator<Item = Entity> {
        self.near.parts().filter_map(|part| part.entity)
    }

    /// Removes all parts from the world. Avian wakes up what slept on them.
    pub(super) fn stop(&mut self, commands: &mut Commands) {
        self.expelling.stop();
        self.near.stop(|part| remove(part, commands));
        self.manners = None;
    }

    /// Prepares the coming step: everything that may touch the surface will touch parts that move like it.
    ///
    /// Returns how many parts had to be blended.
    pub(super) fn prepare(
        &mut self,
        following: &mut Following,
        pace: &Pace,
        around: &mut Around,
        bodies: &mut PartBodies,
    ) -> u32 {
        if around.movers.is_empty() && self.is_idle() {
            return 0;
        }
        self.near.begin(following);
        self.passage.begin();
        self.expelling.begin(None);
        let bounds = following.bounds();
        let bounds = Aabb::new(bounds.min, bounds.max).loosened(pace.prediction);
        self.teach(bodies);

        let (mut blended, mut looking) = (0, Vec::new());
        let mut meeting = std::mem::take(&mut self.meeting);
        for mover in around.movers.meeting(&bounds, &mut meeting) {
            let visitor = &mover.visitor;
            if !mover.layers.interacts_with(bodies.manners.layers)
                || !(mover.pushed || mover.listens || around.listens)
                || around.spares(visitor.body)
            {
                continue;
            }
            if self.near.sleeps_on(visitor, following) {
                self.expelling.keep(visitor.collider);
                continue;
            }
            self.near.look_near(visitor, following, pace);
            looking.push(mover);
        }
        let stays = self.near.stays(following);
        if !looking.is_empty() && !stays {
            self.near.give_out(following, |body| around.sleep.asleep.contains(body));
        }
        for mover in looking {
            let visitor = &mover.visitor;
            self.drive_out(mover, following, pace, around);
            if !stays {
                blended += self.near.push(visitor, following, pace, bodies);
            }
            if bodies.manners.hooks.is_none()
                && let Some((shape, flight)) = &mover.flight
            {
                let grounds = self.near.grounds(visitor, following, pace);
                self.passage
                    .watch((visitor.collider, visitor.body), shape.as_ref(), flight, &grounds);
            }
            // A slowly carried body is not at rest.
            if !stays
                && self.near.moves_near(visitor.collider)
                && !visitor.asleep
                && let Ok(mut timer) = around.sleep.timers.get_mut(visitor.body)
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
    pub(super) fn hold_back(
        &mut self,
        following: &mut Following,
        budget: &mut Budget,
        end: impl Fn(Entity) -> Option<Vec3>,
        is_blocked: impl Fn(Entity, Vec3, Vec3) -> bool,
    ) -> HashMap<Entity, Vec3> {
        self.passage.hold_back(following, budget, end, is_blocked)
    }

    /// Drives a body out of the surface if the surface is solid and the body is inside.
    fn drive_out(&mut self, mover: &Mover, following: &mut Following, pace: &Pace, around: &mut Around) {
        let outward = {
            let posed = following.surface.lock();
            posed.outward().filter(|_| posed.is_solid())
        };
        let (Some(guest), Some(outward)) = (&mover.guest, outward) else {
            return;
        };
        let travelled = following.travelled_before();
        let drive = Drive {
            limit: around.leaving,
            dt: pace.dt,
        };
        let exit = following.at_begin(|pose, place| {
            let at = (pose, place);
            self.expelling
                .exit(mover.visitor.collider, guest, at, travelled, f64::from(outward), drive)
        });
        let Some(exit) = exit else { return };
        // The body's other colliders and other surfaces may drive it too.
        let driven = around.driven.entry(mover.visitor.body).or_default();
        *driven += exit.change_of(mover.velocity + *driven, following);
    }

    fn teach(&mut self, bodies: &mut PartBodies) {
        if self.manners == Some(bodies.manners) {
            return;
        }
        self.manners = Some(bodies.manners);
        for part in self.near.parts().filter_map(|part| part.entity) {
            bodies.manners.teach(bodies.commands.entity(part));
        }
    }
}

impl Around<'_, '_, '_> {
    /// Whether the surface ignores a body: because it is on that body, or because a joint between them disables contacts.
    fn spares(&self, body: Entity) -> bool {
        let Some(own) = self.body else { return false };
        own == body
            || self
                .joints
                .joints_between(own, body)
                .any(|joint| joint.collision_disabled)
    }
}
