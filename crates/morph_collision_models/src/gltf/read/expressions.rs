//! The expressions of VRM avatars: named mixtures of targets, often of several meshes.

use serde::Deserialize;

use super::GltfFile;
use super::list::{Element, ElementError, Entries, List};

/// A named mixture of targets, such as "happy" or the mouth shape "aa", from the extension `VRM` (0.x) or `VRMC_vrm` (1.0).
///
/// What it does to materials is not read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expression {
    /// Its name: in VRM 1.0 that of the preset or the custom expression, in VRM 0.x the name that the author gave it, or else
    /// its preset. It need not be unique.
    pub name: String,
    /// The standard's name, if it is a preset: `happy` in VRM 1.0, `joy` in VRM 0.x.
    pub preset: Option<String>,
    /// The targets that it moves; empty for an expression that changes only materials. If two are the same target, their weights
    /// add up.
    pub binds: Vec<ExpressionBind>,
    /// Whether it is only ever shown not at all or at full strength, never in part.
    pub is_binary: bool,
    /// Why it or some of its binds cannot be read, one message each. These binds are left out.
    pub problems: Vec<String>,
}

/// A target that an expression moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExpressionBind {
    /// The index of a mesh that exists in the file.
    pub mesh: usize,
    /// The node whose mesh it is, in VRM 1.0. In VRM 0.x every node that shows the mesh is meant.
    pub node: Option<usize>,
    /// The index of the target, which the mesh need not have.
    pub target: usize,
    /// The target's weight while the expression is at full strength: usually 0 to 1, and finite.
    pub weight: f32,
}

/// The extensions of the whole file.
#[derive(Debug, Deserialize)]
pub(super) struct Extensions {
    #[serde(rename = "VRM")]
    vrm_0: Option<Element<Vrm0>>,
    #[serde(rename = "VRMC_vrm")]
    vrm_1: Option<Element<Vrm1>>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Vrm0 {
    #[serde(default)]
    blend_shape_master: Option<Master>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Master {
    #[serde(default)]
    blend_shape_groups: List<Group>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Group {
    name: Option<String>,
    preset_name: Option<String>,
    #[serde(default)]
    binds: List<MeshBind>,
    #[serde(default)]
    is_binary: bool,
}

#[derive(Debug, Deserialize)]
struct MeshBind {
    mesh: usize,
    index: usize,
    /// In percent.
    #[serde(default = "percent")]
    weight: f32,
}

#[derive(Debug, Deserialize)]
struct Vrm1 {
    expressions: Option<Named>,
}

#[derive(Debug, Deserialize)]
struct Named {
    #[serde(default)]
    preset: Entries<Vrm1Expression>,
    #[serde(default)]
    custom: Entries<Vrm1Expression>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
struct Vrm1Expression {
    #[serde(default)]
    morph_target_binds: List<NodeBind>,
    #[serde(default)]
    is_binary: bool,
}

#[derive(Debug, Deserialize)]
struct NodeBind {
    node: usize,
    index: usize,
    #[serde(default = "full")]
    weight: f32,
}

fn percent() -> f32 {
    100.0
}

fn full() -> f32 {
    1.0
}

impl GltfFile {
    /// The expressions of a VRM avatar, in the order of the file; those of VRM 1.0 if it has both kinds. Empty for other files, and if
    /// they cannot be read as a whole, which [`GltfFile::extension_notes`] says.
    ///
    /// The first call parses them; the costs of further ones are the copies.
    #[must_use]
    pub fn expressions(&self) -> Vec<Expression> {
        self.read_expressions().unwrap_or_default()
    }

    /// The expressions; the error names the extension that cannot be read.
    pub(super) fn read_expressions(&self) -> Result<Vec<Expression>, (&'static str, ElementError)> {
        let Some(extensions) = &self.root.extensions else {
            return Ok(Vec::new());
        };
        let extensions = extensions.get(&self.budget).map_err(|problem| ("VRM", problem))?;
        if let Some(vrm) = &extensions.vrm_1 {
            let vrm = vrm.get(&self.budget).map_err(|problem| ("VRMC_vrm", problem))?;
            return Ok(vrm
                .expressions
                .as_ref()
                .map(|named| self.of_vrm_1(named))
                .unwrap_or_default());
        }
        if let Some(vrm) = &extensions.vrm_0 {
            let vrm = vrm.get(&self.budget).map_err(|problem| ("VRM", problem))?;
            let groups = vrm.blend_shape_master.as_ref().map(|master| &master.blend_shape_groups);
            return Ok(groups.map(|groups| self.of_vrm_0(groups)).unwrap_or_default());
        }
        Ok(Vec::new())
    }

    fn of_vrm_0(&self, groups: &List<Group>) -> Vec<Expression> {
        let expression = |index: usize| {
            let default_name = || format!("expression_{index}");
            let group = match groups.get(index, &self.budget) {
                Ok(group) => group,
                Err(problem) => return broken(default_name(), None, &problem),
            };
            let given = |name: &Option<String>| name.clone().filter(|name| !name.is_empty());
            let preset = given(&group.preset_name).filter(|preset| preset != "unknown");
            let mut expression = Expression {
                name: given(&group.name)
                    .or_else(|| preset.clone())
                    .unwrap_or_else(default_name),
                preset,
                is_binary: group.is_binary,
                ..Expression::default()
            };
            let bind = |bind: &MeshBind| Ok((bind.mesh, None, bind.index, bind.weight / 100.0));
            self.add_binds(&mut expression, &group.binds, bind);
            expression
        };
        groups.indices().map(expression).collect()
    }

    fn of_vrm_1(&self, named: &Named) -> Vec<Expression> {
        let presets = named.preset.iter().map(|entry| (entry, true));
        let customs = named.custom.iter().map(|entry| (entry, false));
        let expression = |((name, element), is_preset): (&(String, Element<Vrm1Expression>), bool)| {
            let preset = is_preset.then(|| name.clone());
            let json = match element.get(&self.budget) {
                Ok(json) => json,
                Err(problem) => return broken(name.clone(), preset, &problem),
            };
            let mut expression = Expression {
                name: name.clone(),
                preset,
                is_binary: json.is_binary,
                ..Expression::default()
            };
            let bind = |bind: &NodeBind| {
                let node = self.root.nodes.get(bind.node, &self.budget);
                let node = node.map_err(|problem| format!("node {} {problem}", bind.node))?;
                let mesh = node.mesh.ok_or_else(|| format!("node {} shows no mesh", bind.node))?;
                Ok((mesh, Some(bind.node), bind.index, bind.weight))
            };
            self.add_binds(&mut expression, &json.morph_target_binds, bind);
            expression
        };
        presets.chain(customs).map(expression).collect()
    }

    /// Adds binds to an expression, and what is wrong with the others. `bind` gives the mesh, the node, the target and the weight.
    fn add_binds<T: serde::de::DeserializeOwned>(
        &self,
        expression: &mut Expression,
        binds: &List<T>,
        bind: impl Fn(&T) -> Result<(usize, Option<usize>, usize, f32), String>,
    ) {
        for index in binds.indices() {
            let read = || {
                let json = binds
                    .get(index, &self.budget)
                    .map_err(|problem| format!("it {problem}"))?;
                let (mesh, node, target, weight) = bind(json)?;
                if mesh >= self.mesh_count() {
                    return Err(format!("mesh {mesh} does not exist"));
                }
                if !weight.is_finite() {
                    return Err(format!("its weight {weight} is not finite"));
                }
                Ok(ExpressionBind {
                    mesh,
                    node,
                    target,
                    weight,
                })
            };
            match read() {
                Ok(bind) => expression.binds.push(bind),
                Err(problem) => expression.problems.push(format!("bind {index}: {problem}")),
            }
        }
    }
}

/// An expression that cannot be read.
fn broken(name: String, preset: Option<String>, problem: &ElementError) -> Expression {
    Expression {
        name,
        preset,
        problems: vec![format!("it {problem}")],
        ..Expression::default()
    }
}
