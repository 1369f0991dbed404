//! `morph-collide query`: ask about one mesh of a model in one shape.

mod numbers;
mod report;

use std::path::PathBuf;

use clap::Args;
use morph_collision::{Body, Ray, RayQuery, SelfQuery, ShapeQuery, WorldFromModel};

use crate::error::CliError;
use crate::files::model::FileArgs;
use crate::options::shape::ShapeArgs;
use crate::output;
use numbers::Triple;
use report::{PointReport, QueryReport, RayReport, SelfReport, ShapeReport};

/// Upper bound on the bytes that a pair of triangles takes while it is listed and shown.
const BYTES_PER_PAIR: u64 = 512;

const EXAMPLES: &str = "Examples:
  morph-collide query face.glb --weights jawOpen=1,mouthSmileLeft=0.5 --self
  morph-collide query character.glb --clip walk --time 0.4 --ray 0,15,20,0,0,-1";

/// Ask about one mesh of a glTF file in one shape: what a ray hits, which point of the surface is closest, or where the mesh intersects
/// itself.
///
/// Coordinates are in the mesh's own space. A skinned mesh is placed by its joints, at rest or as a clip poses them.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct QueryArgs {
    /// A .glb or .gltf file; - reads a .glb from standard input.
    model: PathBuf,
    #[command(flatten)]
    shape: ShapeArgs,
    #[command(flatten)]
    question: Question,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of text. Numbers that are not finite appear as text: `inf`, `-inf`, `NaN`.
    #[arg(long)]
    json: bool,
}

/// The question to ask: exactly one of these.
#[derive(Debug, Args)]
#[group(required = true, multiple = false)]
struct Question {
    /// Cast a ray from OX,OY,OZ in the direction DX,DY,DZ and list every hit, the closest first.
    #[arg(long, value_name = "OX,OY,OZ,DX,DY,DZ", allow_hyphen_values = true)]
    ray: Option<Triple<2>>,
    /// Find the point of the surface that is closest to X,Y,Z.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    point: Option<Triple<1>>,
    /// List every pair of triangles that touch and share no vertex.
    #[arg(long = "self")]
    of_itself: bool,
}

/// Poses the mesh, asks, and prints the answer.
pub(crate) fn query(args: &QueryArgs) -> Result<(), CliError> {
    let mut shaped = args.shape.read(&args.model, &args.files)?;
    let shape = ShapeReport::new(&shaped);
    if args.question.of_itself {
        let mut pairs = Vec::new();
        let most = usize::try_from(args.files.memory_limit() / BYTES_PER_PAIR).unwrap_or(usize::MAX);
        let mut query = SelfQuery::new();
        if query.up_to(&mut shaped.pose, most, &mut pairs) {
            let (file, mesh) = (args.model.clone(), shaped.index);
            return Err(CliError::TooManySelfPairs { file, mesh, most });
        }
        return show(args, &SelfReport::new(shape, pairs, query.stats()));
    }
    let body = Body::new(&mut shaped.pose, &WorldFromModel::IDENTITY);
    if let Some(Triple([origin, direction])) = args.question.ray {
        let ray = Ray::new(origin, direction, f64::INFINITY).map_err(|error| bad_flag("--ray", &error))?;
        let mut hits = Vec::new();
        let mut query = RayQuery::new();
        query.all(body, &ray, &mut hits);
        return show(args, &RayReport::new(shape, &hits, query.stats()));
    }
    if let Some(Triple([point])) = args.question.point {
        let mut query = ShapeQuery::new();
        let closest = query.closest_point(body, point, f64::INFINITY);
        let closest = closest.map_err(|error| bad_flag("--point", &error))?;
        return show(args, &PointReport::new(shape, closest.as_ref(), query.stats()));
    }
    Ok(())
}

fn show(args: &QueryArgs, report: &impl QueryReport) -> Result<(), CliError> {
    if args.json {
        output::print_json(report)
    } else {
        output::print(&report.text())
    }
}

fn bad_flag(flag: &'static str, reason: &impl ToString) -> CliError {
    CliError::Flag {
        flag,
        reason: reason.to_string(),
    }
}
