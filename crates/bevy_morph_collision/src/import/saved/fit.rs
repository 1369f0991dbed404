//! Which of the saved trees fits a mesh.

use std::sync::Arc;

use morph_collision::{BuildOptions, MorphBvhBuilder, MorphModel, SavedTree, TreeFile};

use super::store::Store;

/// Why no tree fits a mesh.
pub(super) const OTHER_MESH: &str = "it was baked for another mesh, or the mesh has changed since, or is loaded with settings that change it. \
    `morph-collide bake` writes it anew";

/// Saved trees, and what messages call the file and the mesh.
pub(in crate::import) struct Layouts {
    pub(super) file: Arc<TreeFile>,
    pub(super) path: String,
    pub(super) mesh: String,
    pub(super) store: Store,
}

impl Layouts {
    /// Starts to restore the tree of a mesh. If none fits, logs why.
    pub(in crate::import) fn restore(self, model: &Arc<MorphModel>, options: &BuildOptions) -> Option<MorphBvhBuilder> {
        match fitting(self.file.trees.iter(), model, Some(options)) {
            Ok(builder) => Some(builder),
            Err(reason) => {
                self.store.refuse(&self.path, &self.mesh, &reason);
                None
            }
        }
    }
}

/// Restores one of the trees that fits a mesh and the options, if there are any, or says why none does.
pub(super) fn fitting<'a>(
    trees: impl Iterator<Item = &'a SavedTree>,
    model: &Arc<MorphModel>,
    options: Option<&BuildOptions>,
) -> Result<MorphBvhBuilder, String> {
    let fingerprint = model.fingerprint();
    let mut others = None;
    for SavedTree { layout, .. } in trees.filter(|tree| tree.layout.fingerprint() == fingerprint) {
        if options.is_none_or(|options| layout.options() == options) {
            let again = |error| format!("{error}. `morph-collide bake` writes it anew");
            return MorphBvhBuilder::from_layout(model.clone(), layout).map_err(again);
        }
        others = Some(layout.options());
    }
    Err(match (others, options) {
        (Some(found), Some(wanted)) => other_options(found, wanted),
        _ => OTHER_MESH.to_owned(),
    })
}

pub(super) fn other_options(found: &BuildOptions, wanted: &BuildOptions) -> String {
    let [found, wanted] = [found, wanted].map(BuildOptions::leaf_size);
    format!(
        "it was baked with `--leaf {found}`, and `MorphTreeOptions::leaf_size` is {wanted}. Use the same number in both"
    )
}
