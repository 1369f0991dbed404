//! The expressions of a VRM file.

use serde::Serialize;

use crate::gltf::read::Expression;

/// An expression: a named mixture of targets.
#[derive(Debug, Serialize)]
pub struct ExpressionReport {
    /// Its name.
    pub name: String,
    /// The number of targets that it moves.
    pub targets: usize,
    /// Why some of what it moves is left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub problems: Vec<String>,
}

impl ExpressionReport {
    pub(super) fn new(expression: Expression) -> Self {
        Self {
            name: expression.name,
            targets: expression.binds.len(),
            problems: expression.problems,
        }
    }
}
