//! The weights of a pose, and which of them are not 0.

/// One weight per target, and a list of the nonzero ones, so that blending costs only what those cost.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weights {
    all: Vec<f32>,
    /// The targets with nonzero weights, ascending, with their weights.
    active: Vec<(u32, f32)>,
    /// How often they were set. What was computed for them remembers it, and so knows whether it is still valid.
    version: u64,
}

/// One binary search is assumed to cost as much as iterating over this many targets. Not measured.
const SEARCH: usize = 8;

impl Weights {
    pub(crate) fn new(all: &[f32]) -> Self {
        let mut weights = Self::default();
        weights.set(all);
        weights
    }

    pub(crate) fn set(&mut self, all: &[f32]) {
        self.all.clear();
        self.all.extend_from_slice(all);
        self.active.clear();
        let targets = (0..).zip(all.iter().copied());
        self.active.extend(targets.filter(|&(_, weight)| weight != 0.0));
        self.version += 1;
    }

    /// Another number after each change, and never 0.
    pub(crate) fn version(&self) -> u64 {
        self.version
    }

    pub(crate) fn all(&self) -> &[f32] {
        &self.all
    }

    /// The targets with nonzero weights, ascending, with their weights.
    pub(crate) fn active(&self) -> &[(u32, f32)] {
        &self.active
    }

    /// Bytes on the heap.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.all) + self.active.capacity() * size_of::<(u32, f32)>()
    }

    /// Whether so few targets are active that searching a list of this many targets for each of them beats iterating over the list.
    #[inline(always)]
    pub(crate) fn are_few_of(&self, targets: usize) -> bool {
        self.active.len() * SEARCH < targets
    }

    /// Where an active target is in an ascending list. Ask for targets in ascending order, and start with `from` at 0.
    #[inline(always)]
    pub(crate) fn find(targets: &[u16], target: u32, from: &mut usize) -> Option<usize> {
        // A list of all targets needs no search.
        if targets.get(target as usize).is_some_and(|&at| u32::from(at) == target) {
            return Some(target as usize);
        }
        *from += targets[*from..].partition_point(|&other| u32::from(other) < target);
        targets.get(*from).filter(|&&at| u32::from(at) == target).map(|_| *from)
    }

    /// Calls `visit` with the weight and the value of each listed target whose weight is not zero. `targets` must be ascending, and
    /// `values[i]` belongs to `targets[i]`.
    #[inline(always)]
    pub(crate) fn visit<T>(&self, targets: &[u16], values: &[T], mut visit: impl FnMut(f32, &T)) {
        if self.are_few_of(targets.len()) {
            let mut from = 0;
            for &(target, weight) in &self.active {
                if let Some(index) = Self::find(targets, target, &mut from) {
                    visit(weight, &values[index]);
                }
            }
        } else {
            for (&target, value) in targets.iter().zip(values) {
                let weight = self.all[usize::from(target)];
                if weight != 0.0 {
                    visit(weight, value);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    use super::*;

    /// The indices of active targets in `targets`, and the bits of their weights, in order.
    fn visited_by_definition(weights: &[f32], targets: &[u16]) -> Vec<(usize, u32)> {
        let weights = targets.iter().map(|&target| weights[usize::from(target)]);
        let active = weights.enumerate().filter(|&(_, weight)| weight != 0.0);
        active.map(|(index, weight)| (index, weight.to_bits())).collect()
    }

    #[test]
    fn active_targets_are_visited_in_order_however_they_are_found() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let (mut dense, mut searched, mut walked) = (0, 0, 0);
        for case in 0..600 {
            let targets = rng.random_range(0..300_u16);
            let [listed, active] = [(); 2].map(|()| [0.0, 0.02, 0.3, 1.0][rng.random_range(0..4)]);
            let mut weight = || match rng.random_range(0..4) {
                0 => -0.0,
                1 => 0.0,
                _ if !rng.random_bool(active) => 0.0,
                2 => -1.5,
                _ => f32::from_bits(1),
            };
            let all: Vec<f32> = (0..targets).map(|_| weight()).collect();
            let list: Vec<u16> = (0..targets).filter(|_| rng.random_bool(listed)).collect();
            let weights = Weights::new(&all);
            assert_eq!(weights.all().len(), all.len());
            let mut visited = Vec::new();
            let places: Vec<usize> = (0..list.len()).collect();
            weights.visit(&list, &places, |weight, &place| visited.push((place, weight.to_bits())));
            assert_eq!(visited, visited_by_definition(&all, &list), "case {case}");
            let way = match list.len() {
                n if n == all.len() => &mut dense,
                n if weights.are_few_of(n) => &mut searched,
                _ => &mut walked,
            };
            *way += usize::from(!visited.is_empty());
        }
        assert!(dense > 20 && searched > 5 && walked > 20, "{dense} {searched} {walked}");
    }
}
