//! `morph-lab run`: `morph-collide run` with any method.

use clap::Args;
use glam::DVec3;
use morph_collision::batch::Wanted;
use morph_collision::{Aabb, QueryStats, TrianglePair};
use morph_collision_cli::shared::{AnyError, PairFinder, RunArgs, SetUp, Shape, Source, TreeArgs, Verdict, run_with};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::BodyPose;
use morph_collision_testkit::rivals::{Method, MethodKind};

use crate::methods::MethodArgs;

pub(crate) const ABOUT: &str = "Replay a scene with any method and report which triangles intersect";

pub(crate) const LONG_ABOUT: &str = "Replay a scene with any method and report which bodies and triangles intersect.

The rest is as in `morph-collide run`. All methods find the same pairs.";

pub(crate) const EXAMPLES: &str = "Example:
  morph-lab run scene.json --method paper --volume kdop26";

#[derive(Debug, Args)]
pub(crate) struct LabRunArgs {
    #[command(flatten)]
    run: RunArgs,
    #[command(flatten)]
    how: MethodArgs,
}

/// Replays the scene.
pub(crate) fn run(args: &LabRunArgs) -> Result<Verdict, AnyError> {
    args.how.check(args.run.mode(), args.run.tree())?;
    let kind = args.how.kind();
    let rivals = Rivals {
        kind,
        how: &args.how,
        tree: args.run.tree(),
    };
    run_with(&args.run, &rivals, &kind.to_string())?;
    Ok(Verdict::Clean)
}

/// Sets up the bodies of a method.
struct Rivals<'a> {
    kind: MethodKind,
    how: &'a MethodArgs,
    tree: &'a TreeArgs,
}

/// The bodies of a method.
struct Bodies(Box<dyn Method>);

impl SetUp for Rivals<'_> {
    type Bodies = Bodies;

    fn bytes(&self, mesh: &MorphMesh) -> (u64, u64) {
        match self.kind {
            MethodKind::Paper(paper) => (paper.tree_bytes(mesh), paper.body_bytes(mesh)),
            MethodKind::Morph | MethodKind::BottomUp | MethodKind::Hybrid => {
                (mesh.tree_bytes(), mesh.body_bytes(false))
            }
            _ => (mesh.tree_bytes(), mesh.body_bytes(true)),
        }
    }

    fn set_up(&self, source: &Source<'_>) -> Result<Bodies, AnyError> {
        let options = self.how.options(self.tree);
        Ok(Bodies(self.kind.set_up(
            source.meshes,
            source.mesh_of_body,
            &options,
        )?))
    }
}

impl PairFinder for Bodies {
    fn set(&mut self, body: usize, shape: &Shape) -> Result<(), AnyError> {
        if let Some(joints) = &shape.joints {
            self.0.set_joints(body, joints)?;
        }
        Ok(self.0.set_body(body, &shape.weights, &shape.world_from_model)?)
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        self.0.world_bounds(body)
    }

    fn find(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        self.0.collide(a, b, wanted, pairs);
    }

    fn vertices(&mut self, _: usize, mesh: &MorphMesh, shape: &Shape) -> Vec<DVec3> {
        let pose = BodyPose {
            mesh,
            weights: &shape.weights,
            world_from_model: shape.world_from_model,
            joints: shape.joints.as_deref(),
        };
        pose.world_vertices()
    }

    fn work(&self) -> QueryStats {
        self.0.work()
    }
}
