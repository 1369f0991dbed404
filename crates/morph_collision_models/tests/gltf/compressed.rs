//! Compressed models, written by other programs, are read as those programs read them. `data/README.md` says where they come from.

use std::path::{Path, PathBuf};

use glam::Vec3;
use morph_collision_models::gltf::read::{GltfFile, ReadError, ReadOptions, read_meshes};
use morph_collision_models::mesh::MorphMesh;
use serde_json::Value;

/// What another reader found: vertices, and hashes of positions, displacements, triangles and influences.
type Found = (usize, [u32; 4]);

const MODELS: [(&str, Found); 5] = [
    ("plain", (97, [0x2507_cd62, 0xeeda_19bf, 0x451f_77c7, 0xb459_ee7e])),
    ("gltfpack", (97, [0x14e8_388f, 0x74b0_35a9, 0xa1a8_05c7, 0x7d16_968e])),
    ("meshopt", (97, [0x1ec2_dbc5, 0x0764_cdd5, 0xa1a8_05c7, 0xbba1_50e1])),
    (
        "draco_sequential",
        (97, [0xc211_0cf6, 0xeeda_19bf, 0x451f_77c7, 0x288f_9429]),
    ),
    (
        "draco_edgebreaker",
        (101, [0xe8f4_ff68, 0x811c_9dc5, 0xb1b9_61dd, 0x077c_403a]),
    ),
];

fn path(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/gltf/data")).join(format!("{name}.glb"))
}

/// FNV-1a of 32 bits.
fn hash<const N: usize>(bytes: impl IntoIterator<Item = [u8; N]>) -> u32 {
    let step = |hash: u32, byte: u8| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193);
    bytes.into_iter().flatten().fold(0x811c_9dc5, step)
}

fn vectors(vectors: &[Vec3]) -> impl Iterator<Item = [u8; 4]> {
    vectors
        .iter()
        .flat_map(|vector| vector.to_array().map(f32::to_le_bytes))
}

fn found(mesh: &MorphMesh) -> Found {
    let set = &mesh.skin.as_ref().expect("it is skinned").sets[0];
    let weights = set.weights.as_flattened().iter().copied();
    let joints = set.joints.as_flattened().iter().map(|&joint| f32::from(joint));
    let hashes = [
        hash(vectors(&mesh.positions)),
        hash(mesh.targets.iter().flat_map(|target| vectors(target))),
        hash(mesh.triangles.as_flattened().iter().map(|corner| corner.to_le_bytes())),
        hash(weights.chain(joints).map(f32::to_le_bytes)),
    ];
    (mesh.positions.len(), hashes)
}

#[test]
fn every_bit_is_that_of_the_reference_decoders() -> Result<(), ReadError> {
    for (name, expected) in MODELS {
        let meshes = read_meshes(&path(name))?;
        assert_eq!(meshes.len(), 1);
        assert_eq!(meshes[0].triangles.len(), 190, "{name}");
        let found = found(&meshes[0]);
        assert_eq!(found, expected, "{name}: {found:x?}");
    }
    Ok(())
}

/// The rest pose, whose vertices are moved to the world by joints, is that of the plain model within the accuracy of quantization.
#[test]
fn what_is_decoded_stands_where_the_plain_model_stands() -> Result<(), ReadError> {
    let posed = |name: &str, seconds: Option<f32>| {
        let mesh = read_meshes(&path(name))?.remove(0);
        let skin = mesh.skin.as_ref().expect("it is skinned");
        let clip = seconds.map(|_| &skin.skeleton.clips[0]);
        let joints = skin.skeleton.world_from_mesh(clip, seconds.unwrap_or(0.0));
        let weights = vec![0.0; mesh.targets.len()];
        let posed = morph_collision_testkit::oracle::posed_vertices(&mesh.positions, &mesh.targets, &weights);
        Ok::<_, ReadError>(morph_collision_testkit::oracle::skinned_vertices(
            &posed, &skin.sets, &joints,
        ))
    };
    for (name, _) in &MODELS[1..] {
        // Draco's files have no clip.
        let times: &[Option<f32>] = if name.starts_with("draco") {
            &[None]
        } else {
            &[None, Some(0.4)]
        };
        for &seconds in times {
            let plain = posed("plain", seconds)?;
            let size = plain
                .iter()
                .fold(0.0_f64, |size, point| size.max(point.abs().max_element()));
            for point in posed(name, seconds)? {
                let closest = plain
                    .iter()
                    .map(|other| other.distance(point))
                    .fold(f64::INFINITY, f64::min);
                assert!(closest < 5e-3 * size, "{name}: {closest} of {size}");
            }
        }
    }
    Ok(())
}

/// Reads a file's bytes after changing its JSON, which must keep its length.
fn bent(name: &str, from: &str, to: &str) -> Result<GltfFile, ReadError> {
    assert_eq!(from.len(), to.len());
    let mut bytes = std::fs::read(path(name)).expect("the model is there");
    let at = bytes.windows(from.len()).position(|window| window == from.as_bytes());
    let at = at.unwrap_or_else(|| panic!("no {from} in {name}"));
    bytes[at..at + from.len()].copy_from_slice(to.as_bytes());
    GltfFile::parse(&bytes, &path(name), &ReadOptions::default())
}

#[test]
fn broken_streams_are_named() -> Result<(), ReadError> {
    for (name, from, to, says) in [
        (
            "gltfpack",
            "\"mode\":\"ATTRIBUTES\"",
            "\"mode\":\"UNKNOWN!!!\"",
            "the meshopt decoder says: invalid parameter",
        ),
        (
            "gltfpack",
            "\"filter\":\"EXPONENTIAL\"",
            "\"filter\":\"OCTAHEDRAL\" ",
            "the meshopt decoder says: invalid vertex layout",
        ),
        (
            "gltfpack",
            "\"count\":291",
            "\"count\":191",
            "the meshopt decoder says: invalid encoded stream",
        ),
        (
            "draco_sequential",
            "\"POSITION\":0",
            "\"POSITION\":7",
            "the compressed data has no attribute 7",
        ),
        (
            "draco_edgebreaker",
            "\"count\":570",
            "\"count\":270",
            "the Draco decoder says: ",
        ),
        (
            "draco_edgebreaker",
            "\"count\":101",
            "\"count\":103",
            "has 103 elements, but the compressed data has 101",
        ),
    ] {
        let error = match bent(name, from, to)?.mesh(0) {
            Ok(_) => panic!("{name} with {to} was accepted"),
            Err(error) => error.to_string(),
        };
        assert!(error.contains("mesh 0") && error.contains(says), "{to}: {error}");
    }
    Ok(())
}

/// A file with changed JSON.
fn repacked(name: &str, bend: impl FnOnce(&mut Value)) -> GltfFile {
    let bytes = std::fs::read(path(name)).expect("the model is there");
    let word = |at: usize| u32::from_le_bytes([0, 1, 2, 3].map(|i| bytes[at + i])) as usize;
    let (json, rest) = (&bytes[20..20 + word(12)], &bytes[20 + word(12)..]);
    let mut json: Value = serde_json::from_slice(json).expect("it is JSON");
    bend(&mut json);
    let mut json = json.to_string();
    json.extend(std::iter::repeat_n(' ', json.len().next_multiple_of(4) - json.len()));
    let length = |length: usize| (length as u32).to_le_bytes();
    let header = [
        &bytes[..8],
        &length(20 + json.len() + rest.len()),
        &length(json.len()),
        b"JSON",
    ]
    .concat();
    let glb = [&header, json.as_bytes(), rest].concat();
    GltfFile::parse(&glb, &path(name), &ReadOptions::default()).expect("it can be parsed")
}

#[test]
fn what_is_decoded_is_counted_before_it_is_allocated() {
    let of_meshopt = |json: &mut Value| {
        let view = &mut json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
        view["count"] = 400_000_000.into();
    };
    let of_draco = |json: &mut Value| {
        for accessor in json["accessors"].as_array_mut().into_iter().flatten() {
            accessor["count"] = 3_000_000.into();
        }
    };
    for (file, says) in [
        (
            repacked("gltfpack", of_meshopt),
            "decoded buffer view 0 would take 4.5 GiB",
        ),
        (repacked("draco_edgebreaker", of_draco), "decoding buffer view"),
    ] {
        let error = file.mesh(0).map(|_| ()).expect_err("there is no room for it");
        assert!(error.remedy().is_some() && error.to_string().contains(says), "{error}");
    }
}
