//! The shapes that a tree measures its nodes on: base, scaled references, in-betweens, displacements.

use glam::DVec3;

use crate::model::MorphModel;

/// A set of points, one per vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    /// `b`
    Base,
    /// `b + S d_k`
    Reference(u32, f64),
    /// `d_k`
    Displacement(u32),
}

/// Which shapes a tree is built for.
///
/// In-betweens (the paper's Sect. 5) are targets of the tree beside those of the model: target `K + i` is the mean of the
/// two targets of `between[i]`. A pose splits its weights over both, see `pose/weights.rs`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Columns {
    pub(super) model_targets: u32,
    pub(super) between: Vec<[u32; 2]>,
    /// Positive scales, largest first.
    pub(super) scales: Vec<f32>,
    /// Whether references are reflected, too, for negative weights.
    pub(super) reflected: bool,
}

impl Columns {
    /// Every scale, and then, if asked for, every scale negated.
    pub(super) fn scales(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        let positive = self.scales.len();
        let count = if self.reflected { 2 * positive } else { positive };
        (0..count).map(move |i| match i.checked_sub(positive) {
            None => f64::from(self.scales[i]),
            Some(i) => -f64::from(self.scales[i]),
        })
    }

    /// The two model targets of which half each makes up the in-between target.
    pub(crate) fn between(&self) -> &[[u32; 2]] {
        &self.between
    }

    /// The tree's targets that move any of the vertices, ascending.
    pub(super) fn local_targets(&self, model: &MorphModel, vertices: &[u32]) -> Vec<u32> {
        let mut locals: Vec<u32> = vertices
            .iter()
            .flat_map(|&v| model.displacements(v).iter().map(|d| d.target))
            .collect();
        locals.sort_unstable();
        locals.dedup();
        let moved = |target: &u32| locals.binary_search(target).is_ok();
        let between: Vec<u32> = (self.model_targets..)
            .zip(&self.between)
            .filter(|(_, pair)| pair.iter().any(moved))
            .map(|(target, _)| target)
            .collect();
        locals.extend(between);
        locals
    }

    /// The largest absolute coordinate of a target's displacements, rounded up.
    pub(super) fn reach(&self, model: &MorphModel, vertices: &[u32], target: u32) -> f32 {
        let mut reach = 0.0_f64;
        self.for_each_point(model, vertices, Shape::Displacement(target), &mut |d| {
            reach = reach.max(d.abs().max_element());
        });
        crate::bounds::up(reach)
    }

    pub(super) fn for_each_point(
        &self,
        model: &MorphModel,
        vertices: &[u32],
        shape: Shape,
        each: &mut dyn FnMut(DVec3),
    ) {
        for &v in vertices {
            let base = || model.base(v).as_dvec3();
            each(match shape {
                Shape::Base => base(),
                Shape::Reference(target, scale) => base() + scale * self.displacement(model, v, target),
                Shape::Displacement(target) => self.displacement(model, v, target),
            });
        }
    }

    fn displacement(&self, model: &MorphModel, vertex: u32, target: u32) -> DVec3 {
        match target.checked_sub(self.model_targets) {
            None => model_displacement(model, vertex, target),
            Some(i) => {
                let [j, k] = self.between[i as usize];
                0.5 * (model_displacement(model, vertex, j) + model_displacement(model, vertex, k))
            }
        }
    }
}

fn model_displacement(model: &MorphModel, vertex: u32, target: u32) -> DVec3 {
    let displacements = model.displacements(vertex);
    match displacements.binary_search_by_key(&target, |d| d.target) {
        Ok(i) => displacements[i].delta.as_dvec3(),
        Err(_) => DVec3::ZERO,
    }
}
