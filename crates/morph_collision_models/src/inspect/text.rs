//! The readable form of a report.

use std::fmt::{self, Display, Formatter, Write};

use super::animation::{AnimationReport, FileAnimationReport, WeightRange};
use super::expression::ExpressionReport;
use super::node::NodeReport;
use super::report::{FileReport, MeshReport};
use super::skin::SkinReport;
use super::summary;
use super::usable::UsableReport;
use crate::memory::Bytes;
use crate::text::Grouped;
use crate::text::Printable;

/// Files with more meshes get one line per mesh.
const MOST_IN_FULL: usize = 4;
/// At most this many nodes of a mesh, and columns of clips, are shown.
const MOST_LISTED: usize = 3;
/// Longer names are cut.
const LONGEST_NAME: usize = 32;

/// A table of animations, and one block per mesh: its counts, its bounds, its tree, its skin and a table of targets. A file with many
/// meshes gets one line per mesh instead.
impl Display for FileReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", Printable(&self.file))?;
        for note in &self.extension_notes {
            writeln!(f, "note: {}", Printable(note))?;
        }
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        if !self.animations.is_empty() {
            write!(f, "\n{}", animations(&self.animations))?;
        }
        if !self.expressions.is_empty() {
            write!(f, "\n{}", expressions(&self.expressions))?;
        }
        for expression in &self.expressions {
            for problem in &expression.problems {
                let name = cut(&expression.name);
                writeln!(
                    f,
                    "warning: expression \"{}\": {}",
                    Printable(&name),
                    Printable(problem)
                )?;
            }
        }
        if self.meshes.len() > MOST_IN_FULL {
            writeln!(f, "\n{}--mesh N shows mesh N in full", summary::meshes(&self.meshes))?;
            let warnings = self
                .meshes
                .iter()
                .flat_map(|mesh| mesh.warnings.iter().map(|warning| (mesh.index, warning)));
            for (mesh, warning) in warnings {
                writeln!(f, "warning: mesh {mesh}: {warning}")?;
            }
            for mesh in &self.meshes {
                if let Some(left_out) = &mesh.left_out {
                    writeln!(f, "warning: mesh {}: {left_out}", mesh.index)?;
                }
            }
            return Ok(());
        }
        self.meshes.iter().try_for_each(|mesh| render_mesh(f, mesh))
    }
}

/// Aligned columns, two spaces apart. The columns listed in `left` are aligned to the left.
pub(super) fn table(header: &[&str], rows: &[Vec<String>], left: &[usize]) -> String {
    let length = |text: &str| text.chars().count();
    let width = |column: usize| {
        let cells = rows.iter().map(|row| length(&row[column]));
        cells.chain([length(header[column])]).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..header.len()).map(width).collect();
    let mut text = String::new();
    let header: Vec<String> = header.iter().map(ToString::to_string).collect();
    for row in std::iter::once(&header).chain(rows) {
        let mut line = String::new();
        for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            // Writing to a string cannot fail.
            let _ = if left.contains(&column) {
                write!(line, "  {cell:<width$}")
            } else {
                write!(line, "  {cell:>width$}")
            };
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// A name from a file, safe to print and not too long.
pub(super) fn cut(name: &str) -> String {
    let shown = Printable(name).to_string();
    match shown.char_indices().nth(LONGEST_NAME) {
        None => shown,
        Some((end, _)) => format!("{}...", &shown[..end]),
    }
}

fn grouped(number: usize) -> Grouped {
    Grouped(number as u64)
}

fn expressions(expressions: &[ExpressionReport]) -> String {
    let rows: Vec<Vec<String>> = expressions
        .iter()
        .map(|expression| {
            let name = Printable(&cut(&expression.name)).to_string();
            vec![name, grouped(expression.targets).to_string()]
        })
        .collect();
    table(&["expression", "targets"], &rows, &[0])
}

fn animations(animations: &[FileAnimationReport]) -> String {
    let header = [
        "animation",
        "name",
        "seconds",
        "channels",
        "nodes",
        "weights of",
        "interpolation",
    ];
    let row = |animation: &FileAnimationReport| {
        let meshes: Vec<String> = animation
            .meshes
            .iter()
            .take(4)
            .map(|mesh| format!("mesh {mesh}"))
            .collect();
        let more = if animation.meshes.len() > 4 { ", ..." } else { "" };
        let interpolations: Vec<String> = animation
            .interpolations
            .iter()
            .take(4)
            .map(|name| Printable(name).to_string())
            .collect();
        let ignored = match animation.channels_ignored {
            0 => String::new(),
            ignored => format!(" ({ignored} ignored)"),
        };
        vec![
            animation.index.to_string(),
            cut(&animation.name),
            format!("{:.3}", animation.seconds),
            format!("{}{ignored}", grouped(animation.channels)),
            grouped(animation.nodes_moved).to_string(),
            meshes.join(", ") + more,
            interpolations.join(", "),
        ]
    };
    let rows: Vec<Vec<String>> = animations.iter().map(row).collect();
    table(&header, &rows, &[1, 5, 6])
}

fn render_mesh(text: &mut impl Write, mesh: &MeshReport) -> fmt::Result {
    writeln!(text, "\nmesh {} \"{}\"", mesh.index, Printable(&mesh.name))?;
    write!(text, "  triangles   {}", grouped(mesh.triangles))?;
    if mesh.primitives > 1 {
        write!(text, " in {} primitives", grouped(mesh.primitives))?;
    }
    write!(text, "\n  vertices    ")?;
    if let Some(usable) = &mesh.usable {
        write!(text, "{} welded, ", grouped(usable.vertices_welded))?;
    }
    writeln!(text, "{} stored", grouped(mesh.vertices_stored))?;
    if let Some(error) = &mesh.error {
        writeln!(text, "  error       {error}")?;
    }
    for warning in &mesh.warnings {
        writeln!(text, "  warning     {warning}")?;
    }
    if let Some(left_out) = &mesh.left_out {
        writeln!(text, "  left out    {left_out}")?;
    }
    if let Some(usable) = &mesh.usable {
        render_bounds(text, mesh, usable)?;
        let tree = &usable.tree;
        writeln!(
            text,
            "  tree        {} nodes, depth {}, {}",
            grouped(tree.nodes),
            tree.depth,
            Bytes(tree.bytes as u64)
        )?;
    }
    render_nodes(text, &mesh.nodes, mesh.skinned)?;
    mesh.skin.iter().try_for_each(|skin| render_skin(text, skin))?;
    if let Some(usable) = &mesh.usable {
        render_targets(text, mesh, usable)?;
    }
    Ok(())
}

fn render_bounds(text: &mut impl Write, mesh: &MeshReport, usable: &UsableReport) -> fmt::Result {
    let numbers = |numbers: [f32; 3]| numbers.map(|number| number.to_string()).join(" ");
    let bounds = &usable.bounds;
    let space = if mesh.skin.is_some() { "world" } else { "model" };
    writeln!(
        text,
        "  bounds      {} to {} at rest, in {space} space; size {}",
        numbers(bounds.min),
        numbers(bounds.max),
        numbers(bounds.size())
    )
}

fn render_nodes(text: &mut impl Write, nodes: &[NodeReport], skinned: bool) -> fmt::Result {
    if nodes.is_empty() {
        return writeln!(text, "  shown by    no node");
    }
    for node in nodes.iter().take(MOST_LISTED) {
        write!(text, "  shown by    node {} \"{}\"", node.index, Printable(&node.name))?;
        match node.drawn {
            0 => write!(text, ", which the scene does not draw")?,
            1 => {}
            instances => write!(text, " in {} instances", grouped(instances))?,
        }
        let [x, y, z] = node.translation;
        let [a, b, c, d] = node.rotation;
        let [sx, sy, sz] = node.scale;
        match (skinned, node.is_identity()) {
            (true, _) => writeln!(text, ", whose transform does not matter because joints place the mesh")?,
            (false, true) => writeln!(text, ", at the origin")?,
            (false, false) => {
                writeln!(
                    text,
                    ": translation {x} {y} {z}, rotation {a} {b} {c} {d}, scale {sx} {sy} {sz}"
                )?;
            }
        }
    }
    match nodes.len().checked_sub(MOST_LISTED) {
        Some(more) if more > 0 => writeln!(text, "  shown by    {} more nodes", grouped(more)),
        _ => Ok(()),
    }
}

/// One row per target. The range of its weight is shown for each clip, or for all together if there are many.
fn render_targets(text: &mut impl Write, mesh: &MeshReport, usable: &UsableReport) -> fmt::Result {
    if mesh.rigid {
        return writeln!(text, "  targets     none: rigid");
    }
    writeln!(text, "  targets     {}\n", grouped(usable.targets.len()))?;
    let clips = &mesh.animations;
    let one_by_one = clips.len() <= MOST_LISTED;
    let mut header = vec![
        "#".to_owned(),
        "name".to_owned(),
        "default".to_owned(),
        "reach".to_owned(),
    ];
    header.push("unmoved".to_owned());
    if one_by_one {
        header.extend(clips.iter().map(|clip| format!("in animation {}", clip.animation)));
    } else {
        header.push(format!("in all {} clips", clips.len()));
    }
    let range = |range: WeightRange| format!("{:.3} .. {:.3}", range.min, range.max);
    let of_target = |clip: &AnimationReport, index: usize| clip.weights.get(index).copied().unwrap_or_default();
    let row = |(index, target): (usize, &super::TargetReport)| {
        let mut row = vec![
            index.to_string(),
            cut(&target.name),
            target.default_weight.to_string(),
            target.reach.to_string(),
            format!("{:.1} %", target.share_left_alone * 100.0),
        ];
        let ranges = clips.iter().map(|clip| of_target(clip, index));
        if one_by_one {
            row.extend(ranges.map(range));
        } else {
            row.push(ranges.reduce(WeightRange::union).map(range).unwrap_or_default());
        }
        row
    };
    let rows: Vec<Vec<String>> = usable.targets.iter().enumerate().map(row).collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    for line in table(&header, &rows, &[1]).lines() {
        writeln!(text, "  {line}")?;
    }
    for clip in clips {
        let AnimationReport {
            animation,
            name,
            keys,
            interpolation,
            seconds,
            weight_sum,
            ..
        } = clip;
        writeln!(
            text,
            "  weights in animation {animation} \"{}\": {keys} {interpolation} keys, {seconds:.3} s, sum of weights {:.3} .. {:.3}",
            Printable(name),
            weight_sum.min,
            weight_sum.max
        )?;
    }
    Ok(())
}

fn render_skin(text: &mut impl Write, skin: &SkinReport) -> fmt::Result {
    let vertices: usize = skin.vertices_by_influences.iter().sum();
    let counted = skin.vertices_by_influences.iter().enumerate();
    let counted = counted.filter(|(_, count)| **count > 0);
    let counted: Vec<String> = counted
        .map(|(influences, &count)| format!("{influences}: {}", grouped(count)))
        .collect();
    writeln!(
        text,
        "  skin        {} joints; vertices by number of joints that move them: {}",
        grouped(skin.joints.len()),
        counted.join(", ")
    )?;
    let (min, max) = (skin.weight_sum.min, skin.weight_sum.max);
    match skin.vertices_not_summing_to_1 {
        0 => writeln!(text, "              joint weights sum to 1 for all vertices")?,
        off => writeln!(
            text,
            "              joint weights of {} of {} vertices do not sum to 1 (sums are {min:.6} .. {max:.6}), which pulls them towards the origin",
            grouped(off),
            grouped(vertices)
        )?,
    }
    if skin.most_influences > 4 {
        writeln!(
            text,
            "              engines that draw four joints per vertex, such as Bevy, show something else"
        )?;
    }
    for clip in &skin.clips {
        let (animation, name, seconds, nodes) = (clip.animation, Printable(&clip.name), clip.seconds, clip.nodes_moved);
        writeln!(
            text,
            "  joints in animation {animation} \"{name}\": {seconds:.3} s, moves {nodes} nodes"
        )?;
    }
    Ok(())
}
