//! What a scene draws: nodes with meshes, once for each of their instances.

use super::GltfFile;
use super::document::ElementError;
use super::error::{NodeProblem, ReadError};

/// The part of a file that is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extent {
    /// The scene to draw if no other is asked for ([`GltfFile::default_scene`]). A file without scenes is taken as a whole.
    #[default]
    DefaultScene,
    /// The scene with this index.
    Scene(usize),
    /// All meshes of the file, where all of its nodes show them, and once in their own space if none does.
    Everything,
}

/// A mesh as it is drawn once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DrawnMesh {
    /// The mesh's index in the file.
    pub mesh: usize,
    /// The node that shows it; `None` for a mesh that no node shows, which is in its own space.
    pub node: Option<usize>,
    /// Which of the node's [instances](GltfFile::instances), if it has any.
    pub instance: Option<usize>,
}

/// All that is drawn, and what is not.
#[derive(Debug, Default)]
pub struct Drawing {
    /// In the order of meshes, then of nodes, then of instances.
    pub drawn: Vec<DrawnMesh>,
    /// Nodes that cannot be read. They draw nothing.
    pub broken: Vec<ReadError>,
    /// The number of meshes of the file that are not drawn.
    pub meshes_left_out: usize,
    /// The number of nodes with a mesh that are outside the scene or hidden (`KHR_node_visibility`).
    pub nodes_left_out: usize,
}

impl GltfFile {
    /// The names of the scenes, in order. A scene without a name gets a default name.
    #[must_use]
    pub fn scene_names(&self) -> Vec<String> {
        let name = |scene: usize| {
            let json = self.root.scenes.get(scene, &self.budget).ok();
            let name = json.and_then(|json| json.name.clone());
            name.unwrap_or_else(|| format!("scene_{scene}"))
        };
        self.root.scenes.indices().map(name).collect()
    }

    /// The scene that is drawn if no other is asked for: the one that the file names, or else the first. `None` if it has none.
    #[must_use]
    pub fn default_scene(&self) -> Option<usize> {
        let scenes = self.root.scenes.indices();
        let named = self.root.scene.filter(|scene| scenes.contains(scene));
        named.or_else(|| scenes.clone().next())
    }

    /// What is drawn of a file at rest.
    ///
    /// # Errors
    /// The scene does not exist or is malformed, or the list takes too much memory.
    pub fn drawing(&self, extent: Extent) -> Result<Drawing, ReadError> {
        let scene = match extent {
            Extent::DefaultScene => self.default_scene(),
            Extent::Scene(scene) => Some(scene),
            Extent::Everything => None,
        };
        let nodes = self.root.nodes.len() as u64;
        let over = |over| ReadError::OverBudget {
            path: self.path.clone(),
            over,
        };
        self.budget
            .take(nodes, 32, || format!("the list of its {nodes} nodes"))
            .map_err(over)?;
        let is_in = match (scene, extent) {
            (Some(scene), _) => self.nodes_in(scene)?,
            (None, Extent::Everything) => vec![true; self.root.nodes.len()],
            (None, _) => self.visible_nodes(),
        };
        let mut drawing = Drawing::default();
        // For each mesh, whether any node shows it.
        let mut is_shown = vec![false; self.root.meshes.len()];
        for (node, is_in) in is_in.into_iter().enumerate() {
            let json = match self.root.nodes.get(node, &self.budget) {
                Ok(json) => json,
                Err(problem) => {
                    let problem = NodeProblem::Element(problem);
                    drawing.broken.push(self.node_error(node, problem));
                    continue;
                }
            };
            let Some(mesh) = json.mesh else { continue };
            if let Some(is_shown) = is_shown.get_mut(mesh) {
                *is_shown = true;
            }
            if !is_in {
                drawing.nodes_left_out += 1;
                continue;
            }
            let mut add = |instance| {
                drawing.drawn.push(DrawnMesh {
                    mesh,
                    node: Some(node),
                    instance,
                });
            };
            if let Err(problem) = json.is_hidden(&self.budget) {
                drawing
                    .broken
                    .push(self.node_error(node, NodeProblem::Extension(problem)));
                continue;
            }
            match self.instance_count(node) {
                Ok(None) => add(None),
                Ok(Some(count)) => {
                    let what = || format!("the list of {count} instances of node {node}");
                    self.budget
                        .take(count as u64, size_of::<DrawnMesh>() as u64, what)
                        .map_err(over)?;
                    (0..count).map(Some).for_each(add);
                }
                Err(problem) => drawing.broken.push(self.node_error(node, problem)),
            }
        }
        let mut is_drawn = vec![false; is_shown.len()];
        for drawn in &drawing.drawn {
            if let Some(is_drawn) = is_drawn.get_mut(drawn.mesh) {
                *is_drawn = true;
            }
        }
        for (mesh, (is_shown, is_drawn)) in is_shown.into_iter().zip(is_drawn).enumerate() {
            match (scene, is_shown) {
                _ if is_drawn => {}
                (None, false) => drawing.drawn.push(DrawnMesh {
                    mesh,
                    node: None,
                    instance: None,
                }),
                _ => drawing.meshes_left_out += 1,
            }
        }
        // The nodes are in order already.
        drawing.drawn.sort_by_key(|drawn| drawn.mesh);
        Ok(drawing)
    }

    /// For each node, whether it is in a scene and visible.
    pub(super) fn nodes_in(&self, scene: usize) -> Result<Vec<bool>, ReadError> {
        let json = self.root.scenes.get(scene, &self.budget);
        let json = json.map_err(|problem: ElementError| ReadError::Scene {
            path: self.path.clone(),
            scene,
            problem,
        })?;
        let mut is_in = vec![false; self.root.nodes.len()];
        self.mark(&json.nodes, true, &mut is_in);
        Ok(is_in)
    }

    /// For each node, whether neither it nor a node above it is hidden.
    pub(super) fn visible_nodes(&self) -> Vec<bool> {
        let mut is_visible = vec![true; self.root.nodes.len()];
        for node in self.root.nodes.indices() {
            let json = self.root.nodes.get(node, &self.budget);
            if json.is_ok_and(|json| json.is_hidden(&self.budget) == Ok(true)) {
                self.mark(&[node], false, &mut is_visible);
            }
        }
        is_visible
    }

    /// Marks some nodes and all below them that are not marked so far. Of nodes that get the mark `true`, hidden ones are left out.
    fn mark(&self, nodes: &[usize], mark: bool, marks: &mut [bool]) {
        // Each node is entered once, also if the file says that it is below itself.
        let mut waiting: Vec<&[usize]> = vec![nodes];
        while let Some(siblings) = waiting.pop() {
            for &node in siblings {
                let Some(entered) = marks.get_mut(node).filter(|entered| **entered != mark) else {
                    continue;
                };
                let Ok(json) = self.root.nodes.get(node, &self.budget) else {
                    continue;
                };
                if !mark || json.is_hidden(&self.budget) != Ok(true) {
                    *entered = mark;
                    waiting.push(&json.children);
                }
            }
        }
    }
}
