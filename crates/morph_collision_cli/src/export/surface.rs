//! Posed bodies as one coloured surface.

use glam::DVec3;
use morph_collision_models::gltf::write::Appearance;
use morph_collision_models::mesh::MorphMesh;

use crate::cast::Cast;
use crate::cast::posed::Posed;
use crate::touching::Touch;

/// Bodies in world space.
#[derive(Clone, Debug, Default)]
pub(super) struct Surface {
    pub(super) vertices: Vec<DVec3>,
    /// The colour of each vertex. A vertex of triangles of both colours is there twice, so that colours do not run into each other.
    pub(super) colors: Vec<Color>,
    pub(super) parts: Vec<Part>,
}

/// The triangles of one body, in the order of its mesh.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) name: String,
    pub(super) triangles: Vec<[u32; 3]>,
    /// Its vertices: the first one and the end.
    pub(super) vertices: std::ops::Range<u32>,
}

/// The colour of a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Color {
    /// The colour of a body.
    Body(usize),
    Touching,
}

/// The colours of bodies in sRGB, repeated in order.
const BODIES: [[u8; 3]; 6] = [
    [82, 134, 180],
    [98, 172, 158],
    [206, 176, 104],
    [146, 116, 178],
    [134, 168, 90],
    [138, 148, 160],
];
const TOUCHING: [u8; 3] = [224, 48, 40];

impl Color {
    /// In sRGB.
    pub(super) fn rgb(self) -> [u8; 3] {
        match self {
            Self::Body(body) => BODIES[body % BODIES.len()],
            Self::Touching => TOUCHING,
        }
    }

    pub(super) fn appearance(self) -> Appearance {
        let [r, g, b] = self.rgb().map(|value| (f32::from(value) / 255.0).powf(2.2));
        Appearance {
            base_color: [r, g, b, 1.0],
            roughness: 0.7,
        }
    }
}

impl Surface {
    /// The bodies as they are posed; triangles in `touches` have a colour of their own.
    pub(super) fn new(cast: &mut Cast<Vec<Posed>>, touches: &[Touch]) -> Self {
        let mut touching: Vec<Vec<bool>> = (0..cast.bodies)
            .map(|body| vec![false; cast.mesh(body).triangles.len()])
            .collect();
        for touch in touches {
            let [a, b] = touch.bodies;
            touching[a][touch.pair.triangle_a as usize] = true;
            touching[b][touch.pair.triangle_b as usize] = true;
        }
        let mut surface = Self::default();
        for (body, touching) in touching.iter().enumerate() {
            let vertices = cast.method[body].vertices();
            surface.add(
                cast.names[body].clone(),
                Color::Body(body),
                &vertices,
                &cast.mesh(body).triangles,
                touching,
            );
        }
        surface
    }

    /// Adds a body with the vertices that its triangles use.
    fn add(&mut self, name: String, color: Color, vertices: &[DVec3], triangles: &[[u32; 3]], touching: &[bool]) {
        let start = self.vertices.len() as u32;
        // The place of each vertex in either colour.
        let mut places = vec![[u32::MAX; 2]; vertices.len()];
        let mut place = |vertex: u32, is_touching: bool| {
            let slot = &mut places[vertex as usize][usize::from(is_touching)];
            if *slot == u32::MAX {
                *slot = self.vertices.len() as u32;
                self.vertices.push(vertices[vertex as usize]);
                self.colors.push(if is_touching { Color::Touching } else { color });
            }
            *slot
        };
        let triangles = triangles
            .iter()
            .zip(touching)
            .map(|(triangle, &is_touching)| triangle.map(|vertex| place(vertex, is_touching)))
            .collect();
        self.parts.push(Part {
            name,
            triangles,
            vertices: start..self.vertices.len() as u32,
        });
    }

    pub(super) fn triangle_count(&self) -> usize {
        self.parts.iter().map(|part| part.triangles.len()).sum()
    }

    /// The number of triangles that touch.
    pub(super) fn touching_count(&self) -> usize {
        let triangles = self.parts.iter().flat_map(|part| &part.triangles);
        triangles
            .filter(|triangle| self.color(triangle) == Color::Touching)
            .count()
    }

    /// The colour of a triangle, which is that of its corners.
    fn color(&self, triangle: &[u32; 3]) -> Color {
        self.colors[triangle[0] as usize]
    }

    /// One mesh with a primitive for each colour of each body.
    pub(super) fn into_mesh(self) -> (MorphMesh, Vec<Appearance>) {
        let (mut triangles, mut primitives, mut appearances) = (Vec::new(), Vec::new(), Vec::new());
        for part in &self.parts {
            for is_touching in [false, true] {
                let start = triangles.len();
                let wanted = |triangle: &&[u32; 3]| (self.color(triangle) == Color::Touching) == is_touching;
                triangles.extend(part.triangles.iter().filter(wanted));
                if let Some(first) = triangles.get(start) {
                    appearances.push(self.color(first).appearance());
                    primitives.push(start as u32..triangles.len() as u32);
                }
            }
        }
        let positions = self.vertices.iter().map(|vertex| vertex.as_vec3()).collect();
        let mesh = MorphMesh {
            name: "posed".to_owned(),
            positions,
            triangles,
            primitives,
            ..MorphMesh::default()
        };
        (mesh, appearances)
    }
}
