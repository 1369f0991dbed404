//! Computes, hashes and merges the answers of a scene. Threads share the work; each has its own poses.

use std::sync::Arc;

use glam::{DVec3, Quat, Vec3};
use morph_collision::motion::MovingShape;
use morph_collision::{
    Body, BuildOptions, ContactQuery, ConvexHull, DistanceQuery, InputError, JointMatrices, MorphBvh, PairQuery,
    PlacedShape, Pose, Ray, RayHit, RayQuery, SelfQuery, Shape, ShapeQuery, TrianglePair, WorldFromModel,
};

use super::Run;
use super::hash::Hash;
use super::scenes::Scene;

/// Hashed separately, so that a difference shows where it is.
pub(super) const COLUMNS: [&str; 7] = ["vertices", "pairs", "self", "contacts", "distances", "rays", "shapes"];
const VERTICES: usize = 0;
const PAIRS: usize = 1;
const SELF: usize = 2;
const CONTACTS: usize = 3;
const DISTANCES: usize = 4;
const RAYS: usize = 5;
const SHAPES: usize = 6;

/// Hashes of answers, and related counts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answers {
    pub(super) hashes: [Hash; COLUMNS.len()],
    /// The pairs that the walks found first, which depend on the tree.
    pub(super) firsts: Hash,
    pub(super) pair_count: usize,
}

impl Answers {
    const NONE: Self = Self {
        hashes: [Hash::EMPTY; COLUMNS.len()],
        firsts: Hash::EMPTY,
        pair_count: 0,
    };

    fn append(&mut self, other: &Self) {
        for (all, one) in self.hashes.iter_mut().zip(&other.hashes) {
            all.u64(one.value());
        }
        self.firsts.u64(other.firsts.value());
        self.pair_count += other.pair_count;
    }
}

/// A question about one body, or about two, in a frame.
#[derive(Clone, Copy)]
struct Item {
    frame: usize,
    a: usize,
    b: Option<usize>,
}

/// All answers of a scene.
pub(super) fn of(scene: &Scene, run: Run) -> Answers {
    let options = BuildOptions::default().with_leaf_size(run.leaf_size).expect("1 to 255");
    let trees: Vec<Arc<MorphBvh>> = scene
        .meshes
        .iter()
        .map(|mesh| {
            let model = mesh.to_model().expect("the model is valid");
            Arc::new(MorphBvh::build(Arc::new(model), &options).with_kernel(run.kernel))
        })
        .collect();
    let items = items(scene);
    let share = |thread: usize| {
        let mut worker = Worker::new(scene, &trees);
        let mine = items.iter().enumerate().skip(thread).step_by(run.threads);
        mine.map(|(i, item)| (i, worker.answer(i, item))).collect::<Vec<_>>()
    };
    // Not every machine has threads, so the caller's thread does one share.
    let mut answers = std::thread::scope(|scope| {
        let share = &share;
        let others: Vec<_> = (1..run.threads)
            .map(|thread| scope.spawn(move || share(thread)))
            .collect();
        let mut answers = share(0);
        answers.extend(others.into_iter().flat_map(|thread| thread.join().expect("no panic")));
        answers
    });
    answers.sort_by_key(|(i, _)| *i);
    let mut all = Answers::NONE;
    answers.iter().for_each(|(_, one)| all.append(one));
    all
}

fn items(scene: &Scene) -> Vec<Item> {
    let mut items = Vec::new();
    for (frame, bodies) in scene.frames.iter().enumerate() {
        for a in 0..bodies.len() {
            items.push(Item { frame, a, b: None });
            items.extend((a + 1..bodies.len()).map(|b| Item { frame, a, b: Some(b) }));
        }
    }
    items
}

/// A thread's poses and queries. What they remember of one item must not affect the next.
struct Worker<'a> {
    scene: &'a Scene,
    poses: Vec<Pose>,
    pairs: PairQuery,
    within: SelfQuery,
    contacts: ContactQuery,
    distances: DistanceQuery,
    rays: RayQuery,
    shapes: ShapeQuery,
}

impl<'a> Worker<'a> {
    fn new(scene: &'a Scene, trees: &[Arc<MorphBvh>]) -> Self {
        Self {
            scene,
            poses: scene.frames[0]
                .iter()
                .map(|(mesh, ..)| Pose::new(trees[*mesh].clone()))
                .collect(),
            pairs: PairQuery::new(),
            within: SelfQuery::new(),
            contacts: ContactQuery::new(),
            distances: DistanceQuery::new(),
            rays: RayQuery::new(),
            shapes: ShapeQuery::new(),
        }
    }

    fn answer(&mut self, index: usize, item: &Item) -> Answers {
        let place = self.pose(item, item.a);
        let mut answers = Answers::NONE;
        match item.b {
            None => self.one(index, item.a, &place, &mut answers),
            Some(b) => {
                let place_b = self.pose(item, b);
                self.two([item.a, b], [&place, &place_b], &mut answers);
            }
        }
        answers
    }

    fn pose(&mut self, item: &Item, body: usize) -> WorldFromModel {
        let (_, weights, place) = &self.scene.frames[item.frame][body];
        self.poses[body].set_weights(weights).expect("the weights are valid");
        if let Some(joints) = self.scene.joints_of(item.frame, body) {
            let joints = JointMatrices::new(joints).expect("the joints are finite");
            self.poses[body].set_joints(&joints).expect("there is one per joint");
        }
        WorldFromModel::new(*place).expect("the place is finite")
    }

    fn one(&mut self, index: usize, body: usize, place: &WorldFromModel, answers: &mut Answers) {
        let pose = &mut self.poses[body];
        // Must run before all vertices are blended, because queries blend only what they look at.
        let mut hits = Vec::new();
        for ray in rays(place) {
            hits.clear();
            self.rays.all(Body::new(pose, place), &ray, &mut hits);
            let closest = self.rays.closest(Body::new(pose, place), &ray);
            assert_eq!(closest.as_ref().map(|hit| hit.t), hits.first().map(|hit| hit.t));
            let hash = &mut answers.hashes[RAYS];
            hash.u64(hits.len() as u64);
            hits.iter().for_each(|hit| hash_hit(hash, hit));
        }
        for motion in motions(place, self.scene.first_shape + index) {
            let hash = &mut answers.hashes[SHAPES];
            for time in [0.0, 0.3, 1.0] {
                let contact = self
                    .shapes
                    .closest(Body::new(pose, place), &motion.at(time), f64::INFINITY);
                let contact = contact.ok().flatten().expect("no distance is beyond infinity");
                hash.u32(contact.triangle);
                hash.number(contact.distance);
                hash.numbers(contact.point_on_triangle.to_array());
                hash.numbers(contact.normal.to_array());
            }
            if let Some(hit) = self.shapes.cast_moving(Body::new(pose, place), &motion, 1e-6) {
                hash.u32(hit.triangle);
                hash.numbers([hit.time.earliest, hit.time.latest]);
                hash.numbers(hit.point.to_array());
            }
        }
        let mut pairs = Vec::new();
        self.within.all(pose, &mut pairs);
        hash_pairs(&mut answers.hashes[SELF], &mut pairs);

        let hash = &mut answers.hashes[VERTICES];
        if pose.joints().is_some() {
            let welded = pose.bvh().model().welded_from_source().to_vec();
            let mut body = Body::new(pose, place);
            welded
                .iter()
                .filter_map(|&vertex| body.vertex(vertex))
                .for_each(|vertex| hash.world_vertex(vertex));
            return;
        }
        let mut positions = Vec::new();
        pose.source_positions(&mut positions);
        for position in positions {
            hash.vertex(position);
            hash.world_vertex(place.transform_point(position));
        }
    }

    fn two(&mut self, [a, b]: [usize; 2], [place_a, place_b]: [&WorldFromModel; 2], answers: &mut Answers) {
        let (before, after) = self.poses.split_at_mut(b);
        let (pose_a, pose_b) = (&mut before[a], &mut after[0]);
        macro_rules! bodies {
            () => {
                (Body::new(pose_a, place_a), Body::new(pose_b, place_b))
            };
        }
        let (a, b) = bodies!();
        let first = self.pairs.first(a, b);
        let (a, b) = bodies!();
        let mut pairs = Vec::new();
        self.pairs.all(a, b, &mut pairs);
        hash_pairs(&mut answers.hashes[PAIRS], &mut pairs);
        answers.pair_count = pairs.len();
        assert_eq!(first.is_some(), !pairs.is_empty());
        if let Some(first) = first {
            assert!(pairs.contains(&first), "{first:?} is first and not among all");
            hash_pairs(&mut answers.firsts, &mut [first]);
        }

        let (a, b) = bodies!();
        let manifold = self.contacts.manifold(a, b);
        let hash = &mut answers.hashes[CONTACTS];
        if let Some(manifold) = manifold {
            hash.u64(manifold.pair_count as u64);
            hash.numbers(manifold.normal.to_array());
            hash.number(manifold.depth);
            for point in manifold.points() {
                hash.numbers(point.point.to_array());
                hash.number(point.depth);
                hash_pairs(hash, &mut [point.triangles]);
            }
        }

        let (a, b) = bodies!();
        let closest = self.distances.closest(a, b, f64::INFINITY);
        let closest = closest.ok().flatten().expect("no distance is beyond infinity");
        let hash = &mut answers.hashes[DISTANCES];
        hash.number(closest.distance);
        // If two bodies touch, the common point that is found first depends on the tree.
        if closest.distance > 0.0 {
            hash.u32(closest.triangles.triangle_a);
            hash.u32(closest.triangles.triangle_b);
            hash.numbers(closest.point_a.to_array());
            hash.numbers(closest.point_b.to_array());
        }
    }
}

fn hash_pairs(hash: &mut Hash, pairs: &mut [TrianglePair]) {
    pairs.sort_unstable();
    hash.u64(pairs.len() as u64);
    for pair in pairs {
        hash.u32(pair.triangle_a);
        hash.u32(pair.triangle_b);
    }
}

fn hash_hit(hash: &mut Hash, hit: &RayHit) {
    hash.u32(hit.triangle);
    hash.numbers([hit.t, hit.distance]);
    hash.numbers(hit.barycentrics);
    hash.numbers(hit.point.to_array());
    hash.numbers(hit.normal.to_array());
}

/// A shape that moves past the body's origin and turns, once as told and once as its ends tell. Its kind is the next one with every
/// index, because all kinds for every body took three quarters of the time.
fn motions(place: &WorldFromModel, index: usize) -> Vec<MovingShape> {
    let corners = [
        Vec3::X,
        Vec3::Y,
        Vec3::Z,
        Vec3::new(-0.5, -0.25, -0.75),
        Vec3::new(0.5, 0.5, 0.25),
    ];
    let (half_height, radius, half_extents) = (0.75, 0.25, Vec3::new(0.5, 0.25, 0.125));
    let mut shapes = vec![
        Shape::Ball { radius },
        Shape::Capsule {
            half_length: half_height,
            radius,
        },
        Shape::Cuboid { half_extents },
        Shape::RoundCuboid {
            half_extents,
            border_radius: 0.125,
        },
        Shape::Cylinder { half_height, radius },
        Shape::Cone { half_height, radius },
        Shape::ConicalFrustum {
            half_height,
            bottom_radius: radius,
            top_radius: 0.5,
        },
        Shape::ConvexHull(Arc::new(ConvexHull::new(&corners).expect("it is a solid"))),
    ];
    let shape = shapes.swap_remove(index % shapes.len());
    let origin = place.transform_point(Vec3::ZERO);
    let (start, way) = (origin + DVec3::new(2.0, 0.5, 0.25), DVec3::new(-2.5, -0.25, 0.125));
    let placed = |shape| PlacedShape::new(shape, Quat::from_xyzw(0.5, -0.5, 0.5, 0.5), start.as_vec3());
    let motion = |shape| {
        let placed = placed(shape)?;
        let motion = MovingShape::new(placed.clone(), way)?.turning(start, DVec3::new(1.0, -0.5, 0.25))?;
        let between = MovingShape::between(&placed, &motion.at(0.75)).expect("they are of one kind");
        Ok::<_, InputError>([motion, between])
    };
    // Places may be too far away for shapes.
    motion(shape).map_or_else(|_| Vec::new(), Vec::from)
}

/// Rays from a few sides towards the body's origin and past it.
fn rays(place: &WorldFromModel) -> [Ray; 4] {
    let origin = place.transform_point(Vec3::ZERO);
    [
        ([3.0, 0.5, 0.25], [0.0, 0.0, 0.0]),
        ([0.25, -4.0, 1.0], [0.125, 0.0, 0.25]),
        ([-2.0, 2.0, 2.0], [-0.25, 0.125, 0.0]),
        ([0.0, 0.0, 0.0], [0.0, 0.75, 0.5]),
    ]
    .map(|(from, towards)| {
        let (from, towards) = (DVec3::from_array(from), DVec3::from_array(towards));
        Ray::new(origin + from, towards - from, f64::INFINITY).expect("the ray is finite")
    })
}
