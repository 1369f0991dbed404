//! Nodes that show their mesh several times (`EXT_mesh_gpu_instancing`).

use glam::{Affine3A, Quat, Vec3, Vec4};

use super::GltfFile;
use super::accessor::{FRACTIONS, Form, Opened, POINTS};
use super::document::Instancing;
use super::error::{NodeProblem, ReadError};
use crate::skeleton::normalized;

/// What places the instances of a node, as far as the file says.
struct Places<'a> {
    translations: Option<Opened<'a>>,
    rotations: Option<Opened<'a>>,
    scales: Option<Opened<'a>>,
    count: usize,
}

impl GltfFile {
    /// Where the instances of a node's mesh are in the node's space; `None` for a node that shows its mesh once.
    ///
    /// A node with a skin shows its mesh once, because joints place it.
    ///
    /// # Errors
    /// [`ReadError::Node`]: the node or what places its instances is malformed, or takes too much memory.
    pub fn instances(&self, node: usize) -> Result<Option<Vec<Affine3A>>, ReadError> {
        self.read_instances(node)
            .map_err(|problem| self.node_error(node, problem))
    }

    /// The number of instances of a node; `None` for a node that shows its mesh once.
    pub(super) fn instance_count(&self, node: usize) -> Result<Option<usize>, NodeProblem> {
        Ok(self.places(node)?.map(|places| places.count))
    }

    pub(super) fn node_error(&self, node: usize, problem: NodeProblem) -> ReadError {
        ReadError::Node {
            path: self.path.clone(),
            node,
            name: self.node_name(node),
            problem: Box::new(problem),
        }
    }

    fn read_instances(&self, node: usize) -> Result<Option<Vec<Affine3A>>, NodeProblem> {
        let Some(places) = self.places(node)? else {
            return Ok(None);
        };
        let count = places.count;
        // Ten numbers as they are read, and a matrix.
        let bytes = 10 * size_of::<f32>() + size_of::<Affine3A>();
        let take = self
            .budget
            .take(count as u64, bytes as u64, || format!("its {count} instances"));
        take.map_err(NodeProblem::OverBudget)?;
        let (mut translations, mut scales) = (Vec::<Vec3>::new(), Vec::<Vec3>::new());
        let mut rotations: Vec<Vec4> = Vec::new();
        if let Some(opened) = &places.translations {
            opened.append_vec3(&mut translations).map_err(at("TRANSLATION"))?;
        }
        if let Some(opened) = &places.rotations {
            opened.append_vec4(&mut rotations).map_err(at("ROTATION"))?;
        }
        if let Some(opened) = &places.scales {
            opened.append_vec3(&mut scales).map_err(at("SCALE"))?;
        }
        let not_finite = [
            ("TRANSLATION", translations.iter().position(|value| !value.is_finite())),
            ("ROTATION", rotations.iter().position(|value| !value.is_finite())),
            ("SCALE", scales.iter().position(|value| !value.is_finite())),
        ];
        for (attribute, bad) in not_finite {
            if let Some(instance) = bad {
                return Err(NodeProblem::NotFinite { attribute, instance });
            }
        }
        let place = |instance: usize| {
            let rotation = rotations.get(instance);
            Affine3A::from_scale_rotation_translation(
                scales.get(instance).copied().unwrap_or(Vec3::ONE),
                // Stored integers are only nearly of length 1.
                rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_vec4(normalized(*rotation))),
                translations.get(instance).copied().unwrap_or(Vec3::ZERO),
            )
        };
        Ok(Some((0..count).map(place).collect()))
    }

    fn places(&self, node: usize) -> Result<Option<Places<'_>>, NodeProblem> {
        let json = self.root.nodes.get(node, &self.budget).map_err(NodeProblem::Element)?;
        let Some(instancing) = json.extensions.instancing.as_ref().filter(|_| json.skin.is_none()) else {
            return Ok(None);
        };
        let Instancing { attributes } = instancing.get(&self.budget).map_err(NodeProblem::Extension)?;
        let mut first: Option<(&'static str, usize)> = None;
        let mut open = |attribute: &'static str, accessor: Option<usize>, form: &Form| {
            let Some(accessor) = accessor else { return Ok(None) };
            let opened = self.open_accessor(accessor, form).map_err(at(attribute))?;
            let (first, expected) = *first.get_or_insert((attribute, opened.count()));
            if opened.count() != expected {
                return Err(NodeProblem::InstanceCount {
                    attribute,
                    found: opened.count(),
                    first,
                    expected,
                });
            }
            Ok(Some(opened))
        };
        let translations = open("TRANSLATION", attributes.translation, &POINTS)?;
        let rotations = open("ROTATION", attributes.rotation, &FRACTIONS)?;
        let scales = open("SCALE", attributes.scale, &POINTS)?;
        // Without any of them, only other attributes, such as colours, tell instances apart. Their number is unknown.
        Ok(first.map(|(_, count)| Places {
            translations,
            rotations,
            scales,
            count,
        }))
    }
}

fn at(attribute: &'static str) -> impl Fn(super::error::AccessorProblem) -> NodeProblem {
    move |problem| NodeProblem::Instances { attribute, problem }
}
