//! Which extensions a file may require.

/// Prefixes of extensions that do not change the geometry of a mesh.
const IGNORED: [&str; 31] = [
    "ADOBE_materials_",
    "AGI_",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_materials_",
    "EXT_mesh_features",
    "EXT_mesh_gpu_instancing",
    "EXT_property_",
    "EXT_structural_metadata",
    "EXT_texture_",
    "FB_",
    "GOOGLE_",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_collision_shapes",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_lights_",
    "KHR_materials_",
    "KHR_node_",
    "KHR_physics_",
    "KHR_rigid_bodies",
    "KHR_texture_",
    "KHR_xmp",
    "MOZ_",
    "MSFT_audio_",
    "MSFT_lod",
    "MSFT_packing_",
    "MSFT_texture_",
    "OMI_",
    "VRMC_",
];

/// VRM 0.x, which has no prefix.
const VRM: &str = "VRM";

/// The two names of the same compression.
pub(super) const MESHOPT: [&str; 2] = ["EXT_meshopt_compression", "KHR_meshopt_compression"];
pub(super) const DRACO: &str = "KHR_draco_mesh_compression";
const QUANTIZATION: &str = "KHR_mesh_quantization";

/// How the reader treats an extension that a file requires.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Support {
    /// It changes how geometry is stored, and the reader knows how.
    Read,
    /// It does not change the geometry of a mesh.
    Ignored,
    /// It might change geometry.
    Unknown,
}

pub(super) fn support(extension: &str) -> Support {
    if MESHOPT.contains(&extension) || extension == DRACO || extension == QUANTIZATION {
        Support::Read
    } else if extension == VRM || IGNORED.iter().any(|prefix| extension.starts_with(prefix)) {
        Support::Ignored
    } else {
        Support::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_changes_geometry_is_read_or_refused_and_the_rest_is_ignored() {
        for extension in [
            "KHR_draco_mesh_compression",
            "EXT_meshopt_compression",
            "KHR_mesh_quantization",
        ] {
            assert_eq!(support(extension), Support::Read, "{extension}");
        }
        for extension in [
            "VRM",
            "VRMC_vrm",
            "VRMC_springBone",
            "KHR_xmp_json_ld",
            "KHR_node_visibility",
            "KHR_animation_pointer",
            "KHR_texture_basisu",
            "EXT_texture_webp",
            "KHR_physics_rigid_bodies",
            "KHR_audio_emitter",
        ] {
            assert_eq!(support(extension), Support::Ignored, "{extension}");
        }
        for extension in [
            "VRMX",
            "KHR_gaussian_splatting",
            "KHR_mesh_primitive_restart",
            "EXT_mesh_polygon",
            "",
        ] {
            assert_eq!(support(extension), Support::Unknown, "{extension}");
        }
    }
}
