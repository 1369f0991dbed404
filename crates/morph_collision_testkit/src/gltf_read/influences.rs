//! Reads the influences of a mesh's vertices.

use super::GltfFile;
use super::accessor::{FRACTIONS, JOINTS, Opened};
use super::document::{Mesh, Primitive};
use super::error::{MeshProblem, SkinProblem};
use super::primitive::Plan;
use crate::mesh::InfluenceSet;

/// The accessors of one set of influences in one primitive.
struct Stored<'a> {
    primitive: usize,
    first_vertex: usize,
    set: usize,
    joints: Opened<'a>,
    weights: Opened<'a>,
}

/// The names of the attributes of each set.
const OF_JOINTS: [&str; 2] = ["JOINTS_0", "JOINTS_1"];
const OF_WEIGHTS: [&str; 2] = ["WEIGHTS_0", "WEIGHTS_1"];

/// Reads one or two sets of influences, in the order of the mesh's vertices. Further sets in the file are ignored.
pub(super) fn read<'a>(file: &'a GltfFile, mesh: &'a Mesh) -> Result<Vec<InfluenceSet>, SkinProblem> {
    let plan = Plan::of(file, mesh).map_err(SkinProblem::Mesh)?;
    let mut stored = Vec::new();
    for (primitive, first_vertex, vertices) in plan.vertex_ranges() {
        let json = &mesh.primitives[primitive];
        for set in 0..2 {
            let opened = open(file, json, primitive, set, vertices)?;
            stored.extend(opened.map(|(joints, weights)| Stored {
                primitive,
                first_vertex,
                set,
                joints,
                weights,
            }));
        }
    }
    let sets = stored.iter().map(|stored| stored.set + 1).max().unwrap_or(0);
    let vertices = plan.vertex_count();
    let what = || format!("the influences of {vertices} vertices in {sets} sets");
    let take = file.budget.take(vertices as u64 * sets as u64, 24, what);
    take.map_err(SkinProblem::OverBudget)?;
    let mut read = vec![InfluenceSet::default(); sets];
    for stored in &stored {
        let InfluenceSet { joints, weights } = &mut read[stored.set];
        joints.resize(stored.first_vertex, [0; 4]);
        weights.resize(stored.first_vertex, [0.0; 4]);
        let at = |attribute: [&'static str; 2]| {
            let (primitive, attribute) = (stored.primitive, attribute[stored.set]);
            move |problem| SkinProblem::Accessor {
                primitive,
                attribute,
                problem,
            }
        };
        stored.joints.append_joints(joints).map_err(at(OF_JOINTS))?;
        stored.weights.append_joint_weights(weights).map_err(at(OF_WEIGHTS))?;
    }
    for InfluenceSet { joints, weights } in &mut read {
        joints.resize(vertices, [0; 4]);
        weights.resize(vertices, [0.0; 4]);
    }
    Ok(read)
}

/// The accessors of a set; `None` if a primitive has no second one.
fn open<'a>(
    file: &'a GltfFile,
    json: &'a Primitive,
    primitive: usize,
    set: usize,
    vertices: usize,
) -> Result<Option<(Opened<'a>, Opened<'a>)>, SkinProblem> {
    let attributes = &json.attributes;
    let accessors = match set {
        0 => (attributes.joints, attributes.joint_weights),
        _ => (attributes.more_joints, attributes.more_joint_weights),
    };
    if set > 0 && accessors == (None, None) {
        return Ok(None);
    }
    let missing = |attribute| SkinProblem::MissingInfluences { primitive, attribute };
    let joints = accessors.0.ok_or(missing(OF_JOINTS[set]))?;
    let weights = accessors.1.ok_or(missing(OF_WEIGHTS[set]))?;
    let compressed = |fault| SkinProblem::Mesh(MeshProblem::Compressed { primitive, fault });
    let [of_joints, of_weights] = match file.draco(json).map_err(compressed)? {
        Some(decoded) => decoded.influences(set).map_err(compressed)?,
        None => [None, None],
    };
    let checked = |attribute, opened: Result<Opened<'a>, _>| {
        let opened = opened.map_err(|problem| SkinProblem::Accessor {
            primitive,
            attribute,
            problem,
        })?;
        if opened.count() != vertices {
            return Err(SkinProblem::Length {
                primitive,
                attribute,
                found: opened.count(),
                expected: vertices,
            });
        }
        Ok(opened)
    };
    Ok(Some((
        checked(OF_JOINTS[set], file.open_vertices(joints, &JOINTS, of_joints))?,
        checked(OF_WEIGHTS[set], file.open_vertices(weights, &FRACTIONS, of_weights))?,
    )))
}
