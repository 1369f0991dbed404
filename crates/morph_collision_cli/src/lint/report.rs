//! The findings as JSON, and in words.

use std::path::PathBuf;

use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::text::{Grouped, number};
use morph_collision_models::weight_list::WeightList;
use serde::Serialize;

use super::findings::Finding;
use super::members::{Member, MeshTriangles, by_mesh, member_of};
use super::parts::Parts;
use super::proof::ProofReport;
use super::source::{Kind, Source};
use super::subject::{JoinedMesh, Subject};
use super::suggest::Suggestion;
use crate::touching::blame::Blame;
use crate::touching::depth::ThresholdArgs;

/// If there are more weights, the table has only the names of those that matter most.
const MOST_WEIGHTS: usize = 4;

/// The JSON of `lint`.
#[derive(Debug, Serialize)]
pub(super) struct LintReport {
    pub(super) model: PathBuf,
    /// What counts.
    #[serde(skip)]
    pub(super) thresholds: ThresholdArgs,
    pub(super) meshes: Vec<MeshReport>,
}

#[derive(Debug, Serialize)]
pub(super) struct MeshReport {
    pub(super) mesh: usize,
    pub(super) name: String,
    pub(super) triangles: usize,
    pub(super) targets: usize,
    /// The meshes that it consists of, if there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) joined: Vec<JoinedMesh>,
    /// Pairs of triangles that touch at rest. They are not reported.
    pub(super) pairs_at_rest: usize,
    /// Triangles that are left out because they have a vertex without joint weights.
    pub(super) left_out: usize,
    /// The number of shapes that were tried.
    pub(super) shapes: usize,
    /// What was tried, and how much was found with it.
    pub(super) sources: Vec<SourceReport>,
    /// What is proved for all weights, if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) proof: Option<ProofReport>,
    pub(super) findings: Vec<FindingReport>,
    /// The largest weights that do not clip, if they were asked for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub(super) suggestions: Vec<Suggestion>,
}

/// The shapes of one kind.
#[derive(Debug, Serialize)]
pub(super) struct SourceReport {
    pub(super) kind: Kind,
    /// The number of shapes that were tried.
    pub(super) shapes: usize,
    pub(super) findings: usize,
}

#[derive(Debug, Serialize)]
pub(super) struct FindingReport {
    /// `target`, `clip`, `capture`, `pair`, `expression`, `proof` or `mixture`.
    kind: Kind,
    /// The kind and a name.
    pub(super) found_with: String,
    /// Seconds of a clip, the row of a capture, or the number of a mixture, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    at: Option<f64>,
    #[serde(serialize_with = "number")]
    pub(super) depth: f64,
    /// The diagonal of the box around all contacts in the worst shape.
    #[serde(serialize_with = "number")]
    length: f64,
    /// Pairs of triangles in the worst shape.
    pub(super) pairs: usize,
    /// Whether the worst shapes had more pairs than are looked at.
    pub(super) is_truncated: bool,
    /// The number of shapes in which it was found.
    shapes: usize,
    /// Materials and pieces of the mesh.
    parts: Vec<String>,
    /// The targets that can move the place most, whatever their weights.
    near: Vec<String>,
    /// The targets that move it most in the worst shape.
    targets: Vec<String>,
    joints: Vec<String>,
    /// Weights that differ from those at rest.
    weights: WeightList,
    /// Options of `query` and `export` that give the worst shape of the first mesh.
    pub(super) reproduce: String,
    /// The triangles that touch in any of the shapes, with their numbers in their meshes.
    pub(super) meshes: Vec<MeshTriangles>,
    /// Whether the baseline has it.
    pub(super) accepted: bool,
    /// An SVG, for the page.
    #[serde(skip)]
    pub(super) picture: Option<String>,
}

impl FindingReport {
    pub(super) fn new(finding: &Finding, subject: &Subject, parts: &Parts) -> Self {
        let Subject { mesh, index, .. } = subject;
        let blame = Blame::new(mesh);
        let ones = vec![1.0; mesh.targets.len()];
        let (targets, joints) = blame.movers_of(&finding.worst.triangles, &finding.weights);
        let weights = named(subject, &finding.weights);
        let first = finding.worst.triangles.first().copied().unwrap_or_default();
        let member = member_of(&subject.members, first);
        let index = member.map_or(*index, |member| member.mesh);
        let reproduce = match (&finding.source, finding.moment) {
            (Source::Clip(name), Some(seconds)) => format!("--mesh {index} --clip {} --time {seconds}", shell(name)),
            _ => {
                let own = member.map(|member| own_weights(subject, member, &finding.weights));
                let list: Vec<String> = own
                    .into_iter()
                    .flatten()
                    .map(|(name, weight)| format!("{name}={weight}"))
                    .collect();
                format!("--mesh {index} --weights {}", shell(&list.join(",")))
            }
        };
        Self {
            kind: finding.source.kind(),
            found_with: finding.source.words(&mesh.target_names),
            at: finding.moment,
            depth: finding.worst.depth,
            length: finding.worst.length,
            pairs: finding.worst.pairs,
            is_truncated: finding.is_truncated,
            shapes: finding.shapes,
            parts: parts.names(&finding.worst.triangles),
            near: blame.movers_of(&finding.worst.triangles, &ones).0,
            targets,
            joints,
            weights: WeightList::Named(weights),
            reproduce,
            meshes: by_mesh(&subject.members, &finding.touching),
            accepted: false,
            picture: None,
        }
    }

    /// What is where, in a few words.
    pub(super) fn place(&self) -> String {
        let near = match &self.near[..] {
            [] => String::new(),
            near => format!("near {}", near.join(", ")),
        };
        let parts = self.parts.join(" and ");
        [parts, near]
            .into_iter()
            .filter(|words| !words.is_empty())
            .collect::<Vec<_>>()
            .join(", ")
    }

    /// The weights, or when a clip or a capture has them.
    pub(super) fn shape(&self) -> String {
        let at = self.at.unwrap_or_default();
        match self.kind {
            Kind::Clip => format!("at {at:.3} s"),
            Kind::Capture => format!("row {at}"),
            _ => {
                let WeightList::Named(weights) = &self.weights else {
                    return String::new();
                };
                let listed: Vec<String> = weights
                    .iter()
                    .map(|(name, weight)| format!("{name}={weight}"))
                    .collect();
                match weights.len() {
                    count if count > MOST_WEIGHTS => {
                        format!("{count} weights, mostly {}", self.targets.join(", "))
                    }
                    _ => listed.join(","),
                }
            }
        }
    }
}

/// The weights that differ from those at rest, by name, or by index if a name is not unique. Targets that move with others are left out.
fn named(subject: &Subject, weights: &[f32]) -> Vec<(String, f32)> {
    let differs = differing(&subject.mesh, weights);
    let differs = differs.filter(|&target| !subject.follows(target, weights));
    let names = &subject.mesh.target_names;
    differs.map(|target| (unique(names, target), weights[target])).collect()
}

/// The same for one of the meshes, with the names of its own targets.
fn own_weights(subject: &Subject, member: &Member, weights: &[f32]) -> Vec<(String, f32)> {
    let differing: Vec<usize> = differing(&subject.mesh, weights).collect();
    let own = member.targets.iter().enumerate();
    let own = own.filter(|(_, target)| differing.contains(target));
    own.map(|(own, &target)| (unique(&member.target_names, own), weights[target]))
        .collect()
}

fn differing(mesh: &MorphMesh, weights: &[f32]) -> impl Iterator<Item = usize> {
    let both = weights.iter().zip(mesh.weights_at_rest()).enumerate();
    both.filter(|(_, (weight, rest))| *weight != rest)
        .map(|(target, _)| target)
}

fn unique(names: &[String], target: usize) -> String {
    let name = &names[target];
    match names.iter().filter(|other| *other == name).count() {
        1 => name.clone(),
        _ => target.to_string(),
    }
}

/// Text as a word of a command line.
fn shell(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "=,._-+/".contains(c);
    match !text.is_empty() && text.chars().all(is_plain) {
        true => text.to_owned(),
        false => format!("'{}'", text.replace('\'', "'\\''")),
    }
}

impl LintReport {
    /// The findings that the baseline does not have.
    pub(super) fn unaccepted(&self) -> usize {
        self.all().filter(|finding| !finding.accepted).count()
    }

    /// All findings.
    pub(super) fn all(&self) -> impl Iterator<Item = &FindingReport> {
        self.meshes.iter().flat_map(|mesh| &mesh.findings)
    }

    /// The number of shapes that were tried.
    pub(super) fn shapes(&self) -> usize {
        self.meshes.iter().map(|mesh| mesh.shapes).sum()
    }
}

impl MeshReport {
    /// How many findings each kind of source has.
    pub(super) fn by_source(&self) -> String {
        let count =
            |source: &SourceReport| format!("{} {}", Grouped(source.findings as u64), source.kind.of_findings());
        let counts: Vec<String> = self.sources.iter().map(count).collect();
        format!("findings: {}", counts.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_quoted_for_the_shell_if_they_have_to_be() {
        assert_eq!(shell("jawOpen=0.5,a_b=1"), "jawOpen=0.5,a_b=1");
        assert_eq!(shell("it's open=1"), "'it'\\''s open=1'");
        assert_eq!(shell(""), "''");
    }

    #[test]
    fn weights_at_rest_are_left_out_and_double_names_become_indices() {
        let mesh = MorphMesh {
            target_names: ["a", "b", "b", "c"].map(str::to_owned).to_vec(),
            targets: vec![Vec::new(); 4],
            default_weights: vec![0.0, 0.0, 0.0, 0.5],
            ..MorphMesh::default()
        };
        let subject = Subject {
            leaders: (0..4).collect(),
            mesh,
            ..Subject::default()
        };
        let weights = named(&subject, &[1.0, 0.0, 0.25, 0.0]);
        assert_eq!(
            weights,
            [("a".to_owned(), 1.0), ("2".to_owned(), 0.25), ("c".to_owned(), 0.0)]
        );
    }
}
