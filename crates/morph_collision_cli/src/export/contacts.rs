//! The table of triangles that touch.

use std::io::{self, Write};

use glam::{DAffine3, DVec3, Mat4, Vec3};
use morph_collision::{TrianglePair, triangle_contact};

use crate::cast::posed::Posed;
use crate::cast::{Cast, Shape};
use crate::output::csv_field;
use crate::touching::Touch;
use crate::touching::blame::Blame;

/// Two triangles that touch.
pub(super) struct Row {
    bodies: [String; 2],
    triangles: [u32; 2],
    /// The middle of the segment in which they meet.
    point: DVec3,
    /// The length of that segment.
    length: f64,
    /// The targets that move their corners most.
    targets: [String; 2],
}

/// One row per pair. All bodies are posed as in the frame.
pub(super) fn rows(cast: &mut Cast<Vec<Posed>>, frame: usize, touches: &[Touch]) -> Vec<Row> {
    let shapes: Vec<Shape> = (0..cast.bodies).map(|body| cast.shape(frame, body)).collect();
    let blames: Vec<Blame<'_>> = cast
        .mesh_of_body
        .iter()
        .map(|&mesh| Blame::new(&cast.meshes[mesh]))
        .collect();
    let (posed, names) = (&mut cast.method, &cast.names);
    let row = |touch: &Touch| {
        let [a, b] = touch.bodies;
        let triangles = [touch.pair.triangle_a, touch.pair.triangle_b];
        let [start, end] = segment(posed, &shapes[a], touch)?;
        let targets = |body: usize, triangle: u32| blames[body].targets_of(triangle, &shapes[body].weights).join("; ");
        Some(Row {
            bodies: [names[a].clone(), names[b].clone()],
            triangles,
            point: start + (end - start) * 0.5,
            length: start.distance(end),
            targets: [targets(a, triangles[0]), targets(b, triangles[1])],
        })
    };
    touches.iter().filter_map(row).collect()
}

/// The segment in which two triangles meet, in world space. `shape` is that of the first body.
fn segment(posed: &mut [Posed], shape: &Shape, touch: &Touch) -> Option<[DVec3; 2]> {
    let ([a, b], TrianglePair { triangle_a, triangle_b }) = (touch.bodies, touch.pair);
    if a != b {
        let first = posed[a].body().triangle(triangle_a)?;
        let second = posed[b].body().triangle(triangle_b)?;
        return Some(triangle_contact(&first, &second)?.segment);
    }
    // A body intersects itself in its own space. In the world, triangles that just touch may be apart by a rounding.
    let corners = |triangle: Option<[Vec3; 3]>| Some(triangle?.map(Vec3::as_dvec3));
    let first = corners(posed[a].pose.triangle(triangle_a))?;
    let second = corners(posed[a].pose.triangle(triangle_b))?;
    let segment = triangle_contact(&first, &second)?.segment;
    // Joints have placed a skinned mesh in the world.
    let place = match shape.joints {
        None => DAffine3::from_mat4(Mat4::from(shape.world_from_model).as_dmat4()),
        Some(_) => DAffine3::IDENTITY,
    };
    Some(segment.map(|point| place.transform_point3(point)))
}

/// Writes a header and one line per row.
pub(super) fn write_csv(out: &mut dyn Write, rows: &[Row]) -> io::Result<()> {
    writeln!(
        out,
        "body_a,triangle_a,targets_a,body_b,triangle_b,targets_b,x,y,z,length"
    )?;
    for row in rows {
        let [x, y, z] = row.point.to_array();
        writeln!(
            out,
            "{},{},{},{},{},{},{x},{y},{z},{}",
            csv_field(&row.bodies[0]),
            row.triangles[0],
            csv_field(&row.targets[0]),
            csv_field(&row.bodies[1]),
            row.triangles[1],
            csv_field(&row.targets[1]),
            row.length
        )?;
    }
    Ok(())
}
