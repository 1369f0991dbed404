//! Avian's contacts, with surfaces instead of their parts.

use std::fmt::{self, Debug, Formatter};

use avian3d::prelude::{ColliderOf, ContactGraph, ContactManifold, ContactPair, ContactPoint};
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use crate::push::MorphAvianPart;
use crate::surface::{AvianSurface, Touch};

/// Avian's `Collisions`, with each surface instead of its parts.
///
/// A collider and a [`MorphPhysicsCollider`](crate::MorphPhysicsCollider) that touch are one pair, no matter how many parts of the surface
/// are between them. All other pairs are Avian's own. Only pairs that touch are listed.
///
/// Pairs with surfaces are those of the last step. Read it before or after Avian's step, or within the step after the narrow phase. Nothing is allocated. Where a method takes an entity, a
/// [`MorphAvianPart`] stands for its surface.
///
/// A system cannot have this parameter next to `Collisions` or a mutable `ContactGraph`: use [`graph`](Self::graph). It needs a
/// `ParamSet` for this parameter and [`MorphAvianVelocity`](crate::MorphAvianVelocity).
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_avian::prelude::*;
/// #[derive(Component)]
/// struct Trampoline;
///
/// fn hear_landings(trampolines: Query<Entity, With<Trampoline>>, collisions: MorphAvianCollisions) {
///     for trampoline in &trampolines {
///         for contacts in collisions.collisions_with(trampoline) {
///             let impulse = contacts.total_normal_impulse_magnitude();
///             if impulse > 5.0 {
///                 println!("{} lands with {impulse}", contacts.other(trampoline));
///             }
///         }
///     }
/// }
/// # bevy::ecs::system::assert_is_system(hear_landings);
/// ```
#[allow(missing_debug_implementations)]
#[derive(SystemParam)]
pub struct MorphAvianCollisions<'w, 's> {
    graph: Res<'w, ContactGraph>,
    parts: Query<'w, 's, &'static MorphAvianPart>,
    surfaces: Query<'w, 's, (&'static AvianSurface, Option<&'static ColliderOf>)>,
}

impl MorphAvianCollisions<'_, '_> {
    /// Avian's contacts, with parts instead of surfaces.
    #[must_use]
    pub fn graph(&self) -> &ContactGraph {
        &self.graph
    }

    /// The contacts of two colliders, of which one or both may be surfaces. `None` if they do not touch.
    #[must_use]
    pub fn get(&self, entity1: Entity, entity2: Entity) -> Option<MorphAvianContacts<'_>> {
        let (one, two) = (self.without_parts(entity1), self.without_parts(entity2));
        let of_surface = |surface, other| {
            let touch = self.touching(surface)?.get(&other)?;
            self.named(self.graph.get_by_id(touch.contact)?.1)
                .filter(|contacts| contacts.is_of(surface) && contacts.is_of(other))
        };
        of_surface(one, two).or_else(|| of_surface(two, one)).or_else(|| {
            let (_, pair) = self.graph.get(one, two)?;
            self.named(pair)
        })
    }

    /// Whether two colliders touch, of which one or both may be surfaces.
    #[must_use]
    pub fn contains(&self, entity1: Entity, entity2: Entity) -> bool {
        self.get(entity1, entity2).is_some()
    }

    /// All pairs that touch, each once. Visits each pair of Avian once.
    pub fn iter(&self) -> impl Iterator<Item = MorphAvianContacts<'_>> {
        let (active, sleeping) = (self.graph.iter_active_touching(), self.graph.iter_sleeping_touching());
        active.chain(sleeping).filter_map(|pair| self.named(pair))
    }

    /// The pairs of a collider or surface with what it touches, each once. Visits the collider's pairs in Avian, and for a surface also
    /// what touches its parts.
    pub fn collisions_with(&self, entity: Entity) -> impl Iterator<Item = MorphAvianContacts<'_>> {
        let entity = self.without_parts(entity);
        let touches = self.touching(entity).into_iter().flat_map(|touching| touching.values());
        let of_parts = touches.filter_map(|touch| Some(self.graph.get_by_id(touch.contact)?.1));
        let own = self.graph.contact_pairs_with(entity);
        let contacts = of_parts.chain(own).filter_map(|pair| self.named(pair));
        // Avian uses the number of a pair again that it has removed since the step.
        contacts.filter(move |contacts| contacts.is_of(entity))
    }

    /// The colliders and surfaces that touch a collider or surface, each once. Costs as much as [`collisions_with`](Self::collisions_with).
    pub fn entities_colliding_with(&self, entity: Entity) -> impl Iterator<Item = Entity> {
        let entity = self.without_parts(entity);
        self.collisions_with(entity).map(move |contacts| contacts.other(entity))
    }

    /// The surface of a part, or the entity itself.
    fn without_parts(&self, entity: Entity) -> Entity {
        self.parts.get(entity).map_or(entity, |part| part.surface)
    }

    /// What touches the parts of a surface.
    fn touching(&self, surface: Entity) -> Option<&HashMap<Entity, Touch>> {
        Some(&self.surfaces.get(surface).ok()?.0.state.touching)
    }

    /// The colliders of a pair. If one of them is a part, its surface comes first.
    fn names(&self, pair: &ContactPair) -> (Entity, Entity) {
        match (self.parts.get(pair.collider1), self.parts.get(pair.collider2)) {
            (Ok(part), _) => (part.surface, pair.collider2),
            (_, Ok(part)) => (part.surface, pair.collider1),
            _ => (pair.collider1, pair.collider2),
        }
    }

    /// The contacts that a pair of Avian stands for, if it touches. `None` for pairs with parts for which another pair stands.
    fn named<'a>(&'a self, pair: &'a ContactPair) -> Option<MorphAvianContacts<'a>> {
        if !pair.is_touching() {
            return None;
        }
        let (collider1, collider2) = self.names(pair);
        let mut contacts = MorphAvianContacts {
            collider1,
            collider2,
            body1: pair.body1,
            body2: pair.body2,
            pair,
            others: None,
        };
        if [pair.collider1, pair.collider2].contains(&collider1) {
            return Some(contacts);
        }
        let (surface, of) = self.surfaces.get(collider1).ok()?;
        let touch = surface.state.touching.get(&collider2)?;
        contacts.body1 = of.map(|of| of.body);
        contacts.body2 = touch.body;
        contacts.others = Some(self);
        (touch.contact == pair.contact_id).then_some(contacts)
    }
}

/// The contacts of two colliders that touch, from [`MorphAvianCollisions`].
///
/// If they are contacts with parts of a surface, then the surface is [`collider1`](Self::collider1), and the methods visit all pairs of
/// [`collider2`](Self::collider2) in Avian to find them. Their names are those of Avian's `ContactPair`.
#[derive(Clone, Copy)]
pub struct MorphAvianContacts<'a> {
    /// The first collider or surface.
    pub collider1: Entity,
    /// The second collider or surface.
    pub collider2: Entity,
    /// The body of the first one.
    pub body1: Option<Entity>,
    /// The body of the second one.
    pub body2: Option<Entity>,
    /// Avian's pair, or the first one that is found.
    pair: &'a ContactPair,
    /// Where to find the other pairs, if `collider1` may have several parts.
    others: Option<&'a MorphAvianCollisions<'a, 'a>>,
}

impl<'a> MorphAvianContacts<'a> {
    /// The collider or surface that touches this one, which is one of the two.
    #[must_use]
    pub fn other(&self, entity: Entity) -> Entity {
        if self.collider1 == entity {
            self.collider2
        } else {
            self.collider1
        }
    }

    fn is_of(&self, entity: Entity) -> bool {
        self.collider1 == entity || self.collider2 == entity
    }

    /// Avian's pairs: one, or one for each part of the surface that the collider touches. A part may be the first or the second collider
    /// of its pair.
    pub fn pairs(&self) -> impl Iterator<Item = &'a ContactPair> + use<'a> {
        let (surface, collider) = (self.collider1, self.collider2);
        let only = self.others.is_none().then_some(self.pair);
        let of_parts = self.others.into_iter().flat_map(move |all| {
            let pairs = all.graph.contact_pairs_with(collider);
            pairs.filter(move |pair| pair.is_touching() && all.names(pair) == (surface, collider))
        });
        only.into_iter().chain(of_parts)
    }

    /// All contact manifolds, with their unit normals in world space, which point from [`collider1`](Self::collider1) to
    /// [`collider2`](Self::collider2). `ContactManifold::normal` is the opposite one if the surface is the second collider of Avian's pair.
    pub fn manifolds(&self) -> impl Iterator<Item = (Vec3, &'a ContactManifold)> + use<'a> {
        let flips = self.others.is_some();
        let collider = self.collider2;
        self.pairs().flat_map(move |pair| {
            let sign = if flips && pair.collider1 == collider { -1.0 } else { 1.0 };
            pair.manifolds
                .iter()
                .map(move |manifold| (sign * manifold.normal, manifold))
        })
    }

    /// The sum of the impulses along the normals, in world space, on the second collider. Divide it by the time step to get the force.
    #[must_use]
    pub fn total_normal_impulse(&self) -> Vec3 {
        let impulses = self
            .manifolds()
            .map(|(normal, manifold)| normal * manifold.total_normal_impulse());
        impulses.sum()
    }

    /// The sum of the magnitudes of the impulses along the normals, which is not the magnitude of
    /// [`total_normal_impulse`](Self::total_normal_impulse).
    #[must_use]
    pub fn total_normal_impulse_magnitude(&self) -> f32 {
        self.manifolds()
            .map(|(_, manifold)| manifold.total_normal_impulse())
            .sum()
    }

    /// The largest impulse of a contact point along its normal, in world space, on the second collider.
    #[must_use]
    pub fn max_normal_impulse(&self) -> Vec3 {
        let impulses = self
            .manifolds()
            .map(|(normal, manifold)| (normal, manifold.max_normal_impulse()));
        let largest = impulses.max_by(|a, b| a.1.total_cmp(&b.1));
        largest.map_or(Vec3::ZERO, |(normal, impulse)| normal * impulse)
    }

    /// The magnitude of the largest impulse of a contact point along its normal.
    #[must_use]
    pub fn max_normal_impulse_magnitude(&self) -> f32 {
        let impulses = self.manifolds().map(|(_, manifold)| manifold.max_normal_impulse());
        impulses.fold(0.0, f32::max)
    }

    /// Whether the contacts push. They do not if one of the two is a sensor or on a disabled body.
    #[must_use]
    pub fn generates_constraints(&self) -> bool {
        self.pair.generates_constraints()
    }

    /// The contact point with the largest penetration depth, which is negative while the two only come near. `None` for some sensors.
    #[must_use]
    pub fn find_deepest_contact(&self) -> Option<&'a ContactPoint> {
        let points = self.pairs().filter_map(ContactPair::find_deepest_contact);
        points.max_by(|a, b| a.penetration.total_cmp(&b.penetration))
    }
}

impl Debug for MorphAvianContacts<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("MorphAvianContacts")
            .field("collider1", &self.collider1)
            .field("collider2", &self.collider2)
            .field("body1", &self.body1)
            .field("body2", &self.body2)
            .finish_non_exhaustive()
    }
}
