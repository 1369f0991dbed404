//! Reads valid files, in all the ways in which glTF can express the same thing.

use crate::support::{Document, F32, I16, U8, U16, U32, primitive};
use glam::Vec3;
use morph_collision_models::gltf::read::ReadError;
use serde_json::json;

const SQUARE: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

#[test]
fn an_indexed_mesh_with_targets_is_read() -> Result<(), ReadError> {
    let meshes = Document::square(2).read()?;
    assert_eq!(meshes.len(), 1);
    assert_eq!(meshes[0].name, "m");
    assert_eq!(meshes[0].positions[2], Vec3::new(1.0, 1.0, 0.0));
    assert_eq!(meshes[0].triangles, SQUARE);
    assert_eq!(meshes[0].targets, vec![vec![Vec3::Z; 4]; 2]);
    assert_eq!(meshes[0].target_names, ["target_0", "target_1"]);
    assert_eq!(meshes[0].primitives.first(), Some(&(0..2)));
    Ok(())
}

#[test]
fn indices_of_every_width_are_the_same_triangles() -> Result<(), ReadError> {
    let corners = SQUARE.as_flattened();
    let wide = |size: usize| {
        corners
            .iter()
            .flat_map(|c| c.to_le_bytes()[..size].to_vec())
            .collect::<Vec<u8>>()
    };
    for (kind, size) in [(U8, 1), (U16, 2), (U32, 4)] {
        let mut document = Document::square(0);
        let indices = document.accessor(kind, "SCALAR", 6, &wide(size));
        document.json["meshes"][0]["primitives"][0]["indices"] = json!(indices);
        assert_eq!(document.read()?[0].triangles, SQUARE, "{size} bytes");
    }
    Ok(())
}

#[test]
fn without_indices_the_vertices_come_in_order() -> Result<(), ReadError> {
    let mut document = Document::new();
    let positions = document.floats("VEC3", &[0.0; 18]);
    document.mesh("m", vec![primitive(positions, None, &[])]);
    let meshes = document.read()?;
    assert_eq!(meshes[0].triangles, [[0, 1, 2], [3, 4, 5]]);
    assert!(meshes[0].targets.is_empty());
    Ok(())
}

#[test]
fn strips_and_fans_become_triangles_and_points_none() -> Result<(), ReadError> {
    for (mode, expected) in [
        (0, vec![]),
        (1, vec![]),
        (5, vec![[0, 1, 2], [1, 0, 2], [2, 0, 2], [0, 3, 2]]),
        (6, vec![[1, 2, 0], [2, 0, 0], [0, 2, 0], [2, 3, 0]]),
    ] {
        let mut document = Document::square(1);
        document.json["meshes"][0]["primitives"][0]["mode"] = json!(mode);
        let meshes = document.read()?;
        assert_eq!(meshes[0].triangles, expected, "mode {mode}");
        assert_eq!(meshes[0].primitives.first(), Some(&(0..expected.len() as u32)));
        assert_eq!(meshes[0].targets.len(), 1);
    }
    Ok(())
}

#[test]
fn primitives_are_joined_and_shared_vertices_are_read_once() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    let shared = document.json["meshes"][0]["primitives"][0].clone();
    let positions = document.floats("VEC3", &[5.0; 9]);
    let lift = document.floats("VEC3", &[2.0; 9]);
    let primitives = vec![shared.clone(), primitive(positions, None, &[lift]), shared];
    document.json["meshes"][0]["primitives"] = json!(primitives);
    let mesh = document.read()?.remove(0);
    assert_eq!(mesh.positions.len(), 4 + 3);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [4, 5, 6], [0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.primitives, [0..2, 2..3, 3..5]);
    assert_eq!(mesh.targets[0][3..5], [Vec3::Z, Vec3::splat(2.0)]);
    Ok(())
}

#[test]
fn sparse_displacements_replace_zeros_or_a_base() -> Result<(), ReadError> {
    for with_base in [false, true] {
        let mut document = Document::square(1);
        let indices = document.view(&[1, 3]);
        let values: Vec<u8> = [0.0_f32, 7.0, 0.0, 0.0, 0.0, 9.0]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let values = document.view(&values);
        let mut accessor = json!({
            "componentType": F32, "type": "VEC3", "count": 4,
            "sparse": {
                "count": 2,
                "indices": {"bufferView": indices, "componentType": U8},
                "values": {"bufferView": values},
            },
        });
        let rest = if with_base { Vec3::Z } else { Vec3::ZERO };
        if with_base {
            accessor["bufferView"] = document.json["accessors"][2]["bufferView"].clone();
        }
        document.json["accessors"][2] = accessor;
        let mesh = document.read()?.remove(0);
        assert_eq!(
            mesh.targets[0],
            [rest, Vec3::new(0.0, 7.0, 0.0), rest, Vec3::new(0.0, 0.0, 9.0)]
        );
    }
    Ok(())
}

#[test]
fn interleaved_and_quantized_positions_are_decoded() -> Result<(), ReadError> {
    let mut document = Document::square(0);
    // Eight bytes per vertex, of which three 16-bit components are used.
    let words = [
        [0_i16, 0, 0, -1],
        [32767, 0, 0, -1],
        [32767, -32767, 0, -1],
        [0, 16384, 0, -1],
    ];
    let bytes: Vec<u8> = words.as_flattened().iter().flat_map(|w| w.to_le_bytes()).collect();
    let accessor = document.accessor(I16, "VEC3", 4, &bytes);
    let view = document.json["accessors"][accessor]["bufferView"].as_u64().unwrap_or(0) as usize;
    document.json["bufferViews"][view]["byteStride"] = json!(8);
    document.json["accessors"][accessor]["normalized"] = json!(true);
    document.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(accessor);
    document.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let mesh = document.read()?.remove(0);
    assert_eq!(mesh.positions[2], Vec3::new(1.0, -1.0, 0.0));
    assert_eq!(mesh.positions[3], Vec3::new(0.0, 16384.0 / 32767.0, 0.0));
    Ok(())
}

#[test]
fn target_names_come_from_the_extras_as_far_as_they_go() -> Result<(), ReadError> {
    let mut document = Document::square(3);
    document.json["meshes"][0]["extras"] = json!({"targetNames": ["smile", "blink"], "other": 1});
    assert_eq!(document.read()?[0].target_names, ["smile", "blink", "target_2"]);
    Ok(())
}

#[test]
fn a_target_of_normals_alone_moves_nothing() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.json["meshes"][0]["primitives"][0]["targets"] = json!([{"NORMAL": 2}]);
    assert_eq!(document.read()?[0].targets, [vec![Vec3::ZERO; 4]]);
    Ok(())
}

#[test]
fn clips_of_every_interpolation_are_read() -> Result<(), ReadError> {
    let mut document = Document::square(2);
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 0.0, 1.0, 2.0]);
    document.animate("STEP", &[0.0, 1.0, 2.0], &[0.0, 0.5, 1.0, 0.5, 0.0, 0.5]);
    document.animate(
        "CUBICSPLINE",
        &[0.0, 1.0],
        &[9., 9., 0.0, 0.25, 9., 9., 9., 9., 1.0, 0.75, 9., 9.],
    );
    let mesh = document.read()?.remove(0);
    let [linear, step, cubic] = &mesh.animations[..] else {
        panic!("{:?}", mesh.animations)
    };
    assert_eq!(linear.name, "a");
    assert_eq!(linear.sample(0.5), [0.5, 1.0]);
    assert_eq!(step.name, "a (animation 1)");
    assert_eq!(step.sample(0.99), [0.0, 0.5]);
    assert_eq!(step.sample(1.0), [1.0, 0.5]);
    assert_eq!(cubic.weights, [[0.0, 0.25], [1.0, 0.75]]);
    // In-tangents first, then values, then out-tangents: 8 leaving the first key, -4 arriving at the
    // second.
    let mut document = Document::square(1);
    document.animate("CUBICSPLINE", &[0.0, 0.5], &[9.0, 0.0, 8.0, -4.0, 1.0, 9.0]);
    let mesh = document.read()?.remove(0);
    // Half way: (0 + 1) / 2 + (8 - -4) / 8, times the half second between the keys.
    assert_eq!(mesh.animations[0].sample(0.25), [0.5 + 0.5 * 12.0 / 8.0]);
    Ok(())
}

#[test]
fn required_extensions_that_leave_geometry_alone_are_accepted() -> Result<(), ReadError> {
    for extension in [
        "KHR_materials_unlit",
        "KHR_texture_basisu",
        "KHR_texture_transform",
        "KHR_lights_punctual",
        "EXT_texture_webp",
        "KHR_mesh_quantization",
        "KHR_animation_pointer",
        "VRMC_materials_mtoon",
        "KHR_xmp_json_ld",
    ] {
        let mut document = Document::square(1);
        document.json["extensionsRequired"] = json!([extension]);
        let (_directory, file) = document.open()?;
        assert_eq!(file.mesh(0)?.mesh.triangles, SQUARE, "{extension}");
        assert!(file.extension_notes().is_empty());
    }
    Ok(())
}

/// Before, only required extensions were named, with "does not change the geometry" for all of them.
#[test]
fn extensions_that_are_not_applied_are_named_whether_required_or_not() -> Result<(), ReadError> {
    let notes = |used, required| {
        let mut document = Document::square(1);
        document.json["extensionsUsed"] = used;
        document.json["extensionsRequired"] = required;
        Ok::<_, ReadError>(document.open()?.1.extension_notes())
    };
    let springs =
        "VRMC_springBone: its springs are not applied, so hair and clothes follow the joints of the file and its clips";
    assert_eq!(notes(json!(["VRMC_springBone"]), json!([]))?, [springs]);
    assert_eq!(notes(json!([]), json!(["VRMC_springBone"]))?, [springs]);
    let both = notes(
        json!(["NEW_thing", "KHR_node_visibility", "MSFT_lod"]),
        json!(["MSFT_lod"]),
    )?;
    assert_eq!(both.len(), 2);
    assert!(both[0].starts_with("MSFT_lod: simpler versions"));
    assert_eq!(
        both[1],
        "NEW_thing: this extension is unknown, and the file is read without it"
    );
    assert!(notes(json!("no list"), json!([]))?.is_empty());
    let mut document = Document::square(1);
    document.json["extensions"] = json!({"VRM": {"blendShapeMaster": 5}});
    let notes = document.open()?.1.extension_notes();
    assert!(notes[0].starts_with("VRM: its expressions cannot be read, because it is malformed: blendShapeMaster: "));
    Ok(())
}

#[test]
fn a_byte_order_mark_and_later_minor_versions_are_accepted() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.json["asset"] = json!({"version": "2.1", "minVersion": "2.0"});
    let (directory, path) = document.save();
    let text = std::fs::read(&path).expect("it was written");
    std::fs::write(&path, [b"\xef\xbb\xbf", text.as_slice()].concat()).expect("it can be written again");
    assert_eq!(
        morph_collision_models::gltf::read::read_meshes(&path)?[0].triangles,
        SQUARE
    );
    drop(directory);
    Ok(())
}

#[test]
fn default_weights_are_those_of_the_node_or_else_of_the_mesh() -> Result<(), ReadError> {
    let weights = |bend: &dyn Fn(&mut Document)| {
        let mut document = Document::square(2);
        document.json["meshes"][0]["weights"] = json!([0.25, 0.5]);
        bend(&mut document);
        Ok::<_, ReadError>(document.read()?.remove(0).default_weights)
    };
    assert_eq!(weights(&|_| {})?, [0.25, 0.5]);
    assert_eq!(
        weights(&|document| document.json["nodes"] = json!([{"mesh": 0}]))?,
        [0.25, 0.5]
    );
    let nodes = json!([{"mesh": 7, "weights": [9]}, {"mesh": 0, "weights": [1, 0]}, {"mesh": 0, "weights": [0, 1]}]);
    assert_eq!(weights(&|document| document.json["nodes"] = nodes.clone())?, [1.0, 0.0]);
    assert!(weights(&|document| document.json["meshes"][0]["weights"] = json!([0, 0]))?.is_empty());
    let wrong = weights(&|document| document.json["meshes"][0]["weights"] = json!([1]));
    assert!(wrong.is_err_and(|error| error.to_string().contains("1 default weights for 2 targets")));
    let mut document = Document::square(2);
    document.json["nodes"] = nodes;
    let (_directory, file) = document.open()?;
    assert_eq!(file.default_weights(0, Some(2), 2)?, [0.0, 1.0]);
    assert_eq!(file.nodes_of(0).collect::<Vec<_>>(), [1, 2]);
    Ok(())
}

#[test]
fn a_clip_lasts_as_long_as_its_animation() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    // Another channel, of a node that has nothing to do with the mesh, ends later.
    let (input, output) = (
        document.floats("SCALAR", &[0.0, 4.0]),
        document.floats("VEC3", &[0.0; 6]),
    );
    document.list("nodes").push(json!({}));
    let animation = &mut document.json["animations"][0];
    let first = animation["samplers"][0].clone();
    animation["samplers"] = json!([first, {"input": input, "output": output}]);
    // A channel without a node is ignored.
    let first = animation["channels"][0].clone();
    animation["channels"] = json!([
        first,
        {"sampler": 1, "target": {"node": 1, "path": "translation"}},
        {"sampler": 1, "target": {"path": "pointer", "extensions": {}}},
    ]);
    let (_directory, file) = document.open()?;
    let [info] = &file.animations()[..] else {
        panic!("there is one animation")
    };
    assert_eq!((info.seconds, info.channels, info.ignored, info.nodes), (4.0, 3, 1, 1));
    assert!(file.stray_animations().is_empty());
    let clip = file.clips(0, None, 1).clips.remove(0);
    assert_eq!(clip.duration(), 4.0);
    assert_eq!([0.5, 2.5, 4.5].map(|time| clip.sample(time)[0]), [0.5, 1.0, 1.0]);
    Ok(())
}

#[test]
fn a_node_places_a_mesh_at_rest_and_in_clips() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    let (input, output) = (
        document.floats("SCALAR", &[0.0, 1.0]),
        document.floats("VEC3", &[0., 0., 0., 0., 8., 0.]),
    );
    document.json["nodes"] = json!([
        {"children": [1], "scale": [2, 2, 2]},
        {"mesh": 0, "translation": [1, 0, 0]},
    ]);
    document.json["animations"] = json!([{
        "name": "rise",
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": input, "output": output}],
    }]);
    let (_directory, file) = document.open()?;
    let placement = file.placement(0, 1)?;
    let at = |clip, time| placement.world_from_mesh(clip, time)[0].transform_point3(Vec3::X);
    assert_eq!(at(None, 0.0), Vec3::X * 4.0);
    assert_eq!(at(placement.clip("rise"), 0.5), Vec3::new(4.0, 4.0, 0.0));
    assert_eq!(file.world_from_node(0, 1)?.transform_point3(Vec3::X), Vec3::X * 4.0);
    assert!(file.placement(0, 9).is_err());
    Ok(())
}

#[test]
fn animations_of_other_things_are_passed_over() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.animate("LINEAR", &[0.0], &[1.0]);
    document.json["animations"][0]["channels"][0]["target"]["path"] = json!("rotation");
    assert!(document.read()?[0].animations.is_empty());
    Ok(())
}

#[test]
fn every_mesh_is_read_in_order_and_unnamed_ones_get_a_name() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.list("meshes").push(json!({"primitives": []}));
    let meshes = document.read()?;
    assert_eq!(meshes[1].name, "mesh_1");
    assert!(meshes[1].triangles.is_empty() && meshes[1].targets.is_empty());
    Ok(())
}

#[test]
fn buffers_inside_the_json_are_decoded() -> Result<(), ReadError> {
    let mut document = Document::new();
    let positions = document.floats("VEC3", &[0.0; 9]);
    document.mesh("m", vec![primitive(positions, None, &[])]);
    // 36 zero bytes in base64.
    let uri = format!("data:application/octet-stream;base64,{}", "A".repeat(48));
    document.json["buffers"] = json!([{"byteLength": 36, "uri": uri}]);
    assert_eq!(document.read()?[0].positions, [Vec3::ZERO; 3]);
    Ok(())
}
