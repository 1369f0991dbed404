use super::super::input::{InputError, check_length};

/// What an approximate answer may leave open; by default nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Approximation {
    pub(super) tolerance: f64,
    pub(super) budget: Option<u64>,
}

impl Approximation {
    /// Nothing left open: no tolerance, no end of work.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Lets triangles that are at most so far apart, in world units, pass for intersecting.
    ///
    /// Parts of the bodies that lie wholly within that distance of each other are then not looked into: their volumes are
    /// blended, their vertices are not. So it saves work in proportion as it is larger than the triangles; no intersecting
    /// pair is ever missed.
    ///
    /// # Errors
    /// [`InputError::BadNumber`] if it is negative or NaN.
    pub fn with_tolerance(mut self, tolerance: f64) -> Result<Self, InputError> {
        check_length("tolerance", tolerance)?;
        self.tolerance = tolerance;
        Ok(self)
    }

    /// Ends the work after so many tests of volumes and triangles; what is not yet decided is listed.
    ///
    /// The work is counted, not timed, so that the answer is the same on every machine. It is checked before each pair of
    /// nodes; a pair of leaves is always finished.
    #[must_use]
    pub fn with_budget(mut self, tests: u64) -> Self {
        self.budget = Some(tests);
        self
    }
}
