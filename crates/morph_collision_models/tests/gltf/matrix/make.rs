//! Makes a random file of a choice.

use rand::RngExt;
use rand_pcg::Pcg64Mcg;

use super::animate;
use super::choice::{Choice, Compression, Form, Shown};
use super::description::{Description, Instances, Local, Mesh, Node, Primitive, Skin, Vertices};
use super::numbers::{Kind, Numbers, is_signed, largest, rotation};
use crate::support::{F32, U8};

/// The mesh that the choice is about. Mesh 0 is one triangle, which the scene may leave out.
const MESH: usize = 1;

pub(super) fn description(choice: &Choice, rng: &mut Pcg64Mcg) -> Description {
    let mut made = Description {
        meshes: vec![triangle(), mesh(choice, rng)],
        ..Description::default()
    };
    let shown = if choice.shown() == Shown::ByThree { 3 } else { 1 };
    for number in 0..shown {
        // The last one has weights of its own, so those of the mesh do not count there.
        let has_weights = number == 2 || rng.random_bool(0.3);
        let weights = (choice.targets() > 0 && has_weights).then(|| weights(choice.targets(), rng));
        made.nodes.push(Node {
            local: parts(rng),
            mesh: Some(MESH),
            weights,
            instances: (choice.shown() == Shown::Instanced).then(|| instances(choice, rng)),
            ..Node::default()
        });
    }
    if let Some((_, most)) = choice.influences() {
        for number in 0..shown {
            made.nodes[number].skin = Some(made.skins.len());
            add_skin(&mut made, choice, most + 1, rng);
        }
    }
    add_ancestors(&mut made, choice, rng);
    add_scenes(&mut made, rng);
    made.channels = animate::channels(&made, choice, MESH, shown, rng);
    made
}

fn triangle() -> Mesh {
    let positions = Numbers::of((F32, false), 3, [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let vertices = Vertices {
        positions,
        targets: Vec::new(),
        influences: Vec::new(),
    };
    let primitive = Primitive {
        vertices: 0,
        mode: 4,
        indices: None,
    };
    Mesh {
        vertices: vec![vertices],
        primitives: vec![primitive],
        weights: None,
    }
}

fn mesh(choice: &Choice, rng: &mut Pcg64Mcg) -> Mesh {
    let (own, shared) = choice.primitives();
    let vertices: Vec<Vertices> = (0..own).map(|_| vertices(choice, rng)).collect();
    let mut primitives = Vec::new();
    for number in 0..own + shared {
        let is_draco = matches!(choice.compression(), Compression::Draco(..));
        let (mode, has_indices) = match number {
            1.. if !is_draco => (rng.random_range(4..7), rng.random()),
            _ => choice.mode(),
        };
        let vertices_of = number.min(own - 1);
        let count = vertices[vertices_of].positions.count();
        let corners = if mode == 4 { 3 * rng.random_range(2..8) } else { 7 };
        let indices = (0..corners).map(|_| rng.random_range(0..count) as f64).collect();
        primitives.push(Primitive {
            vertices: vertices_of,
            mode,
            indices: has_indices.then(|| Numbers::integers((choice.indices(), false), 1, indices)),
        });
    }
    let has_weights = choice.targets() > 0 && rng.random();
    Mesh {
        vertices,
        primitives,
        weights: has_weights.then(|| weights(choice.targets(), rng)),
    }
}

fn weights(count: usize, rng: &mut Pcg64Mcg) -> Vec<f32> {
    (0..count).map(|_| rng.random_range(-0.5..1.5)).collect()
}

/// The size of numbers of a type, so that rounding to integers leaves something.
fn span(kind: Kind) -> f64 {
    match largest(kind.0) {
        Some(largest) if !kind.1 => {
            if largest < 256.0 {
                100.0
            } else {
                3000.0
            }
        }
        _ => 1.0,
    }
}

fn vertices(choice: &Choice, rng: &mut Pcg64Mcg) -> Vertices {
    // A multiple of three, for triangles without indices.
    let count = 3 * rng.random_range(2..5);
    let random = |kind: Kind, span: f64, zeros: f64, rng: &mut Pcg64Mcg| {
        let least = if is_signed(kind.0) { -span } else { 0.0 };
        let mut values = Vec::new();
        for _ in 0..count {
            let is_zero = rng.random_bool(zeros);
            values.extend([0; 3].map(|_| if is_zero { 0.0 } else { rng.random_range(least..span) }));
        }
        Numbers::of(kind, 3, values)
    };
    let span = span(choice.positions());
    let zeros = if choice.target_form() == Form::SparseZeros(U8) {
        0.6
    } else {
        0.1
    };
    Vertices {
        positions: random(choice.positions(), span, 0.0, rng),
        targets: (0..choice.targets())
            .map(|_| random(choice.displacements(), span, zeros, rng))
            .collect(),
        influences: choice
            .influences()
            .map(|range| influences(choice, count, range, rng))
            .unwrap_or_default(),
    }
}

fn influences(
    choice: &Choice,
    vertices: usize,
    (least, most): (usize, usize),
    rng: &mut Pcg64Mcg,
) -> Vec<[Numbers; 2]> {
    let most_here = rng.random_range(least..=most);
    let sets = most_here.div_ceil(4);
    let kind = choice.joint_weights();
    let mut slots = vec![[Vec::new(), Vec::new()]; sets];
    for _ in 0..vertices {
        let count = rng.random_range(least..=most_here);
        let first = rng.random_range(0..=most);
        let shares: Vec<f64> = (0..count).map(|_| rng.random_range(0.1..1.0)).collect();
        let sum: f64 = shares.iter().sum();
        // Integers sum to the largest one, so that the weights sum to 1.
        let one = largest(kind.0).unwrap_or(1.0);
        let mut rest = one;
        for slot in 0..4 * sets {
            let [joints, weights] = &mut slots[slot / 4];
            let weight = match slot {
                _ if slot + 1 == count => rest,
                _ if slot < count && one > 1.0 => (shares[slot] / sum * one).floor(),
                _ if slot < count => shares[slot] / sum,
                _ => 0.0,
            };
            rest -= weight;
            weights.push(weight / one);
            // A vertex names no joint twice.
            joints.push(if slot < count {
                ((first + slot) % (most + 1)) as f64
            } else {
                0.0
            });
        }
    }
    let numbers = |[joints, weights]: [Vec<f64>; 2]| {
        [
            Numbers::integers((choice.joints(), false), 4, joints),
            Numbers::of(kind, 4, weights),
        ]
    };
    slots.into_iter().map(numbers).collect()
}

fn instances(choice: &Choice, rng: &mut Pcg64Mcg) -> Instances {
    const COUNT: usize = 3;
    let vectors = |range: std::ops::Range<f64>, rng: &mut Pcg64Mcg| {
        let values = (0..3 * COUNT).map(|_| rng.random_range(range.clone()));
        Numbers::of((F32, false), 3, values.collect::<Vec<f64>>())
    };
    let kind = if is_signed(choice.values().0) {
        choice.values()
    } else {
        (F32, false)
    };
    let turns: Vec<f64> = (0..COUNT).flat_map(|_| rotation(kind.0, rng)).collect();
    let rotations = match largest(kind.0) {
        None => Numbers::of(kind, 4, turns),
        Some(_) => Numbers::integers(kind, 4, turns),
    };
    let mut is_kept = || rng.random_bool(0.7);
    let kept = [is_kept(), is_kept(), is_kept()];
    Instances {
        // At least one of them.
        translations: (kept[0] || !kept[1]).then(|| vectors(-3.0..3.0, rng)),
        rotations: kept[1].then_some(rotations),
        scales: kept[2].then(|| vectors(0.5..1.5, rng)),
    }
}

fn add_skin(made: &mut Description, choice: &Choice, count: usize, rng: &mut Pcg64Mcg) {
    let first = made.nodes.len();
    for joint in 0..count {
        let has_parent = joint > 0 && rng.random_bool(0.6);
        // A matrix cannot be animated, and these are not.
        let is_matrix = choice.above() == 2 && joint % 3 == 2;
        made.nodes.push(Node {
            parent: has_parent.then(|| first + rng.random_range(0..joint)),
            local: if is_matrix { matrix(rng) } else { parts(rng) },
            ..Node::default()
        });
    }
    // In another order than the nodes.
    let joints: Vec<usize> = (0..count).map(|joint| first + (joint + 2) % count).collect();
    let binds = (0..count).flat_map(|_| match matrix(rng) {
        Local::Matrix(matrix) => matrix.map(f64::from),
        Local::Parts { .. } => [0.0; 16],
    });
    let inverse_binds = Numbers::of((F32, false), 16, binds.collect::<Vec<f64>>());
    made.skins.push(Skin {
        joints,
        inverse_binds: rng.random_bool(0.8).then_some(inverse_binds),
    });
}

/// Two nodes above everything that has no parent.
fn add_ancestors(made: &mut Description, choice: &Choice, rng: &mut Pcg64Mcg) {
    if choice.above() == 0 {
        return;
    }
    let mut local = || if choice.above() == 1 { parts(rng) } else { matrix(rng) };
    let (parent, top) = (made.nodes.len(), made.nodes.len() + 1);
    for node in made.nodes.iter_mut().filter(|node| node.parent.is_none()) {
        node.parent = Some(parent);
    }
    made.nodes.push(Node {
        parent: Some(top),
        local: local(),
        ..Node::default()
    });
    made.nodes.push(Node {
        local: local(),
        ..Node::default()
    });
}

/// A file without scenes, or one whose scene leaves a node out, or one that hides it.
fn add_scenes(made: &mut Description, rng: &mut Pcg64Mcg) {
    let is_root = |node: &usize| made.nodes[*node].parent.is_none();
    let roots: Vec<usize> = (0..made.nodes.len()).filter(is_root).collect();
    let other = made.nodes.len();
    let form = rng.random_range(0..3);
    made.nodes.push(Node {
        mesh: Some(0),
        // Without scenes, nothing is hidden.
        is_hidden: form == 2,
        ..Node::default()
    });
    made.scenes = match form {
        0 => return,
        1 => vec![vec![other], roots],
        _ => vec![[roots, vec![other]].concat()],
    };
    made.default_scene = (form == 1).then_some(1);
}

fn parts(rng: &mut Pcg64Mcg) -> Local {
    let mut vector = |range: std::ops::Range<f32>| [0; 3].map(|_| rng.random_range(range.clone()));
    let (translation, scale) = (vector(-2.0..2.0), vector(0.7..1.3));
    Local::Parts {
        translation,
        rotation: rotation(F32, rng).map(|c| c as f32),
        scale,
    }
}

fn matrix(rng: &mut Pcg64Mcg) -> Local {
    let matrix = super::evaluate::local(&parts(rng));
    Local::Matrix(std::array::from_fn(|entry| matrix[entry / 4][entry % 4] as f32))
}
