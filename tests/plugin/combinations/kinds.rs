//! A collider of each kind, which stretches upward.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;

use crate::skins::{add, boned, put, skeleton, spawn_joints};
use crate::support::{Edits, bevy_mesh, cube, settle};

/// What can collide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Rigid,
    Morphed,
    Skinned,
    Both,
    Shape,
}

impl Kind {
    pub(super) const ALL: [Self; 5] = [Self::Rigid, Self::Morphed, Self::Skinned, Self::Both, Self::Shape];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Rigid => "rigid mesh",
            Self::Morphed => "morph targets",
            Self::Skinned => "joints",
            Self::Both => "both",
            Self::Shape => "`MorphShape`",
        }
    }
}

/// A cube with sides of 1 around the origin, whose upper side rises. What does not deform rises as a whole.
pub(super) struct Subject {
    pub(super) app: App,
    pub(super) collider: Entity,
    kind: Kind,
    upper_joint: Entity,
}

impl Subject {
    pub(super) fn new(kind: Kind, app: App, more: impl Bundle) -> Self {
        Self::with_plate(kind, app, None, more)
    }

    /// A mesh that also has a flat box at this height, which stays where it is.
    pub(super) fn with_plate(kind: Kind, mut app: App, plate: Option<f32>, more: impl Bundle) -> Self {
        let mut mesh = cube();
        if let Some(height) = plate {
            let plate = rigid::box_mesh(Vec3::new(0.2, 0.1, 0.3));
            let first = mesh.positions.len() as u32;
            mesh.positions
                .extend(plate.positions.iter().map(|&p| p + height * Vec3::Y));
            let triangles = plate.triangles.iter();
            mesh.triangles
                .extend(triangles.map(|corners| corners.map(|corner| first + corner)));
        }
        let rises = |p: Vec3| (0.1..1.0).contains(&p.y);
        if matches!(kind, Kind::Morphed | Kind::Both) {
            let target = mesh
                .positions
                .iter()
                .map(|&p| if rises(p) { Vec3::Y } else { Vec3::ZERO });
            mesh.targets = vec![target.collect()];
            mesh.target_names = vec!["up".into()];
        }
        let joints = spawn_joints(&mut app, [Vec3::ZERO; 2]);
        let collider = app.spawn(Transform::default());
        for joint in joints {
            app.insert(joint, ChildOf(collider));
        }
        if kind == Kind::Shape {
            app.insert(collider, MorphShape::from(Cuboid::default()));
        } else if matches!(kind, Kind::Skinned | Kind::Both) {
            let skinned = add(&mut app, boned(&mesh, |p| u16::from(rises(p))));
            let skin = skeleton(&mut app, &joints);
            app.insert(collider, (Mesh3d(skinned), skin));
        } else {
            let rigid = add(&mut app, bevy_mesh(&mesh));
            app.insert(collider, Mesh3d(rigid));
        }
        if matches!(kind, Kind::Morphed | Kind::Both) {
            app.insert(collider, MeshMorphWeights::Value { weights: vec![0.0] });
        }
        app.insert(collider, more);
        settle(&mut app);
        Self {
            app,
            collider,
            kind,
            upper_joint: joints[1],
        }
    }

    /// Puts the upper side at `0.5 + by`, from the next frame on.
    pub(super) fn stretch(&mut self, by: f32) {
        let (weight, joint, whole) = match self.kind {
            Kind::Morphed => (by, 0.0, 0.0),
            Kind::Skinned => (0.0, by, 0.0),
            Kind::Both => (0.5 * by, 0.5 * by, 0.0),
            Kind::Rigid | Kind::Shape => (0.0, 0.0, by),
        };
        if matches!(self.kind, Kind::Morphed | Kind::Both) {
            let weights = MeshMorphWeights::Value { weights: vec![weight] };
            self.app.insert(self.collider, weights);
        }
        put(&mut self.app, self.upper_joint, Transform::from_xyz(0.0, joint, 0.0));
        if whole != 0.0 {
            put(&mut self.app, self.collider, Transform::from_xyz(0.0, whole, 0.0));
        }
    }

    /// Stretches it, and runs a frame.
    pub(super) fn stretched(&mut self, by: f32) -> &mut App {
        self.stretch(by);
        self.app.update();
        &mut self.app
    }
}
