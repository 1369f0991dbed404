//! What there is in the game, and the clips that it plays.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use bevy_morph_rapier::prelude::*;
use bevy_rapier3d::prelude::*;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::stage::{BLOB_TARGETS, Stage};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// The surface on which bodies fall: in physics, and a collider.
    Hill,
    /// Skinned and morphed.
    Character,
    /// Morphed.
    Dolphin,
    /// A mesh made in code. The game writes its weights.
    Blob,
    /// A rigid body of the physics engine, which only it knows.
    Body,
    /// A shape that the game moves.
    Shape,
}

impl Kind {
    /// How many there may be at once.
    pub(crate) fn most(self) -> usize {
        match self {
            Self::Hill => 1,
            Self::Character | Self::Blob => 2,
            Self::Dolphin => 3,
            Self::Body => 6,
            Self::Shape => 5,
        }
    }

    /// The index of its model.
    pub(crate) fn model(self) -> Option<usize> {
        match self {
            Self::Hill => Some(0),
            Self::Character => Some(1),
            Self::Dolphin => Some(2),
            Self::Blob | Self::Body | Self::Shape => None,
        }
    }

    fn scale(self) -> f32 {
        match self {
            Self::Hill => 2.5,
            // Its unit is the decimetre.
            Self::Character => 0.1,
            Self::Dolphin => 0.6,
            Self::Blob => 0.4,
            Self::Body | Self::Shape => 1.0,
        }
    }

    /// An actor without a body of the physics engine. Its clip is the first one of its model.
    pub(crate) fn spawn(self, stage: &mut Stage, place: Transform) -> Entity {
        let place = place.with_scale(Vec3::splat(self.scale()));
        let model = self.model().map(|model| &stage.models[model]);
        let scene = model.map(|model| (model.scene.clone(), model.clips.first().cloned()));
        let blob = Mesh3d(stage.blob.clone());
        let mut actor = stage.app.world_mut().spawn((place, Visibility::default()));
        match scene {
            Some((scene, clip)) => {
                actor.insert((WorldAssetRoot(scene), MorphColliderScene::default()));
                if let Some(clip) = clip {
                    actor.insert(clip);
                }
            }
            None => {
                let weights = vec![0.0; BLOB_TARGETS];
                actor.insert((blob, MeshMorphWeights::Value { weights }, MorphCollider::default()));
            }
        }
        if self == Self::Hill {
            actor.insert(MorphPhysicsScene::default());
        }
        actor.id()
    }
}

/// A clip that an actor plays. Its player is somewhere below it.
#[derive(Component, Clone, Debug)]
pub(crate) struct Plays {
    pub(crate) graph: Handle<AnimationGraph>,
    pub(crate) node: AnimationNodeIndex,
    /// Where it starts, in seconds.
    pub(crate) from: f32,
    pub(crate) is_paused: bool,
}

/// Starts what actors play, when they begin to play it and when Bevy has spawned their scenes.
pub(crate) fn play_clips(
    mut players: Query<(Entity, &mut AnimationPlayer)>,
    parents: Query<&ChildOf>,
    plays: Query<Ref<Plays>>,
    mut commands: Commands,
) {
    for (entity, mut player) in &mut players {
        let actor = parents.iter_ancestors(entity).find_map(|above| plays.get(above).ok());
        let Some(plays) = actor.filter(|plays| plays.is_changed() || player.is_added()) else {
            continue;
        };
        commands
            .entity(entity)
            .insert(AnimationGraphHandle(plays.graph.clone()));
        player.stop_all();
        player.play(plays.node).repeat().seek_to(plays.from);
        if plays.is_paused {
            player.pause_all();
        }
    }
}

/// The way that an actor goes, round and round.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    centre: Vec3,
    radius: f32,
    speed: f32,
    phase: f32,
}

impl Way {
    pub(crate) fn new(kind: Kind, rng: &mut Pcg64Mcg) -> Self {
        let height = match kind {
            Kind::Hill => 0.0..0.01,
            Kind::Character => -0.2..0.4,
            Kind::Dolphin | Kind::Blob | Kind::Shape => 0.8..1.8,
            Kind::Body => 2.0..4.0,
        };
        let radius = if kind == Kind::Hill {
            0.0
        } else {
            rng.random_range(0.2..1.2)
        };
        let mut along = || {
            if kind == Kind::Hill {
                0.0
            } else {
                rng.random_range(-1.5..1.5_f32)
            }
        };
        let (x, z) = (along(), along());
        Self {
            centre: Vec3::new(x, rng.random_range(height), z),
            radius,
            speed: rng.random_range(-1.5..1.5),
            phase: rng.random_range(0.0..6.0),
        }
    }

    /// Where it leads at a time in seconds. The scale is left as it is.
    pub(crate) fn at(&self, seconds: f32) -> (Vec3, Quat) {
        let angle = self.speed * seconds + self.phase;
        let out = Vec3::new(angle.cos(), 0.0, angle.sin());
        (self.centre + self.radius * out, Quat::from_rotation_y(-angle))
    }
}

/// A ball, a box or a capsule that falls.
pub(crate) fn spawn_body(stage: &mut Stage, rng: &mut Pcg64Mcg, way: &Way) -> Entity {
    let size = rng.random_range(0.1..0.25_f32);
    let collider = match rng.random_range(0..3) {
        0 => Collider::ball(size),
        1 => Collider::cuboid(size, 0.8 * size, 0.6 * size),
        _ => Collider::capsule_y(size, 0.5 * size),
    };
    let (at, rotation) = way.at(0.0);
    let body = (
        RigidBody::Dynamic,
        collider,
        Velocity::default(),
        Damping {
            linear_damping: 0.1,
            angular_damping: 1.0,
        },
        Transform::from_translation(at).with_rotation(rotation),
        Visibility::default(),
    );
    stage.app.world_mut().spawn(body).id()
}

/// A ball, a box, a capsule or a cone, which is a collider. Half of them are also compared on their way.
pub(crate) fn spawn_shape(stage: &mut Stage, rng: &mut Pcg64Mcg, way: &Way) -> Entity {
    let size = rng.random_range(0.1..0.25_f32);
    let shape = match rng.random_range(0..4) {
        0 => MorphShape::Ball { radius: size },
        1 => MorphShape::Cuboid {
            half_extents: size * Vec3::new(1.0, 0.8, 0.6),
        },
        2 => MorphShape::Capsule {
            half_length: size,
            radius: 0.5 * size,
        },
        _ => MorphShape::Cone {
            half_height: size,
            radius: 0.5 * size,
        },
    };
    let mode = MorphCollider::new(MorphCollisionMode::First).with_continuous(rng.random_bool(0.5));
    let (at, rotation) = way.at(0.0);
    let place = Transform::from_translation(at).with_rotation(rotation);
    stage
        .app
        .world_mut()
        .spawn((shape, mode, place, Visibility::default()))
        .id()
}
