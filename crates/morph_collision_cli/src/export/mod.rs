//! `morph-collide export`: writes posed meshes with the triangles that touch in red.
//!
//! ```text
//! model or scene --Cast--> posed bodies --touching--> coloured surface --ply, obj, glb--> OUT
//!                                                 \-> contacts --csv--> OUT.csv
//! ```

mod contacts;
mod surface;
mod text_formats;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use morph_collision_models::gltf::read::GltfFile;
use morph_collision_models::gltf::write::to_glb_of_parts;
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::scenes::{BodyState, Scene};
use morph_collision_models::text::Grouped;
use morph_collision_models::weight_list::{TargetNames, WeightList};
use serde::Serialize;

use crate::cast::Cast;
use crate::cast::posed::Posed;
use crate::error::CliError;
use crate::files::clip_files::ClipFiles;
use crate::files::drawn::DrawnArgs;
use crate::files::model::{FileArgs, MeshChoice, STANDARD};
use crate::options::frame_times::time_in_clip;
use crate::options::shape::{ShapeArgs, WeightArg};
use crate::options::tree::TreeArgs;
use crate::output;
use crate::output::file::OutputFile;
use crate::scene::build::{Candidate, Meshes, ModelSpec, candidates, clips_of, number_names, quoted, scene_of};
use crate::scene::is_scene;
use crate::touching::{Among, Search, Touch};
use surface::Surface;

const EXAMPLES: &str = "Examples:
  morph-collide export face.glb --weights jawOpen=1 --output open.ply
  morph-collide export character.glb --mesh all --clip walk --time 0.4 --output walk.glb
  morph-collide export scene.json --frame 12 --output contact.obj
  morph-collide export scene.json --frame 12 --output contacts.csv";

/// Write a posed mesh, or a frame of a scene, to a file that other programs can open, with the triangles that touch in red.
///
/// Triangles touch if they belong to different bodies, or to the same one without sharing a vertex. Colours are vertex colours in PLY and OBJ,
/// where faces have the order of the mesh's triangles: face numbers, counted from 0, are those of `query` (bodies follow each other). In glb, colours are materials,
/// and the triangles of one body that touch follow those that do not. CSV has a line per pair of triangles instead, with the middle of the segment in which they meet, and the names of
/// their bodies and of the targets that move their corners.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ExportArgs {
    /// A .glb or .gltf file, or a scene file (.json). With --mesh all, all that a model draws is written, where its nodes put it.
    input: PathBuf,
    #[command(flatten)]
    shape: ShapeArgs,
    #[command(flatten)]
    drawn: DrawnArgs,
    /// The frame of a scene, counted from 0; the first one by default.
    #[arg(long, value_name = "N")]
    frame: Option<usize>,
    /// The file to write; - is standard output and needs --format.
    #[arg(long, short, value_name = "OUT", required = true)]
    output: PathBuf,
    /// The format, if the name of the file does not tell.
    #[arg(long, value_enum)]
    format: Option<Format>,
    #[command(flatten)]
    tree: TreeArgs,
    #[command(flatten)]
    files: FileArgs,
    /// Print one JSON object instead of a summary.
    #[arg(long)]
    json: bool,
}

/// A file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Format {
    /// Polygon file, as text.
    Ply,
    /// Wavefront, with vertex colours.
    Obj,
    /// Binary glTF.
    Glb,
    /// A table of the triangles that touch.
    Csv,
}

/// The JSON of `export`.
#[derive(Debug, Serialize)]
struct ExportReport {
    file: String,
    format: Format,
    bodies: Vec<String>,
    vertices: usize,
    triangles: usize,
    touching_triangles: usize,
    touching_pairs: usize,
}

/// Poses, finds what touches, and writes.
pub(crate) fn export(args: &ExportArgs) -> Result<(), CliError> {
    let format = args.format()?;
    let budget = args.files.budget();
    let (scene, frame) = args.scene(&budget)?;
    let from_scene = is_scene(&args.input);
    let path = if from_scene { &*args.input } else { Path::new("export") };
    let mut cast = Cast::load(path, &scene, &args.tree, &args.files, &budget).map_err(|error| match error {
        // There is no scene file to name.
        CliError::State { reason, .. } if args.shape.weights.is_some() && !from_scene => CliError::Flag {
            flag: "--weights",
            reason,
        },
        CliError::State { reason, .. } if !from_scene => CliError::NoUsableMesh {
            file: args.input.clone(),
            reason,
        },
        error => error,
    })?;
    if frame >= cast.frames.len() {
        let reason = match cast.frames.len() {
            0 => "the scene has no frames".to_owned(),
            count => format!("there is no frame {frame}; the scene's frames are 0 to {}", count - 1),
        };
        return Err(CliError::Flag {
            flag: "--frame",
            reason,
        });
    }
    let file = OutputFile::create("--output", &args.output, &cast.inputs)?;
    let touches = touches(&mut cast, frame)?;
    let surface = Surface::new(&mut cast, &touches);
    let report = ExportReport {
        file: args.output.display().to_string(),
        format,
        bodies: cast.names.clone(),
        vertices: surface.vertices.len(),
        triangles: surface.triangle_count(),
        touching_triangles: surface.touching_count(),
        touching_pairs: touches.len(),
    };
    match format {
        Format::Ply => file.write(|out| text_formats::write_ply(out, &surface))?,
        Format::Obj => file.write(|out| text_formats::write_obj(out, &surface))?,
        Format::Glb => {
            let (mesh, appearances) = surface.into_mesh();
            let bytes = to_glb_of_parts(&mesh, &appearances)?;
            file.write(|out| out.write_all(&bytes))?;
        }
        Format::Csv => {
            let rows = contacts::rows(&mut cast, frame, &touches);
            file.write(|out| contacts::write_csv(out, &rows))?;
        }
    }
    if args.json {
        return output::print_json(&report);
    }
    output::print(&format!(
        "{}: {} triangles, {} of them touch others, in {} pairs\n",
        report.file,
        Grouped(report.triangles as u64),
        Grouped(report.touching_triangles as u64),
        Grouped(report.touching_pairs as u64)
    ))
}

/// Poses all bodies in a frame and finds what touches.
fn touches(cast: &mut Cast<Vec<Posed>>, frame: usize) -> Result<Vec<Touch>, CliError> {
    for body in 0..cast.bodies {
        let shape = cast.shape(frame, body);
        cast.method[body]
            .set(&shape)
            .map_err(|reason| cast.refused(frame, body, reason))?;
    }
    let mut touches = Vec::new();
    match Search::default().touching(&mut cast.method, Among::All, cast.most_pairs, &mut touches) {
        true => Ok(touches),
        false => Err(CliError::TooManyTouches {
            input: cast.scene.clone(),
            frame,
            most: cast.most_pairs,
        }),
    }
}

impl ExportArgs {
    fn format(&self) -> Result<Format, CliError> {
        if let Some(format) = self.format {
            return Ok(format);
        }
        let extension = self.output.extension().and_then(|extension| extension.to_str());
        let format = extension.and_then(|extension| Format::from_str(extension, true).ok());
        format.ok_or_else(|| CliError::Flag {
            flag: "--output",
            reason: format!(
                "the name {} does not end with .ply, .obj, .glb or .csv; add --format",
                quoted(&self.output.display().to_string())
            ),
        })
    }

    /// The scene and the frame to export.
    fn scene(&self, budget: &MemoryBudget) -> Result<(Scene, usize), CliError> {
        if is_scene(&self.input) {
            let shape = &self.shape;
            let given = [
                ("--mesh", shape.mesh != MeshChoice::default()),
                ("--weights", shape.weights.is_some()),
                ("--expression", !shape.expression.is_empty()),
                ("--clip", shape.clip.is_some()),
            ];
            if let Some((flag, _)) = given.into_iter().find(|(_, given)| *given) {
                let reason = "a scene file already says what its bodies do; choose one with --frame".to_owned();
                return Err(CliError::Flag { flag, reason });
            }
            self.drawn.refuse("a scene file already says what its bodies are")?;
            return Ok((self.files.read_scene(&self.input, budget)?, self.frame.unwrap_or(0)));
        }
        if self.frame.is_some() {
            let reason = "only a scene has frames; choose a moment of a clip with --clip and --time".to_owned();
            return Err(CliError::Flag {
                flag: "--frame",
                reason,
            });
        }
        let all = self.shape.mesh.0 == "all";
        let spec = ModelSpec {
            file: self.input.clone(),
            meshes: if all {
                Meshes::All
            } else {
                Meshes::One(self.shape.mesh.clone())
            },
        };
        if self.input == Path::new(STANDARD) {
            return Err(CliError::NoUsableMesh {
                file: STANDARD.into(),
                reason: "a model to export cannot come from standard input; give a file's name".to_owned(),
            });
        }
        if !all {
            self.drawn
                .refuse("one mesh is written; --mesh all writes all that is drawn")?;
        }
        // What is read here is dropped before the bodies are made.
        let mut clip_files = ClipFiles::new(&self.files, &self.files.budget(), Path::new(""));
        let (file, found) = candidates(&spec, all, &self.drawn, self.shape.clip.as_slice(), &mut clip_files)?;
        let mut states = self.weights(&found)?;
        if let Some(name) = &self.shape.clip {
            let clips = clips_of(&found, &file, &clip_files, name).map_err(|error| CliError::Flag {
                flag: "--clip",
                reason: error.reason(),
            })?;
            for (state, clip) in states.iter_mut().zip(clips) {
                if let Some((name, length)) = clip {
                    state.clip = Some(name);
                    state.time = Some(time_in_clip(self.shape.time, length, self.shape.is_loop));
                }
            }
        }
        self.express(&file, &found, &mut states)?;
        let mut bodies: Vec<_> = found.into_iter().map(|candidate| candidate.body).collect();
        number_names(&mut bodies);
        Ok((scene_of(bodies, vec![states]), 0))
    }

    /// Adds the weights of expressions below those that are given. Each has to move one of the meshes.
    fn express(&self, file: &GltfFile, found: &[Candidate], states: &mut [BodyState]) -> Result<(), CliError> {
        let expressions = &self.shape.expression;
        let mut moved = vec![false; expressions.len()];
        for (candidate, state) in found.iter().zip(states).filter(|_| !expressions.is_empty()) {
            let seconds = state.time.unwrap_or_default();
            let mut weights = candidate.weights(file, state.clip.as_deref(), seconds);
            for (expression, moved) in expressions.iter().zip(&mut moved) {
                let body = &candidate.body;
                *moved |= expression.add(file, body.mesh, body.node, &mut weights)?;
            }
            let resolved = TargetNames::new(candidate.target_names()).resolve(&state.weights, weights);
            state.weights = WeightList::All(resolved.map_err(|error| CliError::Flag {
                flag: "--weights",
                reason: error.to_string(),
            })?);
        }
        match moved.iter().position(|moved| !moved) {
            Some(still) => Err(expressions[still].moves_nothing("any of the meshes")),
            None => Ok(()),
        }
    }

    /// States with the weights that are given. If there are several meshes, each takes the names that it has.
    fn weights(&self, found: &[Candidate]) -> Result<Vec<BodyState>, CliError> {
        let mut states = vec![BodyState::default(); found.len()];
        let Some(WeightArg(list)) = &self.shape.weights else {
            return Ok(states);
        };
        let wrong = |reason: String| CliError::Flag {
            flag: "--weights",
            reason,
        };
        if let ([state], WeightList::All(_)) | ([state], WeightList::Named(_)) = (&mut states[..], list) {
            state.weights = list.clone();
            return Ok(states);
        }
        let WeightList::Named(named) = list else {
            return Err(wrong(
                "several meshes need names of targets, as in jawOpen=1".to_owned(),
            ));
        };
        for pair in named {
            let alone = WeightList::Named(vec![pair.clone()]);
            let mut complaint = None;
            let mut is_known = false;
            for (candidate, state) in found.iter().zip(&mut states) {
                match TargetNames::new(candidate.target_names()).targets(&alone) {
                    Ok(_) => {
                        is_known = true;
                        match &mut state.weights {
                            WeightList::Named(given) => given.push(pair.clone()),
                            WeightList::All(_) => state.weights = alone.clone(),
                        }
                    }
                    Err(error) => {
                        // The mesh with the most targets has the best suggestion.
                        let targets = candidate.target_names().len();
                        if complaint.as_ref().is_none_or(|(most, _)| *most < targets) {
                            complaint = Some((targets, error.to_string()));
                        }
                    }
                }
            }
            if let (false, Some((_, reason))) = (is_known, complaint) {
                return Err(wrong(reason));
            }
        }
        Ok(states)
    }
}
