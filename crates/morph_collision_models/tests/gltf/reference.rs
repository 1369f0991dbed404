//! Files in every valid form are read as two other readers have them: the `gltf` crate, and a few lines below that follow the
//! specification word by word, from the JSON and the bytes. Neither shares code with ours.

use glam::Vec3;
use morph_collision_models::gltf::read::{GltfFile, ReadError, ReadOptions};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::{Value, json};

use crate::support::{Document, F32, I16, U8, U16, U32};

const I8: u32 = 5120;

/// The types of vertex attributes, and whether their integers are fractions. All of them are valid with `KHR_mesh_quantization`.
const ATTRIBUTES: [(u32, bool); 9] = [
    (F32, false),
    (I8, false),
    (I8, true),
    (U8, false),
    (U8, true),
    (I16, false),
    (I16, true),
    (U16, false),
    (U16, true),
];

/// How an accessor is stored.
#[derive(Clone, Copy, Debug)]
enum Form {
    Plain,
    /// With other data between the elements, before and after them.
    Strided,
    /// With replaced elements, whose indices have this type.
    Sparse(u32),
    /// Zeros with replaced elements.
    SparseZeros(u32),
    /// Zeros.
    Unstored,
}

const FORMS: [Form; 9] = [
    Form::Plain,
    Form::Strided,
    Form::Sparse(U8),
    Form::Sparse(U16),
    Form::Sparse(U32),
    Form::SparseZeros(U8),
    Form::SparseZeros(U16),
    Form::SparseZeros(U32),
    Form::Unstored,
];

fn size(kind: u32) -> usize {
    match kind {
        I8 | U8 => 1,
        I16 | U16 => 2,
        _ => 4,
    }
}

fn element(rng: &mut impl Rng, kind: u32, components: usize) -> Vec<u8> {
    let number = |rng: &mut dyn Rng| match kind {
        F32 => rng.random_range(-9.0_f32..9.0).to_le_bytes().to_vec(),
        _ => (0..size(kind)).map(|_| rng.random()).collect(),
    };
    (0..components).flat_map(|_| number(rng)).collect()
}

/// Adds an accessor with random content.
fn add(
    document: &mut Document,
    rng: &mut impl Rng,
    (kind, normalized): (u32, bool),
    shape: &str,
    count: usize,
    form: Form,
) -> usize {
    let components = match shape {
        "VEC3" => 3,
        "VEC4" => 4,
        _ => 1,
    };
    let elements = |rng: &mut _, count: usize| {
        (0..count)
            .flat_map(|_| element(rng, kind, components))
            .collect::<Vec<u8>>()
    };
    let mut accessor = json!({"componentType": kind, "type": shape, "count": count, "normalized": normalized});
    match form {
        Form::Plain | Form::Sparse(_) => accessor["bufferView"] = document.view(&elements(rng, count)).into(),
        Form::Strided => {
            let (length, offset) = (components * size(kind), 4);
            let stride = length.next_multiple_of(4) + 8;
            let bytes: Vec<u8> = (0..offset + count * stride).map(|_| rng.random()).collect();
            let mut bytes = bytes;
            for index in 0..count {
                let start = offset + index * stride;
                bytes[start..start + length].copy_from_slice(&element(rng, kind, components));
            }
            let view = document.view(&bytes);
            document.json["bufferViews"][view]["byteStride"] = stride.into();
            (accessor["bufferView"], accessor["byteOffset"]) = (view.into(), offset.into());
        }
        Form::SparseZeros(_) | Form::Unstored => {}
    }
    if let Form::Sparse(kind_of_index) | Form::SparseZeros(kind_of_index) = form {
        let replaced: Vec<usize> = (0..count).filter(|_| rng.random_bool(0.4)).collect();
        // At least one, as the specification demands.
        let replaced = if replaced.is_empty() { vec![count - 1] } else { replaced };
        let indices: Vec<u8> = replaced
            .iter()
            .flat_map(|index| index.to_le_bytes()[..size(kind_of_index)].to_vec())
            .collect();
        let (indices, values) = (document.view(&indices), elements(rng, replaced.len()));
        let values = document.view(&values);
        accessor["sparse"] = json!({
            "count": replaced.len(),
            "indices": {"bufferView": indices, "componentType": kind_of_index},
            "values": {"bufferView": values},
        });
    }
    let accessors = document.list("accessors");
    accessors.push(accessor);
    accessors.len() - 1
}

/// The numbers of an accessor, as the specification defines them.
fn specified(json: &Value, bin: &[u8], accessor: usize) -> Vec<Vec<f64>> {
    let accessor = &json["accessors"][accessor];
    let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
    let (kind, count) = (number(&accessor["componentType"]) as u32, number(&accessor["count"]));
    let components = match accessor["type"].as_str() {
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        _ => 1,
    };
    let component = |at: usize, kind: u32| {
        let bytes = &bin[at..at + size(kind)];
        match kind {
            I8 => f64::from(bytes[0] as i8),
            U8 => f64::from(bytes[0]),
            I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            _ => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        }
    };
    let read = |part: &Value, index: usize, kind: u32, components: usize| -> Vec<f64> {
        let view = &json["bufferViews"][number(&part["bufferView"])];
        let stride = view["byteStride"]
            .as_u64()
            .map_or(components * size(kind), |stride| stride as usize);
        let start = number(&view["byteOffset"]) + number(&part["byteOffset"]) + index * stride;
        (0..components)
            .map(|c| component(start + c * size(kind), kind))
            .collect()
    };
    let mut elements: Vec<Vec<f64>> = (0..count)
        .map(|index| match accessor["bufferView"].is_null() {
            true => vec![0.0; components],
            false => read(accessor, index, kind, components),
        })
        .collect();
    let sparse = &accessor["sparse"];
    for index in 0..number(&sparse["count"]) {
        let of_indices = number(&sparse["indices"]["componentType"]) as u32;
        let at = read(&sparse["indices"], index, of_indices, 1)[0] as usize;
        elements[at] = read(&sparse["values"], index, kind, components);
    }
    let fraction = |c: f64| match kind {
        _ if accessor["normalized"] != true => c,
        I8 => (c / 127.0).max(-1.0),
        U8 => c / 255.0,
        I16 => (c / 32767.0).max(-1.0),
        U16 => c / 65535.0,
        _ => c,
    };
    elements.iter_mut().flatten().for_each(|c| *c = fraction(*c));
    elements
}

fn specified_vectors(json: &Value, bin: &[u8], accessor: usize) -> Vec<Vec3> {
    let elements = specified(json, bin, accessor);
    elements
        .iter()
        .map(|c| Vec3::new(c[0] as f32, c[1] as f32, c[2] as f32))
        .collect()
}

/// The triangles of a primitive's corners, by the specification's formulas.
fn specified_triangles(mode: u32, corners: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        4 => (0..corners.len() / 3)
            .map(|i| [corners[3 * i], corners[3 * i + 1], corners[3 * i + 2]])
            .collect(),
        5 => (0..corners.len().saturating_sub(2))
            .map(|i| [corners[i], corners[i + (1 + i % 2)], corners[i + (2 - i % 2)]])
            .collect(),
        6 => (0..corners.len().saturating_sub(2))
            .map(|i| [corners[i + 1], corners[i + 2], corners[0]])
            .collect(),
        _ => Vec::new(),
    }
}

fn open(document: Document) -> Result<(GltfFile, Value, Vec<u8>), ReadError> {
    let (json, bin) = (document.json.clone(), document.bin.clone());
    let (_directory, path) = document.save();
    let file = GltfFile::open(&path, &ReadOptions::default())?;
    // Buffers are read when they are used.
    if file.mesh_count() > 0 {
        file.mesh(0)?;
    }
    Ok((file, json, bin))
}

#[test]
fn positions_and_targets_of_every_type_and_form() -> Result<(), ReadError> {
    let mut rng = Pcg64Mcg::seed_from_u64(27);
    for kind in ATTRIBUTES {
        for form in FORMS {
            let mut document = Document::new();
            let count = rng.random_range(3..40);
            let positions = add(&mut document, &mut rng, kind, "VEC3", count, form);
            let target = add(&mut document, &mut rng, kind, "VEC3", count, form);
            let primitive =
                json!({"attributes": {"POSITION": positions}, "targets": [{"POSITION": target}], "mode": 5});
            document.mesh("m", vec![primitive]);
            let (file, json, bin) = open(document)?;
            let mesh = file.mesh(0)?.mesh;
            assert_eq!(
                mesh.positions,
                specified_vectors(&json, &bin, positions),
                "{kind:?} {form:?}"
            );
            let mut displacements = mesh.targets[0].clone();
            if displacements.is_empty() {
                assert!(matches!(form, Form::Unstored));
                displacements = vec![Vec3::ZERO; count];
            }
            assert_eq!(
                displacements,
                specified_vectors(&json, &bin, target),
                "{kind:?} {form:?}"
            );
        }
    }
    Ok(())
}

#[test]
fn indices_of_every_type_and_form_in_every_mode() -> Result<(), ReadError> {
    let mut rng = Pcg64Mcg::seed_from_u64(28);
    for mode in 0..7 {
        for kind in [None, Some(U8), Some(U16), Some(U32)] {
            for form in FORMS {
                let mut document = Document::new();
                let corners = 3 * rng.random_range(1..12);
                // With no more than 255 vertices, random bytes are good indices of one byte only, so others are made below.
                let vertices = if kind.is_none() { corners } else { 256 };
                let positions = add(&mut document, &mut rng, (F32, false), "VEC3", vertices, Form::Plain);
                let mut primitive = json!({"attributes": {"POSITION": positions}, "mode": mode});
                let indices = kind.map(|kind| add(&mut document, &mut rng, (kind, false), "SCALAR", corners, form));
                if let (Some(indices), Some(kind)) = (indices, kind) {
                    keep_lowest_bytes(&mut document, indices, kind);
                    primitive["indices"] = indices.into();
                }
                document.mesh("m", vec![primitive]);
                let (file, json, bin) = open(document)?;
                let found = file.mesh(0)?;
                let corners: Vec<u32> = match indices {
                    None => (0..vertices as u32).collect(),
                    Some(indices) => specified(&json, &bin, indices).iter().map(|c| c[0] as u32).collect(),
                };
                let expected = specified_triangles(mode, &corners);
                assert_eq!(found.mesh.triangles, expected, "mode {mode}, {kind:?}, {form:?}");
                assert_eq!(found.not_triangles.is_some(), mode < 4);
            }
        }
    }
    Ok(())
}

/// Clears all but the lowest byte of an accessor's numbers, so that they are indices of 256 vertices.
fn keep_lowest_bytes(document: &mut Document, accessor: usize, kind: u32) {
    let accessor = document.json["accessors"][accessor].clone();
    for part in [&accessor, &accessor["sparse"]["values"]] {
        let Some(view) = part["bufferView"].as_u64() else {
            continue;
        };
        let view = &document.json["bufferViews"][view as usize];
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let (start, length) = (number(&view["byteOffset"]), number(&view["byteLength"]));
        let stride = view["byteStride"].as_u64().map_or(size(kind), |stride| stride as usize);
        let offset = number(&part["byteOffset"]);
        for element in (start + offset..start + length).step_by(stride) {
            let end = (element + size(kind)).min(start + length);
            document.bin[(element + 1).min(end)..end].fill(0);
        }
    }
}

#[test]
fn influences_of_every_type_and_form() -> Result<(), ReadError> {
    let mut rng = Pcg64Mcg::seed_from_u64(29);
    for joints in [U8, U16] {
        for weights in [(F32, false), (U8, true), (U16, true)] {
            for form in FORMS {
                let mut document = Document::new();
                let count = rng.random_range(3..20);
                let positions = add(&mut document, &mut rng, (F32, false), "VEC3", count, Form::Plain);
                let joints = add(&mut document, &mut rng, (joints, false), "VEC4", count, form);
                let weights = add(&mut document, &mut rng, weights, "VEC4", count, form);
                let attributes = json!({"POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights});
                document.mesh("m", vec![json!({"attributes": attributes, "mode": 6})]);
                document.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {}]);
                document.json["skins"] = json!([{"joints": [1]}]);
                let (file, json, bin) = open(document)?;
                let skin = file.skin(0, None)?.expect("it is skinned");
                let set = &skin.sets[0];
                let expected = specified(&json, &bin, joints);
                assert_eq!(
                    set.joints
                        .iter()
                        .map(|four| four.map(f64::from).to_vec())
                        .collect::<Vec<_>>(),
                    expected
                );
                let expected = specified(&json, &bin, weights);
                let expected: Vec<Vec<f32>> = expected.iter().map(|c| c.iter().map(|c| *c as f32).collect()).collect();
                assert_eq!(
                    set.weights.iter().map(|four| four.to_vec()).collect::<Vec<_>>(),
                    expected
                );
            }
        }
    }
    Ok(())
}

#[test]
fn keys_of_every_type_and_form() -> Result<(), ReadError> {
    let mut rng = Pcg64Mcg::seed_from_u64(30);
    for kind in [(F32, false), (I8, true), (U8, true), (I16, true), (U16, true)] {
        for form in FORMS {
            for (interpolation, per_key) in [("LINEAR", 1), ("STEP", 1), ("CUBICSPLINE", 3)] {
                let mut document = Document::square(2);
                document.animate(interpolation, &[0.0, 0.5, 2.0], &[0.0]);
                let weights = add(&mut document, &mut rng, kind, "SCALAR", 3 * 2 * per_key, form);
                let turns = add(&mut document, &mut rng, kind, "VEC4", 3 * per_key, form);
                document.json["animations"][0]["samplers"][0]["output"] = weights.into();
                let (file, json, bin) = open(document)?;
                let clip = file.clips(0, None, 2).clips.remove(0);
                let expected: Vec<f32> = specified(&json, &bin, weights).iter().map(|c| c[0] as f32).collect();
                let value = |key: usize| {
                    let at = if per_key == 3 { (3 * key + 1) * 2 } else { key * 2 };
                    expected[at..at + 2].to_vec()
                };
                for (key, time) in [(0, 0.0), (1, 0.5), (2, 2.0), (2, 9.0)] {
                    assert_eq!(clip.sample(time), value(key), "{interpolation} {kind:?} {form:?}");
                }
                assert_eq!(clip.weights.last(), Some(&value(2)));
                // Rotations have the same types.
                assert_eq!(specified(&json, &bin, turns).len(), 3 * per_key);
            }
        }
    }
    Ok(())
}

/// The same with the `gltf` crate, for the types that it reads.
#[test]
fn the_gltf_crate_reads_the_same() -> Result<(), Box<dyn std::error::Error>> {
    let mut rng = Pcg64Mcg::seed_from_u64(31);
    // It refuses accessors without a view.
    for form in FORMS
        .into_iter()
        .filter(|form| !matches!(form, Form::SparseZeros(_) | Form::Unstored))
    {
        for kind in [U8, U16, U32] {
            for mode in [4, 5, 6] {
                let mut document = Document::new();
                let vertices = 256;
                let positions = add(&mut document, &mut rng, (F32, false), "VEC3", vertices, form);
                let target = add(&mut document, &mut rng, (F32, false), "VEC3", vertices, form);
                let indices = add(&mut document, &mut rng, (kind, false), "SCALAR", 30, Form::Plain);
                keep_lowest_bytes(&mut document, indices, kind);
                // It insists on bounds.
                for accessor in [positions, target] {
                    document.json["accessors"][accessor]["min"] = json!([-9, -9, -9]);
                    document.json["accessors"][accessor]["max"] = json!([9, 9, 9]);
                }
                let primitive = json!({
                    "attributes": {"POSITION": positions}, "indices": indices, "targets": [{"POSITION": target}], "mode": mode,
                });
                document.mesh("m", vec![primitive]);
                document.json["buffers"] = json!([{"byteLength": document.bin.len(), "uri": "model%2Ebin"}]);
                let (file, json, bin) = open(document)?;
                let theirs = gltf::Gltf::from_slice(json.to_string().as_bytes())?;
                let primitive = theirs
                    .meshes()
                    .next()
                    .and_then(|mesh| mesh.primitives().next())
                    .ok_or("no primitive")?;
                let reader = primitive.reader(|_| Some(&bin));
                let ours = file.mesh(0)?.mesh;
                let their_positions: Vec<Vec3> =
                    reader.read_positions().ok_or("no positions")?.map(Vec3::from).collect();
                let mut morphed = reader.read_morph_targets();
                let displacements = morphed
                    .next()
                    .and_then(|(positions, ..)| positions)
                    .ok_or("no target")?;
                let displacements: Vec<Vec3> = displacements.map(Vec3::from).collect();
                let corners: Vec<u32> = reader.read_indices().ok_or("no indices")?.into_u32().collect();
                assert_eq!(ours.positions, their_positions, "{form:?}");
                assert_eq!(ours.targets[0], displacements, "{form:?}");
                assert_eq!(ours.triangles, specified_triangles(mode, &corners), "mode {mode}");
            }
        }
    }
    Ok(())
}
