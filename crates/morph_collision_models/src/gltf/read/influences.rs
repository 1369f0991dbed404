//! Reads the influences of a mesh's vertices.

use super::GltfFile;
use super::accessor::{FRACTIONS, JOINTS, Opened};
use super::document::Primitive;
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

/// The names of a set's attributes.
fn names(set: usize) -> [String; 2] {
    [format!("JOINTS_{set}"), format!("WEIGHTS_{set}")]
}

/// Reads the sets of influences, in the order of the vertices of some primitives. Primitives with fewer sets than others get zeros.
pub(super) fn read<'a>(file: &'a GltfFile, primitives: &'a [Primitive]) -> Result<Vec<InfluenceSet>, SkinProblem> {
    let plan = Plan::of(file, primitives).map_err(SkinProblem::Mesh)?;
    let mut stored = Vec::new();
    for (primitive, first_vertex, vertices) in plan.vertex_ranges() {
        let json = &primitives[primitive];
        let last = json.attributes.influences.keys().next_back().copied().unwrap_or(0);
        for set in 0..=last {
            let (joints, weights) = open(file, json, primitive, set, vertices)?;
            stored.push(Stored {
                primitive,
                first_vertex,
                set,
                joints,
                weights,
            });
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
        let [of_joints, of_weights] = names(stored.set);
        let primitive = stored.primitive;
        let at = |attribute| {
            move |problem| SkinProblem::Accessor {
                primitive,
                attribute,
                problem,
            }
        };
        stored.joints.append_joints(joints).map_err(at(of_joints))?;
        stored.weights.append_joint_weights(weights).map_err(at(of_weights))?;
    }
    for InfluenceSet { joints, weights } in &mut read {
        joints.resize(vertices, [0; 4]);
        weights.resize(vertices, [0.0; 4]);
    }
    Ok(read)
}

/// The accessors of a set.
fn open<'a>(
    file: &'a GltfFile,
    json: &'a Primitive,
    primitive: usize,
    set: usize,
    vertices: usize,
) -> Result<(Opened<'a>, Opened<'a>), SkinProblem> {
    let accessors = json.attributes.influences.get(&set).copied().unwrap_or_default();
    let [of_joints, of_weights] = names(set);
    let missing = |attribute: &String| SkinProblem::MissingInfluences {
        primitive,
        attribute: attribute.clone(),
    };
    let joints = accessors[0].ok_or_else(|| missing(&of_joints))?;
    let weights = accessors[1].ok_or_else(|| missing(&of_weights))?;
    let compressed = |fault| SkinProblem::Mesh(MeshProblem::Compressed { primitive, fault });
    let [decoded_joints, decoded_weights] = match file.draco(json).map_err(compressed)? {
        Some(decoded) => decoded.influences(set).map_err(compressed)?,
        None => [None, None],
    };
    let checked = |attribute: String, opened: Result<Opened<'a>, _>| {
        let opened = opened.map_err(|problem| SkinProblem::Accessor {
            primitive,
            attribute: attribute.clone(),
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
    Ok((
        checked(of_joints, file.open_vertices(joints, &JOINTS, decoded_joints))?,
        checked(of_weights, file.open_vertices(weights, &FRACTIONS, decoded_weights))?,
    ))
}
