//! `--expression`: a named mixture of targets that a VRM file has.

use std::str::FromStr;

use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use crate::error::CliError;

/// The value of `--expression`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ExpressionArg {
    name: String,
    strength: f32,
}

impl FromStr for ExpressionArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, strength) = text.rsplit_once('=').unwrap_or((text, "1"));
        let strength = strength.parse().ok().filter(|strength: &f32| strength.is_finite());
        Ok(Self {
            name: name.to_owned(),
            strength: strength.ok_or("expected NAME or NAME=STRENGTH, such as happy=0.5")?,
        })
    }
}

impl ExpressionArg {
    /// Adds its weights to those of a mesh, as a node shows it, or else its main node. Returns whether it moves the mesh.
    pub(crate) fn add(
        &self,
        file: &GltfFile,
        mesh: usize,
        node: Option<usize>,
        weights: &mut [f32],
    ) -> Result<bool, CliError> {
        let shown = Printable(&self.name);
        let expressions = file.expressions();
        let by_name = expressions.iter().find(|expression| expression.name == self.name);
        let by_preset = || {
            expressions
                .iter()
                .find(|known| known.preset.as_ref() == Some(&self.name))
        };
        let Some(expression) = by_name.or_else(by_preset) else {
            let names = expressions.iter().map(|expression| expression.name.as_str());
            return Err(wrong(match expressions.len() {
                0 => format!("{} has no expressions", file.path().display()),
                _ => format!("there is no expression \"{shown}\"{}", suggestion(&self.name, names)),
            }));
        };
        let node = node.or_else(|| file.main_node(mesh));
        let is_meant = |bound: Option<usize>| bound.is_none_or(|bound| node.is_none_or(|node| node == bound));
        let binds = expression.binds.iter();
        let mut moves = false;
        for bind in binds.filter(|bind| bind.mesh == mesh && is_meant(bind.node)) {
            let (target, targets) = (bind.target, weights.len());
            let weight = weights.get_mut(target).ok_or_else(|| {
                wrong(format!(
                    "the expression \"{shown}\" moves target {target}, and the mesh has {targets} targets"
                ))
            })?;
            *weight += self.strength * bind.weight;
            moves = true;
        }
        Ok(moves)
    }

    /// The error for an expression that moves none of the meshes that are meant.
    pub(crate) fn moves_nothing(&self, meshes: &str) -> CliError {
        wrong(format!(
            "the expression \"{}\" does not move {meshes}",
            Printable(&self.name)
        ))
    }
}

fn wrong(reason: String) -> CliError {
    CliError::Flag {
        flag: "--expression",
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expression_is_a_name_and_a_strength() {
        let arg = |name: &str, strength| {
            Ok(ExpressionArg {
                name: name.to_owned(),
                strength,
            })
        };
        assert_eq!("happy".parse(), arg("happy", 1.0));
        assert_eq!("happy=0.5".parse(), arg("happy", 0.5));
        assert_eq!("a=b=-1".parse(), arg("a=b", -1.0));
        for text in ["happy=", "happy=NaN", "happy=very"] {
            assert!(text.parse::<ExpressionArg>().is_err(), "{text}");
        }
    }
}
