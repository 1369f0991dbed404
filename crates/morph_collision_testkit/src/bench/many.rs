//! Many questions at one moment, about skinned characters that walk.

use std::sync::Arc;

use glam::{Affine3A, DVec3};
use morph_collision::batch::{ThreadWorkers, Workers};
use morph_collision::{Body, BuildOptions, JointMatrices, MorphBvh, Pose, Ray, RayQuery, ShapeQuery, WorldFromModel};
use thiserror::Error;

use super::{Experiment, NoExperiment};

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Many {
    /// A hundred rays at each of a hundred walkers: the closest hit.
    Rays,
    /// Ten thousand points at one walker: the closest point. They fill the walker's bounding box, grown by a quarter.
    Points,
}

impl Many {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Rays, Self::Points];

    /// A short name for command lines.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rays => "many-rays",
            Self::Points => "many-points",
        }
    }

    /// A heading.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Rays => "10,000 rays at 100 walkers",
            Self::Points => "10,000 closest points at one walker",
        }
    }
}

/// How it is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// One question after the other, in the given order.
    OneByOne,
    /// All questions about a body in one batch, on this many threads.
    Batch(usize),
}

/// Something is missing, or not as it should be.
#[derive(Debug, Error)]
pub enum NotAsked {
    /// The scene cannot be made.
    #[error(transparent)]
    Scene(#[from] NoExperiment),
    /// The library refuses something.
    #[error("{0}")]
    Refused(String),
}

fn refused(error: impl std::fmt::Display) -> NotAsked {
    NotAsked::Refused(error.to_string())
}

/// A walker's weights and joints, and the rays cast at it then.
#[derive(Debug)]
struct Moment {
    weights: Vec<f32>,
    joints: JointMatrices,
    rays: Vec<Ray>,
}

/// Bodies, and the questions about them.
#[derive(Debug)]
pub struct ManyQuestions {
    many: Many,
    moments: Vec<Moment>,
    poses: Vec<Pose>,
    points: Vec<DVec3>,
    rays: RayQuery,
    shapes: ShapeQuery,
}

/// Where questions are asked from a walker's box: this share of its half size beyond it.
const BEYOND: f64 = 0.25;
const POINTS: u32 = 10_000;

impl ManyQuestions {
    /// Reads the walker, and makes the bodies.
    ///
    /// # Errors
    /// The walker's file is missing or unusable.
    pub fn new(many: Many) -> Result<Self, NotAsked> {
        let experiment = Experiment::named("walkers-rays", 4)?;
        let ray = |ray: &crate::rivals::CastRay| Ray::new(ray.origin, ray.direction, f64::INFINITY).map_err(refused);
        let moment = |frame: usize| -> Result<Moment, NotAsked> {
            let joints: &[Affine3A] = experiment.joints_of(frame, 0).unwrap_or_default();
            Ok(Moment {
                weights: experiment.frames[frame][0].0.clone(),
                joints: JointMatrices::new(joints).map_err(refused)?,
                rays: experiment.rays[frame].iter().map(ray).collect::<Result<_, _>>()?,
            })
        };
        let moments: Vec<_> = (0..experiment.frames.len()).map(moment).collect::<Result<_, _>>()?;
        let model = Arc::new(experiment.mesh.to_model().map_err(refused)?);
        let bvh = Arc::new(MorphBvh::build(model, &BuildOptions::default()));
        let bodies = match many {
            Many::Rays => moments.len(),
            Many::Points => 1,
        };
        let mut all = Self {
            many,
            moments,
            poses: (0..bodies).map(|_| Pose::new(bvh.clone())).collect(),
            points: Vec::new(),
            rays: RayQuery::new(),
            shapes: ShapeQuery::new(),
        };
        all.pose(0)?;
        let bounds = all.poses[0].world_bounds(&WorldFromModel::IDENTITY);
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        // Low-discrepancy steps, from -1 to 1.
        let share = |number: u32, stride: f64| 2.0 * (f64::from(number) * stride).fract() - 1.0;
        let aside = |number| {
            DVec3::new(
                share(number, 0.819_173),
                share(number, 0.671_044),
                share(number, 0.549_700),
            )
        };
        let point = |number| 0.5 * (min + max) + 0.5 * (1.0 + BEYOND) * (max - min) * aside(number);
        all.points = (0..POINTS).map(point).collect();
        Ok(all)
    }

    /// The number of questions at one moment.
    #[must_use]
    pub fn count(&self) -> usize {
        match self.many {
            Many::Rays => self.moments.iter().map(|moment| moment.rays.len()).sum(),
            Many::Points => self.points.len(),
        }
    }

    /// Moves every body to a moment of its own, and asks everything. Returns the number of rays that hit, or of points found, and a sum of
    /// all distances, to compare answers.
    ///
    /// # Errors
    /// The library refuses something.
    pub fn ask(&mut self, moment: usize, asked: Asked) -> Result<(usize, f64), NotAsked> {
        self.pose(moment)?;
        let place = WorldFromModel::IDENTITY;
        let threads = match asked {
            Asked::OneByOne => None,
            Asked::Batch(threads) => Some(ThreadWorkers::new(threads)),
        };
        let (mut found, mut sum) = (0, 0.0);
        let mut add = |distance: f64| {
            found += 1;
            sum += distance;
        };
        let threads = threads.as_ref().map(|threads| threads as &dyn Workers);
        let (mut hits, mut closest) = (Vec::new(), Vec::new());
        let moments = self.moments.iter().cycle().skip(moment);
        for (pose, moment) in self.poses.iter_mut().zip(moments) {
            let mut body = Body::new(pose, &place);
            match (self.many, threads) {
                (Many::Rays, None) => {
                    hits.clear();
                    let rays = moment.rays.iter();
                    hits.extend(rays.map(|ray| self.rays.closest(body.reborrow(), ray)));
                }
                (Many::Rays, Some(threads)) => self.rays.closest_batch(body, &moment.rays, threads, &mut hits),
                (Many::Points, None) => {
                    closest.clear();
                    for point in &self.points {
                        let found = self.shapes.closest_point(body.reborrow(), *point, f64::INFINITY);
                        closest.push(found.map_err(refused)?);
                    }
                }
                (Many::Points, Some(threads)) => self
                    .shapes
                    .closest_point_batch(body, &self.points, f64::INFINITY, threads, &mut closest)
                    .map_err(refused)?,
            }
            hits.iter().flatten().for_each(|hit| add(hit.distance));
            closest.iter().flatten().for_each(|point| add(point.distance));
        }
        Ok((found, sum))
    }

    /// Sets the weights and joints of all bodies.
    fn pose(&mut self, moment: usize) -> Result<(), NotAsked> {
        let moments = self.moments.iter().cycle().skip(moment);
        for (pose, moment) in self.poses.iter_mut().zip(moments) {
            pose.set_weights(&moment.weights).map_err(refused)?;
            pose.set_joints(&moment.joints).map_err(refused)?;
        }
        Ok(())
    }
}
