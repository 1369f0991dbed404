//! Numbers as a file stores them, and what they stand for.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use crate::support::{F32, I16, U8, U16, U32};

pub(super) const I8: u32 = 5120;

/// A component type, and whether its integers are fractions.
pub(super) type Kind = (u32, bool);

/// A list of elements. The numbers are those that are written, so that rounding is part of the description.
#[derive(Clone, Debug)]
pub(super) struct Numbers {
    pub(super) kind: Kind,
    pub(super) components: usize,
    written: Vec<f64>,
}

pub(super) fn size(kind: u32) -> usize {
    match kind {
        I8 | U8 => 1,
        I16 | U16 => 2,
        _ => 4,
    }
}

/// The largest number of an integer type.
pub(super) fn largest(kind: u32) -> Option<f64> {
    match kind {
        I8 => Some(127.0),
        U8 => Some(255.0),
        I16 => Some(32_767.0),
        U16 => Some(65_535.0),
        U32 => Some(4_294_967_295.0),
        _ => None,
    }
}

pub(super) fn is_signed(kind: u32) -> bool {
    matches!(kind, I8 | I16 | F32)
}

impl Numbers {
    /// The written numbers that come closest to these values.
    pub(super) fn of(kind: Kind, components: usize, values: impl IntoIterator<Item = f64>) -> Self {
        let write = |value: f64| match largest(kind.0) {
            None => f64::from(value as f32),
            Some(largest) => {
                let unit = if kind.1 { largest } else { 1.0 };
                let least = if is_signed(kind.0) { -largest } else { 0.0 };
                (value * unit).round().clamp(least, largest)
            }
        };
        let written: Vec<f64> = values.into_iter().map(write).collect();
        assert_eq!(written.len() % components, 0);
        Self {
            kind,
            components,
            written,
        }
    }

    /// Exactly these integers.
    pub(super) fn integers(kind: Kind, components: usize, written: Vec<f64>) -> Self {
        Self {
            kind,
            components,
            written,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.written.len() / self.components
    }

    /// What an element stands for.
    pub(super) fn element(&self, index: usize) -> Vec<f64> {
        let meaning = |&written: &f64| match largest(self.kind.0).filter(|_| self.kind.1) {
            None => written,
            Some(largest) => (written / largest).max(-1.0),
        };
        self.at(index).iter().map(meaning).collect()
    }

    pub(super) fn vector(&self, index: usize) -> [f64; 3] {
        let element = self.element(index);
        [element[0], element[1], element[2]]
    }

    pub(super) fn is_zero(&self, index: usize) -> bool {
        self.at(index).iter().all(|&number| number == 0.0)
    }

    pub(super) fn element_size(&self) -> usize {
        self.components * size(self.kind.0)
    }

    /// The bytes of an element.
    pub(super) fn bytes(&self, index: usize) -> Vec<u8> {
        let write = |&number: &f64| match self.kind.0 {
            I8 => vec![number as i8 as u8],
            U8 => vec![number as u8],
            I16 => (number as i16).to_le_bytes().to_vec(),
            U16 => (number as u16).to_le_bytes().to_vec(),
            U32 => (number as u32).to_le_bytes().to_vec(),
            _ => (number as f32).to_le_bytes().to_vec(),
        };
        self.at(index).iter().flat_map(write).collect()
    }

    fn at(&self, index: usize) -> &[f64] {
        &self.written[index * self.components..(index + 1) * self.components]
    }
}

/// A rotation whose stored quaternion has length 1, up to the rounding of `f32`. Integers have it exactly.
///
/// The square of a quaternion of integers whose squares sum to the largest number has that number as its length.
pub(super) fn rotation(kind: u32, rng: &mut Pcg64Mcg) -> [f64; 4] {
    let range = match largest(kind) {
        None => return unit(rng),
        Some(largest) => largest.sqrt() as i64,
    };
    let square = range * range..(range + 1) * (range + 1);
    let sum = [127, 255, 32_767, 65_535].into_iter().find(|sum| square.contains(sum));
    let sum = sum.expect("these are the largest numbers of all types");
    loop {
        let [x, y, z] = [0; 3].map(|_: i64| rng.random_range(-range..=range));
        let rest = sum - x * x - y * y - z * z;
        let w = (rest.max(0) as f64).sqrt() as i64;
        if w * w == rest {
            let square = [2 * w * x, 2 * w * y, 2 * w * z, w * w - x * x - y * y - z * z];
            let sign = |number: i64| if is_signed(kind) { number } else { number.abs() };
            return square.map(|number| sign(number) as f64);
        }
    }
}

fn unit(rng: &mut Pcg64Mcg) -> [f64; 4] {
    loop {
        let turn = [0; 4].map(|_: i32| rng.random_range(-1.0..1.0_f64));
        let length = turn.iter().map(|c| c * c).sum::<f64>().sqrt();
        if (0.2..1.0).contains(&length) {
            return turn.map(|c| c / length);
        }
    }
}
