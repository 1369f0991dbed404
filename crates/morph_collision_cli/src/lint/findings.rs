//! Regions of many shapes become findings: one for each place of the mesh that a target, a pair of targets, a clip, a capture or the
//! mixtures make touch.

use std::collections::{BTreeSet, HashMap, HashSet};

use glam::Affine3A;
use morph_collision_models::memory::{MemoryBudget, OverBudget};

use super::poses::Tried;
use super::regions::Region;
use super::search::NewPairs;
use super::source::Source;

/// A place of the mesh that touches itself in at least one shape of a source.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    pub(super) source: Source,
    /// The deepest region, and the shape in which it was found.
    pub(super) worst: Region,
    pub(super) moment: Option<f64>,
    pub(super) weights: Vec<f32>,
    pub(super) joints: Option<Vec<Affine3A>>,
    /// The triangles that touch in any shape of the source, ascending.
    pub(super) touching: Vec<u32>,
    /// The number of shapes in which something here touches.
    pub(super) shapes: usize,
    /// Whether a shape had more pairs than were looked at.
    pub(super) is_truncated: bool,
}

/// Collects the findings of one mesh. Shapes of the same source have to follow each other.
#[derive(Debug, Default)]
pub(super) struct Findings {
    done: Vec<Finding>,
    /// Those of the current source. A finding that became part of another is `None`.
    current: Vec<Option<Finding>>,
    of_triangle: HashMap<u32, usize>,
    /// The triangles of all findings.
    seen: HashSet<u32>,
}

impl Findings {
    /// Adds the regions of a shape.
    pub(super) fn add(&mut self, tried: &Tried, found: NewPairs, budget: &MemoryBudget) -> Result<(), OverBudget> {
        if self
            .current
            .iter()
            .flatten()
            .any(|finding| finding.source != tried.source)
        {
            self.end_source();
        }
        let mut counted = BTreeSet::new();
        for region in found.regions {
            self.seen.extend(&region.triangles);
            let new = region
                .triangles
                .iter()
                .filter(|triangle| !self.of_triangle.contains_key(triangle))
                .count();
            // Five lists have a triangle, and the tables.
            budget.take(new as u64, 96, || "the findings".to_owned())?;
            let mut met: Vec<usize> = region
                .triangles
                .iter()
                .filter_map(|triangle| self.of_triangle.get(triangle).copied())
                .collect();
            met.sort_unstable();
            met.dedup();
            let index = match met.split_first() {
                None => {
                    budget.take(tried.weights.len() as u64, 16, || "the findings".to_owned())?;
                    self.current
                        .push(Some(Finding::new(tried, &region, found.is_truncated)));
                    self.current.len() - 1
                }
                Some((&first, others)) => {
                    for &other in others {
                        let other = self.current[other].take();
                        self.join(first, other);
                    }
                    first
                }
            };
            if let Some(finding) = &mut self.current[index] {
                finding.shapes += usize::from(counted.insert(index));
                finding.is_truncated |= found.is_truncated;
                for &triangle in &region.triangles {
                    if self.of_triangle.insert(triangle, index).is_none() {
                        finding.touching.push(triangle);
                    }
                }
                if (region.depth, region.pairs) > (finding.worst.depth, finding.worst.pairs) {
                    finding.worst = region;
                    finding.moment = tried.moment;
                    finding.weights.clone_from(&tried.weights);
                    finding.joints.clone_from(&tried.joints);
                }
            }
        }
        Ok(())
    }

    /// Whether a triangle is in any finding.
    pub(super) fn has(&self, triangle: u32) -> bool {
        self.seen.contains(&triangle)
    }

    /// All findings by kind of source; among those of a kind, the deepest first.
    pub(super) fn finish(mut self) -> Vec<Finding> {
        self.end_source();
        let key = |finding: &Finding| (finding.worst.depth, finding.worst.pairs);
        self.done.sort_by(|one, other| {
            let (one_key, other_key) = (key(one), key(other));
            let by_kind = one.source.kind().cmp(&other.source.kind());
            let by_depth = other_key.0.total_cmp(&one_key.0).then(other_key.1.cmp(&one_key.1));
            by_kind.then(by_depth).then_with(|| one.touching.cmp(&other.touching))
        });
        self.done
    }

    fn end_source(&mut self) {
        for mut finding in self.current.drain(..).flatten() {
            finding.touching.sort_unstable();
            self.done.push(finding);
        }
        self.of_triangle.clear();
    }

    /// Makes another finding a part of one.
    fn join(&mut self, into: usize, other: Option<Finding>) {
        let (Some(finding), Some(other)) = (&mut self.current[into], other) else {
            return;
        };
        for &triangle in &other.touching {
            self.of_triangle.insert(triangle, into);
        }
        finding.touching.extend(other.touching);
        finding.shapes = finding.shapes.max(other.shapes);
        finding.is_truncated |= other.is_truncated;
        if (other.worst.depth, other.worst.pairs) > (finding.worst.depth, finding.worst.pairs) {
            finding.worst = other.worst;
            finding.moment = other.moment;
            finding.weights = other.weights;
            finding.joints = other.joints;
        }
    }
}

impl Finding {
    fn new(tried: &Tried, region: &Region, is_truncated: bool) -> Self {
        Self {
            source: tried.source.clone(),
            worst: region.clone(),
            moment: tried.moment,
            weights: tried.weights.clone(),
            joints: tried.joints.clone(),
            touching: Vec::new(),
            shapes: 0,
            is_truncated,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(regions: &[(&[u32], f64)]) -> NewPairs {
        let region = |&(triangles, depth): &(&[u32], f64)| Region {
            triangles: triangles.to_vec(),
            first_side: triangles[..1].to_vec(),
            pairs: 1,
            depth,
            length: 0.0,
        };
        NewPairs {
            regions: regions.iter().map(region).collect(),
            ..NewPairs::default()
        }
    }

    fn tried(source: Source, moment: f64) -> Tried {
        Tried {
            source,
            moment: Some(moment),
            weights: vec![moment as f32],
            joints: None,
        }
    }

    #[test]
    fn regions_that_overlap_in_any_shape_of_a_source_are_one_finding() -> Result<(), OverBudget> {
        let mut findings = Findings::default();
        let budget = MemoryBudget::default();
        findings.add(
            &tried(Source::Target(0), 1.0),
            found(&[(&[1, 2], 0.1), (&[5, 6], 0.2)]),
            &budget,
        )?;
        findings.add(
            &tried(Source::Target(0), 2.0),
            found(&[(&[2, 6], 0.5), (&[8, 9], 0.3)]),
            &budget,
        )?;
        findings.add(&tried(Source::Target(1), 3.0), found(&[(&[1, 2], 0.4)]), &budget)?;
        findings.add(&tried(Source::Mixtures, 4.0), found(&[(&[1, 2], 0.9)]), &budget)?;
        let found: Vec<_> = findings
            .finish()
            .into_iter()
            .map(|finding| (finding.source, finding.moment, finding.touching, finding.worst.depth))
            .collect();
        assert_eq!(
            found,
            [
                (Source::Target(0), Some(2.0), vec![1, 2, 5, 6], 0.5),
                (Source::Target(1), Some(3.0), vec![1, 2], 0.4),
                (Source::Target(0), Some(2.0), vec![8, 9], 0.3),
                (Source::Mixtures, Some(4.0), vec![1, 2], 0.9),
            ]
        );
        Ok(())
    }

    #[test]
    fn findings_stay_within_the_memory_budget() {
        let mut findings = Findings::default();
        let triangles: Vec<u32> = (0..1000).collect();
        let added = findings.add(
            &tried(Source::Mixtures, 1.0),
            found(&[(&triangles, 1.0)]),
            &MemoryBudget::new(9999),
        );
        assert!(added.is_err_and(|over| over.what == "the findings"));
    }
}
