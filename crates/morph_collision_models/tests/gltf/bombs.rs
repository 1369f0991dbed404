//! Small files that claim to be large are refused before anything is allocated.

use std::path::Path;

use crate::support::{Document, F32, U8, U32, primitive, write};
use morph_collision_models::gltf::read::{GltfFile, ReadError, ReadOptions, Remedy, read_meshes};
use serde_json::{Value, json};

/// An accessor without stored data, or with one stored element.
fn claim(document: &mut Document, kind: u32, shape: &str, count: u64, sparse: bool) -> usize {
    let mut accessor = json!({"componentType": kind, "type": shape, "count": count});
    if sparse {
        let (indices, values) = (document.view(&[0]), document.view(&[0; 12]));
        accessor["sparse"] = json!({
            "count": 1,
            "indices": {"bufferView": indices, "componentType": U8},
            "values": {"bufferView": values},
        });
    }
    let accessors = document.list("accessors");
    accessors.push(accessor);
    accessors.len() - 1
}

fn error(document: Document) -> ReadError {
    let (_directory, path) = document.save();
    let length = std::fs::metadata(&path).expect("it was written").len();
    assert!(length < 4000, "{length} bytes are no small file");
    match read_meshes(&path) {
        Ok(_) => panic!("this takes gigabytes"),
        Err(error) => error,
    }
}

#[track_caller]
fn assert_over_budget(error: &ReadError) {
    let message = error.to_string();
    assert_eq!(error.remedy(), Some(Remedy::MoreMemory), "{message}");
    assert!(
        message.contains("model.gltf") && message.contains("over the limit of 1.0 GiB"),
        "{message}"
    );
}

#[test]
fn the_budget_is_one_for_the_whole_file() {
    // Each alone is far below the limit; together they exceed it.
    let mut document = Document::new();
    let positions = claim(&mut document, F32, "VEC3", 3_000_000, false);
    let sparse: Vec<usize> = (0..8)
        .map(|_| claim(&mut document, F32, "VEC3", 3_000_000, true))
        .collect();
    let targets: Vec<usize> = sparse.into_iter().cycle().take(40).collect();
    document.mesh("m", vec![primitive(positions, None, &targets)]);
    assert_over_budget(&error(document));
}

#[test]
fn meshes_that_fit_one_by_one_do_not_fit_together() {
    let mut document = Document::new();
    let positions = claim(&mut document, F32, "VEC3", 9_000_000, false);
    for _ in 0..6 {
        document.mesh("m", vec![primitive(positions, None, &[])]);
    }
    let error = error(document);
    assert_over_budget(&error);
    assert!(matches!(error, ReadError::Mesh { mesh: 1.., .. }), "{error}");
}

#[test]
fn indices_vertices_and_primitives_are_counted() {
    type Claim<'a> = &'a dyn Fn(&mut Document) -> Vec<Value>;
    let claims: [Claim<'_>; 3] = [
        &|d| vec![primitive(claim(d, F32, "VEC3", 99_999_999, false), None, &[])],
        &|d| {
            let indices = claim(d, U32, "SCALAR", 300_000_000, false);
            vec![primitive(claim(d, F32, "VEC3", 3, false), Some(indices), &[])]
        },
        &|d| {
            let indices = claim(d, U32, "SCALAR", 30_000_000, false);
            vec![primitive(claim(d, F32, "VEC3", 3, false), Some(indices), &[]); 10]
        },
    ];
    for claim in claims {
        let mut document = Document::new();
        let primitives = claim(&mut document);
        document.mesh("m", primitives);
        assert_over_budget(&error(document));
    }
}

#[test]
fn more_triangles_than_can_be_numbered_are_refused() {
    // The second count times 36 bytes slightly exceeds a u64.
    for (count, primitives) in [
        (u64::MAX, 1),
        (u64::MAX, 2),
        (1_537_228_672_809_129_303, 1),
        (3 * (1 << 32), 1),
        (3 * (1 << 31), 2),
    ] {
        let mut document = Document::new();
        let positions = claim(&mut document, F32, "VEC3", 3, false);
        let indices = claim(&mut document, U32, "SCALAR", count, false);
        let primitive = primitive(positions, Some(indices), &[]);
        document.mesh("m", vec![primitive; primitives]);
        let message = error(document).to_string();
        assert!(
            message.contains("beyond 2^32 vertices or triangles"),
            "{count}: {message}"
        );
    }
}

#[test]
fn targets_that_are_not_stored_cost_nothing() -> Result<(), ReadError> {
    let mut document = Document::new();
    let positions = claim(&mut document, F32, "VEC3", 1_000_000, false);
    let indices = document.accessor(U8, "SCALAR", 3, &[0, 0, 0]);
    let zero = claim(&mut document, F32, "VEC3", 1_000_000, false);
    // These would take 12 GB if they were stored.
    document.mesh("m", vec![primitive(positions, Some(indices), &vec![zero; 1000])]);
    let (_directory, file) = document.open()?;
    let before = file.budget().left();
    let mesh = file.mesh(0)?.mesh;
    assert!(mesh.targets.len() == 1000 && mesh.targets.iter().all(Vec::is_empty));
    assert!(before - file.budget().left() < 20_000_000);
    Ok(())
}

#[test]
fn clips_are_counted() -> Result<(), ReadError> {
    let mut document = Document::square(0);
    document.animate("STEP", &[0.0], &[]);
    document.json["accessors"].as_array_mut().expect("a list").truncate(2);
    let times = claim(&mut document, F32, "SCALAR", 1 << 30, false);
    let nothing = claim(&mut document, F32, "SCALAR", 0, false);
    document.json["animations"][0]["samplers"][0] = json!({"input": times, "output": nothing});
    let (_directory, file) = document.open()?;
    let clips = file.clips(0, None, 0);
    assert!(clips.clips.is_empty());
    assert_eq!(
        clips.broken.first().and_then(ReadError::remedy),
        Some(Remedy::MoreMemory),
        "{clips:?}"
    );
    Ok(())
}

#[test]
fn data_and_lists_are_counted_before_they_are_decoded() {
    let options = ReadOptions {
        memory_limit: 100_000,
        ..ReadOptions::default()
    };
    let refused = |json: String| {
        let error = GltfFile::parse(json.as_bytes(), Path::new("m.gltf"), &options).and_then(|file| file.mesh(0));
        let error = error.expect_err("more than 100 kB");
        assert_eq!(error.remedy(), Some(Remedy::MoreMemory), "{error}");
    };
    refused(format!(r#"{{"asset": {{}}, "nodes": [0{}]}}"#, ",0".repeat(1000)));
    refused(" ".repeat(100_001));
    let mut document = Document::square(0);
    document.json["buffers"] = json!([{"byteLength": 9, "uri": format!("data:;base64,{}", "A".repeat(30_000))}]);
    refused(document.json.to_string());
}

#[test]
fn a_larger_limit_lets_a_file_through() -> Result<(), ReadError> {
    let mut document = Document::new();
    let positions = claim(&mut document, F32, "VEC3", 30_000, false);
    document.mesh("m", vec![primitive(positions, None, &[])]);
    let (_directory, path) = write(document.json.to_string().as_bytes(), "model.gltf");
    let with = |memory_limit| {
        let options = ReadOptions {
            memory_limit,
            ..ReadOptions::default()
        };
        GltfFile::open(&path, &options)?.mesh(0)
    };
    assert_eq!(
        with(100_000).map_err(|error| error.remedy()),
        Err(Some(Remedy::MoreMemory))
    );
    assert_eq!(with(10_000_000)?.mesh.positions.len(), 30_000);
    Ok(())
}

#[test]
fn a_buffer_stays_counted_once_its_mesh_is_gone() -> Result<(), ReadError> {
    let mut document = Document::square(0);
    let length = 600_000_usize;
    document.json["buffers"] = json!([
        {"byteLength": length, "uri": "model.bin"},
        {"byteLength": length, "uri": "model.bin"},
    ]);
    document.bin.resize(length, 0);
    let positions = document.json["accessors"][0].clone();
    let mut view = document.json["bufferViews"][0].clone();
    view["buffer"] = json!(1);
    let views = document.list("bufferViews");
    views.push(view);
    let view = views.len() - 1;
    let mut other = positions;
    other["bufferView"] = json!(view);
    let accessors = document.list("accessors");
    accessors.push(other);
    let other = accessors.len() - 1;
    document.mesh("n", vec![primitive(other, Some(1), &[])]);
    let (_directory, path) = document.save();
    let with = |memory_limit| {
        let options = ReadOptions {
            memory_limit,
            ..ReadOptions::default()
        };
        GltfFile::open(&path, &options)
    };
    let lent = |file: &GltfFile, mesh| {
        let found = file.budget().lend(|| file.mesh(mesh));
        found.map(|_| ()).map_err(|error| error.remedy())
    };
    // The first mesh's buffer takes more than half of it.
    let file = with(1_000_000)?;
    assert_eq!(lent(&file, 0), Ok(()));
    assert!(file.budget().left() < 400_000, "{}", file.budget().left());
    assert_eq!(lent(&file, 1), Err(Some(Remedy::MoreMemory)));
    assert_eq!(lent(&file, 0), Ok(()));
    // What did not fit while something else was in memory fits later.
    let file = with(1_000_000)?;
    let crowded = file.budget().lend(|| {
        file.budget().take(500_000, 1, String::new).expect("there is room");
        file.mesh(0).map(|_| ()).map_err(|error| error.remedy())
    });
    assert_eq!(crowded, Err(Some(Remedy::MoreMemory)));
    assert_eq!(lent(&file, 0), Ok(()));
    Ok(())
}

#[test]
fn long_texts_are_cut_in_errors() -> Result<(), ReadError> {
    let long = "x".repeat(100_000);
    let mut document = Document::square(1);
    document.animate("LINEAR", &[0.0], &[1.0]);
    let animation = &mut document.json["animations"][0];
    animation["name"] = json!(long);
    animation["channels"] = json!([0, 0, {"sampler": 9, "target": {"node": 0, "path": "weights"}}]);
    document.list("meshes").push(json!({"primitives": long}));
    let (_directory, file) = document.open()?;
    let mut errors = file.stray_animations();
    assert_eq!(errors.len(), 2);
    errors.extend(file.clips(0, None, 1).broken);
    errors.extend(file.mesh(1).err());
    assert_eq!(errors.len(), 4);
    for error in errors {
        let message = error.to_string();
        assert!(
            message.len() < 1000 && message.contains("model.gltf"),
            "{} bytes",
            message.len()
        );
    }
    Ok(())
}

#[test]
fn the_weights_of_a_step_are_counted_as_often_as_they_are_held() -> Result<(), ReadError> {
    let keys = 10_000;
    let times: Vec<f32> = (0..keys).map(|key| key as f32).collect();
    let mut document = Document::square(1);
    document.animate("STEP", &times, &vec![0.5; times.len()]);
    document.json["animations"][0]["name"] = json!("a".repeat(1000));
    let (_directory, file) = document.open()?;
    // The JSON and the buffer do not count again.
    assert_eq!(file.clips(0, None, 1).clips.len(), 1);
    let before = file.budget().left();
    assert_eq!(file.clips(0, None, 1).clips.len(), 1);
    assert_eq!(before - file.budget().left(), keys * (200 + 24) + 4 * 1000);
    Ok(())
}
