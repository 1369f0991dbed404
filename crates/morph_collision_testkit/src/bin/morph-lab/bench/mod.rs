//! `morph-lab bench`: times morph and the other methods on this machine.
//!
//! ```text
//! flags, models --scenes--> experiments --testkit's bench--> rows --report--> tables or JSON on stdout
//! ```

mod report;
mod scenes;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use morph_collision::batch::Wanted;
use morph_collision_cli::shared::{
    AnyError, CliError, FileArgs, Steps, TreeArgs, Verdict, complain, count, print, print_json,
};
use morph_collision_testkit::bench::{Disagreement, Entrant, Plan, Row, disagreement, measure};
use morph_collision_testkit::machine::{self, Pinned};
use morph_collision_testkit::moments::AnswerError;
use morph_collision_testkit::rivals::MethodOptions;

use crate::error::LabError;
use crate::methods::{self, PaperArgs};
use report::BenchReport;
use scenes::BenchScene;

/// Rounds in which times are split into phases. The shares need only one round.
const SPLIT_ROUNDS: usize = 1;

const EXAMPLES: &str = "Examples:
  morph-lab bench face.glb
  morph-lab bench face.glb --method parry-trimesh --method hybrid --bodies 4";

const LONG: &str = "How times are taken:

Methods take turns for N rounds. In each round they run every frame of a scene on one thread, pinned to the least busy core. A warm-up \
round is discarded. Times are microseconds per frame: the median of the rounds. Ratios are the median of the ratios within a round. All \
methods must find the same pairs (with mode first: the same touching bodies); otherwise the exit code is 1.

A frame's time covers setting weights and placements, the broad phase and the queries. Its parts, `blend`, `refit` and `query`, are \
measured in separate passes and scaled so that they add up to the total. Methods that blend and refit on demand (morph, and the lower \
half of hybrid) run each frame twice: the second time counts as `query`, and the extra time of the first as `refit`. The second time \
runs with warm caches, so `refit` of these methods is an upper estimate. For morph, hybrid and bottom-up, `blend` is setting the weights, and \
vertices are blended in `refit`.

Skinned models play a joint animation, 60 steps a second: the first one that also animates targets, or else the first. rigid-floor is \
not a competitor but the cost without morphing: its meshes are frozen beforehand in the shape of each frame, and only placing and \
queries are timed, with warm caches.";

/// Compare the speed of this library (morph) with other methods on this machine, with its own scenes or your models.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, after_long_help = format!("{EXAMPLES}\n\n{LONG}"))]
pub(crate) struct BenchArgs {
    /// .glb or .gltf files. Each is a scene of its own: bodies of its largest mesh, close together and moving. Without models, the
    /// library's own scenes run.
    models: Vec<PathBuf>,
    /// Number of bodies in the scene of a model.
    #[arg(long, value_name = "N", default_value_t = 2, requires = "models", value_parser = clap::value_parser!(u16).range(2..))]
    bodies: u16,
    /// Number of measured rounds.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Use every Nth of the scene's 400 steps.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..))]
    every: u16,
    /// Run only this scene; can be repeated. The scene of a model has the name of its file without extension.
    ///
    /// The library's own scenes: pass-through-20480, dolphins-564, dolphins-9024, dolphins-36096, heads-cheek, heads-crowd, horse-gallop,
    /// samba, walkers-hands, walkers-deep, walkers-crowd, head-ray, head-rays, walkers-ray, walkers-rays. Those from heads-cheek on need
    /// models from the library's repository, and some need models that are not in it; a scene without its model is skipped, unless you
    /// asked for it.
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
    /// Compare morph only with this method; can be repeated. By default all but brute-force.
    #[arg(long = "method", value_name = "NAME", value_parser = methods::names(), help_heading = methods::HEADING)]
    methods: Vec<String>,
    /// What to find about each pair of bodies; by default both are measured. Scenes with rays have only one mode.
    #[arg(long, value_enum)]
    mode: Option<Mode>,
    #[command(flatten)]
    paper: PaperArgs,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
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
pub(crate) fn bench(args: &BenchArgs) -> Result<Verdict, AnyError> {
    let modes = args.mode.map_or(vec![Mode::All, Mode::First], |mode| vec![mode]);
    let wanted = |entrant: &Entrant| {
        entrant.name == "morph" || args.methods.is_empty() || args.methods.iter().any(|name| name == entrant.name)
    };
    let told = |entrant: Entrant| entrant.with_paper(args.paper.options());
    // Slow methods run only if they are named.
    let slow: &[Entrant] = if args.methods.is_empty() { &[] } else { &Entrant::SLOW };
    let entrants = Entrant::ALL.into_iter().chain(slow.iter().copied());
    let entrants: Vec<Entrant> = entrants.filter(wanted).map(told).collect();
    if !entrants.iter().any(Entrant::is_paper)
        && let Some((flag, _)) = args.paper.given().into_iter().find(|(_, given)| *given)
    {
        let reason = "it is for the method paper, which --method leaves out".to_owned();
        return Err(CliError::Flag { flag, reason }.into());
    }
    if args.models.is_empty() {
        args.files.refuse_without_files()?;
    }
    let scenes = scenes::scenes(args, &entrants)?;
    say_where(machine::pin());
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
    let steps = count("pass", passes as u64);
    let mut measured = Vec::new();
    let mut wrong: Option<Disagreement> = None;
    for scene in &scenes {
        for &mode in modes_of(scene) {
            let rows = run(scene, &entrants, &args.tree.build().into(), plan(mode), &steps).map_err(|reason| {
                LabError::Bench {
                    scene: scene.origin.clone(),
                    reason,
                }
            })?;
            wrong = wrong.or_else(|| disagreement(&scene.experiment, &rows, mode.wanted()));
            measured.push(Measured { scene, mode, rows });
        }
    }
    let report = BenchReport::new(&measured, rounds);
    if args.json {
        print_json(&report)?;
    } else {
        print(&report.text())?;
    }
    match wrong {
        None => Ok(Verdict::Clean),
        Some(disagreement) => {
            complain(format_args!("methods disagree: {disagreement}"));
            Ok(Verdict::FoundWrong)
        }
    }
}

/// A core that was busier makes times vary.
const BUSY: f64 = 0.2;

/// Says on which core times are taken.
fn say_where(pinned: Option<Pinned>) {
    let Some(Pinned { core, busy }) = pinned else {
        complain("cannot pin this thread to a core; going on without, times will vary more");
        return;
    };
    let percent = busy.map(|busy| 100.0 * busy);
    match percent {
        Some(percent) if percent > 100.0 * BUSY => complain(format_args!(
            "warning: core {core} is the least busy one and was {percent:.0} % busy; times will vary, so close other programs"
        )),
        Some(percent) => complain(format_args!(
            "progress: measuring on core {core}, which was {percent:.0} % busy"
        )),
        None => complain(format_args!("progress: measuring on core {core}")),
    }
}

fn run(
    scene: &BenchScene,
    entrants: &[Entrant],
    ours: &MethodOptions,
    plan: Plan,
    steps: &Steps,
) -> Result<Vec<Row>, AnswerError> {
    let experiment = &scene.experiment;
    let entrants = entrants.iter().filter(|entrant| entrant.supports(experiment));
    let contenders = entrants.map(|entrant| entrant.set_up(experiment, ours));
    Ok(measure(
        experiment,
        contenders.collect::<Result<_, _>>()?,
        plan,
        || steps.step(),
    )?)
}
