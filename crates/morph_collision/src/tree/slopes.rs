//! Columns of slopes, in full or in 16 bits per number.

use std::ops::Range;

use crate::bounds::{BoxLanes, LANES};

/// Slopes of eight boxes each, one column after the other.
#[derive(Clone, Debug)]
pub(super) enum Slopes {
    Full(Vec<BoxLanes>),
    /// Rows of eight numbers, and a power of two per column that they are multiples of.
    Compact {
        numbers: Vec<i16>,
        scales: Vec<f32>,
    },
}

/// Some neighbouring columns.
#[derive(Clone, Copy, Debug)]
pub(crate) enum SlopesView<'a> {
    Full(&'a [BoxLanes]),
    Compact { numbers: &'a [i16], scales: &'a [f32] },
}

impl Slopes {
    pub(super) fn new(compact: bool) -> Self {
        if compact {
            Self::Compact {
                numbers: Vec::new(),
                scales: Vec::new(),
            }
        } else {
            Self::Full(Vec::new())
        }
    }

    pub(super) fn len(&self) -> usize {
        match self {
            Self::Full(columns) => columns.len(),
            Self::Compact { scales, .. } => scales.len(),
        }
    }

    pub(super) fn push(&mut self, column: &BoxLanes) {
        match self {
            Self::Full(columns) => columns.push(*column),
            Self::Compact { numbers, scales } => {
                let scale = scale_of(column);
                numbers.extend(
                    column
                        .min
                        .iter()
                        .flat_map(|row| row.0.map(|x| (x / scale).floor() as i16)),
                );
                numbers.extend(
                    column
                        .max
                        .iter()
                        .flat_map(|row| row.0.map(|x| (x / scale).ceil() as i16)),
                );
                scales.push(scale);
            }
        }
    }

    #[inline]
    pub(super) fn view(&self, columns: Range<usize>) -> SlopesView<'_> {
        match self {
            Self::Full(all) => SlopesView::Full(&all[columns]),
            Self::Compact { numbers, scales } => SlopesView::Compact {
                numbers: &numbers[columns.start * BoxLanes::ROWS * LANES..columns.end * BoxLanes::ROWS * LANES],
                scales: &scales[columns],
            },
        }
    }

    pub(super) fn bytes(&self) -> usize {
        match self {
            Self::Full(columns) => size_of_val(&**columns),
            Self::Compact { numbers, scales } => size_of_val(&**numbers) + size_of_val(&**scales),
        }
    }
}

impl SlopesView<'_> {
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Full(columns) => columns.len(),
            Self::Compact { scales, .. } => scales.len(),
        }
    }

    /// Column `i` in full; one in 16 bits is expanded into `room`.
    #[inline(always)]
    pub(crate) fn column<'b>(&'b self, i: usize, room: &'b mut BoxLanes) -> &'b BoxLanes {
        match self {
            Self::Full(columns) => &columns[i],
            Self::Compact { numbers, scales } => {
                let numbers = numbers[i * BoxLanes::ROWS * LANES..].as_chunks::<LANES>().0;
                for (row, numbers) in room.rows_mut().zip(numbers) {
                    for (value, number) in row.0.iter_mut().zip(numbers) {
                        *value = f32::from(*number) * scales[i];
                    }
                }
                room
            }
        }
    }
}

/// The power of two of which the largest number is at most 32766 times as large.
fn scale_of(column: &BoxLanes) -> f32 {
    let numbers = column.rows().flat_map(|row| row.0);
    let largest = numbers.fold(0.0_f32, |largest, x| largest.max(x.abs()));
    // Below 2^(e + 1) with the biased exponent e; 2^-13 of that is at most a 16000th of it. 1 is the smallest normal one.
    let exponent = (largest.to_bits() >> 23).saturating_sub(13).max(1);
    f32::from_bits(exponent << 23)
}
