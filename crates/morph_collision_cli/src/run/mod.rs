//! `morph-collide run`: replay a scene of scripted bodies and report which triangles intersect.
//!
//! ```text
//! scene.json --Cast--> bodies --replay--> hits and times per frame --report, pairs_csv, picture--> stdout, OUT.csv, OUT.png
//!            --Cast--> posed bodies --surface--> contacts or distances per frame --> stdout, OUT.csv
//! ```

mod finder;
mod pairs_csv;
mod picture;
mod replay;
mod report;
mod surface;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::cast::{Cast, SetUp};
use crate::error::CliError;
use crate::files::model::FileArgs;
use crate::messages::progress;
use crate::options::tree::TreeArgs;
use crate::output;
use crate::output::file::OutputFile;
use crate::picture::Picture;

pub use finder::PairFinder;

use finder::OwnTrees;
use picture::{PictureArgs, PictureReport};
use replay::Replay;
use report::RunReport;

const EXAMPLES: &str = "Examples:
  morph-collide run scene.json --picture touch.png
  morph-collide run scene.json --mode contacts --pairs contacts.csv
  morph-collide scene a.glb b.glb --clip walk --place 0,0,0 --place x=-1..1 | morph-collide run -";

/// Replay a scene frame by frame and report which bodies and triangles intersect, where they touch, or how far apart they are.
///
/// `morph-collide scene` makes scene files, and docs/scene.md describes them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct RunArgs {
    /// A scene file; - reads it from standard input.
    scene: PathBuf,
    /// What to find out about each pair of bodies.
    #[arg(long, value_enum, default_value_t = Mode::All)]
    mode: Mode,
    #[command(flatten)]
    tree: TreeArgs,
    /// Write what was found to a CSV file; - writes it to standard output, and the summary to standard error.
    ///
    /// A line per pair of triangles; with the modes first and any a line per pair of bodies, with contacts a line per contact point,
    /// and with distance a line per pair of bodies with their closest points.
    #[arg(long, value_name = "OUT.csv")]
    pairs: Option<PathBuf>,
    #[command(flatten)]
    picture: PictureArgs,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    json: bool,
}

/// What to find out about each pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Mode {
    /// Every pair of triangles that intersect.
    All,
    /// One pair of triangles that intersect.
    First,
    /// Only whether any triangles intersect.
    Any,
    /// Where they touch, how deep, and which way is out.
    Contacts,
    /// How far apart they are, and their closest points.
    Distance,
}

impl Mode {
    /// Its name on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::First => "first",
            Self::Any => "any",
            Self::Contacts => "contacts",
            Self::Distance => "distance",
        }
    }

    /// Whether it describes surfaces instead of listing pairs.
    #[must_use]
    pub fn is_of_surfaces(self) -> bool {
        matches!(self, Self::Contacts | Self::Distance)
    }
}

impl RunArgs {
    /// What to find out.
    #[must_use]
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// How trees are built.
    #[must_use]
    pub fn tree(&self) -> &TreeArgs {
        &self.tree
    }
}

/// Loads, replays and reports a scene. Reported times exclude loading and writing.
///
/// # Errors
/// A file cannot be read or written, or it is not what it should be.
pub fn run(args: &RunArgs) -> Result<(), CliError> {
    run_with(args, &OwnTrees(&args.tree), "morph")
}

/// Like [`run`], with bodies of another method. The modes `contacts` and `distance` always use this library's.
///
/// # Errors
/// See [`run`].
pub fn run_with<S: SetUp<Bodies: PairFinder>>(args: &RunArgs, method: &S, name: &str) -> Result<(), CliError> {
    args.picture.check_mode(args.mode)?;
    if args.mode.is_of_surfaces() {
        return surface::run(args);
    }
    let budget = args.files.budget();
    let scene = args.files.read_scene(&args.scene, &budget)?;
    let mut cast = Cast::load(&args.scene, &scene, method, &args.files, &budget)?;
    args.picture.check(cast.frames.len())?;
    // Checked before the replay, so that a path that cannot be written fails early.
    let output_file = |flag, path: &Option<PathBuf>| {
        let path = path.as_deref();
        path.map(|path| OutputFile::create(flag, path, &cast.inputs))
            .transpose()
    };
    let pairs_file = output_file("--pairs", &args.pairs)?;
    let picture_file = output_file("--picture", &args.picture.picture)?;
    if let (Some(pairs), Some(picture)) = (&pairs_file, &picture_file)
        && pairs.replaces_the_same_as(picture)
    {
        return Err(CliError::Flag {
            flag: "--picture",
            reason: "--pairs names the same file; choose another name".to_owned(),
        });
    }

    let progress = progress::count("frame", cast.frames.len() as u64);
    let replay = replay::replay(&mut cast, args.mode, pairs_file.is_some(), &progress)?;

    if let Some(file) = pairs_file {
        file.write(|out| pairs_csv::write_rows(out, &replay.hits))?;
    }
    let drawn = match picture_file {
        Some(file) => Some(draw(&mut cast, args, &replay, file)?),
        None => None,
    };
    let report = RunReport::new(&replay, cast.bodies, args.mode, name, drawn);
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.summary())
    }
}

/// Draws a frame of a replay into `file`.
fn draw(
    cast: &mut Cast<impl PairFinder>,
    args: &RunArgs,
    replay: &Replay,
    file: OutputFile,
) -> Result<PictureReport, CliError> {
    let frame = args.picture.frame(&replay.frames);
    let hits = replay::hits_of_frame(cast, args.mode, frame, replay.hits.len())?;
    let bodies = picture::bodies(cast, frame, &hits);
    let picture = Picture::draw(&bodies);
    file.write(|out| picture.write_png(out))?;
    Ok(PictureReport {
        file: args.picture.picture.clone().unwrap_or_default(),
        frame,
        touching_triangles: picture::touching_triangles(&bodies),
    })
}
