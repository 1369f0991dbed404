//! What is in a file, apart from how it is stored. A file is written from this, and evaluated from this.

use super::numbers::Numbers;

#[derive(Debug, Default)]
pub(super) struct Description {
    pub(super) meshes: Vec<Mesh>,
    pub(super) nodes: Vec<Node>,
    pub(super) skins: Vec<Skin>,
    /// All channels are of one animation.
    pub(super) channels: Vec<Channel>,
    /// Root nodes of each scene; empty if the file has no scenes.
    pub(super) scenes: Vec<Vec<usize>>,
    pub(super) default_scene: Option<usize>,
}

#[derive(Debug)]
pub(super) struct Mesh {
    pub(super) vertices: Vec<Vertices>,
    pub(super) primitives: Vec<Primitive>,
    pub(super) weights: Option<Vec<f32>>,
}

#[derive(Debug)]
pub(super) struct Vertices {
    pub(super) positions: Numbers,
    pub(super) targets: Vec<Numbers>,
    /// Joints and weights of each set.
    pub(super) influences: Vec<[Numbers; 2]>,
}

#[derive(Debug)]
pub(super) struct Primitive {
    /// Which of the mesh's vertices.
    pub(super) vertices: usize,
    /// 4, 5 or 6: triangles, a strip or a fan.
    pub(super) mode: u32,
    pub(super) indices: Option<Numbers>,
}

#[derive(Debug, Default)]
pub(super) struct Node {
    pub(super) parent: Option<usize>,
    pub(super) local: Local,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) weights: Option<Vec<f32>>,
    pub(super) instances: Option<Instances>,
    pub(super) is_hidden: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Local {
    Parts {
        translation: [f32; 3],
        rotation: [f32; 4],
        scale: [f32; 3],
    },
    /// In columns.
    Matrix([f32; 16]),
}

impl Default for Local {
    fn default() -> Self {
        Self::Parts {
            translation: [0.0; 3],
            rotation: [0.0, 0.0, 0.0, 1.0],
            scale: [1.0; 3],
        }
    }
}

#[derive(Debug)]
pub(super) struct Instances {
    pub(super) translations: Option<Numbers>,
    pub(super) rotations: Option<Numbers>,
    pub(super) scales: Option<Numbers>,
}

#[derive(Debug)]
pub(super) struct Skin {
    pub(super) joints: Vec<usize>,
    pub(super) inverse_binds: Option<Numbers>,
}

#[derive(Debug)]
pub(super) struct Channel {
    pub(super) target: Target,
    /// Whether it is named by `KHR_animation_pointer`.
    pub(super) by_pointer: bool,
    pub(super) interpolation: Interpolation,
    pub(super) times: Numbers,
    /// Of weights, one number per element.
    pub(super) values: Numbers,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Target {
    Weights(usize),
    MeshWeights(usize),
    Translation(usize),
    Rotation(usize),
    Scale(usize),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Interpolation {
    Linear,
    Step,
    Cubic,
}

impl Description {
    pub(super) fn children(&self, node: usize) -> Vec<usize> {
        let is_child = |child: &usize| self.nodes[*child].parent == Some(node);
        (0..self.nodes.len()).filter(is_child).collect()
    }

    /// The numbers of joints that move a vertex.
    pub(super) fn influence_counts(&self) -> impl Iterator<Item = usize> {
        let vertices = self.meshes.iter().flat_map(|mesh| &mesh.vertices);
        vertices
            .filter(|vertices| !vertices.influences.is_empty())
            .flat_map(|vertices| {
                (0..vertices.positions.count()).map(|vertex| {
                    let weights = vertices
                        .influences
                        .iter()
                        .flat_map(|[_, weights]| weights.element(vertex));
                    weights.filter(|&weight| weight > 0.0).count()
                })
            })
    }

    /// The times of all keys.
    pub(super) fn key_times(&self) -> Vec<f32> {
        let times = |channel: &Channel| {
            (0..channel.times.count())
                .map(|key| channel.times.element(key)[0] as f32)
                .collect::<Vec<_>>()
        };
        let mut times: Vec<f32> = self.channels.iter().flat_map(times).collect();
        times.sort_by(f32::total_cmp);
        times.dedup();
        times
    }
}
