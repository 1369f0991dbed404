//! `morph-collide bench`: times morph and the other methods on this machine.
//!
//! ```text
//! flags, models --scenes--> experiments --testkit's bench--> rows --report--> tables or JSON on stdout
//! ```

mod report;
mod scenes;

use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};
use morph_collision_testkit::bench::{self, Disagreement, Entrant, Plan, Row, disagreement, measure};
use morph_collision_testkit::moments::AnswerError;
use morph_collision_testkit::rivals::{MethodOptions, Wanted};

use crate::error::CliError;
use crate::model_file::FileArgs;
use crate::paper_options::PaperArgs;
use crate::progress::{Progress, ProgressArgs};
use crate::tree_options::TreeArgs;
use crate::{Verdict, output};
use report::BenchReport;
use scenes::BenchScene;

/// Rounds in which times are split into phases. The shares need only one round, and rebuilding is slow.
const SPLIT_ROUNDS: usize = 1;

/// Measure morph against every other method on this machine: its own scenes, or your own models.
///
/// Methods take turns for N rounds. In each round they run every frame of a scene on one thread pinned to a core; a warm-up round
/// is discarded. Times are microseconds per frame: the median over the rounds. Ratios to morph are the median of the ratios
/// within a round. All methods have to find the same pairs (mode `first`: the same touching bodies); otherwise the exit
/// code is 1.
///
/// A frame's time covers setting weights and placements, the broad phase and the queries. `blend`, `refit` and `query` are
/// measured in separate passes and scaled so that they add up to the undisturbed total. If a method blends vertices and refits
/// volumes up front, both are timed separately. If it does so on demand during a query (morph, and the lower half of the hybrid),
/// each frame is queried twice: the second time counts as `query`, and the extra time of the first as `refit`. The second time
/// runs with warm processor caches, so `refit` of these methods is an upper estimate. For morph and morph-eager, `blend` is
/// setting weights, and vertices are blended in `refit`.
///
/// morph-eager blends every vertex and refits every volume up front with the same code. Its distance to morph is what laziness
/// gains; its distance to bottom-up is what the engineering gains. Skinned models play a clip of their joints, 60 steps a second:
/// the first one that also animates targets, or else the first. joint-boxes and joint-union run only on skinned models;
/// paper does not support joints. rigid-floor is not a competitor: it is morph's tree over meshes frozen beforehand in each frame's
/// shape (skinned meshes: completely posed beforehand). Only placing and queries are timed, with warm caches. paper is the method as published: its tree, its
/// volumes, one node and one triangle at a time.
#[derive(Debug, Args)]
pub(crate) struct BenchArgs {
    /// .glb or .gltf files, one scene each: bodies made of the mesh with the most triangles, close together and moving. Without
    /// models, the named scenes run.
    models: Vec<PathBuf>,
    /// Number of bodies per model.
    #[arg(long, value_name = "N", default_value_t = 2, requires = "models", value_parser = clap::value_parser!(u16).range(2..))]
    bodies: u16,
    /// Number of measured rounds.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Use every Nth of the scene's 400 steps.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    every: u16,
    /// Run only this scene; can be repeated.
    ///
    /// One of: pass-through-20480, dolphins-564, dolphins-9024, dolphins-36096, heads-cheek, heads-crowd, horse-gallop, samba,
    /// walkers-hands, walkers-deep, walkers-crowd, head-ray, head-rays, walkers-ray, walkers-rays, or a model's file name without
    /// extension. All scenes from heads-cheek on need models from the library's repository and from the folder of models beside
    /// it. If these are missing, such a scene is skipped, or refused if you asked for it.
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
    /// Compare morph only with this method; can be repeated.
    #[arg(long = "method", value_name = "NAME", value_parser = PossibleValuesParser::new(Entrant::ALL.map(|entrant| entrant.name)))]
    methods: Vec<String>,
    /// Find only all pairs of triangles, or only one for each pair of bodies; runs both by default. Scenes with rays have only
    /// one mode.
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    #[command(flatten)]
    paper: PaperArgs,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    #[command(flatten)]
    progress: ProgressArgs,
    /// Print one JSON object instead of tables.
    #[arg(long)]
    json: bool,
}

/// How much to find out about each pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Mode {
    /// Every pair of triangles that intersect.
    All,
    /// One pair of triangles that intersect.
    First,
}

impl Mode {
    fn wanted(self) -> Wanted {
        match self {
            Self::All => Wanted::All,
            Self::First => Wanted::First,
        }
    }
}

/// A scene's rows in one mode.
pub(crate) struct Measured<'a> {
    scene: &'a BenchScene,
    mode: Mode,
    rows: Vec<Row>,
}

/// Measures and reports.
pub(crate) fn bench(args: &BenchArgs) -> Result<Verdict, CliError> {
    let modes = args.mode.map_or(vec![Mode::All, Mode::First], |mode| vec![mode]);
    let wanted = |entrant: &Entrant| {
        entrant.name == "morph" || args.methods.is_empty() || args.methods.iter().any(|name| name == entrant.name)
    };
    let told = |entrant: Entrant| entrant.with_paper(args.paper.options());
    let entrants: Vec<Entrant> = Entrant::ALL.into_iter().filter(wanted).map(told).collect();
    if !entrants.iter().any(Entrant::is_paper)
        && let Some((flag, _)) = args.paper.given().into_iter().find(|(_, given)| *given)
    {
        let reason = "it is for the method paper, which --method leaves out".to_owned();
        return Err(CliError::Flag { flag, reason });
    }
    if args.models.is_empty() {
        args.files.refuse_without_files()?;
    }
    let scenes = scenes::scenes(args, &entrants)?;
    if bench::pin().is_none() {
        output::complain("cannot pin this thread to a core; going on without, times will vary more");
    }
    let rounds = usize::from(args.rounds);
    let plan = |mode: Mode| Plan {
        wanted: mode.wanted(),
        rounds,
        split_rounds: SPLIT_ROUNDS.min(rounds),
    };
    // Rays ask only for the closest hit.
    let modes_of = |scene: &BenchScene| {
        &modes[..if scene.experiment.rays.is_empty() {
            modes.len()
        } else {
            1
        }]
    };
    let of_scene = |scene: &BenchScene| {
        let contenders = entrants.iter().filter(|entrant| entrant.supports(&scene.experiment));
        contenders.count() * modes_of(scene).iter().map(|&mode| plan(mode).passes()).sum::<usize>()
    };
    let passes: usize = scenes.iter().map(of_scene).sum();
    let bar = args.progress.start("pass", passes as u64);
    let mut measured = Vec::new();
    let mut wrong: Option<Disagreement> = None;
    for scene in &scenes {
        for &mode in modes_of(scene) {
            let rows = run(scene, &entrants, &args.tree.build().into(), plan(mode), &bar).map_err(|reason| {
                CliError::Bench {
                    scene: scene.origin.clone(),
                    reason,
                }
            })?;
            wrong = wrong.or_else(|| disagreement(&scene.experiment, &rows, mode.wanted()));
            measured.push(Measured { scene, mode, rows });
        }
    }
    bar.finish();
    let report = BenchReport::new(&measured, rounds);
    if args.json {
        output::print_json(&report)?;
    } else {
        output::print(&report.text())?;
    }
    match wrong {
        None => Ok(Verdict::Clean),
        Some(disagreement) => {
            output::complain(format_args!("methods disagree: {disagreement}"));
            Ok(Verdict::FoundWrong)
        }
    }
}

fn run(
    scene: &BenchScene,
    entrants: &[Entrant],
    ours: &MethodOptions,
    plan: Plan,
    bar: &Progress,
) -> Result<Vec<Row>, AnswerError> {
    let experiment = &scene.experiment;
    let entrants = entrants.iter().filter(|entrant| entrant.supports(experiment));
    let contenders = entrants.map(|entrant| entrant.set_up(experiment, ours));
    Ok(measure(
        experiment,
        contenders.collect::<Result<_, _>>()?,
        plan,
        || bar.step(),
    )?)
}
