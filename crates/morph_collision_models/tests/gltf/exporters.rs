//! Habits of real exporters: files of `data/field`, and their siblings.

use glam::Vec3;
use morph_collision_models::gltf::read::{GltfFile, ReadError, ReadOptions, read_meshes};
use morph_collision_models::mesh::MorphMesh;
use serde_json::{Value, json};

use crate::support::{Document, field, primitive, write};

fn read(name: &str) -> Result<MorphMesh, ReadError> {
    Ok(read_meshes(&field(name))?.remove(0))
}

fn bounds(points: &[Vec3]) -> (Vec3, Vec3) {
    let far = Vec3::INFINITY;
    points
        .iter()
        .fold((far, -far), |(low, high), point| (low.min(*point), high.max(*point)))
}

/// The bytes of a field file with changed JSON, and with bytes of its binary chunk overwritten by zeros if `from` says where.
fn bent(name: &str, zeros: Option<std::ops::Range<usize>>, bend: impl FnOnce(&mut Value)) -> GltfFile {
    let bytes = std::fs::read(field(name)).expect("the file is there");
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| bytes[at + i])) as usize;
    let (json, rest) = (&bytes[20..20 + word(12)], &bytes[20 + word(12)..]);
    let mut json: Value = serde_json::from_slice(json).expect("it is JSON");
    bend(&mut json);
    let mut json = json.to_string();
    json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
    let length = |length: usize| (length as u32).to_le_bytes();
    let mut rest = rest.to_vec();
    if let Some(zeros) = zeros {
        rest[8..][zeros].fill(0);
    }
    let sizes = [length(20 + json.len() + rest.len()), length(json.len())];
    let glb = [&bytes[..8], &sizes[0], &sizes[1], b"JSON", json.as_bytes(), &rest].concat();
    GltfFile::parse(&glb, &field(name), &ReadOptions::default()).expect("it can be parsed")
}

/// Before, all vertices were at the origin.
#[test]
fn draco_is_decoded_although_it_is_only_used() -> Result<(), ReadError> {
    let mesh = read("c45_draco_used_not_required")?;
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    let (low, high) = bounds(&mesh.positions);
    assert!((low + 0.5).abs().max_element() < 1e-3 && (high - 0.5).abs().max_element() < 1e-3);
    // Nor need the file name it at all.
    let unnamed = bent("c45_draco_used_not_required", None, |json| {
        json["extensionsUsed"] = json!([]);
    });
    assert_eq!(unnamed.mesh(0)?.mesh.positions, mesh.positions);
    Ok(())
}

/// Before: "buffer 1: it has no URI".
#[test]
fn meshopt_is_decoded_although_it_is_only_used() -> Result<(), ReadError> {
    let mesh = read("c45b_meshopt_used_not_required")?;
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (8, 12));
    assert_eq!(bounds(&mesh.positions), (Vec3::NEG_ONE, Vec3::ONE));
    Ok(())
}

#[test]
fn a_stream_that_cannot_be_decoded_is_replaced_by_plain_data() -> Result<(), ReadError> {
    // The positions of three vertices beside a stream of zeros.
    let mesh = |required: &[&str], extension: &dyn Fn(&mut Document, usize)| {
        let mut document = Document::new();
        let positions = document.floats("VEC3", &[0., 0., 0., 1., 0., 0., 0., 1., 0.]);
        let stream = document.view(&[0; 16]);
        document.mesh("m", vec![primitive(positions, None, &[])]);
        extension(&mut document, stream);
        document.json["extensionsRequired"] = json!(required);
        document
            .open()
            .and_then(|(_directory, file)| Ok(file.mesh(0)?.mesh.positions))
    };
    let draco = |document: &mut Document, stream: usize| {
        let stream = json!({"KHR_draco_mesh_compression": {"bufferView": stream, "attributes": {"POSITION": 0}}});
        document.json["meshes"][0]["primitives"][0]["extensions"] = stream;
    };
    let meshopt = |document: &mut Document, stream: usize| {
        let at = document.json["bufferViews"][stream]["byteOffset"].clone();
        let stream = json!({"buffer": 0, "byteOffset": at, "byteLength": 16, "byteStride": 12, "count": 3, "mode": "ATTRIBUTES"});
        document.json["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": stream});
    };
    let malformed = |document: &mut Document, _: usize| {
        document.json["bufferViews"][0]["extensions"] = json!({"KHR_meshopt_compression": {"buffer": 0}});
        document.json["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": 7});
    };
    type Compress<'a> = &'a dyn Fn(&mut Document, usize);
    let extensions: [(&[&str], Compress<'_>, &str); 3] = [
        (&["KHR_draco_mesh_compression"], &draco, "the Draco decoder says"),
        (&["EXT_meshopt_compression"], &meshopt, "the meshopt decoder says"),
        (
            &["KHR_draco_mesh_compression", "KHR_meshopt_compression"],
            &malformed,
            "its extension is malformed",
        ),
    ];
    for (names, extension, says) in extensions {
        assert_eq!(mesh(&[], extension)?, [Vec3::ZERO, Vec3::X, Vec3::Y]);
        let error = mesh(names, extension)
            .expect_err("plain data must not be needed")
            .to_string();
        assert!(error.contains(says), "{error}");
    }
    // Without plain data, the stream is at fault.
    let broken = bent("c45b_meshopt_used_not_required", Some(32..105), |_| {});
    let error = broken.mesh(0).expect_err("it cannot be decoded").to_string();
    assert!(
        error.contains("buffer view 1, which cannot be decoded: the meshopt decoder says"),
        "{error}"
    );
    let broken = bent("c45_draco_used_not_required", Some(0..80), |_| {});
    let error = broken.mesh(0).expect_err("it cannot be decoded").to_string();
    assert!(error.contains("the Draco decoder says"), "{error}");
    Ok(())
}

/// Before, all sets after the second were ignored.
#[test]
fn any_number_of_sets_of_influences_is_read() -> Result<(), ReadError> {
    let mesh = read("c01_twelve_influences")?;
    assert!(mesh.to_model().is_ok());
    let sets = mesh.skin.expect("it is skinned").sets;
    assert_eq!(sets.len(), 3);
    for vertex in 0..mesh.positions.len() {
        let sum: f32 = sets.iter().flat_map(|set| set.weights[vertex]).sum();
        assert!((sum - 1.0).abs() < 1e-5, "{sum}");
    }
    assert!(sets[2].joints.as_flattened().iter().any(|&joint| joint > 7));

    let error_of = |missing: &str| {
        let file = bent("c01_twelve_influences", None, |json| {
            let attributes = &mut json["meshes"][0]["primitives"][0]["attributes"];
            attributes.as_object_mut().expect("an object").remove(missing);
        });
        file.skin(0, None).expect_err("a set is incomplete").to_string()
    };
    for missing in ["WEIGHTS_2", "JOINTS_2", "WEIGHTS_1"] {
        let error = error_of(missing);
        assert!(
            error.contains(&format!("primitive 0 has no {missing} attribute")),
            "{error}"
        );
    }
    // Sets end where one is missing.
    let far = bent("c01_twelve_influences", None, |json| {
        let attributes = &mut json["meshes"][0]["primitives"][0]["attributes"];
        attributes["JOINTS_18446744073709551615"] = json!(1);
    });
    let error = far.skin(0, None).expect_err("a set is missing").to_string();
    assert!(error.contains("has no JOINTS_3 attribute"), "{error}");
    Ok(())
}

/// Before, they had default names.
#[test]
fn names_of_targets_are_found_in_primitives() -> Result<(), ReadError> {
    assert_eq!(read("c21_names_in_primitive")?.target_names, ["blink_left", "ah", "oh"]);
    Ok(())
}

#[test]
fn every_target_has_the_first_name_that_is_stored_for_it() -> Result<(), ReadError> {
    let names = |of_mesh: Value, of_primitive: Value, of_accessors: [Value; 3]| {
        let mut document = Document::square(3);
        for (target, name) in of_accessors.into_iter().enumerate() {
            let mut accessor = document.json["accessors"][2].clone();
            accessor["name"] = name;
            document.list("accessors").push(accessor);
            let accessor = document.list("accessors").len() - 1;
            document.json["meshes"][0]["primitives"][0]["targets"][target]["POSITION"] = json!(accessor);
        }
        document.json["meshes"][0]["extras"] = of_mesh;
        // The first primitive has no names.
        let mut second = document.json["meshes"][0]["primitives"][0].clone();
        second["extras"] = of_primitive;
        let primitives = document.json["meshes"][0]["primitives"].as_array_mut();
        primitives.expect("a list").push(second);
        Ok::<_, ReadError>(document.read()?.remove(0).target_names.join(" "))
    };
    let none = [json!(null), json!(null), json!(null)];
    let accessors = [json!("x"), json!("y"), json!("z")];
    let named = |names: Value| json!({"targetNames": names});
    for (of_mesh, of_primitive, of_accessors, expected) in [
        (named(json!(["a", "b", "c"])), named(json!(["d"])), &accessors, "a b c"),
        (
            named(json!(["a"])),
            named(json!(["d", "e"])),
            &accessors,
            "a e target_2",
        ),
        (named(json!(["a", 5, "c", "d"])), json!(7), &none, "a target_1 c"),
        (
            named(json!([])),
            named(json!([null, "e"])),
            &none,
            "target_0 e target_2",
        ),
        (json!("no object"), json!([]), &accessors, "x y z"),
        (named(json!({"a": 0})), json!({"other": 1}), &accessors, "x y z"),
        (
            json!(null),
            json!(null),
            &[json!("x"), json!("x"), json!("z")],
            "target_0 target_1 target_2",
        ),
        (
            json!(null),
            json!(null),
            &[json!("x"), json!(""), json!("z")],
            "target_0 target_1 target_2",
        ),
    ] {
        assert_eq!(names(of_mesh, of_primitive, of_accessors.clone())?, expected);
    }
    Ok(())
}

/// Before: "channel 0 refers to a sampler that does not exist".
#[test]
fn a_malformed_sampler_names_its_field() -> Result<(), ReadError> {
    let options = ReadOptions::default();
    let file = GltfFile::open(&field("c47_interpolation_is_a_number"), &options)?;
    let clips = file.clips(0, None, 1);
    let says = "channel 0: sampler 0 is malformed: interpolation: invalid type: integer `0`, expected a string";
    assert!(clips.clips.is_empty() && clips.broken.len() == 1);
    assert!(clips.broken[0].to_string().ends_with(says), "{}", clips.broken[0]);
    assert_eq!(file.mesh(0)?.mesh.triangles.len(), 12);
    Ok(())
}

#[test]
fn every_malformed_element_names_its_field() {
    let error = |bend: &dyn Fn(&mut Value)| {
        let mut document = Document::square(1);
        bend(&mut document.json);
        document.error()
    };
    for (says, error) in [
        (
            "accessor 0 is malformed: componentType: invalid type: floating point `5126.5`, expected u32",
            error(&|json| json["accessors"][0]["componentType"] = json!(5126.5)),
        ),
        (
            "mesh 0 \"mesh_0\": it is malformed: primitives[0].targets[0].POSITION: invalid type: string \"2\"",
            error(&|json| json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = json!("2")),
        ),
        (
            "mesh 0 \"mesh_0\": it is malformed: primitives[0].attributes.POSITION: invalid type: string \"0\"",
            error(&|json| json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!("0")),
        ),
        (
            "buffer view 0, which is malformed: missing field `byteLength`",
            error(&|json| json["bufferViews"][0] = json!({"buffer": 0})),
        ),
        (
            "not a glTF 2.0 file: meshes: invalid type: map, expected a sequence",
            error(&|json| json["meshes"] = json!({})),
        ),
    ] {
        assert!(error.contains(says), "{error}");
    }
    // Names from the file reach the terminal escaped.
    let (_directory, path) = write(b"{\"asset\": {}, \"\\u001b[2J\": {\"a\": x}}", "model.gltf");
    let error = read_meshes(&path).expect_err("it is no JSON").to_string();
    assert!(
        error.contains("expected value at line 1") && !error.contains('\u{1b}'),
        "{error}"
    );
}

/// Before: "invalid type: floating point `5126.0`, expected u32".
#[test]
fn integers_may_be_written_as_floats() -> Result<(), ReadError> {
    let mesh = read("c24_integers_as_floats")?;
    assert_eq!(
        (mesh.positions.len(), mesh.triangles.len(), mesh.targets.len()),
        (8, 12, 2)
    );
    assert_eq!(mesh.targets[1].iter().map(|moved| moved.y).fold(0.0, f32::max), 3.0);

    // Everywhere, and next to fractions.
    fn with_floats(value: &mut Value) {
        match value {
            Value::Number(number) => *value = json!(number.as_f64()),
            Value::Array(list) => list.iter_mut().for_each(with_floats),
            Value::Object(object) => object.values_mut().for_each(with_floats),
            Value::Null | Value::Bool(_) | Value::String(_) => {}
        }
    }
    let mut document = Document::square(2);
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 0.5, 1.0, 0.25]);
    document.json["meshes"][0]["weights"] = json!([0.5, 1]);
    document.json["buffers"] = json!([{"byteLength": document.bin.len(), "uri": "model.bin"}]);
    document.json["scene"] = json!(1);
    document.json["scenes"] = json!([{}, {"nodes": [0]}]);
    let mut floats = Document {
        json: document.json.clone(),
        bin: document.bin.clone(),
    };
    with_floats(&mut floats.json);
    assert!(floats.json.to_string().contains("\"componentType\":5126.0"));
    let (_directory, file) = floats.open()?;
    assert_eq!(file.default_scene(), Some(1));
    let path = file.path().to_owned();
    assert_eq!(read_meshes(&path)?, document.read()?);
    Ok(())
}

/// Before: "expected value at line 1 column 1", or garbage in place of a small buffer.
#[test]
fn pointers_of_git_lfs_are_named() {
    let pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n";
    for name in ["model.glb", "model.gltf"] {
        let (_directory, path) = write(pointer.as_bytes(), name);
        let error = read_meshes(&path).expect_err("it is a pointer").to_string();
        assert!(
            error.contains("it is a Git LFS pointer") && error.contains("`git lfs pull`"),
            "{error}"
        );
    }
    for length in [36, 1_000_000] {
        let mut document = Document::new();
        let positions = document.floats("VEC3", &[0.0; 9]);
        document.mesh("m", vec![primitive(positions, None, &[])]);
        document.json["buffers"] = json!([{"byteLength": length, "uri": "model.bin"}]);
        document.bin = pointer.into();
        let error = document.error();
        assert!(
            error.contains("buffer 0 \"model.bin\": its file is a Git LFS pointer"),
            "{error}"
        );
    }
}
