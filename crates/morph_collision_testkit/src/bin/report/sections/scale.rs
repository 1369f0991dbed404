//! How time, memory and build time grow with bodies, triangles and targets.

use std::error::Error;
use std::fmt::Write;
use std::sync::Arc;

use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, Pose, WorldFromModel};
use morph_collision_testkit::bench::{Experiment, Stopwatch, median};
use morph_collision_testkit::mesh::MorphMesh;
use morph_collision_testkit::models::random::random_blob;
use morph_collision_testkit::rivals::{MethodKind, MethodOptions, Wanted};
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy};

use super::{Context, race};
use crate::sweeps::{morph, rival};
use morph_collision_testkit::plot::{Axis, Figure, Panel, Series, exponent};

/// Measurements at one size.
struct Size {
    size: usize,
    /// Seconds per frame: ours, and the hybrid's.
    all: [f64; 2],
    first: [f64; 2],
    memory: Memory,
    /// Seconds.
    build: f64,
    parry: f64,
}

/// Bytes.
struct Memory {
    model: usize,
    tree: usize,
    /// Of one body after a query for all pairs.
    pose: usize,
}

/// The quantity that grows, and the experiments of each size.
struct Growth {
    what: &'static str,
    axis: &'static str,
    sizes: Vec<(usize, Experiment)>,
}

const DENSE: &str = "targets, each of which moves every vertex";
const SPARSE: &str = "targets, each of which moves 15 % of the vertices";

/// Up to this many targets have full weights. If there are more, each weight is smaller, so that
/// the sum stays the same.
const FULL_WEIGHTS: f64 = 16.0;

fn growths(context: &Context) -> Vec<Growth> {
    let every = context.every;
    let counts: &[usize] = if context.quick {
        &[1, 10, 100]
    } else {
        &[1, 3, 10, 30, 100, 300, 1000]
    };
    let levels = if context.quick { 3..=5 } else { 3..=8 };
    let targets: &[usize] = if context.quick {
        &[2, 16, 128]
    } else {
        &[2, 4, 8, 16, 32, 64, 128, 256]
    };
    let of_level = |level: u32| {
        let experiment = Experiment::pass_through(level, 2 * every);
        (experiment.mesh.triangles.len(), experiment)
    };
    let of_targets = |sparsity: f32, most: f64| {
        let blob = move |&targets: &usize| {
            let mesh = random_blob(7, 5, targets, sparsity);
            let share = (most / targets as f64).min(1.0);
            (targets, Experiment::grazing("blobs", mesh, share, 2 * every))
        };
        targets.iter().map(blob).collect()
    };
    vec![
        Growth {
            what: "Bodies: dolphins of 564 triangles",
            axis: "bodies",
            sizes: counts
                .iter()
                .map(|&count| (count, Experiment::many_dolphins(count, 0, every)))
                .collect(),
        },
        Growth {
            what: "Triangles: two bodies that pass through each other",
            axis: "triangles of a body",
            sizes: levels.map(of_level).collect(),
        },
        Growth {
            what: "Dense targets: two grazing bodies of 20480 triangles",
            axis: DENSE,
            sizes: of_targets(0.0, FULL_WEIGHTS),
        },
        Growth {
            what: "Sparse targets: the same bodies",
            axis: SPARSE,
            sizes: of_targets(0.85, FULL_WEIGHTS),
        },
        Growth {
            what: "Dense targets, the sum of weights growing along",
            axis: DENSE,
            sizes: of_targets(0.0, f64::INFINITY),
        },
        Growth {
            what: "Sparse targets, the sum of weights growing along",
            axis: SPARSE,
            sizes: of_targets(0.85, f64::INFINITY),
        },
    ]
}

/// Tables and a figure for everything that grows.
pub(crate) fn scale(context: &Context, _: &str) -> Result<String, Box<dyn Error>> {
    let (mut text, mut panels) = (String::new(), Vec::new());
    for growth in growths(context) {
        let mut sizes = Vec::new();
        for (size, experiment) in &growth.sizes {
            eprintln!("scale: {}, {size}", growth.what);
            sizes.push(measure_size(*size, experiment, context)?);
        }
        write_table(&mut text, &growth, &sizes)?;
        panels.push(panel(&growth, &sizes));
    }
    let figure = Figure {
        name: "scale".to_owned(),
        panels,
    };
    let shown = figure.write(&context.plots, "Time against bodies, triangles and targets")?;
    Ok(format!(
        "\n{shown}\nTime of a frame while one number grows; both axes are logarithmic. The hybrid is the eight-wide one. In the tables, *power* is the exponent \
         of growth, fitted by least squares over all sizes but a single body. Memory is that of the mesh (base and displacements), of the tree that all bodies share, and of one body's pose \
         after it was asked for all pairs. Building is our default tree, with its tables, next to Parry's binned tree over the same triangles at rest, in turns. All targets are active, at weights of both signs; \
         sizes of 16 of them sum to about 4, and stay there with more targets, or grow along where that is said, to about 70.\n{text}"
    ))
}

fn write_table(text: &mut String, growth: &Growth, sizes: &[Size]) -> std::fmt::Result {
    writeln!(text, "\n**{}.**\n", growth.what)?;
    writeln!(
        text,
        "| {} | all pairs, us | hybrid / morph | first pair, us | hybrid / morph | mesh, kB | tree, kB | pose, kB | build, ms | Parry's build, ms |",
        growth.axis
    )?;
    writeln!(text, "|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    let kilo = |bytes: usize| bytes as f64 / 1e3;
    for row in sizes {
        writeln!(
            text,
            "| {} | {:.1} | {:.2} | {:.1} | {:.2} | {:.0} | {:.0} | {:.1} | {:.2} | {:.2} |",
            row.size,
            row.all[0] * 1e6,
            row.all[1] / row.all[0],
            row.first[0] * 1e6,
            row.first[1] / row.first[0],
            kilo(row.memory.model),
            kilo(row.memory.tree),
            kilo(row.memory.pose),
            row.build * 1e3,
            row.parry * 1e3,
        )?;
    }
    let power = |of: &dyn Fn(&Size) -> f64| exponent(&points(sizes, of));
    writeln!(
        text,
        "| power | {:.2} | | {:.2} | | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} |",
        power(&|row| row.all[0]),
        power(&|row| row.first[0]),
        power(&|row| row.memory.model as f64),
        power(&|row| row.memory.tree as f64),
        power(&|row| row.memory.pose as f64),
        power(&|row| row.build),
        power(&|row| row.parry),
    )
}

fn points(sizes: &[Size], of: &dyn Fn(&Size) -> f64) -> Vec<(f64, f64)> {
    // A single body has no partner.
    let met = sizes.iter().filter(|row| row.size > 1);
    met.map(|row| (row.size as f64, of(row))).collect()
}

fn panel(growth: &Growth, sizes: &[Size]) -> Panel {
    let line = |name: &str, of: &dyn Fn(&Size) -> f64| {
        let points = points(sizes, &|row| of(row) * 1e6);
        Series {
            name: format!("{name}: {:.2}", exponent(&points)),
            points,
            marked: true,
        }
    };
    Panel {
        title: growth.what.to_owned(),
        x: Axis {
            label: growth.axis,
            log: true,
        },
        y: Axis {
            label: "time of a frame, us",
            log: true,
        },
        series: vec![
            line("morph, all", &|row| row.all[0]),
            line("hybrid, all", &|row| row.all[1]),
            line("morph, first", &|row| row.first[0]),
            line("hybrid, first", &|row| row.first[1]),
        ],
    }
}

fn measure_size(size: usize, experiment: &Experiment, context: &Context) -> Result<Size, Box<dyn Error>> {
    let candidates = [
        morph("morph", MethodOptions::default()),
        rival("hybrid", MethodKind::Hybrid),
    ];
    let rounds = context.rounds.min(3);
    let all = race(experiment, &candidates, Wanted::All, rounds)?;
    let first = race(experiment, &candidates, Wanted::First, rounds)?;
    let [build, parry] = build_times(&experiment.mesh, rounds)?;
    Ok(Size {
        size,
        all: [all[0].time, all[1].time],
        first: [first[0].time, first[1].time],
        memory: memory(experiment)?,
        build,
        parry,
    })
}

fn memory(experiment: &Experiment) -> Result<Memory, Box<dyn Error>> {
    let model = Arc::new(experiment.mesh.to_model()?);
    let bvh = Arc::new(MorphBvh::build(Arc::clone(&model), &BuildOptions::default()));
    let mut poses = [Pose::new(Arc::clone(&bvh)), Pose::new(Arc::clone(&bvh))];
    let frame = &experiment.frames[experiment.frames.len() / 2];
    let mut places = [WorldFromModel::IDENTITY; 2];
    for ((pose, place), (weights, affine)) in poses.iter_mut().zip(&mut places).zip(frame) {
        pose.set_weights(weights)?;
        *place = WorldFromModel::new(*affine)?;
    }
    let ([a, b], [at_a, at_b]) = (&mut poses, &places);
    PairQuery::new().all(Body::new(a, at_a), Body::new(b, at_b), &mut Vec::new());
    Ok(Memory {
        model: model.bytes(),
        tree: bvh.bytes(),
        pose: poses[0].bytes(),
    })
}

/// Seconds to build our tree and Parry's, medians over interleaved rounds.
fn build_times(mesh: &MorphMesh, rounds: usize) -> Result<[f64; 2], Box<dyn Error>> {
    let model = Arc::new(mesh.to_model()?);
    let mut times = [Vec::new(), Vec::new()];
    for _ in 0..rounds {
        let clock = Stopwatch::start();
        let tree = MorphBvh::build(Arc::clone(&model), &BuildOptions::default());
        times[0].push(clock.elapsed().as_secs_f64());
        drop(tree);
        let clock = Stopwatch::start();
        let boxes: Vec<Aabb> = mesh.triangles.iter().map(|corners| around(mesh, corners)).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        times[1].push(clock.elapsed().as_secs_f64());
        drop(tree);
    }
    Ok(times.map(|times| median(times.into_iter())))
}

fn around(mesh: &MorphMesh, corners: &[u32; 3]) -> Aabb {
    let [p, q, r] = corners.map(|vertex| mesh.positions[vertex as usize]);
    Aabb {
        mins: p.min(q).min(r),
        maxs: p.max(q).max(r),
    }
}
