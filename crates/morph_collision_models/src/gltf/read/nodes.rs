//! The nodes that show meshes: default weights and placement.

use std::collections::HashMap;

use glam::{Affine3A, Mat4};

use super::GltfFile;
use super::document::Node;

use super::error::{MeshProblem, ReadError};
use super::skin::Hierarchy;
use crate::skeleton::{Joint, Skeleton};

impl GltfFile {
    /// The nodes that show a mesh, in file order. Nodes that cannot be parsed are skipped.
    pub fn nodes_of(&self, mesh: usize) -> impl Iterator<Item = usize> {
        let shows = move |node: &usize| self.node_json(*node).is_some_and(|json| json.mesh == Some(mesh));
        self.root.nodes.indices().filter(shows)
    }

    /// A node's name, or a default name.
    #[must_use]
    pub fn node_name(&self, node: usize) -> String {
        let name = self.node_json(node).and_then(|json| json.name.clone());
        name.unwrap_or_else(|| format!("node_{node}"))
    }

    /// The weights of a mesh with `targets` targets that no clip animates: those of the node that shows it, or else its own, or else
    /// zero. Empty if all are zero.
    ///
    /// If no `node` is given, [the main one](GltfFile::main_node) counts.
    ///
    /// # Errors
    /// The file has another number of weights, or one that is not finite.
    pub fn default_weights(&self, mesh: usize, node: Option<usize>, targets: usize) -> Result<Vec<f32>, ReadError> {
        let json = self.root.meshes.get(mesh, &self.budget).ok();
        let node = node.or_else(|| self.main_node(mesh));
        let of_node = node.and_then(|node| self.node_json(node)?.weights.as_ref());
        let Some(weights) = of_node.or(json.and_then(|json| json.weights.as_ref())) else {
            return Ok(Vec::new());
        };
        let fail = |problem| ReadError::Mesh {
            path: self.path.clone(),
            mesh,
            name: self.mesh_name(mesh),
            problem: Box::new(problem),
        };
        if weights.len() != targets {
            return Err(fail(MeshProblem::DefaultWeights {
                found: weights.len(),
                expected: targets,
            }));
        }
        if let Some(target) = weights.iter().position(|weight| !weight.is_finite()) {
            let weight = weights[target];
            return Err(fail(MeshProblem::DefaultWeight { target, weight }));
        }
        if weights.iter().all(|&weight| weight == 0.0) {
            return Ok(Vec::new());
        }
        let take = self.budget.take(targets as u64, 4, || "its default weights".into());
        take.map_err(|over| fail(MeshProblem::OverBudget(over)))?;
        Ok(weights.clone())
    }

    /// The node whose skin, weights and clips a mesh has if no other is asked for: of the nodes that the default scene draws, the first one
    /// with a skin, or else the first one; if there is none, of all nodes.
    #[must_use]
    pub fn main_node(&self, mesh: usize) -> Option<usize> {
        let of_meshes = self.main_nodes.get_or_init(|| self.find_main_nodes());
        of_meshes.get(&mesh).copied()
    }

    fn find_main_nodes(&self) -> HashMap<usize, usize> {
        let mut found: HashMap<usize, (usize, [bool; 2])> = HashMap::new();
        let is_in = match self.default_scene() {
            Some(scene) => self.nodes_in(scene).unwrap_or_default(),
            None => self.visible_nodes(),
        };
        for node in self.root.nodes.indices() {
            let Some((mesh, json)) = self.node_json(node).and_then(|json| Some((json.mesh?, json))) else {
                continue;
            };
            let is_drawn = is_in.get(node) == Some(&true);
            let rank = [is_drawn, json.skin.is_some()];
            let best = found.entry(mesh).or_insert((node, rank));
            if rank > best.1 {
                *best = (node, rank);
            }
        }
        found.into_iter().map(|(mesh, (node, _))| (mesh, node)).collect()
    }

    /// How a node is placed in the world, at rest and in clips: a skeleton whose only joint is the node.
    ///
    /// # Errors
    /// The node does not exist, or it or a node above it is malformed.
    pub fn placement(&self, mesh: usize, node: usize) -> Result<Skeleton, ReadError> {
        let mut hierarchy = self.hierarchy_of_node(mesh, node)?;
        self.add_clips(&mut hierarchy);
        Ok(hierarchy.skeleton)
    }

    /// Where a node is in the world at rest.
    ///
    /// # Errors
    /// See [`GltfFile::placement`].
    pub fn world_from_node(&self, mesh: usize, node: usize) -> Result<Affine3A, ReadError> {
        let place = self.hierarchy_of_node(mesh, node)?.skeleton.at_rest();
        Ok(place.first().copied().unwrap_or(Affine3A::IDENTITY))
    }

    fn hierarchy_of_node(&self, mesh: usize, node: usize) -> Result<Hierarchy, ReadError> {
        let mut hierarchy = Hierarchy::default();
        let place = self
            .add_with_ancestors(node, &mut hierarchy)
            .map_err(|problem| ReadError::Skin {
                path: self.path.clone(),
                mesh,
                name: self.mesh_name(mesh),
                problem: Box::new(problem),
            })?;
        hierarchy.skeleton.joints.push(Joint {
            node: place,
            inverse_bind: Mat4::IDENTITY,
        });
        Ok(hierarchy)
    }

    pub(super) fn node_json(&self, node: usize) -> Option<&Node> {
        self.root.nodes.get(node, &self.budget).ok()
    }
}
