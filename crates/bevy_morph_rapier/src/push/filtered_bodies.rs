//! Applies joints that disable contacts between their bodies to the parts of a surface.

use bevy::platform::collections::HashMap;
use bevy_rapier3d::rapier::dynamics::{GenericJoint, ImpulseJointHandle, MultibodyLink, RigidBodyHandle};

use super::world::World;

/// The bodies that a surface does not push, because a joint with disabled contacts connects them to its body.
#[derive(Default)]
pub(crate) struct FilteredBodies {
    bodies: Vec<RigidBodyHandle>,
    /// Joints between parts' bodies and filtered bodies that constrain nothing and only disable contacts.
    contact_filters: HashMap<(RigidBodyHandle, RigidBodyHandle), ImpulseJointHandle>,
}

impl FilteredBodies {
    /// Finds the bodies joined without contacts to the body of a surface, by the rules of Rapier's narrow phase.
    pub(crate) fn find(&mut self, body: Option<RigidBodyHandle>, world: &World) {
        self.bodies.clear();
        let Some(body) = body else { return };
        let joined = world.impulse_joints.attached_joints(body);
        for (one, other, _, _) in joined.filter(|joined| !joined.3.data.contacts_enabled) {
            self.bodies.push(if one == body { other } else { one });
        }
        let multibody = world.multibody_joints.rigid_body_link(body);
        let Some(multibody) = multibody.and_then(|link| world.multibody_joints.get_multibody(link.multibody)) else {
            return;
        };
        for other in multibody
            .links()
            .map(MultibodyLink::rigid_body_handle)
            .filter(|&other| other != body)
        {
            let joint = world.multibody_joints.joint_between(body, other);
            if !multibody.self_contacts_enabled() || joint.is_some_and(|(_, _, link)| !link.joint.data.contacts_enabled)
            {
                self.bodies.push(other);
            }
        }
    }

    pub(crate) fn contains(&self, body: RigidBodyHandle) -> bool {
        self.bodies.contains(&body)
    }

    /// Keeps parts, which exist for other bodies, from touching filtered bodies.
    pub(crate) fn disable_contacts(&mut self, parts: impl Iterator<Item = RigidBodyHandle>, world: &mut World) {
        if self.bodies.is_empty() && self.contact_filters.is_empty() {
            return;
        }
        let bodies = &self.bodies;
        self.contact_filters.retain(|(_, body), contact_filter| {
            // Removing a body removes its joints.
            let stays = world.impulse_joints.get(*contact_filter).is_some() && bodies.contains(body);
            if !stays {
                world.impulse_joints.remove(*contact_filter, false);
            }
            stays
        });
        for part in parts {
            for &body in &self.bodies {
                self.contact_filters.entry((part, body)).or_insert_with(|| {
                    let mut joint = GenericJoint::default();
                    joint.set_contacts_enabled(false);
                    world.impulse_joints.insert(part, body, joint, false)
                });
            }
        }
    }
}
