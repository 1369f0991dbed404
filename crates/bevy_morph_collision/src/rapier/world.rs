//! The parts of a physics world that surfaces read and change.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::math::Vec3;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::parry::shape::HalfSpace;
use bevy_rapier3d::rapier::dynamics::{
    CoefficientCombineRule, ImpulseJointSet, IslandManager, MultibodyJointSet, RigidBody, RigidBodyHandle,
    RigidBodySet, SoftBodySet,
};
use bevy_rapier3d::rapier::geometry::{
    ActiveCollisionTypes, Collider, ColliderHandle, ColliderSet, Group, InteractionGroups,
};
use bevy_rapier3d::rapier::pipeline::{ActiveEvents, ActiveHooks};

use super::obstacles::Obstacles;
use super::sweep::MARGIN;
use crate::physics::near::Visitor;
use crate::physics::part::Pace;
use crate::physics::passage::{FAR, Flight, Ground};
use crate::physics::range::{box_in_range, in_range};
use crate::physics::sorted_boxes::SortedBoxes;
use crate::physics::triangles::Patch;

/// The sets to which bodies are added and from which they are removed.
pub(super) struct World<'a> {
    pub(super) bodies: &'a mut RigidBodySet,
    pub(super) colliders: &'a mut ColliderSet,
    pub(super) islands: &'a mut IslandManager,
    pub(super) impulse_joints: &'a mut ImpulseJointSet,
    pub(super) multibody_joints: &'a mut MultibodyJointSet,
    pub(super) soft_bodies: &'a mut SoftBodySet,
    pub(super) length_unit: f32,
}

impl World<'_> {
    /// Removes a body with its colliders.
    pub(super) fn remove(&mut self, body: RigidBodyHandle) {
        self.bodies.remove(
            body,
            self.islands,
            self.colliders,
            self.impulse_joints,
            self.multibody_joints,
            self.soft_bodies,
            true,
        );
    }
}

/// What surfaces need to know about a step.
pub(super) struct Step<'a> {
    pub(super) pace: Pace,
    /// The speed at which bodies are driven out of solid surfaces.
    pub(super) leaving: f32,
    pub(super) movers: &'a Movers,
    /// Other obstacles, for surfaces on moving dynamic bodies.
    pub(super) obstacles: Option<&'a Obstacles>,
    /// Everything besides movers that needs contacts of surfaces.
    pub(super) audience: &'a Audience,
    /// Whether Rapier does a single step, perhaps with substeps.
    pub(super) once: bool,
    /// The body on which the surface is.
    pub(super) body: Option<RigidBodyHandle>,
    /// Set while a step is in progress.
    pub(super) stepping: &'a Arc<AtomicBool>,
}

/// Everything that needs contacts of surfaces even without movers nearby.
pub(super) struct Audience {
    /// Where colliders with hooks, which receive entities, may be when Rapier looks for pairs.
    hooked: Vec<Aabb>,
    /// Whether Rapier looks for pairs only once.
    once: bool,
    /// Whether there are colliders on no dynamic body that want events, or soft bodies, which collide with the surface as a
    /// whole.
    pub(super) listens: bool,
}

impl Audience {
    /// `once` says whether Rapier does a single step without substeps.
    pub(super) fn of(world: &World, margin: f32, once: bool) -> Self {
        let body = |collider: &Collider| collider.parent().and_then(|body| world.bodies.get(body));
        let listens = |collider: &Collider| {
            collider.active_events().contains(ActiveEvents::COLLISION_EVENTS)
                && !collider
                    .active_collision_types()
                    .difference(ActiveCollisionTypes::default())
                    .is_empty()
                && !body(collider).is_some_and(RigidBody::is_dynamic)
        };
        let whereabouts = |collider: &Collider| {
            let Some(body) = body(collider) else {
                return collider.compute_aabb();
            };
            // If the game moved the body, its colliders follow only in the step.
            let in_body = collider.position_wrt_parent().copied().unwrap_or_default();
            let at = |place| collider.shape().compute_aabb(&(place * in_body));
            at(*body.position())
                .merged(&at(*body.next_position()))
                .loosened(body.soft_ccd_prediction())
        };
        let hooked = world.colliders.iter().map(|(_, collider)| collider);
        let hooked = hooked.filter(|collider| !collider.active_hooks().is_empty());
        Self {
            hooked: hooked
                .map(|collider| whereabouts(collider).loosened(margin + collider.contact_skin()))
                .collect(),
            once,
            listens: !world.soft_bodies.is_empty() || world.colliders.iter().any(|(_, collider)| listens(collider)),
        }
    }

    /// Whether a hook may be called for something in a box.
    pub(super) fn hooks_near(&self, bounds: &Aabb) -> bool {
        let mut hooked = self.hooked.iter();
        // In later substeps, anything may be anywhere.
        hooked.any(|hooked| !self.once || hooked.intersects(bounds))
    }
}

/// Whether a collider is a part of a surface.
pub(super) fn is_part(collider: &Collider) -> bool {
    collider.shape().as_shape::<Patch>().is_some()
}

/// A collider of a dynamic body.
#[derive(Clone, Copy)]
pub(super) struct Mover {
    pub(super) visitor: Visitor<ColliderHandle, RigidBodyHandle>,
    /// How far ahead of it contacts must be prepared, because it moves fast. 0 if the usual distance is enough.
    pub(super) ahead: f32,
    /// Whether it moves so far in the step that it must be swept.
    pub(super) fast: bool,
    /// How it moves, if contact hooks do not decide what it touches.
    pub(super) flight: Option<Flight>,
    /// Whether the game made it a bullet.
    pub(super) bullet: bool,
    pub(super) groups: InteractionGroups,
    pub(super) events: ActiveEvents,
}

/// All colliders of dynamic bodies that surfaces may push.
#[derive(Default)]
pub(super) struct Movers {
    all: Vec<Mover>,
    boxes: SortedBoxes,
}

impl Movers {
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the movers that may be in a box during the step, in the order of their bodies. `places` is scratch memory.
    pub(super) fn meeting<'a>(&'a self, bounds: &Aabb, places: &'a mut Vec<u32>) -> impl Iterator<Item = &'a Mover> {
        self.boxes.meeting(bounds, places);
        places.iter().map(|&place| &self.all[place as usize])
    }

    /// Collects all movers and where they may be during a step. `surfaces` is the number of searches that follow.
    ///
    /// Skips movers that are too large for Parry, or too fast, and reports them to `refuse` by their user data.
    pub(super) fn find(
        &mut self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        dt: f32,
        surfaces: usize,
        refuse: &mut impl FnMut(u128),
    ) {
        find_movers(bodies, colliders, dt, &mut self.all, refuse);
        self.boxes
            .take(self.all.iter().map(|mover| mover.visitor.bounds), surfaces);
    }
}

/// How a collider of a body moves in a step that takes the body to `next`. `bounds` is around the collider.
fn flight(body: &RigidBody, next: &Place, in_body: &Place, bounds: &Aabb, dt: f32) -> Flight {
    let center = body.center_of_mass();
    Flight {
        place: *body.position() * *in_body,
        way: next.transform_point(body.local_center_of_mass()) - center,
        turn: body.angvel() * dt,
        radius: bounds.center().distance(center) + bounds.half_extents().length(),
    }
}

fn find_movers(
    bodies: &RigidBodySet,
    colliders: &ColliderSet,
    dt: f32,
    movers: &mut Vec<Mover>,
    refuse: &mut impl FnMut(u128),
) {
    movers.clear();
    for (handle, body) in bodies.iter() {
        if !body.is_dynamic() || !body.is_enabled() {
            continue;
        }
        let asleep = body.is_sleeping();
        let next = body.predict_position_using_velocity_and_forces(dt);
        for &collider in body.colliders() {
            let Some(shape) = colliders.get(collider) else { continue };
            if shape.is_sensor() || !shape.is_enabled() || is_part(shape) {
                continue;
            }
            let in_body = shape.position_wrt_parent().copied().unwrap_or_default();
            // If the game moved the body, its colliders follow only in the step.
            let mut bounds = shape.shape().compute_aabb(&(*body.position() * in_body));
            let thin = bounds.extents().min_element();
            let mut flight = flight(body, &next, &in_body, &bounds, dt);
            if asleep {
                flight.way = Vec3::ZERO;
                flight.turn = Vec3::ZERO;
            }
            if !asleep {
                bounds = bounds.merged(&shape.shape().compute_aabb(&(next * in_body)));
            }
            if !box_in_range(&bounds) {
                // Movers that are merely far away, or not at a finite position, are not reported: no surface is there.
                if in_range(body.translation()) && shape.shape().as_shape::<HalfSpace>().is_none() {
                    refuse(shape.user_data);
                }
                continue;
            }
            movers.push(Mover {
                visitor: Visitor {
                    collider,
                    body: handle,
                    bounds: bounds.loosened(shape.contact_skin()),
                    asleep,
                },
                // Not less if it moves less far: then boxes would grow in small steps, and each change costs.
                ahead: if flight.relative_to(&Ground::Still) > FAR * thin {
                    MARGIN * shape.shape().ccd_thickness()
                } else {
                    0.0
                },
                fast: flight.way.length() > FAR * thin,
                flight: shape.active_hooks().is_empty().then_some(flight),
                bullet: body.is_ccd_enabled(),
                groups: shape.collision_groups(),
                events: shape.active_events(),
            });
        }
    }
}

/// Properties that the parts of a surface take from the surface's collider.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Manners {
    friction: f32,
    friction_rule: CoefficientCombineRule,
    restitution: f32,
    restitution_rule: CoefficientCombineRule,
    pub(super) contact_skin: f32,
    pub(super) groups: InteractionGroups,
    pub(super) solver_groups: InteractionGroups,
    hooks: ActiveHooks,
    pub(super) events: ActiveEvents,
    force_threshold: f32,
}

impl Manners {
    /// Whether contact hooks decide what it touches.
    pub(super) fn is_hooked(&self) -> bool {
        !self.hooks.is_empty()
    }

    pub(super) fn of(collider: &Collider, solver_groups: InteractionGroups) -> Self {
        Self {
            friction: collider.friction(),
            friction_rule: collider.friction_combine_rule(),
            restitution: collider.restitution(),
            restitution_rule: collider.restitution_combine_rule(),
            contact_skin: collider.contact_skin(),
            groups: collider.collision_groups(),
            solver_groups,
            hooks: collider.active_hooks(),
            events: collider.active_events(),
            force_threshold: collider.contact_force_event_threshold(),
        }
    }

    pub(super) fn teach(&self, collider: &mut Collider) {
        collider.set_friction(self.friction);
        collider.set_friction_combine_rule(self.friction_rule);
        collider.set_restitution(self.restitution);
        collider.set_restitution_combine_rule(self.restitution_rule);
        collider.set_contact_skin(self.contact_skin);
        collider.set_collision_groups(self.groups);
        collider.set_solver_groups(self.solver_groups);
        collider.set_active_hooks(self.hooks);
        collider.set_active_events(self.events);
        collider.set_contact_force_event_threshold(self.force_threshold);
    }
}

/// Empty groups: a collider with these still detects contacts, but pushes nothing.
pub(super) fn no_push(groups: InteractionGroups) -> InteractionGroups {
    InteractionGroups::new(Group::NONE, Group::NONE, groups.test_mode)
}
