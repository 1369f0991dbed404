//! How pairs are found: the method, and how its trees are built.

use clap::{Args, ValueEnum};
use morph_collision::{BuildOptions, Remember, SeparatingAxes};
use morph_collision_testkit::rivals::{MethodKind, MorphTuning};

use super::Mode;
use crate::error::CliError;
use crate::paper_options::PaperArgs;
use crate::tree_options::TreeArgs;

/// The options of `run` that change how it works, never its answer. Defaults are the library's. An option the method does not
/// support is an error.
#[derive(Debug, Args)]
pub(crate) struct MethodArgs {
    /// How to find pairs: morph, morph-eager, rigid-floor, paper, bottom-up, hybrid, rebuild, octree, parry-trimesh, parry-bvh, parry-rebuild or brute-force.
    #[arg(long, value_name = "NAME", default_value_t)]
    method: MethodKind,
    #[command(flatten)]
    paper: PaperArgs,
    #[command(flatten)]
    tree: TreeArgs,
    /// Along which axes morph compares nodes: those of both bodies, or also their nine products, on boxes.
    #[arg(long, value_enum)]
    sat: Option<Sat>,
    /// Let morph start each walk where the last one over the same two bodies ended.
    #[arg(long)]
    front: bool,
    /// Let morph try the leaves first in which it found a pair the last time, where only first pairs are wanted.
    #[arg(long)]
    witness: bool,
    /// Let morph leave two bodies alone until they could have moved as far as they were last proved apart.
    #[arg(long)]
    separation: bool,
}

/// Axes that may separate two nodes.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Sat {
    /// The axes of both bodies.
    Lite,
    /// And the nine products of an axis of one and an axis of the other.
    Full,
}

impl MethodArgs {
    /// Checks that the method, or the mode, knows every option that was given.
    pub(super) fn check(&self, mode: Mode) -> Result<(), CliError> {
        use MethodKind::{BottomUp, Hybrid, Morph, MorphEager, Rebuild, RigidFloor};
        let method = self.method;
        let paper = matches!(method, MethodKind::Paper(_));
        let ours = matches!(method, Morph | MorphEager | RigidFloor);
        let (arity, leaf, split) = self.tree.given();
        let asks = matches!(method, Morph | MorphEager);
        let of_paper = self.paper.given().map(|(flag, given)| (flag, given, paper));
        let others = [
            ("--arity", arity, ours || matches!(method, BottomUp | Hybrid)),
            ("--leaf", leaf, ours || matches!(method, BottomUp | Hybrid | Rebuild)),
            ("--split", split, ours),
            ("--sat", self.sat.is_some(), asks),
            ("--front", self.front, asks),
            ("--witness", self.witness, asks),
            ("--separation", self.separation, asks),
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

    pub(crate) fn tuning(&self) -> MorphTuning {
        MorphTuning {
            axes: match self.sat {
                None | Some(Sat::Lite) => SeparatingAxes::Lite,
                Some(Sat::Full) => SeparatingAxes::Full,
            },
            remember: Remember {
                separation: self.separation,
                front: self.front,
                witness: self.witness,
            },
        }
    }

    pub(crate) fn build(&self) -> BuildOptions {
        self.tree.build()
    }
}
