/// Children of a node at most, and the width of every kernel.
pub(crate) const LANES: usize = 8;

/// One number of eight volumes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub(crate) struct Lanes(pub(crate) [f32; LANES]);

impl Lanes {
    pub(crate) const fn splat(value: f32) -> Self {
        Self([value; LANES])
    }

    /// `self += a * x`, lane by lane, multiply then add.
    #[inline]
    pub(crate) fn add_scaled(&mut self, a: f32, x: &Self) {
        for (sum, x) in self.0.iter_mut().zip(&x.0) {
            *sum += a * x;
        }
    }

    #[inline]
    pub(crate) fn add(&mut self, value: f32) {
        for sum in &mut self.0 {
            *sum += value;
        }
    }
}
