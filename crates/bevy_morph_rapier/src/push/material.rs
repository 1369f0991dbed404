//! What contacts with a surface are like.

use bevy_rapier3d::rapier::dynamics::CoefficientCombineRule;
use bevy_rapier3d::rapier::geometry::{Collider, Group, InteractionGroups};
use bevy_rapier3d::rapier::pipeline::{ActiveEvents, ActiveHooks};

/// Properties that the parts of a surface take from the surface's collider.
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct ContactMaterial {
    friction: f32,
    friction_rule: CoefficientCombineRule,
    restitution: f32,
    restitution_rule: CoefficientCombineRule,
    pub(crate) contact_skin: f32,
    pub(crate) groups: InteractionGroups,
    pub(crate) solver_groups: InteractionGroups,
    hooks: ActiveHooks,
    pub(crate) events: ActiveEvents,
    force_threshold: f32,
}

impl ContactMaterial {
    /// Whether contact hooks decide what it touches.
    pub(crate) fn is_hooked(&self) -> bool {
        !self.hooks.is_empty()
    }

    pub(crate) fn of(collider: &Collider, solver_groups: InteractionGroups) -> Self {
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

    pub(crate) fn apply_to(&self, collider: &mut Collider) {
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
pub(crate) fn no_push(groups: InteractionGroups) -> InteractionGroups {
    InteractionGroups::new(Group::NONE, Group::NONE, groups.test_mode)
}
