//! Weights that cannot be used.

/// For how many consecutive runs the number of weights may differ from the number of targets before it is reported as an error. A
/// game that changes both need not do so in the same frame.
const PATIENCE: u8 = 10;

/// Records weights that cannot be used since the last valid ones.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct BadWeights {
    /// For how many consecutive runs they did not fit the targets.
    runs: u8,
    /// Whether they have been reported.
    reported: bool,
}

impl BadWeights {
    /// There is no pose, so nothing can fit it.
    pub(crate) fn no_pose(&mut self) {
        self.runs = 0;
    }

    /// Records weights that do not fit the targets in number. Returns whether to report them: after several runs, without counting
    /// those in which another tree of the mesh is being built.
    pub(crate) fn wrong_count(&mut self, tree_is_coming: bool) -> bool {
        if !self.reported {
            self.runs = if tree_is_coming { 0 } else { self.runs + 1 };
            if self.runs <= PATIENCE {
                return false;
            }
        }
        self.bad_values()
    }

    /// Records weights that are refused. Returns whether to report them: only the first time.
    pub(crate) fn bad_values(&mut self) -> bool {
        !std::mem::replace(&mut self.reported, true)
    }
}
