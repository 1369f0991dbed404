//! Bodies that are scaled to a point, or almost.

use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::read::read_meshes;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_testkit::oracle::{posed_vertices, triangles_intersect, world_vertices};

use crate::support::{Edits, add_mesh, app, assets, diagnostics, settle, touches};

const MODES: [MorphCollisionMode; 3] = [
    MorphCollisionMode::First,
    MorphCollisionMode::All,
    MorphCollisionMode::Contacts,
];

/// Far below the 5 million pairs of two dolphins' triangles, and above the number of tests needed to place them.
const FEW_TESTS: u64 = 100_000;

fn dolphin() -> MorphMesh {
    let mut meshes = read_meshes(&assets().join("dolphin_2256.glb")).expect("the dolphin is there");
    meshes.swap_remove(0)
}

/// Two bodies side by side under a parent with some scale, after a first frame.
fn under_one_parent(mode: MorphCollisionMode, limit: usize) -> (App, Entity, [Entity; 2]) {
    let mut app = app();
    app.settings().max_triangle_pairs = limit;
    let mesh = add_mesh(&mut app, &dolphin());
    let parent = app.spawn((Transform::default(), Visibility::default()));
    let children = [0.0, 0.9].map(|y| {
        let place = Transform::from_xyz(0.0, y, 0.0);
        let collider = MorphCollider::new(mode);
        app.spawn((Mesh3d(mesh.clone()), place, collider, ChildOf(parent)))
    });
    settle(&mut app);
    (app, parent, children)
}

fn grow(app: &mut App, parent: Entity, scale: f32) {
    let place = Transform::from_xyz(3.0, 2.0, 1.0).with_scale(Vec3::splat(scale));
    app.insert(parent, place);
    app.update();
}

/// Whether two bodies of a mesh touch, by the definition. Only for bodies that touch in very few places or
/// everywhere.
fn truly_touch(app: &App, mesh: &MorphMesh, bodies: [Entity; 2]) -> bool {
    let posed = posed_vertices(&mesh.positions, &mesh.targets, &vec![0.0; mesh.targets.len()]);
    let [a, b] = bodies.map(|body| {
        let place = app.world().get::<GlobalTransform>(body).expect("it is placed");
        let world = world_vertices(&posed, &place.affine());
        let triangles = mesh
            .triangles
            .iter()
            .map(|corners| corners.map(|corner| world[corner as usize]));
        let mut triangles: Vec<_> = triangles.collect();
        let key = |triangle: &[DVec3; 3]| triangle.map(|corner| corner.to_array());
        triangles.sort_by(|s, t| key(s).partial_cmp(&key(t)).expect("finite"));
        triangles.dedup();
        triangles
    });
    a.iter()
        .any(|s| b.iter().any(|t| boxes_meet(s, t) && triangles_intersect(s, t)))
}

fn boxes_meet(s: &[DVec3; 3], t: &[DVec3; 3]) -> bool {
    let span = |t: &[DVec3; 3]| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let ((min_s, max_s), (min_t, max_t)) = (span(s), span(t));
    min_s.cmple(max_t).all() && min_t.cmple(max_s).all()
}

#[test]
fn two_bodies_under_one_parent_that_pops_in_from_scale_0_are_decided_exactly_and_cheaply() {
    const LIMIT: usize = 1000;
    let mesh = dolphin();
    for mode in MODES {
        let (mut app, parent, [a, b]) = under_one_parent(mode, LIMIT);
        let (mut touched, mut truncated) = (0, 0);
        for scale in [0.0, 1e-30, 1e-20, 1e-16, 1e-15, 1e-12, 1e-6, 1.0] {
            grow(&mut app, parent, scale);
            let truth = truly_touch(&app, &mesh, [a, b]);
            assert_eq!(touches(&app, a, b), truth, "{mode:?} at scale {scale}");
            let tests = diagnostics(&app).stats.triangle_tests;
            assert!(tests < FEW_TESTS, "{mode:?} at scale {scale}: {tests} triangle tests");
            let Some(contact) = app.world().resource::<MorphCollisions>().get(a, b) else {
                continue;
            };
            touched += 1;
            truncated += usize::from(contact.is_truncated);
            let listed = contact.triangles.len();
            match mode {
                MorphCollisionMode::First => assert_eq!(listed, 1),
                _ => {
                    assert!(0 < listed && listed <= LIMIT, "{mode:?} at scale {scale}: {listed}");
                    assert_eq!(
                        contact.is_truncated,
                        listed == LIMIT,
                        "{mode:?} at scale {scale}: {listed}"
                    );
                    assert!(contact.is_truncated || scale > 0.0);
                }
            }
            assert_eq!(contact.points.is_empty(), mode != MorphCollisionMode::Contacts);
        }
        // At scale 0 every pair of triangles touches; at scale 1 the bodies are side by side.
        assert!((3..8).contains(&touched), "{mode:?}: {touched}");
        let lists = matches!(mode, MorphCollisionMode::All | MorphCollisionMode::Contacts);
        assert_eq!(truncated > 0, lists, "{mode:?}");
    }
}

#[test]
fn the_default_limit_bounds_what_a_collapsed_body_lists() {
    let limit = MorphCollisionSettings::default().max_triangle_pairs;
    let (mut app, parent, [a, b]) = under_one_parent(MorphCollisionMode::All, limit);
    grow(&mut app, parent, 0.0);
    let contact = app.contact(a, b).expect("they touch");
    assert_eq!(contact.triangles.len(), limit);
    assert!(contact.is_truncated);
    assert_eq!(diagnostics(&app).triangle_pairs, limit as u64);
}

#[test]
fn a_limit_of_0_still_tells_that_bodies_touch() {
    let (mut app, parent, [a, b]) = under_one_parent(MorphCollisionMode::All, 0);
    grow(&mut app, parent, 0.0);
    let contact = app.contact(a, b).expect("they touch");
    assert_eq!(contact.triangles.len(), 1);
    assert!(contact.is_truncated);
}

#[test]
fn a_contact_within_the_limit_is_complete() {
    let (mut app, parent, [a, b]) = under_one_parent(MorphCollisionMode::All, 2256 * 2256);
    grow(&mut app, parent, 1.0);
    assert!(!touches(&app, a, b));
    app.insert(b, Transform::from_xyz(0.0, 0.2, 0.0));
    app.update();
    let whole = app.contact(a, b).expect("they touch");
    assert!(!whole.is_truncated);
    // A limit equal to the number of pairs truncates nothing; one less does.
    for (limit, is_truncated) in [(whole.triangles.len(), false), (whole.triangles.len() - 1, true)] {
        app.settings().max_triangle_pairs = limit;
        // Moves away and back, so that the pair is compared again.
        for y in [0.9, 0.2] {
            app.insert(b, Transform::from_xyz(0.0, y, 0.0));
            app.update();
        }
        let contact = app.contact(a, b).expect("they touch");
        assert_eq!((contact.triangles.len(), contact.is_truncated), (limit, is_truncated));
    }
}

#[test]
fn a_shape_and_a_collapsed_mesh_list_no_more_than_the_limit() {
    const LIMIT: usize = 100;
    for mode in [MorphCollisionMode::All, MorphCollisionMode::Contacts] {
        let (mut app, parent, [a, _]) = under_one_parent(mode, LIMIT);
        let ball = app.spawn((MorphShape::Ball { radius: 0.5 }, Transform::from_xyz(3.0, 2.0, 1.0)));
        grow(&mut app, parent, 0.0);
        let contact = app.contact(a, ball).expect("they touch");
        assert_eq!(contact.triangles.len(), LIMIT);
        assert!(contact.is_truncated);
        assert_eq!(contact.points.is_empty(), mode == MorphCollisionMode::All);
    }
}

#[test]
fn spatial_queries_look_at_no_more_pairs_than_the_limit() {
    let (mut app, parent, [a, b]) = under_one_parent(MorphCollisionMode::Passive, 500);
    grow(&mut app, parent, 0.0);
    let contacts = app
        .world_mut()
        .run_system_once(move |spatial: MorphSpatialQuery| spatial.contacts(a, b))
        .expect("its parameters are there")
        .expect("they touch");
    assert_eq!(contacts.pair_count, 500);
    assert!(contacts.is_truncated);
}
