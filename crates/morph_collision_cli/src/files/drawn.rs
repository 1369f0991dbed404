//! Which of a file's meshes a command takes: those that a scene draws.

use clap::Args;
use morph_collision_models::gltf::read::{DrawnMesh, Extent, GltfFile};
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use crate::error::CliError;
use crate::messages;
use crate::messages::counted;

/// Which meshes of a model are taken, unless one is named.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct DrawnArgs {
    /// Take what this scene of the file draws: its index, or its name.
    ///
    /// By default, the scene that the file names is taken, or its first. Nodes that are hidden (`KHR_node_visibility`) are left out, and each
    /// instance of a node (`EXT_mesh_gpu_instancing`) is a body. A file without scenes is taken as a whole.
    #[arg(long, value_name = "SCENE", conflicts_with = "all_meshes")]
    scene: Option<String>,
    /// Take all meshes of the file, whether a scene draws them or not.
    #[arg(long)]
    all_meshes: bool,
}

impl DrawnArgs {
    /// Everything that is drawn, in the order of meshes, nodes and instances. Says on standard error what is left out.
    pub(crate) fn drawn(&self, file: &GltfFile) -> Result<Vec<DrawnMesh>, CliError> {
        let extent = self.extent(file)?;
        let drawing = file.drawing(extent)?;
        for broken in &drawing.broken {
            messages::complain(format_args!("warning: left out: {broken}"));
        }
        let parts = [
            (drawing.meshes_left_out, "mesh", "meshes"),
            (drawing.nodes_left_out, "node with a mesh", "nodes with meshes"),
        ];
        let parts = parts.into_iter().filter(|(count, ..)| *count > 0);
        let parts: Vec<String> = parts.map(|(count, one, many)| counted(count, one, many)).collect();
        if !parts.is_empty() {
            messages::complain(format_args!(
                "note: {}: the scene does not draw {}; --all-meshes takes everything",
                file.path().display(),
                parts.join(" and ")
            ));
        }
        Ok(drawing.drawn)
    }

    /// Refuses the options where `reason` says that they have no effect.
    pub(crate) fn refuse(&self, reason: &str) -> Result<(), CliError> {
        for (flag, given) in [("--scene", self.scene.is_some()), ("--all-meshes", self.all_meshes)] {
            if given {
                let reason = reason.to_owned();
                return Err(CliError::Flag { flag, reason });
            }
        }
        Ok(())
    }

    fn extent(&self, file: &GltfFile) -> Result<Extent, CliError> {
        let Some(scene) = &self.scene else {
            return Ok(match self.all_meshes {
                true => Extent::Everything,
                false => Extent::DefaultScene,
            });
        };
        let names = file.scene_names();
        let by_index = scene.parse().ok().filter(|&index: &usize| index < names.len());
        let found = by_index.or_else(|| names.iter().position(|name| name == scene));
        found.map(Extent::Scene).ok_or_else(|| CliError::Flag {
            flag: "--scene",
            reason: format!(
                "{} has no scene \"{}\"; it has {}{}",
                file.path().display(),
                Printable(scene),
                counted(names.len(), "scene", "scenes"),
                suggestion(scene, names.iter().map(String::as_str))
            ),
        })
    }
}

/// Says on standard error if a mesh is taken that the default scene does not draw, although it draws others.
pub(crate) fn note_if_not_drawn(file: &GltfFile, mesh: usize) {
    let drawing = file.budget().lend(|| file.drawing(Extent::DefaultScene));
    let Ok(drawing) = drawing else { return };
    let first = drawing.drawn.first().map(|drawn| drawn.mesh);
    if let Some(first) = first.filter(|_| drawing.drawn.iter().all(|drawn| drawn.mesh != mesh)) {
        let (file, name) = (file.path().display(), file.mesh_name(mesh));
        let name = Printable(&name);
        messages::complain(format_args!(
            "note: {file}: the scene does not draw mesh {mesh} \"{name}\"; the first mesh that it draws is {first}, and --mesh chooses one"
        ));
    }
}
