//! The readable form of a report.

use std::fmt::{self, Display, Formatter, Write};

use crate::printable::Printable;

use super::SkinReport;
use super::report::{AnimationReport, FileReport, MeshReport, UsableReport};

/// One block per mesh: its counts, its tree, a table of targets and, per animation, one of weights.
impl Display for FileReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", Printable(&self.file))?;
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        self.meshes.iter().try_for_each(|mesh| render_mesh(f, mesh))
    }
}

fn render_mesh(text: &mut impl Write, mesh: &MeshReport) -> fmt::Result {
    writeln!(text, "\nmesh {} \"{}\"", mesh.index, Printable(&mesh.name))?;
    write!(text, "  vertices    {} stored", mesh.vertices_stored)?;
    if let Some(usable) = &mesh.usable {
        write!(text, ", {} welded", usable.vertices_welded)?;
    }
    writeln!(text)?;
    write!(text, "  triangles   {}", mesh.triangles)?;
    if mesh.primitives > 1 {
        write!(text, " in {} primitives", mesh.primitives)?;
    }
    writeln!(text)?;
    if let Some(error) = &mesh.error {
        writeln!(text, "  error       {error}")?;
    }
    for warning in &mesh.warnings {
        writeln!(text, "  warning     {warning}")?;
    }
    if let Some(usable) = &mesh.usable {
        let tree = &usable.tree;
        writeln!(
            text,
            "  tree        {} nodes, depth {}, {} bytes",
            tree.nodes, tree.depth, tree.bytes
        )?;
        if mesh.rigid {
            writeln!(text, "  targets     none: rigid")?;
        } else {
            render_targets(text, mesh, usable)?;
        }
    }
    for (index, animation) in mesh.animations.iter().enumerate() {
        render_animation(text, index, animation)?;
    }
    mesh.skin.iter().try_for_each(|skin| render_skin(text, skin))
}

/// One row per target, with the range of its weight in every animation.
fn render_targets(text: &mut impl Write, mesh: &MeshReport, usable: &UsableReport) -> fmt::Result {
    writeln!(text, "  targets     {}", usable.targets.len())?;
    let shown = |name: &str| Printable(name).to_string();
    let width = usable
        .targets
        .iter()
        .map(|target| shown(&target.name).chars().count())
        .max()
        .unwrap_or(0)
        .max(4);
    write!(text, "\n    {:>4}  {:width$}  left alone", "#", "name")?;
    for animation in 0..mesh.animations.len() {
        write!(text, "  {:>20}", format!("weight, animation {animation}"))?;
    }
    writeln!(text)?;
    for (index, target) in usable.targets.iter().enumerate() {
        let share = target.share_left_alone * 100.0;
        write!(text, "    {index:>4}  {:width$}  {share:>8.1} %", shown(&target.name))?;
        for animation in &mesh.animations {
            let range = animation
                .weights
                .get(index)
                .map(|range| format!("{:.3} .. {:.3}", range.min, range.max));
            write!(text, "  {:>20}", range.unwrap_or_default())?;
        }
        writeln!(text)?;
    }
    if !mesh.animations.is_empty() {
        writeln!(text)?;
    }
    Ok(())
}

fn render_skin(text: &mut impl Write, skin: &SkinReport) -> fmt::Result {
    let SkinReport {
        joints,
        most_influences,
        weight_sum,
        clips,
    } = skin;
    writeln!(
        text,
        "  skin        {} joints, at most {most_influences} a vertex, sums of weights {:.6} .. {:.6}",
        joints.len(),
        weight_sum.min,
        weight_sum.max
    )?;
    for (index, clip) in clips.iter().enumerate() {
        let (name, seconds, nodes) = (Printable(&clip.name), clip.seconds, clip.nodes_moved);
        writeln!(
            text,
            "  joint clip {index} \"{name}\": {seconds:.3} s, moves {nodes} nodes"
        )?;
    }
    Ok(())
}

fn render_animation(text: &mut impl Write, index: usize, animation: &AnimationReport) -> fmt::Result {
    let AnimationReport {
        name,
        keys,
        seconds,
        weight_sum,
        ..
    } = animation;
    let name = Printable(name);
    writeln!(
        text,
        "  animation {index} \"{name}\": {keys} keys, {seconds:.3} s, sum of weights {:.3} .. {:.3}",
        weight_sum.min, weight_sum.max
    )
}
