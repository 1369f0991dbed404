//! Tries all shapes of one mesh.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::Arc;

use morph_collision::MorphBvh;
use morph_collision::proof::Effort;
use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::inspect::MeshError;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::text::Printable;

use super::capture::Capture;
use super::findings::{Finding, Findings};
use super::input::{refused, shape_words};
use super::mixtures::Mixtures;
use super::options::LintOptions;
use super::parts::Parts;
use super::picture;
use super::poses::{Stage, Tried, clip_stages, expressions};
use super::proof::{ProofReport, prove};
use super::report::{FindingReport, MeshReport, SourceReport};
use super::search::{Known, Rules, Searcher, in_order};
use super::source::{Kind, Source};
use super::subject::Subject;
use super::suggest::{Suggestion, suggest};
use crate::error::CliError;
use crate::error::PoseError;
use crate::files::model::count_memory;
use crate::messages;
use crate::messages::progress;

/// More threads do not help, and each has a pose.
const MOST_THREADS: usize = 64;
/// Upper bound on the bytes that a pair of triangles takes in a list of known pairs.
const BYTES_PER_KNOWN_PAIR: u64 = 32;
/// At most this many findings of a mesh get a picture: the first.
const MOST_PICTURES: usize = 60;

/// Tries all shapes of a mesh.
pub(super) fn lint_mesh(options: &LintOptions, file: &GltfFile, subject: &Subject) -> Result<MeshReport, CliError> {
    let (index, mesh) = (subject.index, &subject.mesh);
    let threads = options.threads.map_or_else(
        || std::thread::available_parallelism().map_or(1, NonZeroUsize::get),
        NonZeroUsize::get,
    );
    let threads = threads.min(MOST_THREADS);
    let bytes = mesh.tree_bytes() + threads as u64 * mesh.body_bytes(false);
    count_memory(file, index, bytes, || "its tree and a pose per thread".to_owned())?;
    // The table of pieces.
    count_memory(file, index, 64 * mesh.triangles.len() as u64, || {
        "its pieces".to_owned()
    })?;
    progress::doing(format!("building the tree of {} triangles", mesh.triangles.len()));
    let fail = |reason: MeshError| CliError::Mesh {
        file: options.model.clone(),
        mesh: index,
        name: mesh.name.clone(),
        reason,
    };
    let model = mesh.to_model().map_err(|reason| fail(reason.into()))?;
    let tree = Arc::new(MorphBvh::build(Arc::new(model), &options.tree));
    let rules = Rules {
        garment_from: subject.garment_from,
        thresholds: options.thresholds,
    };
    let mut lint = Lint {
        options,
        file,
        index,
        subject,
        mesh,
        searchers: (0..threads).map(|_| Searcher::new(&tree, rules)).collect(),
        at_rest: Known::default(),
        alone: Vec::new(),
        findings: Findings::default(),
        tried: BTreeMap::new(),
    };
    lint.look_at_rest()?;
    let moving = subject.moving();
    let mut stages = vec![Stage::Alone(moving.clone()), Stage::Pairs(lint.pairs(&moving)?)];
    let (fps, is_loop) = (options.fps, options.is_loop);
    stages.extend(clip_stages(file, subject, &options.clip, fps, is_loop));
    for path in &options.capture {
        stages.push(Stage::Capture(lint.capture(path)?));
    }
    stages.push(expressions(subject));
    for stage in &stages {
        lint.try_stage(stage)?;
    }
    if !moving.is_empty() {
        lint.try_stage(&Stage::Mixtures(Mixtures::new(
            options.mixtures,
            options.seed,
            moving,
            &stages,
        )))?;
    }
    let proof = if options.prove { lint.prove(&tree)? } else { None };
    lint.finish(&tree, proof)
}

/// What is known of a mesh so far.
struct Lint<'a> {
    options: &'a LintOptions,
    file: &'a GltfFile,
    index: usize,
    subject: &'a Subject,
    mesh: &'a MorphMesh,
    searchers: Vec<Searcher>,
    at_rest: Known,
    /// What each target does alone. Empty unless pairs of targets are tried.
    alone: Vec<Known>,
    findings: Findings,
    /// The number of shapes that were tried.
    tried: BTreeMap<Kind, usize>,
}

impl Lint<'_> {
    fn look_at_rest(&mut self) -> Result<(), CliError> {
        progress::doing("looking at the rest shape");
        let weights = self.mesh.weights_at_rest();
        let skeleton = self.mesh.skin.as_ref().map(|skin| &skin.skeleton);
        let rest = Tried {
            source: Source::Mixtures,
            moment: None,
            weights,
            joints: skeleton.map(|skeleton| skeleton.world_from_mesh(None, 0.0)),
        };
        let most = usize::try_from(self.file.budget().left() / (4 * BYTES_PER_KNOWN_PAIR)).unwrap_or(usize::MAX);
        let found = self.searchers[0].new_pairs(&rest, &[], most);
        let (pairs, is_truncated) = found.map_err(|reason| self.refused("the rest shape".to_owned(), reason))?;
        if is_truncated {
            return Err(CliError::TooManySelfPairs {
                file: self.options.model.clone(),
                mesh: self.index,
                most,
            });
        }
        self.keep(pairs.len())?;
        self.at_rest = pairs.into_iter().collect();
        Ok(())
    }

    /// All pairs of targets, if they are asked for.
    fn pairs(&mut self, moving: &[usize]) -> Result<Vec<[usize; 2]>, CliError> {
        let mut pairs = Vec::new();
        if self.options.pairs {
            let count = moving.len() as u64 * (moving.len() as u64).saturating_sub(1) / 2;
            count_memory(self.file, self.index, 16 * count, || {
                "the pairs of its targets".to_owned()
            })?;
            for (i, &a) in moving.iter().enumerate() {
                pairs.extend(moving[i + 1..].iter().map(|&b| [a, b]));
            }
            self.alone = vec![Known::default(); self.mesh.targets.len()];
        }
        Ok(pairs)
    }

    fn capture(&self, path: &Path) -> Result<Capture, CliError> {
        let capture = Capture::read(path, &self.mesh.target_names, &self.options.files, self.file.budget())?;
        let name = Printable(&capture.name);
        for column in &capture.ignored {
            let column = Printable(column);
            messages::complain(format_args!(
                "warning: {name}: ignored the column \"{column}\", which is not a target"
            ));
        }
        if capture.more_ignored > 0 {
            let more = messages::counted(capture.more_ignored, "more column that is", "more columns that are");
            messages::complain(format_args!("warning: {name}: ignored {more} not a target"));
        }
        Ok(capture)
    }

    fn try_stage(&mut self, stage: &Stage<'_>) -> Result<(), CliError> {
        let (mesh, subject, budget) = (self.mesh, self.subject, self.file.budget());
        let steps = progress::count(&stage.step_name(), stage.len() as u64);
        let mut searchers = std::mem::take(&mut self.searchers);
        let mut alone = std::mem::take(&mut self.alone);
        let mut found_alone = Vec::new();
        let collects = matches!(stage, Stage::Alone(_)) && !alone.is_empty();
        let work = |searcher: &mut Searcher, shape: usize| {
            let shape = stage.shape(subject, shape);
            let found = searcher.find(&shape, &known(&self.at_rest, &alone, &shape.source));
            steps.step();
            (shape, found)
        };
        let findings = &mut self.findings;
        let refused = |shape: &Tried, reason| refused(self.options, self.index, mesh, shape_words(shape, mesh), reason);
        let over = |over: morph_collision_models::memory::OverBudget| CliError::Mesh {
            file: self.options.model.clone(),
            mesh: self.index,
            name: mesh.name.clone(),
            reason: over.into(),
        };
        in_order(&mut searchers, stage.len(), work, |_, (shape, found)| {
            let found = found.map_err(|reason| refused(&shape, reason))?;
            if collects && let Source::Target(target) = shape.source {
                let pairs = found.pairs.len() as u64;
                budget
                    .take(pairs, BYTES_PER_KNOWN_PAIR, || "what targets do alone".to_owned())
                    .map_err(over)?;
                found_alone.push((target, found.pairs.clone()));
            }
            findings.add(&shape, found, budget).map_err(over)
        })?;
        for (target, pairs) in found_alone {
            alone[target].extend(pairs);
        }
        (self.searchers, self.alone) = (searchers, alone);
        if stage.len() > 0 {
            *self.tried.entry(stage.kind()).or_default() += stage.len();
        }
        Ok(())
    }

    /// Proves what it can, and adds what the proof comes across where nothing was found yet.
    fn prove(&mut self, tree: &Arc<MorphBvh>) -> Result<Option<ProofReport>, CliError> {
        let name = &self.mesh.name;
        if self.mesh.skin.is_some() {
            let name = Printable(name);
            messages::complain(format_args!(
                "warning: mesh {} \"{name}\" is skinned, so nothing is proved",
                self.index
            ));
            return Ok(None);
        }
        // A box for each target that moves a node, on a few levels.
        count_memory(self.file, self.index, self.mesh.tree_bytes(), || "the proof".to_owned())?;
        let effort = Effort {
            boxes_per_pair: self.options.effort,
            ..Effort::default()
        };
        let outcome = prove(tree, self.searchers.len(), effort).map_err(|reason| CliError::Pose {
            file: self.options.model.clone(),
            mesh: self.index,
            name: name.clone(),
            reason,
        })?;
        let steps = progress::count("witness of the proof", outcome.witnesses.len() as u64);
        for witness in &outcome.witnesses {
            steps.step();
            let pair = witness.triangles;
            let is_known = [pair.triangle_a, pair.triangle_b]
                .iter()
                .all(|&triangle| self.findings.has(triangle));
            if self.at_rest.contains(&pair) || is_known {
                continue;
            }
            let shape = Tried {
                source: Source::Proof,
                moment: None,
                weights: witness.weights.clone(),
                joints: None,
            };
            *self.tried.entry(Kind::Proof).or_default() += 1;
            let found = self.searchers[0].find(&shape, &[&self.at_rest]);
            let found = found.map_err(|reason| self.refused(shape_words(&shape, self.mesh), reason))?;
            let added = self.findings.add(&shape, found, self.file.budget());
            added.map_err(|over| CliError::Mesh {
                file: self.options.model.clone(),
                mesh: self.index,
                name: name.clone(),
                reason: over.into(),
            })?;
        }
        Ok(Some(ProofReport::new(&outcome)))
    }

    /// The picture of a finding.
    fn picture(&mut self, finding: &Finding) -> Result<String, CliError> {
        let words = || finding.source.words(&self.mesh.target_names);
        let pose = self.searchers[0].pose_of(finding);
        let pose = pose.map_err(|reason| refused(self.options, self.index, self.mesh, words(), reason))?;
        Ok(picture::draw(pose, finding))
    }

    fn finish(mut self, tree: &MorphBvh, proof: Option<ProofReport>) -> Result<MeshReport, CliError> {
        let (mesh, model) = (self.mesh, tree.model());
        let findings = std::mem::take(&mut self.findings).finish();
        let parts = Parts::new(model, &mesh.primitives, self.subject.materials.clone());
        let mut suggestions: Vec<Suggestion> = Vec::new();
        if self.options.suggest {
            let mut searched: Vec<&Source> = Vec::new();
            let steps = progress::count("suggestion", findings.len() as u64);
            for finding in &findings {
                if !searched.contains(&&finding.source) {
                    let known = known(&self.at_rest, &self.alone, &finding.source);
                    let found = suggest(&mut self.searchers[0], self.subject, finding, &known);
                    let words = || finding.source.words(&mesh.target_names);
                    suggestions
                        .extend(found.map_err(|reason| refused(self.options, self.index, mesh, words(), reason))?);
                    searched.push(&finding.source);
                }
                steps.step();
            }
        }
        let mut reports: Vec<FindingReport> = findings
            .iter()
            .map(|finding| FindingReport::new(finding, self.subject, &parts))
            .collect();
        let sources = self.tried.iter().map(|(&kind, &shapes)| SourceReport {
            kind,
            shapes,
            findings: findings.iter().filter(|finding| finding.source.kind() == kind).count(),
        });
        let sources = sources.collect();
        if self.options.pictures {
            for (report, finding) in reports.iter_mut().zip(&findings).take(MOST_PICTURES) {
                report.picture = Some(self.picture(finding)?);
            }
        }
        Ok(MeshReport {
            mesh: self.index,
            name: mesh.name.clone(),
            triangles: mesh.triangles.len(),
            targets: mesh.targets.len(),
            joined: self.subject.joined(),
            pairs_at_rest: self.at_rest.len(),
            left_out: self.subject.left_out,
            shapes: self.tried.values().sum(),
            sources,
            proof,
            findings: reports,
            suggestions,
        })
    }

    /// Counts a list of known pairs.
    fn keep(&self, pairs: usize) -> Result<(), CliError> {
        let bytes = BYTES_PER_KNOWN_PAIR * pairs as u64;
        count_memory(self.file, self.index, bytes, || {
            "the pairs that touch at rest".to_owned()
        })
    }

    fn refused(&self, shape: String, reason: PoseError) -> CliError {
        refused(self.options, self.index, self.mesh, shape, reason)
    }
}

/// The pairs that a shape of a source is compared with.
fn known<'k>(at_rest: &'k Known, alone: &'k [Known], source: &Source) -> Vec<&'k Known> {
    let mut known = vec![at_rest];
    if let Source::Pair(pair) = source {
        known.extend(pair.iter().filter_map(|&target| alone.get(target)));
    }
    known
}
