//! Draws things that move in fixed steps smoothly, by interpolating between their last two steps.

use bevy::prelude::*;

use super::clock::started;

/// On a child that is drawn for its parent. The parent moves in fixed steps, is not scaled, and has no parent itself.
#[derive(Component, Clone, Copy, Debug, Default)]
pub struct Smooth {
    /// Its own transform, in the space of its parent.
    pub own: Transform,
    steps: Option<[Transform; 2]>,
}

impl Smooth {
    /// A child with this transform in the space of its parent.
    #[must_use]
    pub fn at(own: Transform) -> Self {
        Self { own, steps: None }
    }
}

/// A parent that moves farther than this in a step has been teleported.
const LEAP: f32 = 1.0;

/// Draws entities with [`Smooth`].
pub fn plugin(app: &mut App) {
    app.add_systems(FixedLast, remember)
        .add_systems(PostUpdate, draw.before(TransformSystems::Propagate).run_if(started));
}

fn remember(mut drawn: Query<(&mut Smooth, &ChildOf)>, parents: Query<&Transform>) {
    for (mut smooth, parent) in &mut drawn {
        let Ok(&now) = parents.get(parent.parent()) else {
            continue;
        };
        let before = smooth.steps.map_or(now, |[_, last]| last);
        let leaps = before.translation.distance(now.translation) > LEAP;
        smooth.steps = Some([if leaps { now } else { before }, now]);
    }
}

fn draw(
    mut drawn: Query<(&Smooth, &ChildOf, &mut Transform)>,
    parents: Query<&Transform, Without<Smooth>>,
    time: Res<Time<Fixed>>,
) {
    let between = time.overstep_fraction();
    for (smooth, parent, mut place) in &mut drawn {
        let (Some([before, after]), Ok(parent)) = (smooth.steps, parents.get(parent.parent())) else {
            continue;
        };
        let translation = before.translation.lerp(after.translation, between);
        let rotation = before.rotation.slerp(after.rotation, between);
        let back = parent.rotation.inverse();
        *place = Transform {
            translation: back * (translation + rotation * smooth.own.translation - parent.translation),
            rotation: back * rotation * smooth.own.rotation,
            scale: smooth.own.scale,
        };
    }
}
