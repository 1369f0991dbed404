//! Parts of surfaces on dynamic bodies: for one step they are links of their body.
//!
//! A link is attached to its body by a kinematic multibody joint, whose velocity Rapier's solver does not change. A contact with
//! the link therefore involves the mass and the inertia of the body, and the combined velocity of body and surface. A link has no
//! mass of its own.

use bevy::math::{Mat3, Quat, Vec3};
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::rapier::dynamics::{
    GenericJoint, GenericJointBuilder, JointAxesMask, Multibody, MultibodyJointHandle, MultibodyJointSet,
    MultibodyLink, RigidBody, RigidBodyHandle, RigidBodySet, RigidBodyVelocity,
};
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, Collider};

use super::movers::Mover;
use super::world::World;
use bevy_morph_physics::math::largest;
use bevy_morph_physics::push::PartMotion;

/// Below this speed, in length units or radians per second, a part counts as not moving along an axis or rotating.
const STILL: f32 = 1e-6;

/// The inertia of a body along a locked axis, relative to its mass or its inertia along other axes. Rapier's own value there is
/// zero, and a matrix with zeros cannot be inverted.
const LOCKED: f32 = 1e12;

/// A part that will become a link.
pub(crate) struct Link {
    body: RigidBodyHandle,
    pub(crate) part: RigidBodyHandle,
    /// Where it is in the space of the body.
    isometry: Isometry,
    /// Its motion in that space.
    linear: Vec3,
    angular: Vec3,
    length_unit: f32,
}

impl Link {
    pub(crate) fn new(part: RigidBodyHandle, motion: &PartMotion, carrier: &Carrier) -> Self {
        let to_body = carrier.isometry.rotation.inverse();
        Self {
            body: carrier.body,
            part,
            isometry: Isometry::from_parts(carrier.isometry.inverse_transform_point(motion.origin), to_body),
            linear: to_body * motion.linear,
            angular: to_body * motion.angular,
            length_unit: carrier.length_unit,
        }
    }

    /// The joint, and the velocities of its free axes.
    ///
    /// `X` is the axis of rotation, and `Y` is perpendicular to it. Three free axes are then enough, of which one is angular.
    fn joint(&self) -> (GenericJoint, impl Iterator<Item = f32> + use<>) {
        let turns = self.angular.length();
        let still = STILL * self.length_unit;
        let x = if turns > STILL { self.angular } else { self.linear };
        let x = x.try_normalize().unwrap_or(Vec3::X);
        let along = self.linear.dot(x);
        let across = self.linear - along * x;
        let sideways = across.length();
        // The first step is perpendicular to `x` up to a few digits, the second one makes it exact.
        let y = (across / sideways.max(f32::MIN_POSITIVE)).reject_from_normalized(x);
        let y = if sideways > still { y.try_normalize() } else { None };
        let y = y.unwrap_or_else(|| x.any_orthonormal_vector());
        let frame = Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y)));
        let mut locked = JointAxesMask::LIN_Z | JointAxesMask::ANG_Y | JointAxesMask::ANG_Z;
        let mut speed = |speed: f32, least: f32, axis: JointAxesMask| {
            let moves = speed.abs() > least;
            if !moves {
                locked |= axis;
            }
            moves.then_some(speed)
        };
        let speeds = [
            speed(along, still, JointAxesMask::LIN_X),
            speed(sideways, still, JointAxesMask::LIN_Y),
            speed(turns, STILL, JointAxesMask::ANG_X),
        ];
        let joint = GenericJointBuilder::new(locked)
            .local_frame1(Isometry::from_parts(self.isometry.translation, frame))
            .local_frame2(Isometry::from_rotation(self.isometry.rotation.inverse() * frame))
            .contacts_enabled(false)
            .build();
        (joint, speeds.into_iter().flatten())
    }
}

/// A dynamic body that carries a surface.
pub(crate) struct Carrier {
    body: RigidBodyHandle,
    isometry: Isometry,
    pub(crate) center: Vec3,
    pub(crate) velocity: RigidBodyVelocity<f32>,
    pub(crate) soft_ccd_prediction: f32,
    /// The pairs of body types between which parts have contacts.
    pub(crate) types: ActiveCollisionTypes,
    /// How far the body moves any point of the surface in the step.
    pub(crate) way: f32,
    length_unit: f32,
    pub(crate) links: Vec<Link>,
}

impl Carrier {
    /// The body of a surface. `None` if its parts cannot be links of that body.
    pub(crate) fn of(body: RigidBodyHandle, surface: &Collider, world: &World, dt: f32) -> Option<Self> {
        let carrier = world.bodies.get(body)?;
        let is_free = world.multibody_joints.rigid_body_link(body).is_none();
        if !carrier.is_dynamic() || !carrier.is_enabled() || !is_free || !has_inertia(carrier) {
            return None;
        }
        let in_body = surface.position_wrt_parent().copied().unwrap_or_default();
        let local = surface.shape().compute_local_aabb();
        let next = carrier.predict_position_using_velocity_and_forces(dt) * in_body;
        let now = *carrier.position() * in_body;
        let ways = local
            .vertices()
            .map(|corner| now.transform_point(corner).distance(next.transform_point(corner)));
        let types = ActiveCollisionTypes::DYNAMIC_DYNAMIC
            | ActiveCollisionTypes::DYNAMIC_KINEMATIC
            | ActiveCollisionTypes::DYNAMIC_FIXED;
        Some(Self {
            body,
            isometry: *carrier.position(),
            center: carrier.center_of_mass(),
            velocity: *carrier.vels(),
            soft_ccd_prediction: carrier.soft_ccd_prediction(),
            types: surface.active_collision_types() & types | ActiveCollisionTypes::DYNAMIC_DYNAMIC,
            way: largest(ways),
            length_unit: world.length_unit,
            links: Vec::new(),
        })
    }

    /// Whether a collider is on the body itself.
    pub(crate) fn has(&self, mover: &Mover) -> bool {
        mover.nearby.body == self.body
    }
}

/// Whether a body can move along and about all axes that are not locked.
fn has_inertia(body: &RigidBody) -> bool {
    let mass = body.mass_properties();
    let (linear, angular) = (mass.effective_inv_mass, mass.effective_world_inv_inertia);
    let yields = linear
        .to_array()
        .into_iter()
        .chain([angular.m11, angular.m22, angular.m33]);
    let locked = body.locked_axes().bits();
    yields
        .enumerate()
        .all(|(axis, yields)| locked >> axis & 1 != 0 || (yields.is_finite() && yields > 0.0))
}

/// A body with links.
struct Linked {
    body: RigidBodyHandle,
    /// The positions of the body and of its centre of mass at the start of the step, if Rapier moves the one as if it were the
    /// other.
    moved_from: Option<(Vec3, Vec3)>,
}

/// The links of a step.
#[derive(Default)]
pub(crate) struct Links {
    /// The length of the step.
    dt: f32,
    bodies: Vec<Linked>,
    joints: Vec<MultibodyJointHandle>,
}

impl Links {
    /// Joins parts to their bodies for a step of `dt` seconds. `once` says whether it has no substeps.
    pub(crate) fn join(&mut self, links: impl Iterator<Item = Link>, dt: f32, once: bool, world: &mut World) {
        self.dt = dt;
        for link in links {
            let (joint, speeds) = link.joint();
            let inserted = world
                .multibody_joints
                .insert_kinematic(link.body, link.part, joint, true);
            let Some(handle) = inserted else { continue };
            self.joints.push(handle);
            let Some((multibody, id)) = world.multibody_joints.get_mut(handle) else {
                continue;
            };
            if !self.bodies.iter().any(|linked| linked.body == link.body)
                && let Some(body) = world.bodies.get(link.body)
            {
                begin(multibody, body, once);
                self.bodies.push(Linked {
                    body: link.body,
                    moved_from: (!once).then(|| (body.translation(), body.center_of_mass())),
                });
            }
            let Some(first) = multibody.link(id).map(MultibodyLink::assembly_id) else {
                continue;
            };
            let mut velocities = multibody.generalized_velocity_mut();
            for (velocity, speed) in velocities.iter_mut().skip(first).zip(speeds) {
                *velocity = speed;
            }
        }
    }

    /// Removes all joints after the step. Bodies keep the velocities that they had as roots.
    pub(crate) fn part(&mut self, bodies: &mut RigidBodySet, joints: &mut MultibodyJointSet) {
        for linked in self.bodies.drain(..) {
            let multibody = joints.rigid_body_link(linked.body).map(|link| link.multibody);
            let multibody = multibody.and_then(|multibody| joints.get_multibody(multibody));
            if let (Some(multibody), Some(body)) = (multibody, bodies.get_mut(linked.body)) {
                end(multibody, body, linked.moved_from, self.dt);
            }
        }
        // After the first removal, nothing can be read from a multibody any more.
        for joint in self.joints.drain(..) {
            if joints.get(joint).is_some() {
                joints.remove(joint, false);
            }
        }
    }
}

/// Makes the root of a new multibody move like its body.
fn begin(multibody: &mut Multibody, body: &RigidBody, once: bool) {
    // Parts lie next to each other.
    multibody.set_self_contacts_enabled(false);
    if once {
        // Rotate about the centre of mass. That is where the body is now, but not in a later substep.
        let center = body.local_center_of_mass();
        let root = &mut multibody.root_mut().joint.data;
        root.local_frame1 = Isometry::from_translation(*body.rotation() * center);
        root.local_frame2 = Isometry::from_translation(center);
    }
    // Rapier's default would slow it down.
    multibody.damping_mut().fill(0.0);
    let locked = body.locked_axes().bits();
    let mass = &body.mass_properties().local_mprops;
    let inertias = [mass.mass(), mass.principal_inertia().max_element()].map(|own| {
        let own = if own > 0.0 && own.is_finite() { own } else { 1.0 };
        LOCKED * own
    });
    for (axis, inertia) in multibody.armature_mut().iter_mut().take(6).enumerate() {
        *inertia = if locked >> axis & 1 != 0 {
            inertias[axis / 3]
        } else {
            0.0
        };
    }
    let motion = body.linvel().to_array().into_iter().chain(body.angvel().to_array());
    for (velocity, speed) in multibody.generalized_velocity_mut().iter_mut().zip(motion) {
        *velocity = speed;
    }
}

/// Gives a body its velocity as a root, damped as Rapier damps bodies.
fn end(multibody: &Multibody, body: &mut RigidBody, moved_from: Option<(Vec3, Vec3)>, dt: f32) {
    let speeds = multibody.generalized_velocity();
    let mut speeds = speeds.iter().copied();
    let mut velocity = || Some(Vec3::new(speeds.next()?, speeds.next()?, speeds.next()?));
    let (Some(linear), Some(angular)) = (velocity(), velocity()) else {
        return;
    };
    if !linear.is_finite() || !angular.is_finite() {
        return;
    }
    let damped = |velocity: Vec3, damping: f32| velocity / (1.0 + dt * damping);
    if !body.is_sleeping() {
        body.set_linvel(damped(linear, body.linear_damping()), false);
        body.set_angvel(damped(angular, body.angular_damping()), false);
    }
    if let Some((from, center)) = moved_from {
        // Rapier has rotated the body about its origin, which moved like its centre of mass.
        let center = center + (body.translation() - from);
        let isometry = *body.position();
        let translation = center - isometry.rotation * body.local_center_of_mass();
        body.set_position(Isometry::from_parts(translation, isometry.rotation), false);
    }
}
