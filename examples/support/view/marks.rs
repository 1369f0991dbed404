//! Things to put into a scene: marks on a surface, which are an arrow and pins, and meshes in one colour. The `+Y` axis of marks
//! points out of the surface.

use std::f32::consts::PI;

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

/// Makes marks, which are children of the entity that is placed on the surface. The pointer goes through them.
#[derive(SystemParam)]
#[allow(missing_debug_implementations, reason = "assets have none")]
pub struct Marks<'w> {
    meshes: ResMut<'w, Assets<Mesh>>,
    materials: ResMut<'w, Assets<StandardMaterial>>,
}

impl Marks<'_> {
    /// An arrow whose tip is on the surface.
    pub fn arrow(&mut self, color: Color) -> impl Bundle + use<> {
        let tip = Cone {
            radius: 0.05,
            height: 0.15,
        };
        let upside_down = Transform::from_xyz(0.0, 0.075, 0.0).with_rotation(Quat::from_rotation_x(PI));
        let shaft = Transform::from_xyz(0.0, 0.3, 0.0);
        self.two(
            color,
            (tip.into(), upside_down),
            (Cylinder::new(0.015, 0.3).into(), shaft),
        )
    }

    /// A pin that sticks in the surface, with a round head.
    pub fn pin(&mut self, color: Color, length: f32) -> impl Bundle + use<> {
        let shaft = Cylinder::new(0.05 * length, length);
        let head = Sphere::new(0.1875 * length);
        let at = |height| Transform::from_xyz(0.0, height, 0.0);
        self.two(color, (shaft.into(), at(0.5 * length)), (head.into(), at(length)))
    }

    /// A mesh in one colour.
    pub fn mesh(&mut self, color: Color, mesh: impl Into<Mesh>) -> (Mesh3d, MeshMaterial3d<StandardMaterial>) {
        let (mesh, color) = (self.meshes.add(mesh.into()), self.materials.add(color));
        (Mesh3d(mesh), MeshMaterial3d(color))
    }

    fn two(&mut self, color: Color, first: (Mesh, Transform), second: (Mesh, Transform)) -> impl Bundle + use<> {
        let color = self.materials.add(color);
        let mut part = |(mesh, place): (Mesh, Transform)| {
            (
                Mesh3d(self.meshes.add(mesh)),
                MeshMaterial3d(color.clone()),
                place,
                Pickable::IGNORE,
            )
        };
        children![part(first), part(second)]
    }
}
