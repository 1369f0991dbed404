//! Joins the primitives of a mesh into one list of vertices and one of triangles.

use std::collections::HashMap;

use glam::Vec3;
use gltf::{Semantic, json};
use json::validation::Checked;

use super::{
    accessor::Accessors,
    error::{AccessorProblem, MeshProblem},
    triangles,
};
use crate::mesh::MorphMesh;

/// Reads positions, targets and triangles; the names are the caller's.
pub(super) fn read(mesh: &json::Mesh, accessors: &Accessors<'_>) -> Result<MorphMesh, MeshProblem> {
    let mut joined = MorphMesh::default();
    let mut shared = HashMap::new();
    for (index, primitive) in mesh.primitives.iter().enumerate() {
        Primitive {
            index,
            json: primitive,
            accessors,
        }
        .append_to(&mut joined, &mut shared)?;
    }
    Ok(joined)
}

/// The accessors a vertex comes from: positions, and displacements per target. Primitives with the same ones share vertices.
type VertexSource = (usize, Vec<Option<usize>>);

struct Primitive<'a> {
    index: usize,
    json: &'a json::mesh::Primitive,
    accessors: &'a Accessors<'a>,
}

impl Primitive<'_> {
    fn append_to(&self, mesh: &mut MorphMesh, shared: &mut HashMap<VertexSource, u32>) -> Result<(), MeshProblem> {
        let primitive = self.index;
        let source = self.vertex_source()?;
        if primitive == 0 {
            mesh.targets = vec![Vec::new(); source.1.len()];
        } else if source.1.len() != mesh.targets.len() {
            let (found, expected) = (source.1.len(), mesh.targets.len());
            return Err(MeshProblem::TargetCount {
                primitive,
                found,
                expected,
            });
        }

        let vertices = self.accessors.count(source.0).map_err(self.at("POSITION"))?;
        let drawn = self.triangles(vertices)?;
        if !drawn.is_empty() {
            let first_vertex = match shared.get(&source) {
                Some(&first) => first,
                None => {
                    let first = self.append_vertices(mesh, &source, vertices)?;
                    shared.insert(source, first);
                    first
                }
            };
            mesh.triangles
                .extend(drawn.iter().map(|triangle| triangle.map(|v| first_vertex + v)));
        }
        let start = mesh.primitives.last().map_or(0, |range| range.end);
        let end = u32::try_from(mesh.triangles.len()).map_err(|_| MeshProblem::TooLarge { primitive })?;
        mesh.primitives.push(start..end);
        Ok(())
    }

    fn vertex_source(&self) -> Result<VertexSource, MeshProblem> {
        let positions = self
            .json
            .attributes
            .get(&Checked::Valid(Semantic::Positions))
            .ok_or(MeshProblem::MissingPositions { primitive: self.index })?;
        let targets = self.json.targets.iter().flatten();
        Ok((
            positions.value(),
            targets.map(|target| target.positions.map(|p| p.value())).collect(),
        ))
    }

    fn triangles(&self, vertices: usize) -> Result<Vec<[u32; 3]>, MeshProblem> {
        let primitive = self.index;
        let Checked::Valid(mode) = self.json.mode else {
            return Err(MeshProblem::UnknownMode { primitive });
        };
        let corners = match self.json.indices {
            Some(accessor) => self.accessors.indices(accessor.value()).map_err(self.at("indices"))?,
            None => {
                // Decoding first, because a count by itself is only a claim.
                let position = self.vertex_source()?.0;
                let stored = self.accessors.vec3(position).map_err(self.at("POSITION"))?.len();
                (0..u32::try_from(stored).map_err(|_| MeshProblem::TooLarge { primitive })?).collect()
            }
        };
        if let Some(position) = corners.iter().position(|&v| v as usize >= vertices) {
            let vertex = corners[position];
            return Err(MeshProblem::VertexOutOfRange {
                primitive,
                position,
                vertex,
                vertices,
            });
        }
        triangles::from_corners(mode, &corners).ok_or(MeshProblem::IncompleteTriangle {
            primitive,
            corners: corners.len(),
        })
    }

    /// Appends the vertices and returns the index of the first.
    fn append_vertices(
        &self,
        mesh: &mut MorphMesh,
        (positions, targets): &VertexSource,
        vertices: usize,
    ) -> Result<u32, MeshProblem> {
        let primitive = self.index;
        let too_large = |_| MeshProblem::TooLarge { primitive };
        let first = u32::try_from(mesh.positions.len()).map_err(too_large)?;
        u32::try_from(mesh.positions.len() + vertices).map_err(too_large)?;

        let decoded = self.accessors.vec3(*positions).map_err(self.at("POSITION"))?;
        mesh.positions.extend(decoded.into_iter().map(Vec3::from_array));
        for (target, (accessor, displacements)) in targets.iter().zip(&mut mesh.targets).enumerate() {
            let Some(accessor) = *accessor else {
                // A target may move normals alone.
                displacements.resize(displacements.len() + vertices, Vec3::ZERO);
                continue;
            };
            let attribute = format!("target {target} POSITION");
            let found = self.accessors.count(accessor).map_err(self.at(&attribute))?;
            if found != vertices {
                return Err(MeshProblem::TargetLength {
                    primitive,
                    target,
                    found,
                    expected: vertices,
                });
            }
            let decoded = self.accessors.vec3(accessor).map_err(self.at(&attribute))?;
            displacements.extend(decoded.into_iter().map(Vec3::from_array));
        }
        Ok(first)
    }

    fn at(&self, attribute: &str) -> impl Fn(AccessorProblem) -> MeshProblem + use<> {
        let (primitive, attribute) = (self.index, attribute.to_owned());
        move |problem| MeshProblem::Accessor {
            primitive,
            attribute: attribute.clone(),
            problem,
        }
    }
}
