//! Which extensions are read, and what is said about the others.

use std::collections::BTreeSet;

use super::GltfFile;
use super::list::abridged;

/// The two names of the same compression.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";

/// What the reader does with everything that they change in a posed mesh.
const READ: [&str; 7] = [
    MESHOPT[0],
    MESHOPT[1],
    DRACO,
    "KHR_mesh_quantization",
    "KHR_animation_pointer",
    "KHR_node_visibility",
    "EXT_mesh_gpu_instancing",
];

/// Prefixes of extensions that change what is posed or drawn, or that a user of collisions may expect to have an effect. The first that
/// fits counts.
const NOT_APPLIED: [(&str, &str); 24] = [
    (
        "AGI_articulations",
        "parts that it turns by named parameters stay at rest",
    ),
    ("EXT_mesh_lod", DETAIL),
    ("EXT_node_lod", DETAIL),
    (
        "EXT_property_animation",
        "animations of further properties are not applied",
    ),
    ("FB_asset_variants", "variants of the model are not chosen"),
    ("KHR_avatar", CHARACTER),
    (
        "KHR_billboard",
        "nodes that it turns to the viewer keep the rotations of the file",
    ),
    ("KHR_character", CHARACTER),
    ("KHR_collision_shapes", SHAPES),
    ("KHR_implicit_shapes", SHAPES),
    ("KHR_interactivity", "its behaviour graphs are not run"),
    ("KHR_physics_", PHYSICS),
    ("KHR_rigid_bodies", PHYSICS),
    (
        "MAXAR_mesh_variants",
        "the meshes that nodes name are read, and no variant of them",
    ),
    (
        "MOZ_hubs_components",
        "what its components show, hide and move is not applied",
    ),
    ("MSFT_lod", DETAIL),
    ("OMI_collider", SHAPES),
    ("OMI_physics_shape", SHAPES),
    ("OMI_physics_", PHYSICS),
    ("OMI_vehicle_", PHYSICS),
    (
        "VRMC_node_constraint",
        "its constraints are not applied, so constrained nodes keep the transforms of the file and its clips",
    ),
    (
        "VRMC_springBone",
        "its springs are not applied, so hair and clothes follow the joints of the file and its clips",
    ),
    (
        "VRMC_vrm_animation",
        "expressions and gaze in its clips are not applied",
    ),
    ("VRMC_vrm", "its expressions are read; gaze is not applied"),
];

const DETAIL: &str = "simpler versions for far viewers are not chosen; what the scene itself draws is read";
const CHARACTER: &str = "its expressions and virtual joints are not read";
const PHYSICS: &str = "its physics is not simulated, so nodes stay where the file and its clips put them";
const SHAPES: &str = "its simplified shapes are not read; the meshes themselves collide";

/// VRM 0.x, which has no prefix.
const VRM: &str = "VRM";
const OF_VRM: &str = "its expressions are read; springs and gaze are not applied";

/// Prefixes of extensions that change neither what is drawn nor where: materials, textures, lights, sounds and metadata.
const HARMLESS: [&str; 38] = [
    "ADOBE_materials_",
    "AGI_metadata",
    "AGI_stk_metadata",
    "BENTLEY_materials_",
    "CESIUM_primitive_outline",
    "EXT_image_",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_manifold",
    "EXT_materials_",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_mesh_primitive_edge_visibility",
    "EXT_property_",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_geometry_metadata",
    "FB_material",
    "FB_ngon_encoding",
    "GODOT_single_root",
    "GOOGLE_",
    "KHR_audio",
    "KHR_environment_map",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_techniques_webgl",
    "KHR_texture_",
    "KHR_xmp",
    "MOZ_alt_materials",
    "MOZ_lightmap",
    "MOZ_texture_",
    "MSFT_audio_",
    "MSFT_packing_",
    "MSFT_texture_",
    "OMI_",
    "VRMC_materials_",
];

/// How the reader treats an extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Support {
    /// All that it does to posed meshes is read.
    Read,
    /// It does nothing to posed meshes.
    Harmless,
    /// It does something to them that is not applied; a sentence says what.
    NotApplied(&'static str),
    /// Nothing is known of it. It might change geometry.
    Unknown,
}

pub(super) fn support(extension: &str) -> Support {
    let fits = |prefix: &str| extension.starts_with(prefix);
    if READ.contains(&extension) {
        Support::Read
    } else if extension == VRM {
        Support::NotApplied(OF_VRM)
    } else if let Some((_, note)) = NOT_APPLIED.iter().find(|(prefix, _)| fits(prefix)) {
        Support::NotApplied(note)
    } else if HARMLESS.iter().any(|prefix| fits(prefix)) {
        Support::Harmless
    } else {
        Support::Unknown
    }
}

impl GltfFile {
    /// One sentence for each extension that the file uses and whose effect on posed meshes is not read, or not known, in the order of
    /// their names; `NAME: what is not applied`. Also says if the expressions of an avatar cannot be read.
    #[must_use]
    pub fn extension_notes(&self) -> Vec<String> {
        let named = [&self.root.extensions_used, &self.root.extensions_required];
        let named: BTreeSet<&String> = named.into_iter().flatten().collect();
        let note = |name: &String| match support(name) {
            Support::Read | Support::Harmless => None,
            Support::NotApplied(note) => Some(format!("{}: {note}", abridged(name))),
            Support::Unknown => Some(format!(
                "{}: this extension is unknown, and the file is read without it",
                abridged(name)
            )),
        };
        let mut notes: Vec<String> = named.into_iter().filter_map(note).collect();
        if let Err((extension, problem)) = self.read_expressions() {
            notes.push(format!(
                "{extension}: its expressions cannot be read, because it {problem}"
            ));
        }
        notes
    }

    /// Whether the file says that readers need to know one of these extensions.
    pub(super) fn requires(&self, extensions: &[&str]) -> bool {
        let mut required = self.root.extensions_required.iter();
        required.any(|name| extensions.contains(&name.as_str()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_posed_meshes_is_read_or_named() {
        for extension in READ {
            assert_eq!(support(extension), Support::Read, "{extension}");
        }
        for extension in [
            "KHR_xmp_json_ld",
            "KHR_texture_transform",
            "KHR_materials_variants",
            "EXT_texture_webp",
            "EXT_mesh_features",
            "KHR_node_hoverability",
            "KHR_node_selectability",
            "KHR_audio_emitter",
            "VRMC_materials_mtoon",
            "OMI_spawn_point",
        ] {
            assert_eq!(support(extension), Support::Harmless, "{extension}");
        }
        for (extension, says) in [
            ("VRM", "springs"),
            ("VRMC_vrm", "gaze"),
            ("VRMC_vrm_animation", "clips"),
            ("VRMC_springBone", "springs"),
            ("VRMC_springBone_extended_collider", "springs"),
            ("VRMC_node_constraint", "constraints"),
            ("KHR_physics_rigid_bodies", "simulated"),
            ("OMI_physics_body", "simulated"),
            ("OMI_physics_shape", "simplified shapes"),
            ("MSFT_lod", "simpler versions"),
            ("AGI_articulations", "stay at rest"),
        ] {
            let found = support(extension);
            assert!(
                matches!(found, Support::NotApplied(note) if note.contains(says)),
                "{extension}: {found:?}"
            );
        }
        for extension in [
            "VRMX",
            "KHR_node_something",
            "KHR_gaussian_splatting",
            "KHR_mesh_primitive_restart",
            "EXT_mesh_polygon",
            "",
        ] {
            assert_eq!(support(extension), Support::Unknown, "{extension}");
        }
    }
}
