//! Writes one mesh with its targets and clips as a binary glTF 2.0 file (`.glb`), the same bytes for the same mesh.
//!
//! Besides what the mesh holds, the file gets what a renderer wants: smooth normals for the base and every target
//! (`shading`), planar texture coordinates and one material. The layout is one buffer; `buffer` packs it.

mod buffer;
mod shading;

use std::{collections::BTreeMap, io, path::Path};

use gltf_json::{
    self as json, Index, Root,
    accessor::Type,
    animation::{Channel, Interpolation, Property, Sampler, Target},
    material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor},
    mesh::{MorphTarget, Primitive, Semantic},
    validation::Checked,
};
use serde_json::value::RawValue;

use self::buffer::Packer;
use crate::mesh::{MorphMesh, WeightAnimation};

/// How the written mesh looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// Base colour, linear RGBA in 0..=1.
    pub base_color: [f32; 4],
    /// Roughness in 0..=1.
    pub roughness: f32,
}

impl Default for Appearance {
    fn default() -> Self {
        Self {
            base_color: [0.6, 0.6, 0.6, 1.0],
            roughness: 0.6,
        }
    }
}

/// Why a mesh could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file could not be written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// glTF has no way to say "no vertices" or "no triangles".
    #[error("mesh \"{0}\" has no vertices or no triangles, which glTF cannot hold")]
    Empty(String),
    /// A list is not as long as it has to be.
    #[error("mesh \"{mesh}\": {what} {index} has {found} elements instead of {expected}")]
    Length {
        /// The mesh's name.
        mesh: String,
        /// What the list is: a target, or a clip.
        what: &'static str,
        /// The index of the target or clip.
        index: usize,
        /// Its length.
        found: usize,
        /// The length it has to have.
        expected: usize,
    },
    /// A triangle refers to a vertex that does not exist, or a primitive to a triangle.
    #[error("mesh \"{mesh}\": {what} {index} refers to elements that do not exist")]
    OutOfRange {
        /// The mesh's name.
        mesh: String,
        /// What refers: a triangle or a primitive.
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// The file would be larger than glTF's 32-bit lengths allow.
    #[error("mesh \"{mesh}\": cannot be packed: {reason}")]
    Pack {
        /// The mesh's name.
        mesh: String,
        /// Why.
        reason: String,
    },
}

/// Writes `mesh` to `path`, replacing what is there.
///
/// # Errors
/// As [`to_glb`], and where the file cannot be written.
pub fn write_glb(path: &Path, mesh: &MorphMesh, appearance: &Appearance) -> Result<(), WriteError> {
    let bytes = to_glb(mesh, appearance)?;
    std::fs::write(path, bytes).map_err(|source| WriteError::Io {
        path: path.to_owned(),
        source,
    })
}

/// The bytes of a `.glb` file: one scene with one node that shows `mesh`.
///
/// Every primitive shares the vertices and has indices of its own, of 16 bits where they fit.
///
/// # Errors
/// [`WriteError`] where the mesh is empty, or its lists do not go together.
pub fn to_glb(mesh: &MorphMesh, appearance: &Appearance) -> Result<Vec<u8>, WriteError> {
    check(mesh)?;
    let mut root = Root {
        asset: asset(),
        ..Root::default()
    };
    let mut packer = Packer::default();

    let (attributes, targets) = vertices(mesh, &mut root, &mut packer);
    let material = root.push(material(mesh, appearance));
    let primitives = mesh.primitives.iter().map(|range| {
        let triangles = &mesh.triangles[range.start as usize..range.end as usize];
        Primitive {
            attributes: attributes.clone(),
            extensions: None,
            extras: None,
            indices: Some(packer.indices(&mut root, triangles.as_flattened(), mesh.positions.len())),
            material: Some(material),
            mode: Checked::Valid(json::mesh::Mode::Triangles),
            targets: (!targets.is_empty()).then(|| targets.clone()),
        }
    });
    let primitives = primitives.collect();
    let json_mesh = root.push(json::Mesh {
        extensions: None,
        extras: target_names(mesh),
        name: Some(mesh.name.clone()),
        primitives,
        weights: (!mesh.targets.is_empty()).then(|| vec![0.0; mesh.targets.len()]),
    });
    let node = root.push(json::Node {
        mesh: Some(json_mesh),
        name: Some(mesh.name.clone()),
        ..json::Node::default()
    });
    for clip in &mesh.animations {
        animation(clip, node, &mut root, &mut packer);
    }
    let scene = json::Scene {
        extensions: None,
        extras: None,
        name: None,
        nodes: vec![node],
    };
    root.scene = Some(root.push(scene));

    let pack = |reason: String| WriteError::Pack {
        mesh: mesh.name.clone(),
        reason,
    };
    packer.finish(root).map_err(|error| pack(error.to_string()))
}

fn asset() -> json::Asset {
    json::Asset {
        generator: Some("morph_collision_testkit".into()),
        ..json::Asset::default()
    }
}

fn check(mesh: &MorphMesh) -> Result<(), WriteError> {
    let name = || mesh.name.clone();
    let length = |what, index, found, expected| match found == expected {
        true => Ok(()),
        false => Err(WriteError::Length {
            mesh: name(),
            what,
            index,
            found,
            expected,
        }),
    };
    let vertices = mesh.positions.len();
    for (index, target) in mesh.targets.iter().enumerate() {
        if !target.is_empty() {
            length("target", index, target.len(), vertices)?;
        }
    }
    for (index, clip) in mesh.animations.iter().enumerate() {
        length("clip", index, clip.weights.len(), clip.times.len())?;
        if !clip.tangents.is_empty() {
            length("the tangents of clip", index, clip.tangents.len(), clip.times.len())?;
        }
        for weights in clip.weights.iter().chain(clip.tangents.iter().flatten()) {
            length("a key of clip", index, weights.len(), mesh.targets.len())?;
        }
    }
    if let Some(index) = mesh
        .triangles
        .iter()
        .position(|t| t.iter().any(|&v| v as usize >= vertices))
    {
        return Err(WriteError::OutOfRange {
            mesh: name(),
            what: "triangle",
            index,
        });
    }
    let bad_range =
        |range: &std::ops::Range<u32>| range.start >= range.end || range.end as usize > mesh.triangles.len();
    if let Some(index) = mesh.primitives.iter().position(bad_range) {
        return Err(WriteError::OutOfRange {
            mesh: name(),
            what: "primitive",
            index,
        });
    }
    if vertices == 0 || mesh.primitives.is_empty() {
        return Err(WriteError::Empty(name()));
    }
    Ok(())
}

type Attributes = BTreeMap<Checked<Semantic>, Index<json::Accessor>>;

/// The attributes of the base and of every target, normals included.
fn vertices(mesh: &MorphMesh, root: &mut Root, packer: &mut Packer) -> (Attributes, Vec<MorphTarget>) {
    let normals = shading::smooth_normals(&mesh.positions, &mesh.triangles);
    let flat = |values: &[glam::Vec3]| values.iter().map(glam::Vec3::to_array).collect::<Vec<_>>();
    let attributes = Attributes::from([
        (
            Checked::Valid(Semantic::Positions),
            packer.vertices(root, Type::Vec3, &flat(&mesh.positions), true),
        ),
        (
            Checked::Valid(Semantic::Normals),
            packer.vertices(root, Type::Vec3, &flat(&normals), false),
        ),
        (
            Checked::Valid(Semantic::TexCoords(0)),
            packer.vertices(root, Type::Vec2, &shading::planar_uv(&mesh.positions), false),
        ),
    ]);
    let targets = mesh.targets.iter().enumerate().map(|(index, displacements)| {
        let bent = shading::smooth_normals(&mesh.reference(index), &mesh.triangles);
        let change: Vec<_> = bent.iter().zip(&normals).map(|(&bent, &base)| bent - base).collect();
        MorphTarget {
            positions: (!displacements.is_empty())
                .then(|| packer.vertices(root, Type::Vec3, &flat(displacements), true)),
            normals: Some(packer.vertices(root, Type::Vec3, &flat(&change), false)),
            tangents: None,
        }
    });
    let targets = targets.collect();
    (attributes, targets)
}

fn material(mesh: &MorphMesh, appearance: &Appearance) -> json::Material {
    json::Material {
        name: Some(mesh.name.clone()),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor(appearance.base_color),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(appearance.roughness),
            ..PbrMetallicRoughness::default()
        },
        ..json::Material::default()
    }
}

/// `{"targetNames": [..]}`, the convention of Blender, three.js and Bevy.
fn target_names(mesh: &MorphMesh) -> json::Extras {
    let names = serde_json::json!({ "targetNames": mesh.target_names });
    let raw = RawValue::from_string(names.to_string()).ok()?;
    (!mesh.target_names.is_empty()).then_some(raw)
}

/// One linear or cubic channel on the node's weights. Clips without keys are left out, because glTF has none.
fn animation(clip: &WeightAnimation, node: Index<json::Node>, root: &mut Root, packer: &mut Packer) {
    if clip.times.is_empty() || clip.weights.iter().all(Vec::is_empty) {
        return;
    }
    // glTF wants strictly ascending times, so a jump (two keys at one time) becomes the shortest ramp there is.
    let mut times = clip.times.clone();
    for key in 1..times.len() {
        times[key] = times[key].max(times[key - 1].next_up());
    }
    let input = packer.keys(root, &times, true);
    let (interpolation, weights) = if clip.tangents.is_empty() {
        (Interpolation::Linear, clip.weights.concat())
    } else {
        // A key is its in-tangent, its value and its out-tangent.
        let keys = clip.weights.iter().zip(&clip.tangents);
        let keys = keys.map(|(weights, [arriving, leaving])| [&arriving[..], weights, leaving].concat());
        (Interpolation::CubicSpline, keys.collect::<Vec<_>>().concat())
    };
    let output = packer.keys(root, &weights, false);
    root.push(json::Animation {
        extensions: None,
        extras: None,
        channels: vec![Channel {
            sampler: Index::new(0),
            target: Target {
                extensions: None,
                extras: None,
                node,
                path: Checked::Valid(Property::MorphTargetWeights),
            },
            extensions: None,
            extras: None,
        }],
        name: Some(clip.name.clone()),
        samplers: vec![Sampler {
            extensions: None,
            extras: None,
            input,
            interpolation: Checked::Valid(interpolation),
            output,
        }],
    });
}
