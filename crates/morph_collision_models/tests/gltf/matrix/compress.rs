//! Compressed data, in the forms that need no search for good compression.

use meshoptimizer_rs::codec::{
    IndexEncoding, VertexEncoding, encode_index_buffer, encode_index_sequence, encode_vertex_buffer,
};
use meshoptimizer_rs::{Limits, Workspace};

use super::numbers::{I8, Numbers};
use crate::support::{F32, I16, U8, U16, U32};

/// The mode and the data of a view that meshoptimizer compresses; `None` if it has no mode for such elements.
pub(super) fn meshopt(
    extension: &str,
    bytes: &[u8],
    stride: usize,
    indices: Option<(u32, &Numbers)>,
) -> Option<(&'static str, Vec<u8>)> {
    let workspace = &mut Workspace::new(Limits::default());
    let Some((mode, indices)) = indices else {
        if !stride.is_multiple_of(4) {
            return None;
        }
        // Only one of the extensions allows the newer version of the format.
        let encoding = VertexEncoding::new(u8::from(extension.starts_with("KHR")), 2).expect("it is known");
        let encoded = encode_vertex_buffer(bytes, bytes.len() / stride, stride, encoding, workspace);
        return Some(("ATTRIBUTES", encoded.expect("they can be encoded")));
    };
    if indices.kind.0 == U8 {
        return None;
    }
    let corners: Vec<u32> = (0..indices.count()).map(|at| indices.element(at)[0] as u32).collect();
    let encoded = if mode == 4 {
        (
            "TRIANGLES",
            encode_index_buffer(&corners, IndexEncoding::DEFAULT, workspace),
        )
    } else {
        (
            "INDICES",
            encode_index_sequence(&corners, IndexEncoding::DEFAULT, workspace),
        )
    };
    Some((encoded.0, encoded.1.expect("they can be encoded")))
}

/// A Draco stream: sequential, with plain indices and plain attributes. The number of an attribute is its place in the list.
pub(super) fn draco(corners: &Numbers, attributes: &[&Numbers]) -> Vec<u8> {
    let vertices = attributes[0].count();
    assert!(vertices < 128, "one byte is enough for all numbers");
    // Version 2.2, a mesh, sequential, without flags.
    let mut stream = b"DRACO\x02\x02\x01\x00\x00\x00".to_vec();
    stream.extend([(corners.count() / 3) as u8, vertices as u8]);
    // The indices are not compressed.
    stream.push(1);
    stream.extend((0..corners.count()).map(|at| corners.element(at)[0] as u8));
    // One decoder for all attributes.
    stream.extend([1, attributes.len() as u8]);
    for (number, attribute) in attributes.iter().enumerate() {
        // The first one is the positions, all others are generic.
        let role = if number == 0 { 0 } else { 4 };
        let kind = match attribute.kind.0 {
            I8 => 1,
            U8 => 2,
            I16 => 3,
            U16 => 4,
            U32 => 6,
            F32 => 9,
            kind => panic!("component type {kind}"),
        };
        stream.extend([
            role,
            kind,
            attribute.components as u8,
            u8::from(attribute.kind.1),
            number as u8,
        ]);
    }
    // Their values are stored as they are.
    stream.extend(vec![0; attributes.len()]);
    for attribute in attributes {
        stream.extend((0..attribute.count()).flat_map(|at| attribute.bytes(at)));
    }
    stream
}
