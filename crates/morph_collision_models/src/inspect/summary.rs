//! One line per mesh, or per file.

use std::fmt::{self, Display, Formatter};

use serde::Serialize;

use super::report::{FileReport, MeshReport};
use super::text::{cut, table};
use crate::text::Grouped;
use crate::text::Printable;

/// One line per file, and their totals.
#[derive(Debug, Default, Serialize)]
pub struct Summary {
    /// One row per file.
    pub files: Vec<SummaryRow>,
}

/// The meshes of a file that can collide, together.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SummaryRow {
    /// The file's name as it was given.
    pub file: String,
    /// Meshes in the file.
    pub meshes: usize,
    /// Meshes that can collide. All further numbers are about these.
    pub usable: usize,
    /// Triangles.
    pub triangles: usize,
    /// Vertices after those in the same place are welded.
    pub vertices: usize,
    /// Targets.
    pub targets: usize,
    /// Joints.
    pub joints: usize,
    /// Animations in the file.
    pub animations: usize,
    /// Number of warnings.
    pub warnings: usize,
    /// Why the file cannot be used at all, or else the first mesh that cannot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
}

impl SummaryRow {
    /// The row of a file.
    #[must_use]
    pub fn of(report: &FileReport) -> Self {
        let usable = || {
            report
                .meshes
                .iter()
                .filter_map(|mesh| Some((mesh, mesh.usable.as_ref()?)))
        };
        let of_mesh = |mesh: &MeshReport| mesh.warnings.len() + usize::from(mesh.left_out.is_some());
        let warnings = report.meshes.iter().map(of_mesh);
        let broken = report.meshes.iter().find(|mesh| mesh.usable.is_none());
        let broken = broken.map(|mesh| {
            let error = mesh.error.as_deref().unwrap_or_default();
            format!("mesh {} \"{}\": {error}", mesh.index, Printable(&mesh.name))
        });
        Self {
            file: report.file.clone(),
            meshes: report.meshes.len(),
            usable: usable().count(),
            triangles: usable().map(|(mesh, _)| mesh.triangles).sum(),
            vertices: usable().map(|(_, usable)| usable.vertices_welded).sum(),
            targets: usable().map(|(_, usable)| usable.targets.len()).sum(),
            joints: usable()
                .filter_map(|(mesh, _)| Some(mesh.skin.as_ref()?.joints.len()))
                .sum(),
            animations: report.animations.len(),
            warnings: report.warnings.len() + warnings.sum::<usize>(),
            problem: report.why_unusable().or(broken),
        }
    }

    /// The row of a file that cannot be read.
    #[must_use]
    pub fn unreadable(file: String, problem: String) -> Self {
        Self {
            file,
            problem: Some(problem),
            ..Self::default()
        }
    }
}

/// A table with one row per file, and a line with the totals.
impl Display for Summary {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let grouped = |number: usize| Grouped(number as u64).to_string();
        let header = [
            "file",
            "meshes",
            "usable",
            "triangles",
            "vertices",
            "targets",
            "joints",
            "animations",
            "warnings",
            "problem",
        ];
        let row = |row: &SummaryRow| {
            vec![
                Printable(&row.file).to_string(),
                grouped(row.meshes),
                grouped(row.usable),
                grouped(row.triangles),
                grouped(row.vertices),
                grouped(row.targets),
                grouped(row.joints),
                grouped(row.animations),
                grouped(row.warnings),
                row.problem
                    .as_deref()
                    .map(|problem| Printable(problem).to_string())
                    .unwrap_or_default(),
            ]
        };
        let rows: Vec<Vec<String>> = self.files.iter().map(row).collect();
        f.write_str(&table(&header, &rows, &[0, 9]))?;
        let total = |count: fn(&SummaryRow) -> usize| grouped(self.files.iter().map(count).sum());
        writeln!(
            f,
            "{} files: {} of {} meshes can collide; {} triangles, {} vertices, {} targets",
            grouped(self.files.len()),
            total(|row| row.usable),
            total(|row| row.meshes),
            total(|row| row.triangles),
            total(|row| row.vertices),
            total(|row| row.targets)
        )
    }
}

/// A table with one row per mesh of a file.
pub(super) fn meshes(meshes: &[MeshReport]) -> String {
    let grouped = |number: usize| Grouped(number as u64).to_string();
    let header = [
        "mesh",
        "name",
        "triangles",
        "vertices",
        "targets",
        "joints",
        "clips",
        "problem",
    ];
    let row = |mesh: &MeshReport| {
        let usable = mesh.usable.as_ref();
        let joints = mesh.skin.as_ref().map_or(0, |skin| skin.joints.len());
        let mut clips: Vec<usize> = mesh.animations.iter().map(|clip| clip.animation).collect();
        clips.extend(mesh.skin.iter().flat_map(|skin| &skin.clips).map(|clip| clip.animation));
        clips.sort_unstable();
        clips.dedup();
        vec![
            mesh.index.to_string(),
            cut(&mesh.name),
            grouped(mesh.triangles),
            grouped(usable.map_or(mesh.vertices_stored, |usable| usable.vertices_welded)),
            grouped(usable.map_or(0, |usable| usable.targets.len())),
            grouped(joints),
            grouped(clips.len()),
            mesh.error
                .as_deref()
                .map(|error| Printable(error).to_string())
                .unwrap_or_default(),
        ]
    };
    let rows: Vec<Vec<String>> = meshes.iter().map(row).collect();
    table(&header, &rows, &[1, 7])
}
