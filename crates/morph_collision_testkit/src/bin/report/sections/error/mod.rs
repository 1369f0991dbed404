//! What is gained by answers that may be off, next to settings that change no answer.

mod approximate;
mod judge;

use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fmt::Write;

use glam::{Affine3A, DQuat, DVec3};
use morph_collision::{Aabb, BuildOptions, VolumeKind};
use morph_collision_testkit::bench::{Contender, Experiment, Plan, disagreement, measure};
use morph_collision_testkit::gltf_read::read_meshes;
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::moments::real_model;
use morph_collision_testkit::rivals::Wanted;

use super::Context;
use crate::plot::{Axis, Figure, Panel, Series};
use crate::sweeps::{Candidate, morph};
use approximate::{ApproximateMorph, Leave};
use judge::{Verdict, judge};

/// Faces of other people, and what to call them.
const FACES: [(&str, &str); 2] = [
    ("mh_head_eyes_teeth_arkit52_dao.glb", "MakeHuman heads"),
    ("ict_face_skin.glb", "ICT faces"),
];

/// Shares of a body's size.
const TOLERANCES: [f64; 5] = [1e-3, 3e-3, 1e-2, 3e-2, 1e-1];
const DISPLACEMENTS: [f64; 5] = [1e-4, 1e-3, 3e-3, 1e-2, 3e-2];
const BUDGETS: [u64; 5] = [1000, 3000, 10_000, 30_000, 100_000];

/// A row of the table.
struct Line {
    label: String,
    /// `None` where answers are exact.
    leave: Option<Leave>,
    verdict: Verdict,
    ratio: f64,
}

/// A table and a figure for each scene; of a face that is not there, what the page has.
pub(crate) fn error(context: &Context, old: &str) -> Result<String, Box<dyn Error>> {
    let mut text = format!("\n{INTRODUCTION}");
    for (experiment, name) in [
        (Experiment::dolphins(2, context.every), "dolphins"),
        (Experiment::pass_through(5, context.every), "pass-through"),
    ] {
        text += &of_experiment(&experiment, name, context)?;
    }
    for (file, title) in FACES {
        let Some(path) = real_model(file) else {
            eprintln!("error: {title} stay as they are in the page");
            text += &kept(old, title);
            continue;
        };
        let meshes = read_meshes(&path).map_err(Box::new)?;
        let mesh = meshes.into_iter().next().ok_or_else(|| format!("{file}: no mesh"))?;
        text += &of_experiment(
            &heads(title, mesh, context.every),
            file.trim_end_matches(".glb"),
            context,
        )?;
    }
    Ok(text)
}

const INTRODUCTION: &str = "What approximate answers save, all pairs. *Time* is that of a frame over the exact default's in the same rounds. *Missed* are intersecting pairs that \
are in no list of the answer but, with a budget, its undecided parts; *spurious* are pairs that pass for intersecting and do not, both as shares of the exact \
pairs. Lengths are in percent of the diagonal of a body's box at rest: *found* is the largest error found (with a tolerance the distance of triangles that pass for intersecting, over a sample of \
them; with a displacement that of vertices), *promised* the bound in the answers. A budget is a number of tests for each pair of bodies. The report \
fails if a promise is broken.\n";

/// The part of a place that is about a scene: from its heading to the next.
fn kept(old: &str, title: &str) -> String {
    let heading = format!("\n**{title},");
    let Some(start) = old.find(&heading) else {
        return String::new();
    };
    let end = old[start + 1..].find("\n**").map_or(old.len(), |end| start + 1 + end);
    old[start..end].to_owned()
}

/// Two heads that face each other and press their faces together and come apart, twice in 400 steps, while each lives through its clip.
fn heads(title: &str, mesh: MorphMesh, every: usize) -> Experiment {
    let bounds = Aabb::from_points(mesh.positions.iter().copied());
    let (size, middle) = (bounds.size().as_dvec3(), bounds.center());
    let clip = mesh.animations.first().cloned().unwrap_or_default();
    let targets = mesh.targets.len();
    let frame = |step: usize| {
        let t = step as f64 / 400.0;
        let apart = size.z * (0.93 + 0.09 * (2.0 * TAU * t).cos());
        let body = |turn: f64, z: f64, ahead: f64| {
            let mut weights = clip.sample(((t + ahead) * f64::from(clip.duration())) as f32);
            weights.resize(targets, 0.0);
            let turned = DQuat::from_rotation_y(turn).as_quat();
            let place = Affine3A::from_rotation_translation(turned, DVec3::new(0.0, 0.0, z).as_vec3());
            (weights, place * Affine3A::from_translation(-middle))
        };
        vec![body(0.0, 0.0, 0.0), body(PI, apart, 0.37)]
    };
    let steps: Vec<usize> = (0..400).step_by(every).collect();
    Experiment {
        name: title.to_owned(),
        title: format!("{title}, 2 x {} triangles with {targets} targets", mesh.triangles.len()),
        bodies: 2,
        frames: steps.iter().map(|&step| frame(step)).collect(),
        steps,
        mesh,
    }
}

fn exact() -> Vec<Candidate> {
    let default = BuildOptions::default;
    vec![
        morph("exact, the default", default()),
        morph("exact, kdop18", default().with_volume(VolumeKind::Kdop18)),
        morph("exact, sphere", default().with_volume(VolumeKind::Sphere)),
        morph("exact, leaf 4", default().with_leaf_size(4)),
        morph("exact, leaf 16", default().with_leaf_size(16)),
        morph("exact, in-betweens", default().with_in_betweens(true)),
    ]
}

fn of_experiment(experiment: &Experiment, name: &str, context: &Context) -> Result<String, Box<dyn Error>> {
    eprintln!("error: {}", experiment.title);
    let bounds = Aabb::from_points(experiment.mesh.positions.iter().copied());
    let size = f64::from(bounds.size().length());
    let approximate: Vec<(String, Leave)> = TOLERANCES
        .iter()
        .map(|share| (format!("tolerance {} %", 100.0 * share), Leave::Tolerance(share * size)))
        .chain(DISPLACEMENTS.iter().map(|share| {
            let label = format!("displacement {} %", 100.0 * share);
            (label, Leave::Displacement(share * size))
        }))
        .chain(
            BUDGETS
                .iter()
                .map(|&tests| (format!("budget {tests}"), Leave::Budget(tests))),
        )
        .collect();

    let exact = exact();
    let mut contenders = Vec::new();
    for candidate in &exact {
        contenders.push(candidate.set_up(experiment)?);
    }
    for (label, leave) in &approximate {
        contenders.push(Contender {
            name: label.clone(),
            method: Box::new(ApproximateMorph::new(experiment, *leave)?),
        });
    }
    let plan = Plan {
        wanted: Wanted::All,
        rounds: context.rounds,
        split_rounds: 0,
    };
    let rows = measure(experiment, contenders, plan, || ())?;
    if let Some(wrong) = disagreement(experiment, &rows[..exact.len()], Wanted::All) {
        return Err(wrong.into());
    }
    let truth = rows[0].pairs();
    let mut lines = Vec::new();
    for (index, row) in rows.into_iter().enumerate() {
        let leave = index.checked_sub(exact.len()).map(|index| approximate[index].1);
        let verdict = match leave {
            Some(leave) => judge(experiment, leave)?,
            None => Verdict {
                truth,
                ..Verdict::default()
            },
        };
        lines.push(Line {
            label: row.name,
            leave,
            verdict,
            ratio: row.ratio,
        });
    }
    let figure = figure(experiment, name, &lines, size);
    let shown = figure.write(&context.plots, &format!("Time against error: {}", experiment.title))?;
    let mut text = format!(
        "\n**{}.** {} frames, {truth} pairs of triangles.\n\n{shown}\n",
        experiment.title,
        experiment.frames.len()
    );
    write_table(&mut text, &lines, size)?;
    Ok(text)
}

fn write_table(text: &mut String, lines: &[Line], size: f64) -> std::fmt::Result {
    writeln!(text, "| | time | missed | spurious | error found | promised |")?;
    writeln!(text, "|---|--:|--:|--:|--:|--:|")?;
    for line in lines {
        let verdict = &line.verdict;
        let share = |count: u64| match count {
            0 => "0".to_owned(),
            count => match 100.0 * count as f64 / verdict.truth.max(1) as f64 {
                percent if percent >= 100.0 => format!("{percent:.0} %"),
                percent => format!("{percent:.2} %"),
            },
        };
        write!(
            text,
            "| {} | {:.2} | {} | {} |",
            line.label,
            line.ratio,
            share(verdict.missed),
            share(verdict.spurious)
        )?;
        match line.leave {
            None => writeln!(text, " 0 | 0 |")?,
            Some(Leave::Budget(_)) => writeln!(text, " | |")?,
            Some(Leave::Tolerance(_) | Leave::Displacement(_)) => writeln!(
                text,
                " {:.4} % | {:.4} % |",
                100.0 * verdict.found / size,
                100.0 * verdict.promised / size
            )?,
        }
    }
    Ok(())
}

fn figure(experiment: &Experiment, name: &str, lines: &[Line], size: f64) -> Figure {
    let points = |of: &dyn Fn(&Line) -> Option<f64>| {
        let point = |line: &Line| of(line).map(|x| (x, line.ratio));
        lines.iter().filter_map(point).collect()
    };
    let series = |name: &str, of: &dyn Fn(&Line) -> Option<f64>| Series {
        name: name.to_owned(),
        points: points(of),
        marked: true,
    };
    let time = Axis {
        label: "time over the exact default's",
        log: false,
    };
    let percent = 100.0 / size;
    let bounded = Panel {
        title: format!("{}: what may be off", experiment.name),
        x: Axis {
            label: "bound asked for, percent of a body's size",
            log: true,
        },
        y: time,
        series: vec![
            series("tolerance", &|line| match line.leave {
                Some(Leave::Tolerance(tolerance)) => Some(percent * tolerance),
                _ => None,
            }),
            series("displacement", &|line| match line.leave {
                Some(Leave::Displacement(displacement)) => Some(percent * displacement),
                _ => None,
            }),
        ],
    };
    let budget = Panel {
        title: format!("{}: an end of work", experiment.name),
        x: Axis {
            label: "intersecting pairs left undecided, percent",
            log: false,
        },
        y: time,
        series: vec![series("budget", &|line| match line.leave {
            Some(Leave::Budget(_)) => Some(100.0 * line.verdict.missed as f64 / line.verdict.truth.max(1) as f64),
            _ => None,
        })],
    };
    Figure {
        name: format!("error-{name}"),
        panels: vec![bounded, budget],
    }
}

#[cfg(test)]
mod tests {
    use super::kept;

    #[test]
    fn the_part_about_a_face_is_kept_to_the_next_heading() {
        let old = "\nintro\n\n**A, 2 x 3.** x\n\n| row |\n\n**B, 2 x 4.** y\n| last |\n";
        assert_eq!(kept(old, "A"), "\n**A, 2 x 3.** x\n\n| row |\n");
        assert_eq!(kept(old, "B"), "\n**B, 2 x 4.** y\n| last |\n");
        assert_eq!(kept(old, "C"), "");
    }
}
