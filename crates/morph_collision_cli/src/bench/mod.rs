//! `morph-collide bench`: this machine's times of morph and of every other method.
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

/// Rounds in which times are split; shares need no more, and rebuilding takes its time.
const SPLIT_ROUNDS: usize = 1;

/// Measure morph against every other method on this machine: its own scenes, or your own models.
///
/// Methods take turns for N rounds, each running every frame of a scene on one thread pinned to a core; a round before them is thrown
/// away. Times are microseconds per frame, medians over the rounds; ratios to morph are medians of the ratios within a round. All methods
/// have to find the same pairs (mode `first`: the same touching bodies); otherwise the exit code is 1.
///
/// A frame's time is that of weights and places, broad phase and queries. `blend`, `refit` and `query` are measured in passes of their
/// own and scaled to come to the undisturbed total. Blending vertices and refitting volumes are timed apart where a method does
/// them at once. Where it does them when a query gets there (morph, the hybrid's lower half), each frame is asked twice: the second time is
/// `query`, what the first took more is `refit`; the second time finds processor caches warm, so
/// that `refit` of these methods is an upper estimate. For morph and morph-eager `blend` is setting weights, and vertices are blended in `refit`.
///
/// morph-eager blends every vertex and fits every volume at once, by the same code: its distance to morph is what the method gains, its
/// distance to bottom-up what the engineering does. Skinned models play a clip of their joints, 60 steps a second: the first that moves targets as
/// well, or else the first. joint-boxes and joint-union are for them only; rigid-floor and paper know no joints. rigid-floor is no rival: it is morph's tree over meshes frozen in each frame's shape beforehand, of which only placing and queries are
/// timed, with warm caches. paper is the method as the paper has it: its tree, its volumes, one node and one triangle at a time.
#[derive(Debug, Args)]
pub(crate) struct BenchArgs {
    /// .glb or .gltf files, a scene each: bodies of the mesh with most triangles, close together and moving. The scenes that have names if none.
    models: Vec<PathBuf>,
    /// How many bodies of each model.
    #[arg(long, value_name = "N", default_value_t = 2, requires = "models", value_parser = clap::value_parser!(u16).range(2..))]
    bodies: u16,
    /// Rounds that count.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Use every Nth of the scene's 400 steps.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    every: u16,
    /// Only this scene; may be given again.
    ///
    /// One of: pass-through-20480, dolphins-564, dolphins-9024, dolphins-36096, heads-cheek, heads-crowd, horse-gallop, samba,
    /// walkers-hands, walkers-deep, walkers-crowd, head-ray, head-rays, walkers-ray, walkers-rays, or a model's file name without extension. All from heads-cheek on need models that are read from the library's repository and the folder of models
    /// beside it; where these are missing such a scene is skipped, or refused if asked for.
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
    /// Only this method beside morph; may be given again.
    #[arg(long = "method", value_name = "NAME", value_parser = PossibleValuesParser::new(Entrant::ALL.map(|entrant| entrant.name)))]
    methods: Vec<String>,
    /// Only all pairs of triangles, or only one for each pair of bodies; both where left out. Scenes with rays have only one mode.
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

/// How much to find out about two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Mode {
    /// Every pair of triangles that meet.
    All,
    /// One pair of triangles that meet.
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

/// A scene's rows in a mode.
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
    // Of a ray only the closest hit is asked for.
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
