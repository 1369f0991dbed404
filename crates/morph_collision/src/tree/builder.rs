//! Builds a tree in steps.

use std::fmt;
use std::future::Future;
use std::ops::ControlFlow;
use std::pin::Pin;
use std::sync::Arc;
use std::task::Poll;

use super::budget::{Budget, resume};
use super::build::build_within;
use super::{BuildOptions, LayoutError, MorphBvh, TreeLayout};
use crate::model::MorphModel;

/// The work of one step, in the unit of [`Budget`].
pub(super) const STEP: usize = 1 << 17;

/// Builds a [`MorphBvh`] in steps, for threads that must not block, such as the only thread of a web page.
///
/// The tree is the same as from [`MorphBvh::build`], bit for bit. A step does as much work as putting 131,072 triangles into boxes,
/// which takes about a millisecond. Steps can take longer if a mesh has more triangles or vertices than that, because some steps
/// process the whole mesh.
///
/// ```
/// # use std::{ops::ControlFlow, sync::Arc};
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvhBuilder, MorphModel};
/// # let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// # let model = Arc::new(MorphModel::from_displacements::<[Vec3; 3]>(&base, &[[0, 1, 2]], &[])?);
/// let mut builder = MorphBvhBuilder::new(model, &BuildOptions::default());
/// let bvh = loop {
///     builder = match builder.step() {
///         ControlFlow::Continue(builder) => builder, // draw a frame, handle events
///         ControlFlow::Break(bvh) => break bvh,
///     };
/// };
/// # Ok::<(), morph_collision::ModelError>(())
/// ```
pub struct MorphBvhBuilder {
    pub(super) budget: Arc<Budget>,
    build: Pin<Box<dyn Future<Output = MorphBvh> + Send + Sync>>,
}

impl MorphBvhBuilder {
    /// Creates a builder. It does nothing until the first step.
    #[must_use]
    pub fn new(model: Arc<MorphModel>, options: &BuildOptions) -> Self {
        let budget = Arc::new(Budget::unlimited());
        let (of_build, options) = (budget.clone(), *options);
        Self {
            budget,
            build: Box::pin(async move { build_within(model, &options, &of_build).await }),
        }
    }

    /// Creates a builder that restores a tree over the mesh for which it was built, in steps. The layout is checked at once, apart from its
    /// certificates: if they are corrupt, the tree has none.
    ///
    /// # Errors
    /// As for [`MorphBvh::from_layout`].
    pub fn from_layout(model: Arc<MorphModel>, layout: &TreeLayout) -> Result<Self, LayoutError> {
        layout.check(&model)?;
        let budget = Arc::new(Budget::unlimited());
        let (of_build, layout) = (budget.clone(), layout.clone());
        let build = async move {
            let bvh = layout.rebuild(model, &of_build).await;
            // Without certificates, answers are the same.
            let _ = layout.certify(&bvh);
            bvh
        };
        Ok(Self {
            budget,
            build: Box::pin(build),
        })
    }

    /// Does the next step. Returns the builder, or the tree after the last step.
    pub fn step(mut self) -> ControlFlow<MorphBvh, Self> {
        self.budget.begin(STEP);
        match resume(self.build.as_mut()) {
            Poll::Ready(bvh) => ControlFlow::Break(bvh),
            Poll::Pending => ControlFlow::Continue(self),
        }
    }
}

impl fmt::Debug for MorphBvhBuilder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MorphBvhBuilder").finish_non_exhaustive()
    }
}
