//! The table of triangles that touch.

use std::io::{self, Write};

use glam::DVec3;
use morph_collision::triangle_contact;

use crate::blame::Blame;
use crate::cast::Cast;
use crate::output::csv_field;
use crate::posed::Posed;
use crate::touching::Touch;

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
    let weights: Vec<_> = (0..cast.bodies).map(|body| cast.shape(frame, body).weights).collect();
    let blames: Vec<Blame<'_>> = cast
        .mesh_of_body
        .iter()
        .map(|&mesh| Blame::new(&cast.meshes[mesh]))
        .collect();
    let (posed, names) = (&mut cast.method, &cast.names);
    let row = |touch: &Touch| {
        let [a, b] = touch.bodies;
        let triangles = [touch.pair.triangle_a, touch.pair.triangle_b];
        let first = posed[a].body().triangle(triangles[0])?;
        let second = posed[b].body().triangle(triangles[1])?;
        let contact = triangle_contact(&first, &second)?;
        let targets = |body: usize, triangle: u32| blames[body].targets_of(triangle, &weights[body]).join("; ");
        Some(Row {
            bodies: [names[a].clone(), names[b].clone()],
            triangles,
            point: contact.point(),
            length: contact.length(),
            targets: [targets(a, triangles[0]), targets(b, triangles[1])],
        })
    };
    touches.iter().filter_map(row).collect()
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
