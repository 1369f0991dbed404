//! The file as a whole: the container, its JSON and its buffers.

use std::path::Path;

use gltf::{Document, Glb, buffer, json};

use super::error::ReadError;

/// Size of the header of a `.glb` file in bytes.
const GLB_HEADER: usize = 12;

/// Required extensions that leave plain geometry as it is, by the beginning of their names.
const HARMLESS: [&str; 6] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "EXT_texture_",
    "EXT_lights_",
    "KHR_mesh_quantization",
];

/// A parsed file with its buffers in memory.
pub(super) struct Container {
    document: Document,
    buffers: Vec<buffer::Data>,
}

impl Container {
    pub(super) fn open(path: &Path) -> Result<Self, ReadError> {
        let bytes = std::fs::read(path).map_err(|source| ReadError::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::parse(&bytes, path, Some(path.parent().unwrap_or(Path::new(""))))
    }

    /// From a file's bytes; buffers in other files are looked for in `directory`, and refused without one.
    pub(super) fn parse(bytes: &[u8], path: &Path, directory: Option<&Path>) -> Result<Self, ReadError> {
        let not_gltf = |reason: String| ReadError::NotGltf {
            path: path.to_owned(),
            reason,
        };

        let (json, blob) = if bytes.starts_with(b"glTF") {
            check_glb_length(bytes).map_err(not_gltf)?;
            let glb = Glb::from_slice(bytes).map_err(|error| not_gltf(error.to_string()))?;
            (glb.json.into_owned(), glb.bin.map(std::borrow::Cow::into_owned))
        } else {
            (bytes.to_vec(), None)
        };
        let root: json::Root = json::deserialize::from_slice(&json).map_err(|error| not_gltf(error.to_string()))?;
        check_extensions(path, &root)?;
        check_uris(path, &root, directory)?;

        // Not validated as a whole: the rules that matter are checked where they matter, and `validate` itself indexes
        // out of bounds on a POSITION accessor that does not exist.
        let document = Document::from_json_without_validation(root);
        let buffers = gltf::import_buffers(&document, directory, blob).map_err(|error| ReadError::Buffer {
            path: path.to_owned(),
            reason: error.to_string(),
        })?;
        Ok(Self { document, buffers })
    }

    pub(super) fn root(&self) -> &json::Root {
        self.document.as_json()
    }

    pub(super) fn buffers(&self) -> &[buffer::Data] {
        &self.buffers
    }
}

/// `Glb::from_slice` subtracts the header's size from the length without looking.
fn check_glb_length(bytes: &[u8]) -> Result<(), String> {
    let Some(length) = bytes
        .get(8..GLB_HEADER)
        .and_then(|field| <[u8; 4]>::try_from(field).ok())
    else {
        return Err(format!(
            "the file ends after {} bytes, inside the glb header",
            bytes.len()
        ));
    };
    let length = u32::from_le_bytes(length) as usize;
    if length < GLB_HEADER || length > bytes.len() {
        return Err(format!(
            "the glb header promises {length} bytes, the file has {}",
            bytes.len()
        ));
    }
    Ok(())
}

fn check_extensions(path: &Path, root: &json::Root) -> Result<(), ReadError> {
    let unknown = |name: &&String| !HARMLESS.iter().any(|harmless| name.starts_with(harmless));
    match root.extensions_required.iter().find(unknown) {
        Some(extension) => Err(ReadError::Extension {
            path: path.to_owned(),
            extension: extension.clone(),
        }),
        None => Ok(()),
    }
}

/// Without a directory there are no other files. And `import_buffers` unwraps the percent-decoding of a relative URI, which fails where the
/// bytes are not UTF-8.
fn check_uris(path: &Path, root: &json::Root, directory: Option<&Path>) -> Result<(), ReadError> {
    for (index, buffer) in root.buffers.iter().enumerate() {
        let Some(uri) = buffer.uri.as_deref() else { continue };
        if directory.is_none() && !uri.starts_with("data:") {
            return Err(ReadError::Buffer {
                path: path.to_owned(),
                reason: format!("buffer {index} is in the file {uri:?}; here all has to be in one file, as in a .glb"),
            });
        }
        if !uri.contains(':') && !percent_decodes_to_utf8(uri) {
            let reason = format!("buffer {index}: the URI is not UTF-8 after percent-decoding");
            return Err(ReadError::Buffer {
                path: path.to_owned(),
                reason,
            });
        }
    }
    Ok(())
}

fn percent_decodes_to_utf8(uri: &str) -> bool {
    let hex = |byte: u8| char::from(byte).to_digit(16).map(|digit| digit as u8);
    let mut decoded = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&byte, tail)) = rest.split_first() {
        match (byte, tail) {
            (b'%', [high, low, after @ ..]) if hex(*high).is_some() && hex(*low).is_some() => {
                decoded.push(hex(*high).unwrap_or(0) << 4 | hex(*low).unwrap_or(0));
                rest = after;
            }
            _ => {
                decoded.push(byte);
                rest = tail;
            }
        }
    }
    std::str::from_utf8(&decoded).is_ok()
}
