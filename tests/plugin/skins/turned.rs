//! Culling boxes of characters that are turned: as tight as those of upright ones, and around everything that is drawn.

use std::path::Path;

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityPlugin;
use bevy::math::{DAffine3, DMat4, DVec3, Mat4};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::without_collisions;
use morph_collision_workspace::crowd::{self, root_of};
use morph_collision_workspace::drawn::{self, Part, extent};

use crate::log::start;
use crate::models::shared;
use crate::support::assets;

/// How a character is turned.
fn turns() -> [Quat; 6] {
    let about_y = |degrees: f32| Quat::from_rotation_y(degrees.to_radians());
    [
        Quat::IDENTITY,
        about_y(45.0),
        about_y(90.0),
        about_y(200.0),
        Quat::from_rotation_x(0.7),
        Quat::from_euler(EulerRot::XYZ, 1.0, 2.0, -0.5),
    ]
}

/// Instances of a model in the same place, each turned in another way, and all at the same moment of a clip.
struct Turned {
    app: App,
    meshes: Vec<MorphMesh>,
    /// The skinned parts, with the index of their instance.
    parts: Vec<(usize, Part)>,
}

impl Turned {
    fn new(file: &Path, clip: Option<&str>) -> Self {
        let mut app = without_collisions(file.parent().unwrap());
        app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
        start(&mut app);
        let places = turns().map(Transform::from_rotation);
        let (roots, clips) = crowd::spawn(&mut app, file, &places, ()).expect("the model can be loaded");
        let clip = clips.iter().find(|(name, _)| clip.is_none_or(|clip| clip == name));
        let (_, clip) = clip.expect("the model has such a clip");
        app.update();
        while app.world().resource::<MorphTrees>().building() > 0 {
            app.update();
        }
        // Only now, so that the moments do not depend on how long trees take.
        crowd::play(&mut app, clip, &roots, |_, _| 0.0);
        app.update();
        let meshes = read_meshes(file).expect("the model can be read");
        let parts = drawn::parts::<()>(app.world_mut(), &meshes).into_iter();
        let skinned = parts.filter(|part| meshes[part.mesh].skin.is_some());
        let place = |part: Part| (root_of(app.world(), part.entity, &roots).expect("it has a root"), part);
        let mut parts: Vec<(usize, Part)> = skinned.map(place).collect();
        // Queries have no order. Instances have their parts in the same one.
        parts.sort_by_key(|(_, part)| (part.mesh, part.triangles.start));
        Self { app, meshes, parts }
    }

    /// The area of a part's box, over that of the smallest box in the space of its entity. Fails if a vertex is outside.
    fn looseness(&self, part: &Part) -> f64 {
        let world = self.app.world();
        let aabb = world.get::<Aabb>(part.entity).unwrap();
        let place = Mat4::from(world.get::<GlobalTransform>(part.entity).unwrap().affine());
        let place = DAffine3::from_mat4(DMat4::from_cols_array(&place.to_cols_array().map(f64::from)));
        let vertices = drawn::vertices(world, &self.meshes[part.mesh], part.entity);
        let used = part.triangles(&self.meshes).as_flattened();
        let to_entity = place.inverse();
        let seen: Vec<DVec3> = used
            .iter()
            .map(|&corner| to_entity.transform_point3(vertices[corner as usize]))
            .collect();
        let (min, max) = extent(&seen);
        let (center, half) = (aabb.center.as_dvec3(), aabb.half_extents.as_dvec3());
        let slack = (max - min).max_element() * 1e-6;
        let holds = (center - half - slack).cmple(min).all() && (center + half + slack).cmpge(max).all();
        assert!(holds, "{aabb:?} does not hold {min} to {max}");
        let scale = DVec3::new(
            place.matrix3.x_axis.length(),
            place.matrix3.y_axis.length(),
            place.matrix3.z_axis.length(),
        );
        let area = |sides: DVec3| sides.x * sides.y + sides.y * sides.z + sides.z * sides.x;
        area(2.0 * half * scale) / area((max - min) * scale)
    }
}

#[test]
fn culling_boxes_of_turned_characters_are_as_tight_as_those_of_upright_ones() {
    // The largest median over the frames, for each model.
    for (file, clip, largest) in [
        (Some(assets().join("mh_character_low.glb")), Some("walk"), 1.25),
        (shared("Fox.glb"), Some("Survey"), 1.25),
        // The weights of its hands do not sum to 1.
        (shared("RobotExpressive.glb"), None, 4.0),
    ] {
        let Some(file) = file else {
            continue;
        };
        let name = file.file_name().unwrap_or_default().display();
        let mut turned = Turned::new(&file, clip);
        let mut of_turns = turns().map(|_| Vec::new());
        for _ in 0..24 {
            (0..3).for_each(|_| turned.app.update());
            for (instance, part) in &turned.parts {
                of_turns[*instance].push(turned.looseness(part));
            }
        }
        let upright = of_turns[0].clone();
        for (turn, ratios) in turns().iter().zip(&mut of_turns) {
            let off = ratios.iter().zip(&upright).map(|(a, b)| (a / b - 1.0).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 0.01, "{name} turned by {turn}: {off} off the upright ones");
            ratios.sort_by(f64::total_cmp);
            let median = ratios[ratios.len() / 2];
            println!("{name} turned by {turn}: {median:.3}");
            assert!(median <= largest, "{name} turned by {turn}: {median}");
        }
    }
}
