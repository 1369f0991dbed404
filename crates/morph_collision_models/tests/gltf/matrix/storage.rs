//! Accessors, views and the binary chunk of a file.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::{Value, json};

use super::choice::{Choice, Compression, Form};
use super::compress;
use super::numbers::{Numbers, size};

pub(super) struct Storage {
    bin: Vec<u8>,
    /// The content of a second buffer: what compressed views are decoded to.
    plain: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    compression: Compression,
    /// For bytes that mean nothing.
    rng: Pcg64Mcg,
}

impl Storage {
    pub(super) fn new(choice: &Choice, seed: u64) -> Self {
        Self {
            bin: Vec::new(),
            plain: Vec::new(),
            views: Vec::new(),
            accessors: Vec::new(),
            compression: choice.compression(),
            rng: Pcg64Mcg::seed_from_u64(seed),
        }
    }

    /// A view of these bytes as they are.
    pub(super) fn bytes(&mut self, bytes: &[u8]) -> usize {
        let offset = append(&mut self.bin, bytes);
        self.views
            .push(json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}));
        self.views.len() - 1
    }

    /// A view of elements, compressed if the file is. Indices with their primitive's mode are compressed in other ways.
    fn view(&mut self, bytes: &[u8], stride: usize, indices: Option<(u32, &Numbers)>) -> usize {
        let compressed = match self.compression {
            Compression::Meshopt(name, _, has_plain) => {
                compress::meshopt(name, bytes, stride, indices).map(|compressed| (name, has_plain, compressed))
            }
            _ => None,
        };
        let Some((name, has_plain, (mode, data))) = compressed else {
            return self.bytes(bytes);
        };
        let place = if has_plain {
            append(&mut self.plain, bytes)
        } else {
            // Only the length is stored.
            append(&mut self.plain, &vec![0; bytes.len()])
        };
        let offset = append(&mut self.bin, &data);
        let extension = json!({
            "buffer": 0, "byteOffset": offset, "byteLength": data.len(),
            "byteStride": stride, "count": bytes.len() / stride, "mode": mode,
        });
        self.views.push(json!({
            "buffer": 1, "byteOffset": place, "byteLength": bytes.len(), "extensions": {name: extension},
        }));
        self.views.len() - 1
    }

    fn accessor(&mut self, numbers: &Numbers, view: Option<usize>) -> usize {
        let shape = ["", "SCALAR", "VEC2", "VEC3", "VEC4"]
            .get(numbers.components)
            .unwrap_or(&"MAT4");
        let mut accessor = json!({"componentType": numbers.kind.0, "type": shape, "count": numbers.count()});
        if numbers.kind.1 {
            accessor["normalized"] = true.into();
        }
        if let Some(view) = view {
            accessor["bufferView"] = view.into();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor whose data is somewhere else.
    pub(super) fn unstored(&mut self, numbers: &Numbers) -> usize {
        self.accessor(numbers, None)
    }

    /// An accessor with its own view, without gaps.
    pub(super) fn plain(&mut self, numbers: &Numbers) -> usize {
        let bytes: Vec<u8> = (0..numbers.count()).flat_map(|at| numbers.bytes(at)).collect();
        let view = self.view(&bytes, numbers.element_size(), None);
        self.accessor(numbers, Some(view))
    }

    /// Indices of vertices.
    pub(super) fn indices(&mut self, mode: u32, indices: &Numbers) -> usize {
        let bytes: Vec<u8> = (0..indices.count()).flat_map(|at| indices.bytes(at)).collect();
        let view = self.view(&bytes, indices.element_size(), Some((mode, indices)));
        self.accessor(indices, Some(view))
    }

    /// A list of numbers that belong to no vertices.
    pub(super) fn list(&mut self, numbers: &Numbers, form: Form) -> usize {
        match form {
            // Views with a stride are only for vertices.
            Form::Plain | Form::Interleaved => self.plain(numbers),
            Form::Sparse(_) | Form::SparseZeros(_) => self.sparse(numbers, form, numbers.element_size()),
        }
    }

    /// Attributes of the same vertices.
    pub(super) fn vertices(&mut self, lists: &[&Numbers], form: Form) -> Vec<usize> {
        let aligned = |numbers: &Numbers| numbers.element_size().next_multiple_of(4);
        match form {
            Form::Interleaved if !lists.is_empty() => self.interleaved(lists),
            Form::Plain | Form::Interleaved => {
                let mut accessors = Vec::new();
                for numbers in lists {
                    let bytes = self.spread(numbers, aligned(numbers), |_| true);
                    let view = self.view(&bytes, aligned(numbers), None);
                    self.views[view]["byteStride"] = aligned(numbers).into();
                    accessors.push(self.accessor(numbers, Some(view)));
                }
                accessors
            }
            Form::Sparse(_) | Form::SparseZeros(_) => {
                let sparse = |numbers: &&Numbers| self.sparse(numbers, form, aligned(numbers));
                lists.iter().map(sparse).collect()
            }
        }
    }

    fn interleaved(&mut self, lists: &[&Numbers]) -> Vec<usize> {
        const BEFORE: usize = 4;
        let stride = lists
            .iter()
            .fold(BEFORE, |sum, list| sum + list.element_size().next_multiple_of(4));
        let mut bytes: Vec<u8> = (0..stride * lists[0].count()).map(|_| self.rng.random()).collect();
        let mut offset = BEFORE;
        let mut offsets = Vec::new();
        for list in lists {
            for at in 0..list.count() {
                let start = at * stride + offset;
                bytes[start..start + list.element_size()].copy_from_slice(&list.bytes(at));
            }
            offsets.push(offset);
            offset += list.element_size().next_multiple_of(4);
        }
        let view = self.view(&bytes, stride, None);
        self.views[view]["byteStride"] = stride.into();
        let mut accessors = Vec::new();
        for (list, offset) in lists.iter().zip(offsets) {
            let accessor = self.accessor(list, Some(view));
            self.accessors[accessor]["byteOffset"] = offset.into();
            accessors.push(accessor);
        }
        accessors
    }

    /// Elements at a stride. Those that are not kept, and the gaps, are random.
    fn spread(&mut self, numbers: &Numbers, stride: usize, is_kept: impl Fn(usize) -> bool) -> Vec<u8> {
        let mut bytes: Vec<u8> = (0..stride * numbers.count()).map(|_| self.rng.random()).collect();
        for at in (0..numbers.count()).filter(|&at| is_kept(at)) {
            bytes[at * stride..at * stride + numbers.element_size()].copy_from_slice(&numbers.bytes(at));
        }
        bytes
    }

    /// An accessor with replaced elements, over others or over zeros.
    fn sparse(&mut self, numbers: &Numbers, form: Form, stride: usize) -> usize {
        let count = numbers.count();
        let (kind, replaced): (u32, Vec<usize>) = match form {
            Form::SparseZeros(kind) => (kind, (0..count).filter(|&at| !numbers.is_zero(at)).collect()),
            Form::Sparse(kind) => (kind, (0..count).filter(|_| self.rng.random_bool(0.4)).collect()),
            Form::Plain | Form::Interleaved => panic!("{form:?} is not sparse"),
        };
        // At least one, as the specification demands.
        let replaced = if replaced.is_empty() { vec![count - 1] } else { replaced };
        let view = matches!(form, Form::Sparse(_)).then(|| {
            let bytes = self.spread(numbers, stride, |at| !replaced.contains(&at));
            let view = self.view(&bytes, stride, None);
            if stride != numbers.element_size() {
                self.views[view]["byteStride"] = stride.into();
            }
            view
        });
        let accessor = self.accessor(numbers, view);
        let indices: Vec<u8> = replaced
            .iter()
            .flat_map(|at| at.to_le_bytes()[..size(kind)].to_vec())
            .collect();
        let values: Vec<u8> = replaced.iter().flat_map(|&at| numbers.bytes(at)).collect();
        self.accessors[accessor]["sparse"] = json!({
            "count": replaced.len(),
            "indices": {"bufferView": self.bytes(&indices), "componentType": kind},
            "values": {"bufferView": self.bytes(&values)},
        });
        accessor
    }
}

/// Appends bytes, aligned to four; returns where they start.
fn append(to: &mut Vec<u8>, bytes: &[u8]) -> usize {
    to.resize(to.len().next_multiple_of(4), 0);
    let offset = to.len();
    to.extend(bytes);
    offset
}

/// The whole file.
pub(super) fn glb(mut json: Value, mut storage: Storage) -> Vec<u8> {
    json["bufferViews"] = storage.views.into();
    json["accessors"] = storage.accessors.into();
    let is_stored = matches!(storage.compression, Compression::Meshopt(_, _, true));
    let second = json!({"byteLength": storage.plain.len()});
    if is_stored {
        // In one file, a second buffer is a URI.
        let engine = base64::engine::general_purpose::STANDARD;
        let text = base64::Engine::encode(&engine, &storage.plain);
        json["buffers"] = json!([{}, second]);
        json["buffers"][1]["uri"] = format!("data:application/octet-stream;base64,{text}").into();
    } else if let Compression::Meshopt(name, ..) = storage.compression {
        json["buffers"] = json!([{}, second]);
        json["buffers"][1]["extensions"] = json!({name: {"fallback": true}});
    } else {
        json["buffers"] = json!([{}]);
    }
    storage.bin.resize(storage.bin.len().next_multiple_of(4), 0);
    json["buffers"][0]["byteLength"] = storage.bin.len().into();
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let word = |length: usize| (length as u32).to_le_bytes();
    let total = 28 + text.len() + storage.bin.len();
    [
        b"glTF\x02\0\0\0",
        &word(total)[..],
        &word(text.len()),
        b"JSON",
        &text,
        &word(storage.bin.len()),
        b"BIN\0",
        &storage.bin,
    ]
    .concat()
}
