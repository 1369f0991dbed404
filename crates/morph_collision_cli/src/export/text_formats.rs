//! PLY and OBJ, both as text with a colour per vertex.

use std::io::{self, Write};

use super::surface::Surface;

/// Writes a PLY file. Coordinates are rounded to `f32`, which most programs expect.
pub(super) fn write_ply(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    writeln!(
        out,
        "ply\nformat ascii 1.0\ncomment morph-collide: triangles that touch are red"
    )?;
    writeln!(out, "element vertex {}", surface.vertices.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property float {axis}")?;
    }
    for color in ["red", "green", "blue"] {
        writeln!(out, "property uchar {color}")?;
    }
    writeln!(out, "element face {}", surface.triangle_count())?;
    writeln!(out, "property list uchar uint vertex_indices\nend_header")?;
    for (vertex, color) in surface.vertices.iter().zip(&surface.colors) {
        let ([x, y, z], [r, g, b]) = (vertex.as_vec3().to_array(), color.rgb());
        writeln!(out, "{x} {y} {z} {r} {g} {b}")?;
    }
    for [a, b, c] in surface.parts.iter().flat_map(|part| &part.triangles) {
        writeln!(out, "3 {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes an OBJ file: an object per body, and colours behind the coordinates, as most programs read them.
pub(super) fn write_obj(out: &mut dyn Write, surface: &Surface) -> io::Result<()> {
    writeln!(out, "# morph-collide: triangles that touch are red")?;
    for part in &surface.parts {
        // Line breaks would end the name.
        let name: String = part
            .name
            .chars()
            .map(|c| if c.is_control() { '_' } else { c })
            .collect();
        writeln!(out, "o {name}")?;
        for vertex in part.vertices.clone() {
            let [x, y, z] = surface.vertices[vertex as usize].to_array();
            let [r, g, b] = surface.colors[vertex as usize]
                .rgb()
                .map(|value| f32::from(value) / 255.0);
            writeln!(out, "v {x} {y} {z} {r:.4} {g:.4} {b:.4}")?;
        }
        for corners in &part.triangles {
            // Vertices count from 1.
            let [a, b, c] = corners.map(|vertex| u64::from(vertex) + 1);
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::surface::{Color, Part};
    use super::*;

    fn surface() -> Surface {
        let part = |name: &str, first: u32| Part {
            name: name.to_owned(),
            triangles: vec![[first, first + 1, first + 2]],
            vertices: first..first + 3,
        };
        Surface {
            vertices: vec![
                DVec3::ZERO,
                DVec3::X,
                DVec3::Y,
                DVec3::ZERO,
                DVec3::X,
                DVec3::splat(0.1),
            ],
            colors: [[Color::Body(0); 3], [Color::Touching; 3]].concat(),
            parts: vec![part("Body\n1", 0), part("Other", 3)],
        }
    }

    #[test]
    fn ply_has_a_line_per_vertex_and_per_triangle() -> io::Result<()> {
        let mut bytes = Vec::new();
        write_ply(&mut bytes, &surface())?;
        let text = String::from_utf8_lossy(&bytes);
        let (header, body) = text.split_once("end_header\n").unwrap_or_default();
        assert!(
            header.contains("element vertex 6\n") && header.contains("element face 2\n"),
            "{header}"
        );
        let lines: Vec<&str> = body.lines().collect();
        assert_eq!(lines.len(), 8);
        assert_eq!((lines[0], lines[5]), ("0 0 0 82 134 180", "0.1 0.1 0.1 224 48 40"));
        assert_eq!(lines[6..], ["3 0 1 2", "3 3 4 5"]);
        Ok(())
    }

    #[test]
    fn obj_counts_from_1_and_has_an_object_per_body() -> io::Result<()> {
        let mut bytes = Vec::new();
        write_obj(&mut bytes, &surface())?;
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("o Body_1\n") && text.contains("o Other\n"), "{text}");
        assert!(text.contains("v 0.1 0.1 0.1 0.8784 0.1882 0.1569\n"), "{text}");
        assert!(text.ends_with("f 4 5 6\n"), "{text}");
        Ok(())
    }
}
