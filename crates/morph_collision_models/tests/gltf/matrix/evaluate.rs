//! The triangles of a description at a time, as the specification of glTF 2.0 defines them, in `f64`. It shares no code with the reader.

use super::curve;
use super::description::{Description, Interpolation, Local, Mesh, Primitive, Target};

pub(super) type Point = [f64; 3];
/// In columns.
pub(super) type Matrix = [[f64; 4]; 4];

/// A mesh as it is drawn once: mesh, node and instance.
pub(super) type Place = (usize, usize, Option<usize>);

impl Description {
    /// Everything that the default scene draws, in the order of meshes, then nodes, then instances, with its triangles at a time.
    pub(super) fn drawn(&self, seconds: f64) -> Vec<(Place, Vec<[Point; 3]>)> {
        let mut nodes = Vec::new();
        match self.scenes.get(self.default_scene.unwrap_or(0)) {
            None => nodes.extend(0..self.nodes.len()),
            Some(roots) => {
                for &root in roots {
                    self.add_visible(root, &mut nodes);
                }
            }
        }
        let mut drawn = Vec::new();
        for node in nodes {
            let Some(mesh) = self.nodes[node].mesh else { continue };
            let instances = self.nodes[node].instances.as_ref();
            let count = instances.map(|instances| {
                let lists = [&instances.translations, &instances.rotations, &instances.scales];
                lists
                    .into_iter()
                    .flatten()
                    .next()
                    .expect("there is one of them")
                    .count()
            });
            for instance in 0..count.unwrap_or(1) {
                let place = (mesh, node, count.map(|_| instance));
                drawn.push((place, self.triangles(place, seconds)));
            }
        }
        drawn.sort_by_key(|(place, _)| *place);
        drawn
    }

    fn add_visible(&self, node: usize, nodes: &mut Vec<usize>) {
        if !self.nodes[node].is_hidden {
            nodes.push(node);
            for child in self.children(node) {
                self.add_visible(child, nodes);
            }
        }
    }

    fn triangles(&self, place: Place, seconds: f64) -> Vec<[Point; 3]> {
        let mesh = &self.meshes[place.0];
        let weights = self.weights(place.1, seconds);
        let of_primitive = |primitive: &Primitive| {
            let points = self.vertices(mesh, primitive.vertices, place, &weights, seconds);
            let corners = corners(primitive, points.len());
            corners
                .into_iter()
                .map(move |triangle| triangle.map(|corner| points[corner]))
        };
        mesh.primitives.iter().flat_map(of_primitive).collect()
    }

    fn vertices(&self, mesh: &Mesh, vertices: usize, place: Place, weights: &[f64], seconds: f64) -> Vec<Point> {
        let vertices = &mesh.vertices[vertices];
        let skin = self.nodes[place.1].skin.map(|skin| &self.skins[skin]);
        let joints: Option<Vec<Matrix>> = skin.map(|skin| {
            let matrix = |(joint, node): (usize, &usize)| match &skin.inverse_binds {
                None => self.global(*node, seconds),
                Some(binds) => {
                    let bind = binds.element(joint);
                    let bind = std::array::from_fn(|c| std::array::from_fn(|r| bind[4 * c + r]));
                    product(&self.global(*node, seconds), &bind)
                }
            };
            skin.joints.iter().enumerate().map(matrix).collect()
        });
        let of_vertex = |vertex: usize| {
            let mut point = vertices.positions.vector(vertex);
            for (target, weight) in vertices.targets.iter().zip(weights) {
                let by = target.vector(vertex);
                point = [0, 1, 2].map(|axis| point[axis] + weight * by[axis]);
            }
            let Some(joints) = &joints else {
                return transformed(&self.placement(place, seconds), point);
            };
            let mut sum = [0.0; 3];
            for [of_joints, of_weights] in &vertices.influences {
                for (joint, weight) in of_joints.element(vertex).into_iter().zip(of_weights.element(vertex)) {
                    let moved = transformed(&joints[joint as usize], point);
                    sum = [0, 1, 2].map(|axis| sum[axis] + weight * moved[axis]);
                }
            }
            sum
        };
        (0..vertices.positions.count()).map(of_vertex).collect()
    }

    /// The weights of the mesh that a node shows.
    fn weights(&self, node: usize, seconds: f64) -> Vec<f64> {
        let own = self.nodes[node].weights.as_ref();
        let mesh = self.nodes[node].mesh.expect("it shows one");
        let targets = self.meshes[mesh].vertices[0].targets.len();
        let animated = self.channels.iter().find(|channel| match channel.target {
            Target::Weights(animated) => animated == node,
            Target::MeshWeights(animated) => animated == mesh && own.is_none(),
            _ => false,
        });
        match (animated, own.or(self.meshes[mesh].weights.as_ref())) {
            (Some(channel), _) => curve::value(channel, targets, seconds),
            (None, Some(weights)) => weights.iter().map(|&weight| f64::from(weight)).collect(),
            (None, None) => vec![0.0; targets],
        }
    }

    /// Where a mesh without a skin is in the world.
    fn placement(&self, (_, node, instance): Place, seconds: f64) -> Matrix {
        let global = self.global(node, seconds);
        let (Some(instance), Some(instances)) = (instance, &self.nodes[node].instances) else {
            return global;
        };
        let translation = instances
            .translations
            .as_ref()
            .map_or([0.0; 3], |list| list.vector(instance));
        let scale = instances.scales.as_ref().map_or([1.0; 3], |list| list.vector(instance));
        let rotation = instances.rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |list| {
            let turn = list.element(instance);
            [turn[0], turn[1], turn[2], turn[3]]
        });
        product(&global, &composed(translation, rotation, scale))
    }

    fn global(&self, node: usize, seconds: f64) -> Matrix {
        let local = self.local_at(node, seconds);
        match self.nodes[node].parent {
            None => local,
            Some(parent) => product(&self.global(parent, seconds), &local),
        }
    }

    fn local_at(&self, node: usize, seconds: f64) -> Matrix {
        let Local::Parts {
            translation,
            rotation,
            scale,
        } = self.nodes[node].local
        else {
            return local(&self.nodes[node].local);
        };
        let (mut translation, mut scale) = (translation.map(f64::from), scale.map(f64::from));
        let mut rotation = rotation.map(f64::from);
        for channel in &self.channels {
            let vector = |components: usize| curve::value(channel, components, seconds);
            match channel.target {
                Target::Translation(animated) if animated == node => translation.copy_from_slice(&vector(3)),
                Target::Scale(animated) if animated == node => scale.copy_from_slice(&vector(3)),
                Target::Rotation(animated) if animated == node => {
                    rotation = match channel.interpolation {
                        Interpolation::Linear => curve::rotation(channel, seconds),
                        _ => curve::normalized(&vector(4)),
                    }
                }
                _ => {}
            }
        }
        composed(translation, rotation, scale)
    }
}

/// The corners of a primitive's triangles.
fn corners(primitive: &Primitive, vertices: usize) -> Vec<[usize; 3]> {
    let list: Vec<usize> = match &primitive.indices {
        None => (0..vertices).collect(),
        Some(indices) => (0..indices.count()).map(|at| indices.element(at)[0] as usize).collect(),
    };
    match primitive.mode {
        4 => (0..list.len() / 3)
            .map(|i| [list[3 * i], list[3 * i + 1], list[3 * i + 2]])
            .collect(),
        5 => (0..list.len() - 2)
            .map(|i| [list[i], list[i + (1 + i % 2)], list[i + (2 - i % 2)]])
            .collect(),
        _ => (0..list.len() - 2)
            .map(|i| [list[i + 1], list[i + 2], list[0]])
            .collect(),
    }
}

/// A node's own transform at rest.
pub(super) fn local(local: &Local) -> Matrix {
    match local {
        Local::Matrix(entries) => std::array::from_fn(|c| std::array::from_fn(|r| f64::from(entries[4 * c + r]))),
        Local::Parts {
            translation,
            rotation,
            scale,
        } => composed(
            translation.map(f64::from),
            rotation.map(f64::from),
            scale.map(f64::from),
        ),
    }
}

fn composed(translation: Point, [x, y, z, w]: [f64; 4], scale: Point) -> Matrix {
    let turned = [
        [
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y + w * z),
            2.0 * (x * z - w * y),
        ],
        [
            2.0 * (x * y - w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z + w * x),
        ],
        [
            2.0 * (x * z + w * y),
            2.0 * (y * z - w * x),
            1.0 - 2.0 * (x * x + y * y),
        ],
    ];
    let axis = |c: usize| {
        [
            turned[c][0] * scale[c],
            turned[c][1] * scale[c],
            turned[c][2] * scale[c],
            0.0,
        ]
    };
    [
        axis(0),
        axis(1),
        axis(2),
        [translation[0], translation[1], translation[2], 1.0],
    ]
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|c| std::array::from_fn(|r| (0..4).map(|k| a[k][r] * b[c][k]).sum()))
}

fn transformed(matrix: &Matrix, [x, y, z]: Point) -> Point {
    [0, 1, 2].map(|r| matrix[0][r] * x + matrix[1][r] * y + matrix[2][r] * z + matrix[3][r])
}
