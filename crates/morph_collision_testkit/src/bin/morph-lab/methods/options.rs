//! The method that finds pairs, and its options.

use clap::Args;
use morph_collision_cli::shared::{CliError, Mode, TreeArgs};
use morph_collision_testkit::rivals::{MethodKind, MethodOptions};

use super::{HEADING, HYBRID_BINARY, PaperArgs, kind, names};

/// The options of `run` that change how it works but never its answer. Defaults are the library's. An option that the method does
/// not support is an error.
#[derive(Debug, Args)]
pub(crate) struct MethodArgs {
    /// The method that finds the pairs. All methods find the same pairs; `bench` compares their speed.
    #[arg(long, value_name = "NAME", default_value = "morph", value_parser = names(), help_heading = HEADING)]
    method: String,
    #[command(flatten)]
    paper: PaperArgs,
    /// The most children of a node of bottom-up-scalar and hybrid-scalar: 2, 4 or 8 (the default).
    #[arg(long, value_name = "N", value_parser = arity, help_heading = HEADING)]
    arity: Option<usize>,
    /// With morph, bottom-up or hybrid and the modes first and any: try first the triangles that touched in the frame before.
    #[arg(long, help_heading = HEADING)]
    witness: bool,
}

fn arity(text: &str) -> Result<usize, String> {
    match text {
        "2" => Ok(2),
        "4" => Ok(4),
        "8" => Ok(8),
        _ => Err("expected 2, 4 or 8".to_owned()),
    }
}

impl MethodArgs {
    /// Checks that the method and the mode support every option that was given.
    pub(crate) fn check(&self, mode: Mode, tree: &TreeArgs) -> Result<(), CliError> {
        use MethodKind::{BottomUp, BottomUpScalar, Hybrid, HybridScalar, Morph};
        let method = kind(&self.method);
        if mode.is_of_surfaces() && method != Morph {
            let reason = format!("mode {} works only with morph", mode.name());
            let flag = "--method";
            return Err(CliError::Flag { flag, reason });
        }
        let paper = matches!(method, MethodKind::Paper(_));
        let binary = self.method == HYBRID_BINARY;
        let has_arity = matches!(method, BottomUpScalar | HybridScalar);
        let of_paper = self.paper.given().map(|(flag, given)| (flag, given, paper));
        let others = [
            ("--arity", self.arity.is_some(), has_arity && !binary),
            ("--leaf", tree.leaf().is_some(), method.uses_our_trees() || has_arity),
            ("--witness", self.witness, matches!(method, Morph | BottomUp | Hybrid)),
        ];
        for (flag, given, fits) in of_paper.into_iter().chain(others) {
            if given && !fits {
                let reason = format!("the method {} has no such option", self.method);
                return Err(CliError::Flag { flag, reason });
            }
        }
        if self.witness && !matches!(mode, Mode::First | Mode::Any) {
            return Err(CliError::Flag {
                flag: "--witness",
                reason: "works only with --mode first or --mode any".to_owned(),
            });
        }
        Ok(())
    }

    /// The method, with its options.
    pub(crate) fn kind(&self) -> MethodKind {
        match kind(&self.method) {
            MethodKind::Paper(_) => MethodKind::Paper(self.paper.options()),
            other => other,
        }
    }

    pub(crate) fn options(&self, tree: &TreeArgs) -> MethodOptions {
        let options = MethodOptions {
            witness: self.witness,
            ..tree.build().into()
        };
        let binary = (self.method == HYBRID_BINARY).then_some(2);
        match self.arity.or(binary) {
            Some(arity) => MethodOptions { arity, ..options },
            None => options,
        }
    }
}
