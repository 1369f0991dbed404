//! The picture of one frame.

use std::path::PathBuf;

use clap::Args;

use super::replay::{FrameCounts, Hit};
use super::{Mode, PairFinder};
use crate::cast::Cast;
use crate::error::CliError;
use crate::files::model::has_extension;
use crate::picture::DrawnBody;

/// Whether and what to draw.
#[derive(Debug, Args)]
pub(crate) struct PictureArgs {
    /// Draw the frame with the most touching triangles to a PNG file, with these triangles in red; - writes it to standard output.
    ///
    /// No graphics driver is needed. With the modes first and any, only the one pair that was found for two bodies is red.
    #[arg(long, value_name = "OUT.png")]
    pub(super) picture: Option<PathBuf>,
    /// Draw this frame instead, counted from 0.
    #[arg(long, value_name = "N", requires = "picture")]
    picture_frame: Option<usize>,
}

/// What was drawn.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub(crate) struct PictureReport {
    pub(crate) file: PathBuf,
    pub(crate) frame: usize,
    /// Number of red triangles.
    pub(crate) touching_triangles: usize,
}

impl PictureArgs {
    /// # Errors
    /// The mode lists no triangles that could be red, or the file's name promises another format.
    pub(super) fn check_mode(&self, mode: Mode) -> Result<(), CliError> {
        if self.picture.is_some() && mode.is_of_surfaces() {
            let reason = format!("there are no pictures of mode {}; use all, first or any", mode.name());
            let flag = "--picture";
            return Err(CliError::Flag { flag, reason });
        }
        if let Some(picture) = &self.picture
            && picture.extension().is_some()
            && !has_extension(picture, &["png"])
        {
            let reason = format!(
                "{}: pictures are PNG files; use a name that ends with .png",
                picture.display()
            );
            let flag = "--picture";
            return Err(CliError::Flag { flag, reason });
        }
        Ok(())
    }

    /// # Errors
    /// The frame does not exist.
    pub(super) fn check(&self, frames: usize) -> Result<(), CliError> {
        let complain = |flag, reason| Err(CliError::Flag { flag, reason });
        match (self.picture_frame, frames) {
            (_, 0) if self.picture.is_some() => complain("--picture", "the scene has no frames to draw".to_owned()),
            (Some(frame), _) if frame >= frames => complain(
                "--picture-frame",
                format!(
                    "there is no frame {frame}; the scene's frames are 0 to {}",
                    frames.saturating_sub(1)
                ),
            ),
            _ => Ok(()),
        }
    }

    /// The requested frame, or else the first of the frames with the most pairs.
    pub(super) fn frame(&self, counts: &[FrameCounts]) -> usize {
        let most = || counts.iter().enumerate().rev().max_by_key(|(_, counts)| counts.pairs);
        self.picture_frame
            .unwrap_or_else(|| most().map_or(0, |(frame, _)| frame))
    }
}

/// The bodies of a frame, in which they are posed. Triangles in `hits` are marked as touching.
pub(super) fn bodies(cast: &mut Cast<impl PairFinder>, frame: usize, hits: &[Hit]) -> Vec<DrawnBody> {
    let mut bodies: Vec<DrawnBody> = (0..cast.bodies)
        .map(|body| {
            let shape = cast.shape(frame, body);
            let mesh = &cast.meshes[cast.mesh_of_body[body]];
            DrawnBody {
                vertices: cast.method.vertices(body, mesh, &shape),
                triangles: mesh.triangles.clone(),
                touching: vec![false; mesh.triangles.len()],
            }
        })
        .collect();
    for hit in hits {
        bodies[hit.body_a as usize].touching[hit.pair.triangle_a as usize] = true;
        bodies[hit.body_b as usize].touching[hit.pair.triangle_b as usize] = true;
    }
    bodies
}

/// How many triangles are red.
pub(super) fn touching_triangles(bodies: &[DrawnBody]) -> usize {
    bodies
        .iter()
        .flat_map(|body| &body.touching)
        .filter(|&&touching| touching)
        .count()
}
