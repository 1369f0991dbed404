//! Changes glTF files in ways that keep their structure: the JSON stays JSON, and the container stays a container.
//!
//! Random bytes hardly ever get past the JSON parser. Here, values of the JSON are replaced, removed, copied and exchanged, and bytes of
//! the binary chunk are changed, so that most files reach the code that follows indices and decodes data. Now and then a part is added that
//! the file does not have ([`graft`]).

use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::{Map, Value};

use super::graft::graft;

/// At most this many changes are made at once.
const MOST_CHANGES: u32 = 6;
/// Files are not made larger than this.
const LARGEST: usize = 1 << 16;

/// Numbers at which code breaks.
const NUMBERS: [f64; 22] = [
    0.0,
    1.0,
    -1.0,
    2.0,
    3.0,
    4.0,
    5.0,
    255.0,
    256.0,
    65_535.0,
    65_536.0,
    16_777_217.0,
    1e9,
    2_147_483_648.0,
    4_294_967_295.0,
    4_294_967_296.0,
    9_007_199_254_740_993.0,
    1.844_674_407_370_955_2e19,
    1e39,
    0.5,
    -0.0,
    1e-46,
];

/// Words that mean something in a glTF file.
const WORDS: [&str; 42] = [
    "SCALAR",
    "VEC3",
    "VEC4",
    "MAT4",
    "LINEAR",
    "STEP",
    "CUBICSPLINE",
    "translation",
    "rotation",
    "scale",
    "weights",
    "pointer",
    "ATTRIBUTES",
    "TRIANGLES",
    "INDICES",
    "NONE",
    "OCTAHEDRAL",
    "QUATERNION",
    "EXPONENTIAL",
    "COLOR",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_mesh_quantization",
    "VRMC_vrm",
    "POSITION",
    "JOINTS_0",
    "WEIGHTS_0",
    "JOINTS_2",
    "WEIGHTS_2",
    "TRANSLATION",
    "ROTATION",
    "SCALE",
    "EXT_mesh_gpu_instancing",
    "KHR_node_visibility",
    "KHR_animation_pointer",
    "/nodes/0/weights",
    "/meshes/0/weights",
    "targetNames",
    "extensions",
    "2.0",
    "data:;base64,AAAA",
];

/// Component types and modes.
const KINDS: [u64; 13] = [5120, 5121, 5122, 5123, 5125, 5126, 0, 1, 2, 3, 4, 5, 6];

/// A changed copy of a `.glb` or `.gltf` file; the same seed gives the same one. `None` if the bytes are neither.
#[must_use]
pub fn bend(bytes: &[u8], seed: u64) -> Option<Vec<u8>> {
    let rng = &mut Pcg64Mcg::seed_from_u64(seed);
    let (json, mut chunk) = parts(bytes)?;
    let mut json: Value = serde_json::from_slice(json).ok()?;
    for _ in 0..rng.random_range(1..=MOST_CHANGES) {
        match rng.random_range(0..10) {
            0 if !chunk.is_empty() => bend_bytes(&mut chunk, rng),
            1 | 2 => graft(&mut json, rng),
            _ => bend_value(&mut json, rng),
        }
    }
    let bent = pack(&json, &chunk, bytes.starts_with(b"glTF"))?;
    (bent.len() <= LARGEST.max(bytes.len())).then_some(bent)
}

/// The JSON and the binary chunk.
pub(super) fn parts(bytes: &[u8]) -> Option<(&[u8], Vec<u8>)> {
    if !bytes.starts_with(b"glTF") {
        return Some((bytes, Vec::new()));
    }
    let word = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize);
    let end = 20_usize.checked_add(word(12)?)?;
    let chunk = word(end).and_then(|length| bytes.get(end + 8..end.checked_add(8)?.checked_add(length)?));
    Some((bytes.get(20..end)?, chunk.unwrap_or_default().to_vec()))
}

pub(super) fn pack(json: &Value, chunk: &[u8], is_glb: bool) -> Option<Vec<u8>> {
    let mut json = serde_json::to_vec(json).ok()?;
    if !is_glb {
        return Some(json);
    }
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = |bytes: &[u8]| u32::try_from(bytes.len()).map(u32::to_le_bytes).ok();
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend(u32::try_from(28 + json.len() + chunk.len()).ok()?.to_le_bytes());
    for (kind, content) in [(b"JSON", json.as_slice()), (b"BIN\0", chunk)] {
        glb.extend(length(content)?);
        glb.extend(kind);
        glb.extend(content);
    }
    Some(glb)
}

fn bend_bytes(bytes: &mut Vec<u8>, rng: &mut impl Rng) {
    let at = rng.random_range(0..bytes.len());
    let end = (at + rng.random_range(1..16_usize)).min(bytes.len());
    match rng.random_range(0..5) {
        0 => bytes[at] ^= 1 << rng.random_range(0..8),
        1 => bytes[at] = rng.random(),
        2 => bytes[at..end].fill(if rng.random_bool(0.5) { 0 } else { 255 }),
        3 => bytes.truncate(at),
        _ => {
            let other = rng.random_range(0..bytes.len());
            bytes.swap(at, other);
        }
    }
}

/// Walks down to a random value and changes it.
fn bend_value(value: &mut Value, rng: &mut impl Rng) {
    let goes_on = rng.random_bool(0.85);
    match value {
        Value::Object(object) if !object.is_empty() => {
            let index = rng.random_range(0..object.len());
            if goes_on {
                if let Some((_, child)) = object.iter_mut().nth(index) {
                    bend_value(child, rng);
                }
            } else {
                bend_object(object, index, rng);
            }
        }
        Value::Array(list) if !list.is_empty() => {
            let index = rng.random_range(0..list.len());
            if goes_on {
                bend_value(&mut list[index], rng);
            } else {
                bend_list(list, index, rng);
            }
        }
        other => *other = another(other, rng),
    }
}

fn bend_object(object: &mut Map<String, Value>, index: usize, rng: &mut impl Rng) {
    let Some(key) = object.keys().nth(index).cloned() else {
        return;
    };
    match rng.random_range(0..4) {
        0 => {
            object.remove(&key);
        }
        1 => {
            // Another key of the file's own, or a word.
            let word = WORDS[rng.random_range(0..WORDS.len())].to_owned();
            let value = object.get(&key).cloned().unwrap_or_default();
            object.insert(word, value);
        }
        2 => {
            let other = object.values().nth(rng.random_range(0..object.len())).cloned();
            object.insert(key, other.unwrap_or_default());
        }
        _ => {
            let value = object.get(&key).map(|value| another(value, rng));
            object.insert(key, value.unwrap_or_default());
        }
    }
}

fn bend_list(list: &mut Vec<Value>, index: usize, rng: &mut impl Rng) {
    match rng.random_range(0..4) {
        0 => {
            list.remove(index);
        }
        1 => {
            let copy = list[index].clone();
            list.insert(rng.random_range(0..=list.len()), copy);
        }
        2 => {
            let other = rng.random_range(0..list.len());
            list.swap(index, other);
        }
        _ => list[index] = another(&list[index], rng),
    }
}

/// Another value, mostly of the same type.
fn another(value: &Value, rng: &mut impl Rng) -> Value {
    match (value, rng.random_range(0..10)) {
        (_, 0) => [
            Value::Null,
            Value::Bool(true),
            Value::Array(Vec::new()),
            Value::Object(Map::new()),
        ][rng.random_range(0..4_usize)]
        .clone(),
        (Value::Number(number), 1..=4) => {
            // Nearby indices and sizes.
            let by = rng.random_range(-4..=4_i64);
            number
                .as_i64()
                .map_or(Value::from(by), |number| Value::from(number.saturating_add(by)))
        }
        (Value::Number(_), 5) => Value::from(KINDS[rng.random_range(0..KINDS.len())]),
        (Value::Number(_), _) => {
            let number = NUMBERS[rng.random_range(0..NUMBERS.len())];
            // Whole numbers are written without a point, as indices have to be.
            if number.fract() == 0.0 && number.abs() < 1e19 && number >= 0.0 {
                Value::from(number as u64)
            } else {
                Value::from(number)
            }
        }
        (Value::Bool(is), _) => Value::Bool(!is),
        _ => Value::from(WORDS[rng.random_range(0..WORDS.len())]),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use morph_collision_models::gltf::read::{GltfFile, ReadOptions};
    use morph_collision_models::gltf::write::{Appearance, to_glb};

    #[test]
    fn bent_files_are_still_files_and_most_get_past_the_parser() {
        let mesh = morph_collision_models::generated::rigs::tube(1, 3, 2, 2);
        let glb = to_glb(&mesh, &Appearance::default()).expect("it can be written");
        let bent: Vec<Vec<u8>> = (0..300).filter_map(|seed| bend(&glb, seed)).collect();
        assert!(bent.len() > 290, "{}", bent.len());
        assert!(bent.iter().all(|bytes| *bytes != glb));
        let parsed = bent
            .iter()
            .filter_map(|bytes| GltfFile::parse(bytes, Path::new("bent.glb"), &ReadOptions::default()).ok());
        let parsed: Vec<GltfFile> = parsed.collect();
        assert!(parsed.len() > 150, "{}", parsed.len());
        let read = parsed.iter().filter(|file| file.mesh(0).is_ok()).count();
        assert!((50..parsed.len()).contains(&read), "{read} of {}", parsed.len());
        assert_eq!(bend(&glb, 7), bend(&glb, 7));
        assert_eq!(bend(b"glTF", 1), None);
        assert_eq!(bend(b"not JSON", 1), None);
    }
}
