//! Finds the triangles that touch among posed bodies, within each body and between them.

use morph_collision::{PairQuery, SelfQuery, TrianglePair, overlapping_pairs};

use crate::posed::Posed;

/// Two triangles that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Touch {
    /// The same body twice if it intersects itself.
    pub(crate) bodies: [usize; 2],
    pub(crate) pair: TrianglePair,
}

/// Which pairs of triangles to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Among {
    /// Of the same body and of different bodies.
    All,
    /// Of the same body.
    #[value(name = "self")]
    Itself,
    /// Of different bodies.
    Bodies,
}

/// Memory that searches reuse.
#[derive(Debug, Default)]
pub(crate) struct Search {
    of_one: SelfQuery,
    of_two: PairQuery,
    pairs: Vec<TrianglePair>,
}

impl Search {
    /// Appends all pairs that touch, ascending. Returns false if there are more than `most`; then some are missing.
    pub(crate) fn touching(&mut self, bodies: &mut [Posed], among: Among, most: usize, found: &mut Vec<Touch>) -> bool {
        let start = found.len();
        let mut complete = true;
        if among != Among::Bodies {
            for (index, body) in bodies.iter_mut().enumerate() {
                self.pairs.clear();
                let room = most.saturating_sub(found.len());
                complete &= !self.of_one.up_to(&mut body.pose, room, &mut self.pairs);
                found.extend(self.pairs.iter().map(|&pair| Touch {
                    bodies: [index; 2],
                    pair,
                }));
            }
        }
        if among != Among::Itself {
            let bounds: Vec<_> = bodies.iter_mut().map(|body| Some(body.bounds())).collect();
            let mut candidates = Vec::new();
            overlapping_pairs(&bounds, &mut candidates);
            for (a, b) in candidates {
                let both = [a, b].map(|body| body as usize);
                let Ok([first, second]) = bodies.get_disjoint_mut(both) else {
                    continue;
                };
                self.pairs.clear();
                let room = most.saturating_sub(found.len());
                complete &= !self.of_two.up_to(first.body(), second.body(), room, &mut self.pairs);
                found.extend(self.pairs.iter().map(|&pair| Touch { bodies: both, pair }));
            }
        }
        found[start..].sort_unstable();
        complete
    }
}
