//! What a scene draws: nodes, hidden nodes and instances, each with its own skin, weights and clips.

use glam::{Affine3A, Quat, Vec3};
use morph_collision_models::gltf::read::{Drawing, DrawnMesh, Extent, ReadError};
use serde_json::json;

use crate::support::{Document, F32, I16};

fn drawn(drawing: &Drawing) -> Vec<(usize, Option<usize>, Option<usize>)> {
    let tuple = |drawn: &DrawnMesh| (drawn.mesh, drawn.node, drawn.instance);
    drawing.drawn.iter().map(tuple).collect()
}

/// Two meshes; node 0 is above 1 and 2, node 3 is alone, node 4 has no mesh.
fn nodes() -> Document {
    let mut document = Document::square(1);
    let mesh = document.json["meshes"][0].clone();
    document.list("meshes").extend([mesh.clone(), mesh]);
    document.json["nodes"] = json!([
        {"children": [1, 2]}, {"mesh": 1}, {"mesh": 0, "children": [0]}, {"mesh": 0}, {"children": [9]},
    ]);
    document
}

#[test]
fn only_the_default_scene_is_drawn_and_others_on_request() -> Result<(), ReadError> {
    let mut document = nodes();
    document.json["scenes"] = json!([{"nodes": [3]}, {"nodes": [0, 4, 7], "name": "main"}]);
    document.json["scene"] = json!(1);
    let (_directory, file) = document.open()?;
    assert_eq!(file.scene_names(), ["scene_0", "main"]);
    assert_eq!(file.default_scene(), Some(1));
    // A node below itself is drawn once.
    let main = file.drawing(Extent::DefaultScene)?;
    assert_eq!(drawn(&main), [(0, Some(2), None), (1, Some(1), None)]);
    assert_eq!(
        (main.meshes_left_out, main.nodes_left_out, main.broken.len()),
        (1, 1, 0)
    );
    let first = file.drawing(Extent::Scene(0))?;
    assert_eq!(drawn(&first), [(0, Some(3), None)]);
    assert_eq!((first.meshes_left_out, first.nodes_left_out), (2, 2));
    let all = file.drawing(Extent::Everything)?;
    assert_eq!(
        drawn(&all),
        [
            (0, Some(2), None),
            (0, Some(3), None),
            (1, Some(1), None),
            (2, None, None)
        ]
    );
    let error = file.drawing(Extent::Scene(2)).expect_err("there are two").to_string();
    assert!(error.contains("scene 2 does not exist"), "{error}");
    Ok(())
}

#[test]
fn without_a_default_the_first_scene_is_drawn_and_without_scenes_everything() -> Result<(), ReadError> {
    let mut document = nodes();
    document.json["scenes"] = json!([{"nodes": [3]}]);
    document.json["scene"] = json!(5);
    let (_directory, file) = document.open()?;
    assert_eq!(drawn(&file.drawing(Extent::DefaultScene)?), [(0, Some(3), None)]);
    let (_directory, file) = nodes().open()?;
    assert_eq!(file.drawing(Extent::DefaultScene)?.drawn.len(), 4);
    // Meshes without any node, as in a library of parts.
    let (_directory, file) = Document::square(0).open()?;
    assert_eq!(drawn(&file.drawing(Extent::DefaultScene)?), [(0, None, None)]);
    Ok(())
}

#[test]
fn a_hidden_node_hides_everything_below_it() -> Result<(), ReadError> {
    let mut document = nodes();
    document.json["scenes"] = json!([{"nodes": [0, 3]}]);
    document.json["nodes"][0]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
    document.json["nodes"][3]["extensions"] = json!({"KHR_node_visibility": {"visible": true}});
    document.json["extensionsRequired"] = json!(["KHR_node_visibility"]);
    let (_directory, file) = document.open()?;
    let drawing = file.drawing(Extent::DefaultScene)?;
    assert_eq!(drawn(&drawing), [(0, Some(3), None)]);
    assert_eq!((drawing.meshes_left_out, drawing.nodes_left_out), (2, 2));
    Ok(())
}

#[test]
fn without_scenes_hidden_nodes_are_left_out_and_broken_extensions_spoil_only_their_node() -> Result<(), ReadError> {
    let mut document = nodes();
    document.json["nodes"] = json!([{"children": [1]}, {"mesh": 0}, {"mesh": 1}, {"mesh": 2}]);
    document.json["nodes"][0]["extensions"] = json!({"KHR_node_visibility": {"visible": false}});
    document.json["nodes"][3]["extensions"] = json!({"KHR_node_visibility": {"visible": 1}});
    let (_directory, file) = document.open()?;
    let drawing = file.drawing(Extent::DefaultScene)?;
    assert_eq!(drawn(&drawing), [(1, Some(2), None)]);
    assert_eq!((drawing.meshes_left_out, drawing.nodes_left_out), (2, 1));
    let broken: Vec<String> = drawing.broken.iter().map(ToString::to_string).collect();
    assert_eq!(broken.len(), 1, "{broken:?}");
    assert!(
        broken[0].contains("node 3 \"node_3\": an extension of it is malformed: visible: invalid type"),
        "{broken:?}"
    );
    // Nodes are placed as if the extension were not there.
    assert_eq!(file.world_from_node(1, 2)?, Affine3A::IDENTITY);
    Ok(())
}

#[test]
fn instances_are_placed_in_the_space_of_their_node() -> Result<(), ReadError> {
    let mut document = nodes();
    document.json["nodes"] = json!([{"mesh": 0, "translation": [0, 0, 5]}]);
    let translations = document.floats("VEC3", &[1., 0., 0., 0., 2., 0.]);
    // Half a turn about y, as normalized integers, and none.
    let turns: [i16; 8] = [0, 32767, 0, 0, 0, 0, 0, 32767];
    let turns: Vec<u8> = turns.iter().flat_map(|value| value.to_le_bytes()).collect();
    let rotations = document.accessor(I16, "VEC4", 2, &turns);
    document.json["accessors"][rotations]["normalized"] = json!(true);
    let scales = document.floats("VEC3", &[1., 1., 1., 3., 3., 3.]);
    let attributes = json!({"TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales, "_ID": 77});
    document.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
    let (_directory, file) = document.open()?;
    let first = file.drawing(Extent::DefaultScene)?;
    assert_eq!(drawn(&first)[..2], [(0, Some(0), Some(0)), (0, Some(0), Some(1))]);
    let instances = file.instances(0)?.expect("there are two");
    let expected = [
        Affine3A::from_rotation_translation(Quat::from_xyzw(0., 1., 0., 0.), Vec3::X),
        Affine3A::from_scale_rotation_translation(Vec3::splat(3.), Quat::IDENTITY, 2. * Vec3::Y),
    ];
    assert_eq!(instances.len(), 2);
    for (found, expected) in instances.iter().zip(&expected) {
        assert!(found.abs_diff_eq(*expected, 1e-6), "{found:?}, not {expected:?}");
    }
    Ok(())
}

#[test]
fn broken_and_enormous_instances_spoil_only_their_node() -> Result<(), ReadError> {
    let broken = |translations: &dyn Fn(&mut Document) -> usize, attribute: &str| {
        let mut document = nodes();
        let three = document.floats("VEC3", &[0.; 9]);
        let other = translations(&mut document);
        let attributes = json!({"TRANSLATION": three, attribute: other});
        document.json["nodes"] = json!([{"mesh": 1}, {"mesh": 0}]);
        document.json["nodes"][1]["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": attributes}});
        let (_directory, file) = document.open()?;
        let drawing = file.drawing(Extent::DefaultScene);
        let instances = file.instances(1).map_err(|error| error.to_string());
        Ok::<_, ReadError>((drawing, instances))
    };
    let (drawing, error) = broken(&|document| document.floats("VEC3", &[1.; 6]), "SCALE")?;
    let error = error.expect_err("the counts differ");
    assert!(
        error.contains("node 1 \"node_1\": its instances have 2 elements of SCALE, but 3 of TRANSLATION"),
        "{error}"
    );
    let drawing = drawing?;
    assert_eq!(drawn(&drawing)[0], (1, Some(0), None));
    assert_eq!(drawing.broken.len(), 1);
    let (_, error) = broken(&|document| document.floats("SCALAR", &[1.; 3]), "ROTATION")?;
    let error = error.expect_err("the shape is wrong");
    assert!(error.contains("ROTATION of its instances: "), "{error}");
    let (_, error) = broken(
        &|document| document.floats("VEC3", &[1., 1., 1., 1., 1., f32::NAN, 1., 1., 1.]),
        "SCALE",
    )?;
    let error = error.expect_err("a scale is not finite");
    assert!(
        error.contains("node 1 \"node_1\": SCALE of its instance 1 is not finite"),
        "{error}"
    );
    // An accessor without data may claim any count.
    let enormous = |document: &mut Document| {
        let accessors = document.list("accessors");
        accessors.push(json!({"componentType": F32, "type": "VEC3", "count": 1_u64 << 40}));
        accessors.len() - 1
    };
    let (drawing, error) = broken(&enormous, "TRANSLATION")?;
    assert!(drawing.is_err_and(|error| error.remedy().is_some()));
    assert!(error.is_err());
    Ok(())
}

#[test]
fn weights_and_clips_belong_to_the_node() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    // The document makes node 0; the clip is that of node 1.
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    document.list("nodes").push(json!({"mesh": 0, "weights": [0.5]}));
    document.json["animations"][0]["channels"][0]["target"]["node"] = json!(1);
    let (_directory, file) = document.open()?;
    assert_eq!(file.clips(0, Some(1), 1).clips.len(), 1);
    assert!(file.clips(0, Some(0), 1).clips.is_empty());
    assert_eq!(file.clips(0, None, 1).clips.len(), 1);
    assert_eq!(file.default_weights(0, Some(1), 1)?, [0.5]);
    assert!(file.default_weights(0, Some(0), 1)?.is_empty());
    Ok(())
}

#[test]
fn each_node_has_its_own_skin() -> Result<(), ReadError> {
    let mut document = Document::square(0);
    let joints = document.accessor(crate::support::U8, "VEC4", 4, &[0; 16]);
    let weights = document.floats("VEC4", &[1., 0., 0., 0.].repeat(4));
    let attributes = &mut document.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = json!(joints);
    attributes["WEIGHTS_0"] = json!(weights);
    document.json["nodes"] = json!([
        {"mesh": 0}, {"mesh": 0, "skin": 1}, {"mesh": 0, "skin": 0},
        {"name": "left", "translation": [-3, 0, 0]}, {"name": "right", "translation": [3, 0, 0]},
    ]);
    document.json["skins"] = json!([{"joints": [3]}, {"joints": [4]}]);
    document.json["scenes"] = json!([{"nodes": [0, 2, 3, 4]}]);
    let (_directory, file) = document.open()?;
    let at = |node| {
        let skin = file.skin(0, node)?;
        Ok::<_, ReadError>(skin.map(|skin| skin.skeleton.at_rest()[0].translation.x))
    };
    assert_eq!((at(Some(0))?, at(Some(1))?, at(Some(2))?), (None, Some(3.), Some(-3.)));
    // The first node with a skin that the scene draws.
    assert_eq!((file.main_node(0), at(None)?), (Some(2), Some(-3.)));
    Ok(())
}

#[test]
fn animation_pointers_pose_what_they_name() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    document.list("nodes").push(json!({"mesh": 0, "weights": [0.25]}));
    let places = document.floats("VEC3", &[0., 0., 0., 0., 8., 0.]);
    let animation = &mut document.json["animations"][0];
    let input = animation["samplers"][0]["input"].clone();
    let samplers = animation["samplers"].as_array_mut().expect("it is a list");
    samplers.push(json!({"input": input, "output": places}));
    let channel = |sampler: usize, pointer: &str| {
        let extension = json!({"KHR_animation_pointer": {"pointer": pointer}});
        json!({"sampler": sampler, "target": {"path": "pointer", "extensions": extension}})
    };
    animation["channels"] = json!([
        channel(0, "/meshes/0/weights"),
        channel(1, "/nodes/0/translation"),
        channel(0, "/materials/0/alphaCutoff"),
        channel(0, "/nodes/1/extensions/KHR_node_visibility/visible"),
        channel(0, "/nodes/1/weights/0"),
    ]);
    let (_directory, file) = document.open()?;
    // Node 1 has weights of its own, so those of the mesh do not count, and one of several weights alone is not animated.
    let clips = file.clips(0, Some(0), 1);
    assert_eq!((clips.clips.len(), clips.broken.len()), (1, 0));
    assert_eq!(clips.clips[0].sample(0.5), [0.5]);
    let clips = file.clips(0, Some(1), 1);
    assert_eq!(clips.clips.len(), 0);
    let told = clips.broken[0].to_string();
    assert!(
        told.contains("channel 4 animates /nodes/1/weights/0, which is not applied"),
        "{told}"
    );
    let placement = file.placement(0, 0)?;
    let moved = placement.world_from_mesh(placement.clips.first(), 0.5)[0].translation;
    assert_eq!(Vec3::from(moved), 4.0 * Vec3::Y);
    let strays: Vec<String> = file.stray_animations().iter().map(ToString::to_string).collect();
    assert_eq!(strays.len(), 1, "{strays:?}");
    assert!(strays[0].contains("animates /nodes/1/extensions/KHR_node_visibility/visible"));
    let stray = file.stray_animation(0).map(|error| error.to_string());
    assert_eq!((stray.as_ref(), strays.len()), (strays.first(), 1));
    let name = &file.animation_names()[0];
    assert_eq!(
        (file.animation_name(0), file.animation_named(name)),
        (Some(&**name), Some(0))
    );
    assert_eq!((file.animation_name(1), file.animation_named("absent")), (None, None));
    let info = &file.animations()[0];
    assert_eq!((info.channels, info.ignored, info.nodes), (5, 3, 1));
    Ok(())
}

#[test]
fn trees_with_joints_of_one_skin_belong_together() -> Result<(), ReadError> {
    let mut document = nodes();
    document.json["meshes"][0]["primitives"][0]["attributes"]["JOINTS_0"] = json!(0);
    document.json["meshes"][0]["primitives"][0]["attributes"]["WEIGHTS_0"] = json!(0);
    // 0 is above 1, and 2 above 3; 4 and 5 are above each other; 6 to 8 are alone.
    document.json["nodes"] = json!([
        {"children": [1]}, {}, {"children": [3]}, {"mesh": 1}, {"children": [5]}, {"children": [4], "mesh": 1},
        {"mesh": 0, "skin": 0}, {"mesh": 0}, {"mesh": 0, "skin": 1},
    ]);
    document.json["skins"] = json!([{"joints": [1, 99, 3]}, {"joints": [3]}]);
    let (_directory, file) = document.open()?;
    let mut trees = file.trees();
    let mut of = |shown: &[(usize, usize)]| -> Vec<Option<usize>> {
        let roots: Vec<Option<usize>> = shown.iter().map(|&(mesh, node)| trees.join(mesh, node)).collect();
        roots
            .into_iter()
            .map(|root| root.map(|root| trees.of_root(root)))
            .collect()
    };
    assert_eq!(of(&[(1, 3), (0, 8)]), [Some(2), Some(2)], "the skin is not joined yet");
    let together = of(&[(1, 3), (0, 6), (0, 7), (0, 8), (0, 6)]);
    assert_eq!(together, [Some(0), Some(0), Some(7), Some(0), Some(0)]);
    let of_cycle = of(&[(1, 4), (1, 5)]);
    assert_eq!(of_cycle[0], of_cycle[1]);
    assert!(of_cycle[0].is_some());
    assert_eq!(of(&[(1, 99)]), [None]);
    Ok(())
}
