//! The layouts of a model's meshes in one compact file.

use std::mem::size_of;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::layout::TreeLayout;
use super::layout_error::VERSION;
use crate::hash::{START, hash};

/// The version of the file. Raise it when what serde writes of [`TreeFile`] changes.
const FORMAT: u32 = 1;
/// The bytes of a tree with nothing in it: one for each field.
const SMALLEST: usize = 8;
const MAGIC: [u8; 8] = *b"MorphBVH";
/// Magic number, two versions and a checksum.
const HEADER: usize = MAGIC.len() + 2 * size_of::<u32>() + size_of::<u64>();

/// The trees of a model's meshes, to ship beside the model. `morph-collide bake` writes such files, and `bevy_morph_collision` reads them.
///
/// Bytes, all in little-endian order: a magic number, the versions of the file and of the layouts, a checksum, and the trees in the format
/// `postcard`. An integer takes as many bytes as it needs, so a tree takes about three bytes per triangle.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, SavedTree, TreeFile};
/// # let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// # let model = Arc::new(MorphModel::from_displacements::<[Vec3; 3]>(&base, &[[0, 1, 2]], &[])?);
/// let bvh = MorphBvh::build(model.clone(), &BuildOptions::default());
/// let saved = SavedTree { label: "Mesh0/Primitive0".into(), joints: None, layout: bvh.layout() };
/// let bytes = TreeFile { trees: vec![saved] }.to_bytes();
/// let file = TreeFile::from_bytes(&bytes)?;
/// let restored = MorphBvh::from_layout(model, &file.trees[0].layout)?;
/// assert_eq!(restored.layout(), bvh.layout());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TreeFile {
    /// In any order.
    pub trees: Vec<SavedTree>,
}

/// The tree of a mesh, as one or more instances show it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedTree {
    /// Which mesh of the model. For glTF it is a primitive, as in `Mesh0/Primitive1`.
    pub label: String,
    /// The number of joints of the skeletons with which the mesh is shown, if any.
    pub joints: Option<u32>,
    /// The tree.
    pub layout: TreeLayout,
}

/// Why bytes are no [`TreeFile`].
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum TreeFileError {
    /// It is some other file.
    #[error("it is not a file of trees")]
    OtherFile,
    /// It was written by another version of this crate.
    #[error("it has version {}.{}, this program reads {FORMAT}.{VERSION}", found[0], found[1])]
    Version {
        /// The versions of the file and of the layouts in it.
        found: [u32; 2],
    },
    /// Bytes are missing, added or changed.
    #[error("it is incomplete or damaged")]
    Damaged,
}

impl TreeFile {
    /// The file's bytes.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        // Only sequences of unknown length and failing writers are errors.
        Self::forged(&postcard::to_allocvec(self).unwrap_or_default())
    }

    /// Reads a file. Takes at most a mebibyte and 32 times as much memory as the file, whatever is in it, so limit the bytes of files that are
    /// not your own.
    ///
    /// # Errors
    /// [`TreeFileError`] if it is no such file, has another version, or is damaged. Whether a layout fits a mesh is checked when its tree is
    /// restored.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, TreeFileError> {
        let rest = bytes.strip_prefix(&MAGIC).ok_or(TreeFileError::OtherFile)?;
        let (format, rest) = rest.split_first_chunk().ok_or(TreeFileError::Damaged)?;
        let (version, rest) = rest.split_first_chunk().ok_or(TreeFileError::Damaged)?;
        let found = [*format, *version].map(u32::from_le_bytes);
        if found != [FORMAT, VERSION] {
            return Err(TreeFileError::Version { found });
        }
        let (sum, trees) = rest.split_first_chunk().ok_or(TreeFileError::Damaged)?;
        if u64::from_le_bytes(*sum) != checksum(trees) {
            return Err(TreeFileError::Damaged);
        }
        read_trees(trees).ok_or(TreeFileError::Damaged)
    }

    /// A file with any bytes for its trees and the right checksum, for tests and fuzzing.
    #[doc(hidden)]
    #[must_use]
    pub fn forged(trees: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + trees.len());
        bytes.extend(MAGIC);
        bytes.extend([FORMAT, VERSION].into_iter().flat_map(u32::to_le_bytes));
        bytes.extend(checksum(trees).to_le_bytes());
        bytes.extend(trees);
        bytes
    }
}

/// As serde would read a [`TreeFile`], but without a list that grows: while it moves, it would take three times the size of its trees. In a
/// tree, serde never reserves more than a mebibyte for a length that is only claimed.
fn read_trees(bytes: &[u8]) -> Option<TreeFile> {
    let (count, mut rest) = postcard::take_from_bytes::<usize>(bytes).ok()?;
    if count > rest.len() / SMALLEST {
        return None;
    }
    let mut trees = Vec::with_capacity(count);
    for _ in 0..count {
        let (tree, after) = postcard::take_from_bytes(rest).ok()?;
        trees.push(tree);
        rest = after;
    }
    rest.is_empty().then_some(TreeFile { trees })
}

fn checksum(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks();
    let words = words.iter().map(|&word| u32::from_le_bytes(word).into());
    let all = words.chain(rest.iter().map(|&byte| byte.into()));
    hash(START, all.chain([bytes.len() as u64]))
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, LazyLock};

    use morph_collision_models::generated::random::random_blob;
    use proptest::prelude::*;

    use super::*;
    use crate::model::{MorphModel, WeightBox};
    use crate::proof::{Effort, SelfProof};
    use crate::tree::{BuildOptions, MorphBvh};

    /// A file with two trees, one of them certified, and their mesh.
    fn file() -> (TreeFile, Arc<MorphModel>) {
        static FILE: LazyLock<(TreeFile, Arc<MorphModel>)> = LazyLock::new(new_file);
        FILE.clone()
    }

    fn new_file() -> (TreeFile, Arc<MorphModel>) {
        let blob = random_blob(3, 3, 2, 0.9);
        let model = MorphModel::from_displacements(&blob.positions, &blob.triangles, &blob.targets).unwrap();
        let model = Arc::new(model);
        let saved = |leaf_size: usize, joints: Option<u32>| {
            let options = BuildOptions::default().with_leaf_size(leaf_size).unwrap();
            let bvh = Arc::new(MorphBvh::build(model.clone(), &options));
            if leaf_size == 8 {
                let proof = SelfProof::new(&bvh, &WeightBox::unit(2), Effort::default()).unwrap();
                bvh.set_certificates(proof.certificates(&proof.run()).unwrap()).unwrap();
            }
            SavedTree {
                label: "Mesh0/Primitive0".into(),
                joints,
                layout: bvh.layout(),
            }
        };
        let trees = vec![saved(8, None), saved(255, Some(3))];
        (TreeFile { trees }, model)
    }

    #[test]
    fn a_file_keeps_its_trees_and_their_certificates() {
        let (file, model) = file();
        let bytes = file.to_bytes();
        let read = TreeFile::from_bytes(&bytes).unwrap();
        assert_eq!(read, file);
        let restored = MorphBvh::from_layout(model.clone(), &read.trees[0].layout).unwrap();
        assert!(restored.certificates().is_some());
        assert_eq!(restored.layout(), file.trees[0].layout);
        let without = TreeFile {
            trees: vec![file.trees[1].clone()],
        };
        let per_triangle = without.to_bytes().len() as f64 / model.triangle_count() as f64;
        assert!(per_triangle < 4.0, "{per_triangle}");
    }

    #[test]
    fn other_files_versions_and_parts_are_told_apart() {
        let bytes = file().0.to_bytes();
        let read = |bytes: &[u8]| TreeFile::from_bytes(bytes).unwrap_err();
        for other in [&b""[..], b"glTF", b"MorphBV"] {
            assert_eq!(read(other), TreeFileError::OtherFile);
        }
        for (at, found) in [(8, [2, VERSION]), (12, [FORMAT, 2])] {
            let mut newer = bytes.clone();
            newer[at] = 2;
            assert_eq!(read(&newer), TreeFileError::Version { found });
        }
        for length in MAGIC.len()..bytes.len() {
            assert_eq!(read(&bytes[..length]), TreeFileError::Damaged, "{length}");
        }
        assert_eq!(read(&[&bytes[..], &[0]].concat()), TreeFileError::Damaged);
        for at in HEADER - 8..bytes.len() {
            let mut flipped = bytes.clone();
            flipped[at] ^= 1;
            assert_eq!(read(&flipped), TreeFileError::Damaged, "{at}");
        }
    }

    #[test]
    fn no_more_trees_are_claimed_than_the_bytes_have_room_for() {
        let smallest = [0, 0, 0, 0, 1, 0, 0, 0];
        assert_eq!(smallest.len(), SMALLEST);
        let read = |count: u8, trees: usize| {
            let bytes = [&[count][..], &smallest.repeat(trees)].concat();
            TreeFile::from_bytes(&TreeFile::forged(&bytes)).map(|file| file.trees.len())
        };
        assert_eq!(read(100, 100), Ok(100));
        for (count, trees) in [(100, 99), (99, 100), (1, 0)] {
            assert_eq!(read(count, trees), Err(TreeFileError::Damaged));
        }
        // 2^63 trees.
        let claimed = TreeFile::forged(&[&[0x80; 9][..], &[1], &smallest].concat());
        assert_eq!(TreeFile::from_bytes(&claimed), Err(TreeFileError::Damaged));
    }

    proptest! {
        /// Damage with the right checksum is an error of the file or of the layout, or gives a tree.
        #[test]
        fn forged_files_are_errors_or_trees(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4), cut in any::<prop::sample::Index>(), cuts in any::<bool>()) {
            let (file, model) = file();
            let mut trees = file.to_bytes().split_off(HEADER);
            for (at, value) in changes {
                let at = at.index(trees.len());
                trees[at] = value;
            }
            if cuts {
                trees.truncate(cut.index(trees.len()));
            }
            for saved in TreeFile::from_bytes(&TreeFile::forged(&trees)).map_or(Vec::new(), |file| file.trees) {
                if let Ok(bvh) = MorphBvh::from_layout(model.clone(), &saved.layout) {
                    prop_assert_eq!(bvh.layout(), saved.layout);
                }
            }
        }
    }
}
