//! The modes that describe surfaces: where bodies touch, or how far apart they are.

use std::fmt::Write as _;
use std::io::{self, Write};

use morph_collision::{ClosestPair, ContactQuery, DistanceQuery, Manifold, QueryStats, overlapping_pairs};
use morph_collision_models::text::Printable;
use morph_collision_models::text::{number, numbers};
use serde::Serialize;

use super::{Mode, RunArgs};
use crate::cast::Cast;
use crate::cast::posed::Posed;
use crate::error::CliError;
use crate::messages::counted;
use crate::messages::progress;
use crate::output;
use crate::output::file::OutputFile;

/// The bodies of a scene with this project's trees.
type Surfaces = Cast<Vec<Posed>>;

/// The JSON of the modes `contacts` and `distance`.
#[derive(Debug, Serialize)]
struct SurfaceReport {
    frames: usize,
    bodies: Vec<String>,
    mode: &'static str,
    /// By frame, then by bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    contacts: Option<Vec<Contact>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    distances: Option<Vec<Distance>>,
    node_tests: u64,
    triangle_tests: u64,
}

/// Two bodies that touch in a frame.
#[derive(Debug, Serialize)]
struct Contact {
    frame: usize,
    body_a: usize,
    body_b: usize,
    /// Intersecting pairs of triangles.
    pairs: usize,
    #[serde(serialize_with = "number")]
    depth: f64,
    /// The direction in which the first body leaves the second.
    #[serde(serialize_with = "numbers")]
    normal: [f64; 3],
    points: Vec<Point>,
}

#[derive(Debug, Serialize)]
struct Point {
    #[serde(serialize_with = "numbers")]
    point: [f64; 3],
    #[serde(serialize_with = "number")]
    depth: f64,
    triangle_a: u32,
    triangle_b: u32,
}

/// How far apart two bodies are in a frame.
#[derive(Debug, Serialize)]
struct Distance {
    frame: usize,
    body_a: usize,
    body_b: usize,
    #[serde(serialize_with = "number")]
    distance: f64,
    triangle_a: u32,
    triangle_b: u32,
    #[serde(serialize_with = "numbers")]
    point_a: [f64; 3],
    #[serde(serialize_with = "numbers")]
    point_b: [f64; 3],
}

/// Loads, replays and reports a scene.
pub(super) fn run(args: &RunArgs) -> Result<(), CliError> {
    let budget = args.files.budget();
    let scene = args.files.read_scene(&args.scene, &budget)?;
    let mut cast = Cast::load(&args.scene, &scene, &args.tree, &args.files, &budget)?;
    let csv = args.pairs.as_deref();
    let csv = csv
        .map(|path| OutputFile::create("--pairs", path, &cast.inputs))
        .transpose()?;
    let mut report = SurfaceReport {
        frames: cast.frames.len(),
        bodies: cast.names.clone(),
        mode: args.mode.name(),
        contacts: (args.mode == Mode::Contacts).then(Vec::new),
        distances: (args.mode == Mode::Distance).then(Vec::new),
        node_tests: 0,
        triangle_tests: 0,
    };
    let steps = progress::count("frame", cast.frames.len() as u64);
    for frame in 0..cast.frames.len() {
        pose(&mut cast, frame)?;
        let stats = match (&mut report.contacts, &mut report.distances) {
            (Some(contacts), _) => touch(&mut cast.method, frame, contacts),
            (None, Some(distances)) => measure(&mut cast.method, frame, distances),
            (None, None) => QueryStats::default(),
        };
        report.node_tests += stats.node_tests;
        report.triangle_tests += stats.triangle_tests;
        steps.step();
    }
    if let Some(csv) = csv {
        csv.write(|out| report.write_csv(out))?;
    }
    if args.json {
        output::print_json(&report)
    } else {
        output::print(&report.text())
    }
}

fn pose(cast: &mut Surfaces, frame: usize) -> Result<(), CliError> {
    for body in 0..cast.bodies {
        let shape = cast.shape(frame, body);
        cast.method[body]
            .set(&shape)
            .map_err(|reason| cast.refused(frame, body, reason))?;
    }
    Ok(())
}

/// Finds the contacts of all bodies whose boxes overlap.
fn touch(bodies: &mut [Posed], frame: usize, contacts: &mut Vec<Contact>) -> QueryStats {
    let (mut query, mut stats) = (ContactQuery::new(), QueryStats::default());
    let bounds: Vec<_> = bodies.iter_mut().map(|body| Some(body.bounds())).collect();
    let mut candidates = Vec::new();
    overlapping_pairs(&bounds, &mut candidates);
    for (a, b) in candidates {
        let [body_a, body_b] = [a, b].map(|body| body as usize);
        let Ok([first, second]) = bodies.get_disjoint_mut([body_a, body_b]) else {
            continue;
        };
        if let Some(manifold) = query.manifold(first.body(), second.body()) {
            contacts.push(Contact::new(frame, [body_a, body_b], &manifold));
        }
        stats += query.stats();
    }
    stats
}

/// Finds the closest points of all pairs of bodies.
fn measure(bodies: &mut [Posed], frame: usize, distances: &mut Vec<Distance>) -> QueryStats {
    let (mut query, mut stats) = (DistanceQuery::new(), QueryStats::default());
    for body_a in 0..bodies.len() {
        for body_b in body_a + 1..bodies.len() {
            let Ok([first, second]) = bodies.get_disjoint_mut([body_a, body_b]) else {
                continue;
            };
            // Fails only for a maximum that is negative or NaN.
            if let Ok(Some(closest)) = query.closest(first.body(), second.body(), f64::INFINITY) {
                distances.push(Distance::new(frame, [body_a, body_b], &closest));
            }
            stats += query.stats();
        }
    }
    stats
}

impl Contact {
    fn new(frame: usize, [body_a, body_b]: [usize; 2], manifold: &Manifold) -> Self {
        let point = |contact: &morph_collision::ContactPoint| Point {
            point: contact.point.to_array(),
            depth: contact.depth,
            triangle_a: contact.triangles.triangle_a,
            triangle_b: contact.triangles.triangle_b,
        };
        Self {
            frame,
            body_a,
            body_b,
            pairs: manifold.pair_count,
            depth: manifold.depth,
            normal: manifold.normal.to_array(),
            points: manifold.points().iter().map(point).collect(),
        }
    }
}

impl Distance {
    fn new(frame: usize, [body_a, body_b]: [usize; 2], closest: &ClosestPair) -> Self {
        Self {
            frame,
            body_a,
            body_b,
            distance: closest.distance,
            triangle_a: closest.triangles.triangle_a,
            triangle_b: closest.triangles.triangle_b,
            point_a: closest.point_a.to_array(),
            point_b: closest.point_b.to_array(),
        }
    }
}

impl SurfaceReport {
    fn write_csv(&self, out: &mut dyn Write) -> io::Result<()> {
        if let Some(contacts) = &self.contacts {
            writeln!(
                out,
                "frame,body_a,body_b,pairs,depth,normal_x,normal_y,normal_z,point_x,point_y,point_z,point_depth,triangle_a,triangle_b"
            )?;
            for contact in contacts {
                let [x, y, z] = contact.normal;
                for point in &contact.points {
                    let [px, py, pz] = point.point;
                    writeln!(
                        out,
                        "{},{},{},{},{},{x},{y},{z},{px},{py},{pz},{},{},{}",
                        contact.frame,
                        contact.body_a,
                        contact.body_b,
                        contact.pairs,
                        contact.depth,
                        point.depth,
                        point.triangle_a,
                        point.triangle_b
                    )?;
                }
            }
        }
        if let Some(distances) = &self.distances {
            writeln!(
                out,
                "frame,body_a,body_b,distance,ax,ay,az,bx,by,bz,triangle_a,triangle_b"
            )?;
            for row in distances {
                let ([ax, ay, az], [bx, by, bz]) = (row.point_a, row.point_b);
                writeln!(
                    out,
                    "{},{},{},{},{ax},{ay},{az},{bx},{by},{bz},{},{}",
                    row.frame, row.body_a, row.body_b, row.distance, row.triangle_a, row.triangle_b
                )?;
            }
        }
        Ok(())
    }

    fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, text: &mut String) -> std::fmt::Result {
        let (frames, bodies) = (self.frames, self.bodies.len());
        writeln!(
            text,
            "{}, {}",
            counted(frames, "frame", "frames"),
            counted(bodies, "body", "bodies")
        )?;
        for (index, name) in self.bodies.iter().enumerate() {
            writeln!(text, "  body {index}: {}", Printable(name))?;
        }
        if let Some(contacts) = &self.contacts {
            if !contacts.is_empty() {
                writeln!(
                    text,
                    "{:>6} {:>7} {:>9} {:>12}  way out, first point",
                    "frame", "bodies", "pairs", "depth"
                )?;
            }
            for contact in contacts {
                let [x, y, z] = contact.normal;
                write!(
                    text,
                    "{:6} {:>7} {:9} {:12.6}  {x:.3} {y:.3} {z:.3}",
                    contact.frame,
                    format!("{}, {}", contact.body_a, contact.body_b),
                    contact.pairs,
                    contact.depth
                )?;
                match contact.points.first() {
                    Some(Point { point: [x, y, z], .. }) => writeln!(text, ", {x:.6} {y:.6} {z:.6}")?,
                    None => writeln!(text)?,
                }
            }
            let mut frames: Vec<usize> = contacts.iter().map(|contact| contact.frame).collect();
            frames.dedup();
            writeln!(text, "Bodies touch in {} of {} frames.", frames.len(), self.frames)?;
        }
        if let Some(distances) = &self.distances {
            writeln!(
                text,
                "{:>6} {:>7} {:>14}  closest points",
                "frame", "bodies", "distance"
            )?;
            for row in distances {
                let ([ax, ay, az], [bx, by, bz]) = (row.point_a, row.point_b);
                writeln!(
                    text,
                    "{:6} {:>7} {:14.6}  {ax:.6} {ay:.6} {az:.6} and {bx:.6} {by:.6} {bz:.6}",
                    row.frame,
                    format!("{}, {}", row.body_a, row.body_b),
                    row.distance
                )?;
            }
            let least = distances.iter().min_by(|a, b| a.distance.total_cmp(&b.distance));
            if let Some(least) = least {
                writeln!(
                    text,
                    "Bodies {} and {} are closest in frame {}: {:.6} apart.",
                    least.body_a, least.body_b, least.frame, least.distance
                )?;
            }
        }
        Ok(())
    }
}
