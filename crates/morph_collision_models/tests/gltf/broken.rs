//! Broken files give an error with its place, and never a panic.

use std::path::Path;

use crate::support::{Document, F32, U8, primitive, write};
use morph_collision_models::generated;
use morph_collision_models::gltf::read::{ReadError, parse_meshes, read_meshes};
use morph_collision_models::gltf::write::{Appearance, to_glb};
use serde_json::json;

fn error_of(bytes: &[u8]) -> String {
    let (_directory, path) = write(bytes, "model.glb");
    match read_meshes(&path) {
        Ok(meshes) => panic!("accepted: {meshes:?}"),
        Err(error) => error.to_string(),
    }
}

#[track_caller]
fn assert_says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "\"{message}\" should say \"{part}\"");
    }
}

#[test]
fn a_missing_file_is_named() {
    let error = read_meshes(Path::new("no/such/file.glb"));
    assert!(
        matches!(&error, Err(ReadError::Io { path, .. }) if path == Path::new("no/such/file.glb")),
        "{error:?}"
    );
}

#[test]
fn other_files_are_not_gltf() {
    for bytes in [
        &b""[..],
        b"solid cube",
        b"{}",
        b"[1, 2]",
        b"glTF",
        b"glTF\x02\0\0\0\x03\0\0\0",
        b"\xff\xfe\0\0",
    ] {
        assert_says(&error_of(bytes), &["model.glb", "not a glTF 2.0 file"]);
    }
}

#[test]
fn truncation_and_corruption_are_survived_everywhere() {
    let glb = to_glb(&generated::dolphin(0), &Appearance::default()).expect("a generated mesh can be written");
    for length in (0..glb.len()).step_by(97) {
        assert_says(&error_of(&glb[..length]), &["model.glb"]);
    }
    // Changes digits and letters of the JSON one at a time. The file is read or refused, without a
    // panic.
    for at in (20..3000).step_by(7) {
        for replacement in *b"9x-" {
            let mut corrupt = glb.clone();
            corrupt[at] = replacement;
            let (_directory, path) = write(&corrupt, "corrupt.glb");
            let _survived = read_meshes(&path);
        }
    }
}

#[test]
fn a_missing_or_short_buffer_is_named() {
    let mut document = Document::square(1);
    document.json["buffers"] = json!([{"byteLength": 4, "uri": "elsewhere.bin"}]);
    assert_says(&document.error(), &["model.gltf", "buffer 0 \"elsewhere.bin\""]);

    let mut document = Document::square(1);
    document.json["buffers"] = json!([{"byteLength": 1_000_000, "uri": "model.bin"}]);
    assert_says(&document.error(), &["buffer 0", "1000000"]);

    let mut document = Document::square(1);
    document.json["buffers"] = json!([{"byteLength": 4, "uri": "%ff.bin"}]);
    assert_says(&document.error(), &["buffer 0", "UTF-8"]);
}

#[test]
fn bytes_that_refer_to_a_file_are_refused_with_its_name() {
    let mut document = Document::square(1);
    document.json["buffers"] = json!([{"byteLength": 4, "uri": "elsewhere.bin"}]);
    let bytes = document.json.to_string();
    let error = parse_meshes(bytes.as_bytes(), Path::new("model.gltf")).unwrap_err();
    assert_says(&error.to_string(), &["model.gltf", "buffer 0", "elsewhere.bin"]);
}

#[test]
fn extensions_that_might_change_geometry_are_refused_with_advice() {
    for extension in ["NEW_something", "KHR_gaussian_splatting"] {
        let mut document = Document::square(1);
        document.json["extensionsRequired"] = json!(["KHR_materials_unlit", extension]);
        let needs = format!("requires the glTF extension {extension}, which this reader does not know");
        assert_says(
            &document.error(),
            &[&needs, "export the model again without it", "gltf-transform"],
        );
    }
}

#[test]
fn other_versions_of_gltf_are_refused() {
    for (asset, needed) in [
        (json!({"version": "1.0"}), "glTF 1.0"),
        (json!({"version": "3.0"}), "glTF 3.0"),
        (json!({"version": "2.1", "minVersion": "2.1"}), "glTF 2.1"),
        (json!({"version": "two"}), "glTF two"),
    ] {
        let mut document = Document::square(1);
        document.json["asset"] = asset;
        assert_says(&document.error(), &["not a glTF 2.0 file", needed, "convert it"]);
    }
    // In glTF 1.0, lists were objects.
    let mut document = Document::square(1);
    document.json["asset"] = json!({"version": "1.0"});
    document.json["accessors"] = json!({"first": {}});
    assert_says(&document.error(), &["glTF 1.0"]);
}

#[test]
fn a_primitive_without_positions_is_named() {
    let mut document = Document::square(1);
    document.json["meshes"][0]["primitives"][0]["attributes"] = json!({"NORMAL": 0});
    assert_says(&document.error(), &["mesh 0 \"m\"", "primitive 0 has no POSITION"]);
}

#[test]
fn primitives_that_disagree_about_their_targets_are_refused() {
    let mut document = Document::square(2);
    let second = primitive(0, Some(1), &[2]);
    document.json["meshes"][0]["primitives"]
        .as_array_mut()
        .expect("a list")
        .push(second);
    assert_says(
        &document.error(),
        &["mesh 0 \"m\"", "primitive 1 has 1 morph targets, but primitive 0 has 2"],
    );
}

#[test]
fn a_target_of_another_length_is_named() {
    let mut document = Document::square(2);
    let short = document.floats("VEC3", &[0.0; 9]);
    document.json["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] = json!(short);
    assert_says(
        &document.error(),
        &["primitive 0, target 1 has 3 displacements for 4 vertices"],
    );
}

#[test]
fn a_vertex_out_of_range_is_named() {
    let mut document = Document::square(0);
    document.bin[48 + 4] = 9;
    assert_says(&document.error(), &["primitive 0, index 2 refers to vertex 9 of 4"]);
}

#[test]
fn half_a_triangle_is_refused() {
    let mut document = Document::square(0);
    document.json["accessors"][1]["count"] = json!(5);
    assert_says(&document.error(), &["5 triangle corners, which is no multiple of 3"]);
}

#[test]
fn accessors_that_cannot_be_decoded_are_named() {
    let check = |bend: &dyn Fn(&mut Document), parts: &[&str]| {
        let mut document = Document::square(1);
        bend(&mut document);
        assert_says(&document.error(), parts);
    };
    let primitive = |d: &mut Document| d.json["meshes"][0]["primitives"][0].take();
    check(
        &|d| {
            let mut p = primitive(d);
            p["attributes"]["POSITION"] = json!(77);
            d.json["meshes"][0]["primitives"][0] = p;
        },
        &["primitive 0, POSITION: accessor 77 does not exist"],
    );
    check(
        &|d| d.json["meshes"][0]["primitives"][0]["indices"] = json!(77),
        &["indices: accessor 77 does not exist"],
    );
    check(
        &|d| d.json["accessors"][0]["bufferView"] = json!(50),
        &["buffer view 50, which does not exist"],
    );
    check(
        &|d| d.json["bufferViews"][0]["buffer"] = json!(3),
        &["accessor 0: buffer 3: it does not exist"],
    );
    check(
        &|d| d.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
        &["accessor 0 reaches beyond"],
    );
    check(
        &|d| d.json["accessors"][0]["byteOffset"] = json!(u64::MAX),
        &["accessor 0 reaches beyond"],
    );
    check(
        &|d| d.json["accessors"][2]["byteOffset"] = json!(4),
        &["target 0 POSITION: accessor 2 reaches beyond"],
    );
    check(
        &|d| d.json["accessors"][1]["count"] = json!(u64::MAX),
        &["accessor 1 reaches beyond"],
    );
    check(
        &|d| d.json["bufferViews"][0]["byteStride"] = json!(4),
        &["12 bytes every 4 bytes"],
    );
    check(
        &|d| d.json["accessors"][0]["type"] = json!("VEC2"),
        &["accessor 0 holds VEC2 of F32 where VEC3"],
    );
    check(
        &|d| d.json["accessors"][1]["componentType"] = json!(F32),
        &["accessor 1 holds SCALAR of F32"],
    );
    check(
        &|d| d.json["accessors"][1]["componentType"] = json!(1),
        &["accessor 1 holds SCALAR of an unknown"],
    );
    check(
        &|d| d.json["meshes"][0]["primitives"][0]["mode"] = json!(17),
        &["primitive 0 has an unknown mode"],
    );
}

#[test]
fn sparse_accessors_are_checked() {
    let sparse = |index: u8, count: u64| {
        let mut document = Document::square(1);
        let indices = document.view(&[index]);
        let values = document.view(&[0; 12]);
        document.json["accessors"][2] = json!({
            "componentType": F32, "type": "VEC3", "count": count,
            "sparse": {
                "count": 1,
                "indices": {"bufferView": indices, "componentType": U8},
                "values": {"bufferView": values},
            },
        });
        document
    };
    assert_says(
        &sparse(4, 4).error(),
        &["target 0 POSITION: accessor 2 replaces element 4 of 4"],
    );

    let mut huge = sparse(0, u64::from(u32::MAX));
    huge.json["meshes"][0]["primitives"][0] = primitive(2, None, &[]);
    assert_says(
        &huge.error(),
        &["mesh 0 \"m\"", "4294967295 vertices", "over the limit of 1.0 GiB"],
    );
}

fn messages(errors: &[ReadError]) -> String {
    let messages = errors.iter().map(ToString::to_string);
    messages.collect::<Vec<_>>().join("\n")
}

#[test]
fn broken_clips_are_named() {
    let check = |times: &[f32], weights: &[f32], bend: &dyn Fn(&mut Document), part: &str| {
        let mut document = Document::square(1);
        document.animate("LINEAR", times, weights);
        bend(&mut document);
        let (_directory, file) = document.open().expect("the mesh is sound");
        let mut problems = file.clips(0, None, 1).broken;
        problems.extend(file.stray_animations());
        assert_says(&messages(&problems), &["model.gltf", "animation 0 \"a\"", part]);
        // The mesh can still be read.
        let mesh = file.mesh(0).expect("the mesh is sound").mesh;
        assert_eq!((mesh.triangles.len(), file.clips(0, None, 1).clips.len()), (2, 0));
    };
    let channel = |d: &mut Document, name: &str, value: usize| match name {
        "sampler" => d.json["animations"][0]["channels"][0]["sampler"] = json!(value),
        _ => d.json["animations"][0]["channels"][0]["target"]["node"] = json!(value),
    };
    check(
        &[0.0, 1.0],
        &[0.0],
        &|_| (),
        "channel 0 has 1 weights, but 2 keys of 1 targets need 2",
    );
    check(&[1.0, 0.5], &[0.0, 0.0], &|_| (), "key 1 is at 0.5 s");
    check(&[f32::NAN], &[0.0], &|_| (), "key 0 is at NaN s");
    check(
        &[0.0],
        &[f32::INFINITY],
        &|_| (),
        "key 0, target 0: the weight inf is not finite",
    );
    check(
        &[0.0],
        &[0.0],
        &|d| channel(d, "sampler", 5),
        "channel 0: sampler 5 does not exist",
    );
    check(
        &[0.0],
        &[0.0],
        &|d| channel(d, "node", 5),
        "channel 0: node 5 does not exist",
    );
    check(
        &[0.0],
        &[0.0],
        &|d| d.json["nodes"][0]["mesh"] = json!(5),
        "channel 0: mesh 5 does not exist",
    );
    check(
        &[0.0],
        &[0.0],
        &|d| d.json["accessors"][3]["bufferView"] = json!(99),
        "key times: accessor 3",
    );
}
