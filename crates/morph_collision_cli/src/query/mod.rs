//! `morph-collide query`: ask about one mesh of a model in one shape.

mod numbers;
mod report;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use morph_collision::{
    Body, BuildOptions, JointMatrices, MorphBvh, Pose, Ray, RayQuery, SelfQuery, ShapeQuery, WorldFromModel,
};
use morph_collision_testkit::inspect::MeshError;
use morph_collision_testkit::mesh::MorphMesh;

use crate::error::CliError;
use crate::model_file::{FileArgs, count_memory, find_clip, read_clips};
use crate::output;
use numbers::{Triple, Weights};
use report::{PointReport, QueryReport, RayReport, SelfReport};

/// Upper bound on the bytes that a pair of triangles takes while it is listed and shown.
const BYTES_PER_PAIR: u64 = 512;

/// Ask about one mesh of a glTF file in one shape: what a ray hits, which point of its surface is closest, or
/// where it intersects itself.
///
/// Everything is in the mesh's own space. A skinned mesh is placed by its joints, at rest or as a clip poses
/// them.
#[derive(Debug, Args)]
pub(crate) struct QueryArgs {
    /// A .glb or .gltf file.
    model: PathBuf,
    /// The mesh's index in the file.
    #[arg(long, value_name = "N", default_value_t = 0)]
    mesh: usize,
    /// One weight per target, comma-separated; all zero by default.
    #[arg(long, value_name = "W,W,..", allow_hyphen_values = true)]
    weights: Option<Weights>,
    /// Name of a clip in the file. It moves the joints of a skinned mesh, and the weights unless --weights is
    /// given.
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,
    /// The time in the clip, in seconds. Clips loop.
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = 0.0,
        requires = "clip",
        allow_hyphen_values = true
    )]
    time: f32,
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
    /// Cast a ray from OX,OY,OZ along DX,DY,DZ and show every hit, the first one first.
    #[arg(long, value_name = "OX,OY,OZ,DX,DY,DZ", allow_hyphen_values = true)]
    ray: Option<Triple<2>>,
    /// Show the point of the surface that is closest to X,Y,Z.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    point: Option<Triple<1>>,
    /// Show every pair of triangles that share a point but no vertex.
    #[arg(long = "self")]
    of_itself: bool,
}

/// Poses the mesh, asks, and prints the answer.
pub(crate) fn query(args: &QueryArgs) -> Result<(), CliError> {
    let mut pose = pose(args)?;
    if args.question.of_itself {
        let mut pairs = Vec::new();
        let most = usize::try_from(args.files.memory_limit() / BYTES_PER_PAIR).unwrap_or(usize::MAX);
        let mut query = SelfQuery::new();
        if query.up_to(&mut pose, most, &mut pairs) {
            let (file, mesh) = (args.model.clone(), args.mesh);
            return Err(CliError::TooManySelfPairs { file, mesh, most });
        }
        return show(args, &SelfReport::new(pairs, query.stats()));
    }
    let body = Body::new(&mut pose, &WorldFromModel::IDENTITY);
    if let Some(Triple([origin, direction])) = args.question.ray {
        let ray = Ray::new(origin, direction, f64::INFINITY).map_err(|error| bad_flag("--ray", &error))?;
        let mut hits = Vec::new();
        let mut query = RayQuery::new();
        query.all(body, &ray, &mut hits);
        return show(args, &RayReport::new(&hits, query.stats()));
    }
    if let Some(Triple([point])) = args.question.point {
        let mut query = ShapeQuery::new();
        let closest = query.closest_point(body, point, f64::INFINITY);
        let closest = closest.map_err(|error| bad_flag("--point", &error))?;
        return show(args, &PointReport::new(closest.as_ref(), query.stats()));
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

/// The mesh in the requested pose.
fn pose(args: &QueryArgs) -> Result<Pose, CliError> {
    let (file, mut mesh) = args.files.open_mesh(&args.model, args.mesh, "--mesh")?;
    count_memory(&file, args.mesh, mesh.tree_bytes(), || "its tree".into())?;
    if !args.time.is_finite() {
        return Err(bad_flag("--time", &"it must be a finite number"));
    }
    let mut of_clip = [None, None];
    if let Some(name) = &args.clip {
        read_clips(&file, args.mesh, &mut mesh)?;
        of_clip = find_clip(&mesh, name).map_err(|reason| bad_flag("--clip", &reason))?;
    }
    let [of_weights, of_joints] = of_clip;
    let tree = build(&mesh).map_err(|reason| CliError::Mesh {
        file: args.model.clone(),
        mesh: args.mesh,
        name: mesh.name.clone(),
        reason,
    })?;
    let mut pose = Pose::new(Arc::new(tree));
    if let Some(Weights(weights)) = &args.weights {
        pose.set_weights(weights)
            .map_err(|error| bad_flag("--weights", &error))?;
    } else if let Some(clip) = of_weights {
        let weights = mesh.animations[clip].sample(args.time);
        pose.set_weights(&weights).map_err(|error| bad_flag("--clip", &error))?;
    }
    if let Some(skin) = &mesh.skin {
        let skeleton = &skin.skeleton;
        let clip = of_joints.map(|clip| &skeleton.clips[clip]);
        let joints = JointMatrices::new(&skeleton.world_from_mesh(clip, args.time));
        let set = joints.and_then(|joints| pose.set_joints(&joints));
        set.map_err(|reason| CliError::Pose {
            file: args.model.clone(),
            mesh: args.mesh,
            name: mesh.name.clone(),
            reason,
        })?;
    }
    Ok(pose)
}

fn build(mesh: &MorphMesh) -> Result<MorphBvh, MeshError> {
    Ok(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()))
}

fn bad_flag(flag: &'static str, reason: &impl ToString) -> CliError {
    CliError::Flag {
        flag,
        reason: reason.to_string(),
    }
}
