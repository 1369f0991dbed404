//! The dimensions of the matrix, and choices of one level of each, such that every pair of levels occurs.

use std::collections::BTreeSet;

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::description::Interpolation;
use super::numbers::{I8, Kind};
use crate::support::{F32, I16, U8, U16, U32};

/// The number of levels of each dimension.
const LEVELS: [usize; 19] = [9, 7, 3, 5, 4, 7, 5, 2, 3, 4, 3, 3, 4, 3, 3, 5, 4, 3, 3];

/// A level of each dimension, by index.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice([usize; LEVELS.len()]);

/// How an accessor is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    Plain,
    /// With other data in between. Accessors of the same vertices share a view.
    Interleaved,
    /// Some elements are replaced; the indices of these have this type.
    Sparse(u32),
    /// Zeros with replaced elements.
    SparseZeros(u32),
}

/// How the data is compressed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Compression {
    None,
    /// With this name, whether the file requires it, and whether plain data is stored, too.
    Meshopt(&'static str, bool, bool),
    /// Whether the file requires it, and whether plain data is stored, too.
    Draco(bool, bool),
}

/// Which nodes show the mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shown {
    ByOne,
    /// Each with its own skin, if it is skinned.
    ByThree,
    /// At several places.
    Instanced,
}

impl Choice {
    pub(super) fn positions(&self) -> Kind {
        const KINDS: [Kind; 9] = [
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
        KINDS[self.0[0]]
    }

    pub(super) fn displacements(&self) -> Kind {
        const KINDS: [Kind; 7] = [
            (F32, false),
            (I8, false),
            (I8, true),
            (I16, false),
            (I16, true),
            (U8, true),
            (U16, false),
        ];
        KINDS[self.0[1]]
    }

    pub(super) fn indices(&self) -> u32 {
        [U8, U16, U32][self.0[2]]
    }

    pub(super) fn vertex_form(&self) -> Form {
        [
            Form::Plain,
            Form::Interleaved,
            Form::Sparse(U8),
            Form::Sparse(U16),
            Form::Sparse(U32),
        ][self.0[3]]
    }

    pub(super) fn target_form(&self) -> Form {
        [Form::Plain, Form::Interleaved, Form::Sparse(U16), Form::SparseZeros(U8)][self.0[4]]
    }

    pub(super) fn compression(&self) -> Compression {
        // Some writers leave the plain data out, although readers need not know the extension.
        let is_plain_too = self.0[8] == 0;
        [
            Compression::None,
            Compression::Meshopt("EXT_meshopt_compression", true, false),
            Compression::Meshopt("EXT_meshopt_compression", false, is_plain_too),
            Compression::Meshopt("KHR_meshopt_compression", true, false),
            Compression::Meshopt("KHR_meshopt_compression", false, is_plain_too),
            Compression::Draco(true, false),
            Compression::Draco(false, is_plain_too),
        ][self.0[5]]
    }

    /// The least and the largest number of influences; `None` without a skin.
    pub(super) fn influences(&self) -> Option<(usize, usize)> {
        [None, Some((1, 3)), Some((4, 5)), Some((6, 8)), Some((9, 12))][self.0[6]]
    }

    pub(super) fn joints(&self) -> u32 {
        [U8, U16][self.0[7]]
    }

    pub(super) fn joint_weights(&self) -> Kind {
        [(F32, false), (U8, true), (U16, true)][self.0[8]]
    }

    /// The mode of the first primitive, and whether it has indices.
    pub(super) fn mode(&self) -> (u32, bool) {
        [(4, true), (4, false), (5, true), (6, false)][self.0[9]]
    }

    /// The number of primitives with vertices of their own, and of further primitives with the same vertices.
    pub(super) fn primitives(&self) -> (usize, usize) {
        [(1, 0), (1, 2), (3, 0)][self.0[10]]
    }

    pub(super) fn targets(&self) -> usize {
        [0, 1, 4][self.0[11]]
    }

    /// How the clip animates weights: not, by a node, by a pointer to a node, or by a pointer to the mesh.
    pub(super) fn animated_weights(&self) -> usize {
        self.0[12]
    }

    /// How the clip animates nodes: not, by paths, or by pointers.
    pub(super) fn animated_nodes(&self) -> usize {
        self.0[13]
    }

    pub(super) fn interpolation(&self) -> Interpolation {
        [Interpolation::Linear, Interpolation::Step, Interpolation::Cubic][self.0[14]]
    }

    /// The type of animated weights and rotations.
    pub(super) fn values(&self) -> Kind {
        [(F32, false), (I8, true), (U8, true), (I16, true), (U16, true)][self.0[15]]
    }

    pub(super) fn value_form(&self) -> Form {
        [Form::Plain, Form::Interleaved, Form::Sparse(U8), Form::SparseZeros(U16)][self.0[16]]
    }

    pub(super) fn shown(&self) -> Shown {
        [Shown::ByOne, Shown::ByThree, Shown::Instanced][self.0[17]]
    }

    /// What is above the nodes: nothing, nodes with parts, or nodes with matrices.
    pub(super) fn above(&self) -> usize {
        self.0[18]
    }

    fn random(rng: &mut Pcg64Mcg) -> Self {
        Self(LEVELS.map(|levels| rng.random_range(0..levels)))
    }

    /// Whether there are such files.
    fn is_possible(&self) -> bool {
        let is_draco = matches!(self.compression(), Compression::Draco(..));
        // Draco compresses triangles with indices, each primitive with its own vertices.
        !(is_draco && (self.mode() != (4, true) || self.primitives().1 > 0))
            // Joints place a mesh, and not its node's instances.
            && !(self.influences().is_some() && self.shown() == Shown::Instanced)
            && !(self.targets() == 0 && self.animated_weights() > 0)
    }

    /// The pairs of levels in it: dimension, level, later dimension, level.
    fn pairs(&self) -> impl Iterator<Item = [usize; 4]> {
        let later = move |one: usize| (one + 1..LEVELS.len()).map(move |two| [one, self.0[one], two, self.0[two]]);
        (0..LEVELS.len()).flat_map(later)
    }
}

/// Random choices with every possible pair of levels, until a pair is not found in many attempts.
pub(super) fn choices(rng: &mut Pcg64Mcg) -> Vec<Choice> {
    let mut open = BTreeSet::new();
    for (one, levels) in LEVELS.into_iter().enumerate() {
        for (two, others) in LEVELS.into_iter().enumerate().skip(one + 1) {
            open.extend((0..levels).flat_map(|a| (0..others).map(move |b| [one, a, two, b])));
        }
    }
    let mut chosen = Vec::new();
    let mut impossible = 0;
    while let Some(pair) = open.first().copied() {
        let attempts = (0..400).filter_map(|_| {
            let mut choice = Choice::random(rng);
            (choice.0[pair[0]], choice.0[pair[2]]) = (pair[1], pair[3]);
            choice.is_possible().then_some(choice)
        });
        // The one with most of the missing pairs, of a few.
        let new = |choice: &Choice| choice.pairs().filter(|pair| open.contains(pair)).count();
        let Some(best) = attempts.take(20).max_by_key(new) else {
            impossible += 1;
            open.remove(&pair);
            continue;
        };
        for pair in best.pairs() {
            open.remove(&pair);
        }
        chosen.push(best);
    }
    // Draco, required or not, with three modes and with shared vertices; instances with four numbers of influences; no targets and three
    // ways to animate them.
    assert_eq!(impossible, 2 * 4 + 4 + 3);
    chosen
}
