//! Moves all bodies from one frame to the next and finds the first contact of each pair.

use std::ops::ControlFlow;
use std::sync::Arc;

use morph_collision::QueryStats;
use morph_collision::motion::{LimitReached, MotionContact, MotionQuery, MovingBody};
use morph_collision_models::mesh::MorphMesh;

use crate::cast::posed::{Posed, trees};
use crate::cast::{Cast, SetUp, Source};
use crate::error::{AnyError, CliError};
use crate::options::tree::TreeArgs;

/// Sets up each body at the start and at the end of a step.
pub(super) struct Ends<'a>(pub(super) &'a TreeArgs);

/// The bodies at both ends.
type BothEnds = Vec<[Posed; 2]>;

impl SetUp for Ends<'_> {
    type Bodies = BothEnds;

    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64) {
        (mesh.tree_bytes(), mesh.body_bytes(false).saturating_mul(2))
    }

    fn set_up(&self, source: &Source<'_>) -> Result<BothEnds, AnyError> {
        let trees = trees(source, &self.0.build());
        let posed = |mesh: usize| Posed::new(Arc::clone(&trees[mesh]));
        Ok(source
            .mesh_of_body
            .iter()
            .map(|&mesh| [posed(mesh), posed(mesh)])
            .collect())
    }
}

/// The first contact of two bodies in a step.
pub(super) struct FirstContact {
    /// The frame at which the step starts.
    pub(super) frame: usize,
    pub(super) bodies: [usize; 2],
    pub(super) contact: MotionContact,
    /// The number of pairs of features that touch, if they were counted.
    pub(super) pairs: Option<u64>,
}

/// Two bodies that may touch in a step, but so many of whose features are so close that it takes too long to tell.
pub(super) struct Undecided {
    pub(super) frame: usize,
    pub(super) bodies: [usize; 2],
    /// Nothing touches before this time, as a share of the step.
    pub(super) not_before: f64,
}

/// What was found so far.
pub(super) struct Stage {
    query: MotionQuery,
    tolerance: f64,
    counts: bool,
    pub(super) contacts: Vec<FirstContact>,
    pub(super) undecided: Vec<Undecided>,
    /// Summed over all steps.
    pub(super) stats: QueryStats,
}

impl Stage {
    pub(super) fn new(tolerance: f64, counts: bool) -> Self {
        Self {
            query: MotionQuery::new(),
            tolerance,
            counts,
            contacts: Vec::new(),
            undecided: Vec::new(),
            stats: QueryStats::default(),
        }
    }

    /// Finds the first contacts between a frame and the next.
    pub(super) fn step(&mut self, cast: &mut Cast<BothEnds>, frame: usize) -> Result<(), CliError> {
        for body in 0..cast.bodies {
            if frame == 0 {
                pose(cast, 0, body, 0)?;
            } else {
                // The end of the last step is the start of this one, with its cache.
                cast.method[body].swap(0, 1);
            }
            pose(cast, frame + 1, body, 1)?;
        }
        for b in 1..cast.bodies {
            let (before, rest) = cast.method.split_at_mut(b);
            for (a, ends) in before.iter_mut().enumerate() {
                let (Some(body_a), Some(body_b)) = (moving(ends), moving(&mut rest[0])) else {
                    continue;
                };
                let first = self.query.first(body_a, body_b, self.tolerance);
                self.stats += self.query.stats();
                let bodies = [a, b];
                match first {
                    Ok(Some(contact)) => {
                        let pairs = self.counts.then(|| self.count(ends, &mut rest[0])).flatten();
                        self.contacts.push(FirstContact {
                            frame,
                            bodies,
                            contact,
                            pairs,
                        });
                    }
                    Ok(None) => {}
                    Err(LimitReached { not_before }) => self.undecided.push(Undecided {
                        frame,
                        bodies,
                        not_before,
                    }),
                }
            }
        }
        Ok(())
    }

    /// The number of pairs of features that touch; `None` if counting them takes too long.
    fn count(&mut self, a: &mut [Posed; 2], b: &mut [Posed; 2]) -> Option<u64> {
        let mut pairs = 0;
        let counted = self.query.visit(moving(a)?, moving(b)?, self.tolerance, |_| {
            pairs += 1;
            ControlFlow::Continue(())
        });
        self.stats += self.query.stats();
        counted.is_ok().then_some(pairs)
    }
}

/// The body of a step. Its poses always have the same tree.
fn moving([start, end]: &mut [Posed; 2]) -> Option<MovingBody<'_>> {
    MovingBody::new(start.body(), end.body()).ok()
}

/// Sets the weights, joints and placement of one end of a body's step.
fn pose(cast: &mut Cast<BothEnds>, frame: usize, body: usize, end: usize) -> Result<(), CliError> {
    let shape = cast.shape(frame, body);
    cast.method[body][end]
        .set(&shape)
        .map_err(|reason| cast.refused(frame, body, reason))
}
