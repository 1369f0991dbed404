//! Leaves out the parts of a mesh for which a model would refuse all of it.

use std::fmt::{self, Display, Formatter};

use glam::Vec3;
use morph_collision::{BadParts, ModelError};
use serde::Serialize;

use crate::gltf::read::{FoundMesh, GltfFile, Skipped};
use crate::mesh::MorphMesh;
use crate::text::Grouped;

/// What was left out of a mesh that was read with [`ReadOptions::skip_bad`](crate::gltf::read::ReadOptions::skip_bad).
///
/// The other triangles are numbered without those that are left out.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LeftOut {
    /// Triangles that are left out.
    pub triangles: usize,
    /// Triangles of the mesh, with those.
    pub of_triangles: usize,
    /// Targets that do not move the vertices of a primitive because they are missing or too short there; counted once per primitive.
    pub targets: usize,
    /// Vertices that are bad, whether a triangle uses them or not.
    pub vertices: usize,
    /// What is wrong with the first bad vertex or triangle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

impl LeftOut {
    /// Leaves out the bad parts of a mesh, which has its skin already, if its file was opened with `skip_bad`. Returns what was left out, by
    /// this and by the reader; `None` if the mesh is complete.
    ///
    /// # Errors
    /// [`ModelError`] if lists of the mesh have different lengths or are too long.
    pub fn of(file: &GltfFile, found: &mut FoundMesh) -> Result<Option<Self>, ModelError> {
        if !file.skips_bad() {
            return Ok(None);
        }
        let bad = found.mesh.leave_out_bad_parts()?;
        let Skipped { triangles, targets } = found.skipped;
        let left_out = triangles + bad.triangles().len();
        let of_reader = (triangles > 0).then(|| "a corner is not a vertex".to_owned());
        let told = Self {
            triangles: left_out,
            of_triangles: found.mesh.triangles.len() + left_out,
            targets,
            vertices: bad.vertices().len(),
            reason: bad.first().map(ToString::to_string).or(of_reader),
        };
        let is_complete = told.triangles + told.targets + told.vertices == 0;
        Ok((!is_complete).then_some(told))
    }
}

/// One sentence, such as `3 of 68 triangles left out: vertex 17, influence 0: ...`.
impl Display for LeftOut {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let grouped = |number: usize| Grouped(number as u64);
        let (out, all) = (grouped(self.triangles), grouped(self.of_triangles));
        let noun = if self.of_triangles == 1 {
            "triangle"
        } else {
            "triangles"
        };
        write!(f, "{out} of {all} {noun} left out")?;
        match self.targets {
            0 => {}
            1 => f.write_str(", and 1 target that a primitive lacks")?,
            targets => write!(f, ", and {} targets that primitives lack", grouped(targets))?,
        }
        match &self.reason {
            Some(reason) => write!(f, ": {reason}"),
            None => Ok(()),
        }
    }
}

impl MorphMesh {
    /// Finds the bad triangles and vertices. Cost: one pass over all of the mesh.
    ///
    /// # Errors
    /// [`ModelError`] if lists have different lengths or are too long.
    pub fn bad_parts(&self) -> Result<BadParts, ModelError> {
        // They keep the numbers of the others right.
        let any_empty = self.targets.iter().any(Vec::is_empty);
        let zeros = vec![Vec3::ZERO; if any_empty { self.positions.len() } else { 0 }];
        let in_full = self.targets.iter();
        let in_full = in_full.map(|target| if target.is_empty() { &zeros } else { target });
        let targets: Vec<&[Vec3]> = in_full.map(Vec::as_slice).collect();
        let influences = self.skin.as_ref().map(|skin| (skin.joint_count(), skin.influences()));
        let skin = influences.as_ref().map(|(joints, sets)| (*joints, &sets[..]));
        BadParts::find(&self.positions, &self.triangles, &targets, skin)
    }

    /// Removes bad triangles, and makes bad vertices equal to a good one. Vertices keep their numbers; the triangles after a bad one do not.
    ///
    /// # Errors
    /// [`ModelError`] if lists have different lengths or are too long.
    pub fn leave_out_bad_parts(&mut self) -> Result<BadParts, ModelError> {
        let bad = self.bad_parts()?;
        bad.repair(&mut self.positions);
        self.targets.iter_mut().for_each(|target| bad.repair(target));
        for set in self.skin.iter_mut().flat_map(|skin| &mut skin.sets) {
            bad.repair(&mut set.joints);
            bad.repair(&mut set.weights);
        }
        bad.remove_from(&mut self.triangles);
        let moved = |end: u32| end - bad.triangles().partition_point(|&triangle| triangle < end) as u32;
        for range in &mut self.primitives {
            *range = moved(range.start)..moved(range.end);
        }
        Ok(bad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated::rigs::tube;

    #[test]
    fn primitives_lose_their_bad_triangles_and_the_model_is_valid() -> Result<(), ModelError> {
        let mut mesh = tube(1, 4, 6, 2);
        let (whole, all) = (mesh.to_model()?, mesh.triangles.len() as u32);
        mesh.primitives = vec![0..7, 7..7, 7..all];
        mesh.targets[1] = Vec::new();
        let spoiled = mesh.triangles[3][1];
        let sets = &mut mesh.skin.as_mut().expect("a tube has a skin").sets;
        sets[1].weights[spoiled as usize][3] = f32::NAN;
        mesh.triangles[9][0] = u32::MAX;
        let is_bad = |(t, corners): &(u32, &[u32; 3])| *t == 9 || corners.contains(&spoiled);
        let bad: Vec<u32> = (0..).zip(&mesh.triangles).filter(is_bad).map(|(t, _)| t).collect();
        let before = bad.iter().filter(|t| **t < 7).count() as u32;
        assert!(mesh.to_model().is_err());
        let found = mesh.leave_out_bad_parts()?;
        assert_eq!((found.triangles(), found.vertices()), (&bad[..], &[spoiled][..]));
        let rest = all - bad.len() as u32;
        assert_eq!(
            mesh.primitives,
            [0..7 - before, 7 - before..7 - before, 7 - before..rest]
        );
        let model = mesh.to_model()?;
        assert_eq!(model.triangle_count(), rest as usize);
        assert_eq!(model.joint_weight_error(), whole.joint_weight_error());
        assert!(mesh.leave_out_bad_parts()?.first().is_none());
        Ok(())
    }

    #[test]
    fn the_sentence_names_how_much_and_why() {
        let told = LeftOut {
            triangles: 3,
            of_triangles: 1068,
            targets: 2,
            vertices: 1,
            reason: Some("vertex 17 is bad".to_owned()),
        };
        assert_eq!(
            told.to_string(),
            "3 of 1,068 triangles left out, and 2 targets that primitives lack: vertex 17 is bad"
        );
    }
}
