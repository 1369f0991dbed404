//! Writes one mesh with its targets and clips as a binary glTF 2.0 file (`.glb`). The same mesh always gives the same bytes.
//!
//! A skinned mesh is written with its influences, its joints with all their ancestors, and their clips (`skin`, `animation`). The
//! file also gets what a renderer needs: smooth normals for the base and every target (`shading`), planar texture coordinates and
//! one material. The layout is one buffer; `buffer` packs it.

mod animation;
mod buffer;
mod check;
mod shading;
mod skin;

use std::{collections::BTreeMap, path::Path};

use gltf_json::{
    self as json, Index, Root,
    accessor::Type,
    material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor},
    mesh::{MorphTarget, Primitive, Semantic},
    validation::Checked,
};
use serde_json::value::RawValue;

pub use self::check::WriteError;

use self::animation::Animated;
use self::buffer::Packer;
use crate::mesh::MorphMesh;

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

/// Writes `mesh` to `path`, replacing an existing file.
///
/// # Errors
/// Those of [`to_glb`], and if the file cannot be written.
pub fn write_glb(path: &Path, mesh: &MorphMesh, appearance: &Appearance) -> Result<(), WriteError> {
    let bytes = to_glb(mesh, appearance)?;
    std::fs::write(path, bytes).map_err(|source| WriteError::Io {
        path: path.to_owned(),
        source,
    })
}

/// The bytes of a `.glb` file: one scene with one node that shows `mesh`, and the nodes of its skeleton if it has a skin.
///
/// A weight clip and a joint clip with the same name become one animation of the file, if that keeps both kinds in order. Joints
/// with several roots get one common root, as glTF requires.
///
/// All primitives share the vertices. Each has its own indices, with 16 bits if they fit.
///
/// # Errors
/// [`WriteError`] if the mesh is empty, or its lists do not match.
pub fn to_glb(mesh: &MorphMesh, appearance: &Appearance) -> Result<Vec<u8>, WriteError> {
    to_glb_of_parts(mesh, std::slice::from_ref(appearance))
}

/// Like [`to_glb`], with an appearance for each primitive; the last one is that of all further primitives.
///
/// # Errors
/// See [`to_glb`].
pub fn to_glb_of_parts(mesh: &MorphMesh, appearances: &[Appearance]) -> Result<Vec<u8>, WriteError> {
    check::check(mesh)?;
    let mut root = Root {
        asset: asset(),
        ..Root::default()
    };
    let mut packer = Packer::default();

    let (mut attributes, targets) = vertices(mesh, &mut root, &mut packer);
    if let Some(skin) = &mesh.skin {
        skin::add_influences(skin, &mut attributes, &mut root, &mut packer);
    }
    let materials: Vec<_> = appearances
        .iter()
        .map(|appearance| root.push(material(mesh, appearance)))
        .collect();
    let primitives = mesh.primitives.iter().enumerate().map(|(index, range)| {
        let triangles = &mesh.triangles[range.start as usize..range.end as usize];
        Primitive {
            attributes: attributes.clone(),
            extensions: None,
            extras: None,
            indices: Some(packer.indices(&mut root, triangles.as_flattened(), mesh.positions.len())),
            material: materials.get(index).or(materials.last()).copied(),
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
        weights: (!mesh.targets.is_empty()).then(|| mesh.weights_at_rest()),
    });
    let node = root.push(json::Node {
        mesh: Some(json_mesh),
        name: Some(mesh.name.clone()),
        ..json::Node::default()
    });
    let skeleton = mesh.skin.as_ref().map(|skin| &skin.skeleton);
    let bones = skeleton.map(|skeleton| skin::bones(skeleton, &mut root, &mut packer));
    root.nodes[node.value()].skin = bones.as_ref().map(|bones| bones.skin);
    let animated = Animated {
        mesh: node,
        bones: bones.as_ref().map_or(&[], |bones| &bones.nodes),
    };
    let clips = skeleton.map_or(&[][..], |skeleton| &skeleton.clips);
    animation::write(&mesh.animations, clips, &animated, &mut root, &mut packer);
    let scene = json::Scene {
        extensions: None,
        extras: None,
        name: None,
        nodes: std::iter::once(node).chain(bones.map(|bones| bones.root)).collect(),
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
        // The name of the crate that this code came from. The files in the repository's `assets/` have it, and stay the same to the last bit.
        generator: Some("morph_collision_testkit".into()),
        ..json::Asset::default()
    }
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
