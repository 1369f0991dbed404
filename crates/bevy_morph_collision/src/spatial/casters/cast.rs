//! Casts all casters of a kind together.

use bevy::ecs::component::Mutable;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use morph_collision::batch::QuestionBatch;
use tracing::debug_span;

use super::carrier::Carriers;
use crate::app::{MorphCollisionSystems, Names, WarnOnce};
use crate::spatial::walker::Walker;
use crate::spatial::{MorphQueryFilter, MorphSpatialQuery};
use crate::state::MorphCollisionDiagnostics;

/// A kind of casters.
pub(super) trait Caster: Component {
    /// Its name in messages.
    const NAME: &'static str;
    /// What is cast, in world space, checked.
    type Cast: Sync;
    /// What a cast finds, in the order of hits.
    type Found: Send;
    /// What a hit says.
    type Hit: Clone + PartialEq;
    /// The component with the hits.
    type Hits: Component<Mutability = Mutable>;

    /// Whether it is cast, whether it ignores its own body, and what it sees.
    fn sees(&self) -> (bool, bool, &MorphQueryFilter);
    /// Places it in the world, or says what is wrong with it.
    fn place(&self, place: &GlobalTransform) -> Result<Self::Cast, String>;
    /// Orders questions so that similar ones follow each other.
    fn sort<'a>(batch: &mut QuestionBatch, casts: impl Iterator<Item = &'a Self::Cast> + Clone)
    where
        Self::Cast: 'a;
    /// The first hits, as many as it wants.
    fn ask(&self, cast: &Self::Cast, filter: &MorphQueryFilter, walker: &mut Walker<'_, '_, '_>) -> Vec<Self::Found>;
    /// What a hit says.
    fn hit(found: &Self::Found, spatial: &MorphSpatialQuery) -> Self::Hit;
    /// The list of hits.
    fn list(hits: &mut Self::Hits) -> &mut Vec<Self::Hit>;
}

/// Casts all casters of a kind, and replaces their hits.
pub(super) fn cast_all<C: Caster>(
    spatial: MorphSpatialQuery,
    carriers: Carriers,
    casters: Query<(Entity, &C, &GlobalTransform)>,
    mut lists: Query<&mut C::Hits>,
    names: Names,
    mut log: Local<WarnOnce>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::cast_all").entered();
    let mut questions = Vec::new();
    let mut put = |entity, found: Vec<C::Hit>| {
        if let Ok(mut hits) = lists.get_mut(entity)
            // Reading the list is not a change.
            && *C::list(hits.bypass_change_detection()) != found
        {
            *C::list(&mut hits) = found;
        }
    };
    for (entity, caster, place) in &casters {
        let (enabled, ignores_self, filter) = caster.sees();
        let cast = enabled.then(|| caster.place(place));
        match cast {
            Some(Ok(cast)) => {
                let filter = carriers.filter(entity, filter, ignores_self);
                questions.push((entity, caster, cast, filter));
                continue;
            }
            Some(Err(problem)) => log.warn(C::NAME, names.about(entity), || {
                let name = names.with_file(entity);
                format!("the `{}` of entity {name} hits nothing: {problem}", C::NAME)
            }),
            None => {}
        }
        put(entity, Vec::new());
    }
    let mut batch = QuestionBatch::new();
    C::sort(&mut batch, questions.iter().map(|(_, _, cast, _)| cast));
    let answers = spatial.answers(&batch, |walker, index| {
        let (_, caster, cast, filter) = &questions[index];
        caster.ask(cast, filter, walker)
    });
    for ((entity, ..), found) in questions.iter().zip(&answers) {
        put(*entity, found.iter().map(|found| C::hit(found, &spatial)).collect());
    }
    diagnostics.spend(MorphCollisionSystems::Casters, start.elapsed());
}
