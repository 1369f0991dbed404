//! What a game implements.

use bevy::ecs::system::ReadOnlySystemParam;
use bevy::prelude::*;

pub use crate::broad_phase::MorphCandidatePair;
use crate::contacts::MorphContact;

/// A game's own rules for pairs of colliders, as a [`SystemParam`](bevy::ecs::system::SystemParam) that reads whatever they depend on.
///
/// Add them with [`MorphCollisionHooksPlugin`](crate::plugins::MorphCollisionHooksPlugin). They are asked about pairs of which a collider,
/// or its body, has [`MorphActiveCollisionHooks`](crate::components::MorphActiveCollisionHooks). With several hooks, all have to agree.
///
/// Hooks decide about collisions of the plugin: [`MorphCollisions`](crate::contacts::MorphCollisions) and its events. Spatial queries have
/// [filters](crate::spatial::MorphQueryFilter), and physics engines have hooks of their own.
///
/// # Teams
///
/// Members of a team do not collide with each other:
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component, PartialEq)]
/// struct Team(u8);
///
/// #[derive(SystemParam)]
/// struct TeamRules<'w, 's> {
///     teams: Query<'w, 's, &'static Team>,
/// }
///
/// impl MorphCollisionHooks for TeamRules<'_, '_> {
///     fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
///         !matches!(self.teams.get_many([pair.body1, pair.body2]), Ok([one, other]) if one == other)
///     }
/// }
///
/// # let mut app = App::new();
/// # app.add_plugins((MinimalPlugins, TransformPlugin, AssetPlugin::default(), bevy::mesh::MeshPlugin));
/// app.add_plugins((MorphPlugins, MorphCollisionHooksPlugin::<TeamRules>::default()));
/// app.world_mut().spawn((MorphShape::Ball { radius: 0.5 }, Team(1), MorphActiveCollisionHooks::FILTER_PAIRS));
/// # app.finish();
/// # app.update();
/// ```
///
/// # The owner of a projectile
///
/// An arrow does not hit the character that shoots it, not even the hand at the string:
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component)]
/// struct ShotBy(Entity);
///
/// #[derive(SystemParam)]
/// struct SpareTheOwner<'w, 's> {
///     arrows: Query<'w, 's, &'static ShotBy>,
/// }
///
/// impl MorphCollisionHooks for SpareTheOwner<'_, '_> {
///     fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
///         let is_shot_by = |arrow, owner| self.arrows.get(arrow).is_ok_and(|by| by.0 == owner);
///         !is_shot_by(pair.body1, pair.body2) && !is_shot_by(pair.body2, pair.body1)
///     }
/// }
/// # App::new().add_plugins(MorphCollisionHooksPlugin::<SpareTheOwner>::default());
/// ```
///
/// # A one-way surface
///
/// What comes from below goes through the leaf of a giant plant. What is on top of it is in contact:
///
/// ```
/// # use bevy::ecs::system::SystemParam;
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// #[derive(Component)]
/// struct OneWay;
///
/// #[derive(SystemParam)]
/// struct OneWaySurfaces<'w, 's> {
///     surfaces: Query<'w, 's, (), With<OneWay>>,
/// }
///
/// impl MorphCollisionHooks for OneWaySurfaces<'_, '_> {
///     fn modify_contacts(&self, contact: &mut MorphContact, _: &mut Commands) -> bool {
///         // The normal leads `collider1` out of `collider2`.
///         let is_above = |surface, up| !self.surfaces.contains(surface) || up > 0.0;
///         is_above(contact.collider2, contact.normal.y) && is_above(contact.collider1, -contact.normal.y)
///     }
/// }
/// # App::new().add_plugins(MorphCollisionHooksPlugin::<OneWaySurfaces>::default());
/// ```
pub trait MorphCollisionHooks: ReadOnlySystemParam + Send + Sync {
    /// Whether two colliders are compared. If not, they do not touch, and a contact that they have ends.
    ///
    /// Called once in each run for each pair whose boxes overlap, or overlap on the way of a continuous collider, and that layers and modes
    /// allow; before any triangle is tested. The order of the calls is that of the entities.
    fn filter_pairs(&self, pair: &MorphCandidatePair, commands: &mut Commands) -> bool {
        let _ = (pair, commands);
        true
    }

    /// Changes a contact before anybody sees it. If it returns `false`, the colliders do not touch.
    ///
    /// Called once in each run for each pair that touches. The contact is always the one that was found: what was changed in earlier runs is
    /// not in it. The colliders and bodies cannot be changed.
    fn modify_contacts(&self, contact: &mut MorphContact, commands: &mut Commands) -> bool {
        let _ = (contact, commands);
        true
    }
}
