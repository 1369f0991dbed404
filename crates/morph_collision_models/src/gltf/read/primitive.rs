//! Joins the primitives of a mesh into one list of vertices and one of triangles.
//!
//! First all accessors are opened, then the memory of the whole mesh is counted, and only then is anything decoded.

use std::collections::HashMap;

use glam::Vec3;
use gltf::mesh::Mode;

use super::accessor::{INDICES, Opened, POINTS};
use super::attributes::Influences;
use super::document::Primitive;
use super::draco::DracoMesh;
use super::error::{AccessorProblem, MeshProblem};
use super::skipped::Skipped;
use super::triangles::mode;
use super::{GltfFile, triangles};
use crate::mesh::MorphMesh;

/// The kinds of primitives in a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Primitives {
    pub(super) triangles: bool,
    pub(super) lines: bool,
    pub(super) points: bool,
}

/// Reads positions, targets and triangles. The caller sets the names.
///
/// Targets without stored data are left empty. The last value is what was left out.
pub(super) fn read<'a>(
    file: &'a GltfFile,
    primitives: &'a [Primitive],
) -> Result<(MorphMesh, Primitives, Skipped), MeshProblem> {
    let plan = Plan::of(file, primitives)?;
    plan.count_memory(file)?;
    let mut skipped = plan.skipped;
    Ok((plan.decode(&mut skipped)?, plan.drawn, skipped))
}

/// The accessors that vertices come from: positions, displacements per target, and influences. Primitives with the same key share
/// vertices.
type SourceKey<'a> = (usize, Vec<Option<usize>>, &'a Influences);

/// A mesh that is checked but not yet decoded.
#[derive(Default)]
pub(super) struct Plan<'a> {
    targets: usize,
    sources: Vec<Source<'a>>,
    known: HashMap<SourceKey<'a>, usize>,
    parts: Vec<Part<'a>>,
    vertices: usize,
    triangles: u64,
    drawn: Primitives,
    /// Whether to leave out what is bad, instead of refusing the mesh.
    skip_bad: bool,
    /// What is known to be left out before anything is decoded.
    skipped: Skipped,
}

struct Source<'a> {
    /// The first primitive that uses it, for messages.
    primitive: usize,
    first_vertex: u32,
    positions: Opened<'a>,
    /// The stored targets and their indices.
    targets: Vec<(usize, Opened<'a>)>,
}

/// A primitive. If it draws no triangle it has no source.
struct Part<'a> {
    primitive: usize,
    source: Option<usize>,
    mode: Mode,
    corners: Corners<'a>,
}

/// Where the corners of a primitive come from.
enum Corners<'a> {
    /// All vertices in order.
    Vertices,
    Stored(Opened<'a>),
    /// Separate triangles, whatever the mode.
    Decoded(DracoMesh<'a>),
}

impl<'a> Plan<'a> {
    /// Checks the positions, targets and indices of some primitives.
    pub(super) fn of(file: &'a GltfFile, primitives: &'a [Primitive]) -> Result<Self, MeshProblem> {
        let mut plan = Plan {
            skip_bad: file.skip_bad,
            ..Plan::default()
        };
        let counts = primitives.iter().map(|primitive| primitive.targets.len());
        plan.targets = if plan.skip_bad {
            counts.max().unwrap_or(0)
        } else {
            primitives.first().map_or(0, |first| first.targets.len())
        };
        for (index, json) in primitives.iter().enumerate() {
            plan.add(file, index, json)?;
        }
        Ok(plan)
    }

    /// The number of vertices of the whole mesh.
    pub(super) fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// The primitives that add vertices, in the order of the vertices: the primitive, its first vertex and the number of
    /// vertices.
    pub(super) fn vertex_ranges(&self) -> impl Iterator<Item = (usize, usize, usize)> {
        let sources = self.sources.iter();
        sources.map(|source| (source.primitive, source.first_vertex as usize, source.positions.count()))
    }

    fn add(&mut self, file: &'a GltfFile, primitive: usize, json: &'a Primitive) -> Result<(), MeshProblem> {
        let positions = json.attributes.positions;
        let positions = positions.ok_or(MeshProblem::MissingPositions { primitive })?;
        let targets: Vec<Option<usize>> = json.targets.iter().map(|target| target.positions).collect();
        if self.skip_bad {
            self.skipped.targets += self.targets - targets.len();
        } else if targets.len() != self.targets {
            return Err(MeshProblem::TargetCount {
                primitive,
                found: targets.len(),
                expected: self.targets,
            });
        }
        let mode = mode(json.mode).ok_or(MeshProblem::UnknownMode { primitive })?;
        match mode {
            Mode::Points => self.drawn.points = true,
            Mode::Lines | Mode::LineLoop | Mode::LineStrip => self.drawn.lines = true,
            Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan => self.drawn.triangles = true,
        }
        let mut part = Part {
            primitive,
            source: None,
            mode,
            corners: Corners::Vertices,
        };
        if triangles::is_drawn_of_triangles(mode) {
            let compressed = |fault| MeshProblem::Compressed { primitive, fault };
            let decoded = file.draco(json).map_err(compressed)?;
            let values = decoded
                .map(|decoded| decoded.positions())
                .transpose()
                .map_err(compressed)?;
            let opened = file.open_vertices(positions, &POINTS, values.flatten());
            let opened = opened.map_err(at(primitive, "POSITION"))?;
            let corners = match (decoded, json.indices) {
                (Some(decoded), _) => {
                    part.mode = Mode::Triangles;
                    part.corners = Corners::Decoded(decoded);
                    3 * decoded.triangle_count()
                }
                (None, Some(accessor)) => {
                    let indices = file.open_accessor(accessor, &INDICES);
                    let indices = indices.map_err(at(primitive, "indices"))?;
                    let count = indices.count();
                    part.corners = Corners::Stored(indices);
                    count
                }
                (None, None) => opened.count(),
            };
            let (triangles, whole) = triangles::count(part.mode, corners);
            if !whole {
                self.skip(MeshProblem::IncompleteTriangle { primitive, corners })?;
                self.skipped.triangles += 1;
            }
            // An accessor without stored data may claim any count.
            self.triangles = self.triangles.saturating_add(triangles as u64);
            if u32::try_from(self.triangles).is_err() {
                return Err(MeshProblem::TooLarge { primitive });
            }
            if triangles > 0 {
                let key = (positions, targets, &json.attributes.influences);
                part.source = Some(self.source(file, primitive, opened, key)?);
            }
        }
        self.parts.push(part);
        Ok(())
    }

    fn source(
        &mut self,
        file: &'a GltfFile,
        primitive: usize,
        positions: Opened<'a>,
        key: SourceKey<'a>,
    ) -> Result<usize, MeshProblem> {
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let vertices = positions.count();
        let mut targets = Vec::new();
        // A target may move only normals.
        let moving = key.1.iter().enumerate();
        for (target, accessor) in moving.filter_map(|(target, accessor)| Some((target, (*accessor)?))) {
            let opened = file.open_accessor(accessor, &POINTS);
            let opened = opened.map_err(at(primitive, &format!("target {target} POSITION")))?;
            if opened.count() != vertices {
                self.skip(MeshProblem::TargetLength {
                    primitive,
                    target,
                    found: opened.count(),
                    expected: vertices,
                })?;
                self.skipped.targets += 1;
            } else if !opened.is_unstored() {
                targets.push((target, opened));
            }
        }
        let too_large = MeshProblem::TooLarge { primitive };
        let end = self
            .vertices
            .checked_add(vertices)
            .filter(|&end| u32::try_from(end).is_ok());
        let Some(end) = end else { return Err(too_large) };
        self.sources.push(Source {
            primitive,
            first_vertex: self.vertices as u32,
            positions,
            targets,
        });
        self.vertices = end;
        self.known.insert(key, self.sources.len() - 1);
        Ok(self.sources.len() - 1)
    }

    /// An error, unless what is bad is left out.
    fn skip(&self, problem: MeshProblem) -> Result<(), MeshProblem> {
        if self.skip_bad { Ok(()) } else { Err(problem) }
    }

    /// For each target, whether any data is stored for it.
    fn moving_targets(&self) -> Vec<bool> {
        let mut moving = vec![false; self.targets];
        for (target, _) in self.sources.iter().flat_map(|source| &source.targets) {
            moving[*target] = true;
        }
        moving
    }

    fn count_memory(&self, file: &GltfFile) -> Result<(), MeshProblem> {
        let moving = self.moving_targets().into_iter().filter(|moving| *moving).count();
        let (vertices, triangles) = (self.vertices as u64, self.triangles);
        // Positions and displacements, and the numbers for vertices without indices.
        let per_vertex = (moving as u64 + 1) * size_of::<Vec3>() as u64 + 4;
        // Triangles twice, and their corners, while a primitive is decoded.
        let bytes = vertices.saturating_mul(per_vertex).saturating_add(triangles * 36);
        let what = || format!("its {vertices} vertices with {moving} stored targets and its {triangles} triangles");
        file.budget.take(bytes, 1, what).map_err(MeshProblem::OverBudget)
    }

    fn decode(&self, skipped: &mut Skipped) -> Result<MorphMesh, MeshProblem> {
        let mut mesh = MorphMesh {
            positions: Vec::with_capacity(self.vertices),
            targets: vec![Vec::new(); self.targets],
            triangles: Vec::with_capacity(self.triangles as usize),
            ..MorphMesh::default()
        };
        for (target, moving) in self.moving_targets().into_iter().enumerate() {
            if moving {
                mesh.targets[target].reserve_exact(self.vertices);
            }
        }
        for source in &self.sources {
            let primitive = source.primitive;
            source
                .positions
                .append_vec3(&mut mesh.positions)
                .map_err(at(primitive, "POSITION"))?;
            for (target, opened) in &source.targets {
                let displacements = &mut mesh.targets[*target];
                displacements.resize(source.first_vertex as usize, Vec3::ZERO);
                let attribute = format!("target {target} POSITION");
                opened.append_vec3(displacements).map_err(at(primitive, &attribute))?;
            }
        }
        for displacements in mesh.targets.iter_mut().filter(|target| !target.is_empty()) {
            displacements.resize(self.vertices, Vec3::ZERO);
        }
        for part in &self.parts {
            skipped.triangles += self.decode_triangles(part, &mut mesh)?;
        }
        Ok(mesh)
    }

    /// Adds the triangles of a primitive; returns how many are left out because they have a corner that is no vertex.
    fn decode_triangles(&self, part: &Part<'_>, mesh: &mut MorphMesh) -> Result<usize, MeshProblem> {
        let primitive = part.primitive;
        let mut left_out = 0;
        let start = mesh.primitives.last().map_or(0, |range| range.end);
        if let Some(source) = part.source {
            let source = &self.sources[source];
            let vertices = source.positions.count();
            let corners = match &part.corners {
                Corners::Stored(indices) => indices.indices().map_err(at(primitive, "indices"))?,
                Corners::Decoded(decoded) => decoded.corners(),
                Corners::Vertices => (0..vertices as u32).collect(),
            };
            if let Some(position) = corners.iter().position(|&v| v as usize >= vertices) {
                self.skip(MeshProblem::VertexOutOfRange {
                    primitive,
                    position,
                    vertex: corners[position],
                    vertices,
                })?;
            }
            let mut drawn = triangles::from_corners(part.mode, &corners);
            let all = drawn.len();
            drawn.retain(|triangle| triangle.iter().all(|&v| (v as usize) < vertices));
            left_out = all - drawn.len();
            let shifted = drawn.iter().map(|triangle| triangle.map(|v| source.first_vertex + v));
            mesh.triangles.extend(shifted);
        }
        let end = u32::try_from(mesh.triangles.len()).map_err(|_| MeshProblem::TooLarge { primitive })?;
        mesh.primitives.push(start..end);
        Ok(left_out)
    }
}

fn at(primitive: usize, attribute: &str) -> impl Fn(AccessorProblem) -> MeshProblem + use<> {
    let attribute = attribute.to_owned();
    move |problem| MeshProblem::Accessor {
        primitive,
        attribute: attribute.clone(),
        problem,
    }
}
