//! The method that finds pairs, and how its trees are built.

use clap::Args;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::rivals::{Method, MethodKind, MethodOptions, SetUpError};

use super::Mode;
use crate::cast::SetUp;
use crate::error::CliError;
use crate::paper_options::PaperArgs;
use crate::tree_options::TreeArgs;

/// The options of `run` that change how it works but never its answer. Defaults are the library's. An option that the method does
/// not support is an error.
#[derive(Debug, Args)]
pub(crate) struct MethodArgs {
    /// Method that finds pairs: morph, morph-eager, rigid-floor, paper, bottom-up, hybrid, rebuild, octree, parry-trimesh,
    /// parry-bvh, parry-rebuild or brute-force.
    #[arg(long, value_name = "NAME", default_value_t)]
    method: MethodKind,
    #[command(flatten)]
    paper: PaperArgs,
    #[command(flatten)]
    tree: TreeArgs,
    /// Most children of a node of bottom-up and hybrid: 2, 4 or 8.
    #[arg(long, value_name = "N", value_parser = arity)]
    arity: Option<usize>,
    /// With morph and mode `first`, first try the leaves in which it found a pair the last time.
    #[arg(long)]
    witness: bool,
}

fn arity(text: &str) -> Result<usize, String> {
    match text {
        "2" => Ok(2),
        "4" => Ok(4),
        "8" => Ok(8),
        _ => Err("it must be 2, 4 or 8".to_owned()),
    }
}

impl MethodArgs {
    /// Checks that the method and the mode support every option that was given.
    pub(super) fn check(&self, mode: Mode) -> Result<(), CliError> {
        use MethodKind::{BottomUp, Hybrid, Morph, MorphEager, Rebuild, RigidFloor};
        let method = self.method;
        let paper = matches!(method, MethodKind::Paper(_));
        let ours = matches!(method, Morph | MorphEager | RigidFloor);
        let has_arity = matches!(method, BottomUp | Hybrid);
        let of_paper = self.paper.given().map(|(flag, given)| (flag, given, paper));
        let others = [
            ("--arity", self.arity.is_some(), has_arity),
            (
                "--leaf",
                self.tree.leaf().is_some(),
                ours || has_arity || method == Rebuild,
            ),
            ("--witness", self.witness, matches!(method, Morph | MorphEager)),
        ];
        for (flag, given, fits) in of_paper.into_iter().chain(others) {
            if given && !fits {
                let reason = format!("the method {method} has no such option");
                return Err(CliError::Flag { flag, reason });
            }
        }
        if self.witness && mode == Mode::All {
            return Err(CliError::Flag {
                flag: "--witness",
                reason: "it works only with --mode first or --mode any".to_owned(),
            });
        }
        Ok(())
    }

    pub(crate) fn method(&self) -> MethodKind {
        match self.method {
            MethodKind::Paper(_) => MethodKind::Paper(self.paper.options()),
            other => other,
        }
    }

    pub(super) fn options(&self) -> MethodOptions {
        let options = MethodOptions {
            witness: self.witness,
            ..self.tree.build().into()
        };
        match self.arity {
            Some(arity) => MethodOptions { arity, ..options },
            None => options,
        }
    }
}

impl SetUp for MethodArgs {
    type Bodies = Box<dyn Method>;

    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64) {
        match self.method() {
            MethodKind::Paper(paper) => (paper.tree_bytes(mesh), paper.body_bytes(mesh)),
            MethodKind::Morph | MethodKind::MorphEager => (mesh.tree_bytes(), mesh.body_bytes(false)),
            _ => (mesh.tree_bytes(), mesh.body_bytes(true)),
        }
    }

    fn set_up(&self, meshes: &[MorphMesh], mesh_of_body: &[usize]) -> Result<Self::Bodies, SetUpError> {
        self.method().set_up(meshes, mesh_of_body, &self.options())
    }
}
