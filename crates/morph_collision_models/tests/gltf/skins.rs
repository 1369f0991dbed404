//! Skins: influences, joints with their ancestors, and clips that move them.

use glam::{Affine3A, Quat, Vec3, Vec3A, Vec4};
use morph_collision_models::gltf::read::{GltfFile, ReadError, Remedy};
use morph_collision_models::skeleton::{Interpolation, Property, Skeleton};
use serde_json::{Value, json};

use crate::support::{Document, F32, U8, U16, primitive};

/// A square bound to two joints, "low" and "high" above it, under a node that is not a joint: nodes 0, 1 and 2. Node 3 shows
/// it.
fn bound_square() -> Document {
    let mut document = Document::square(1);
    let joints = document.accessor(
        U8,
        "VEC4",
        4,
        &[[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 1, 1]].concat(),
    );
    let weights = [
        [1.0, 0.0, 0.0, 0.0],
        [0.25, 0.75, 0.0, 0.0],
        [0.5, 0.5, 0.0, 0.0],
        [0.25; 4],
    ]
    .concat();
    let weights = document.floats("VEC4", &weights);
    bind(&mut document, 0, json!({"JOINTS_0": joints, "WEIGHTS_0": weights}));
    *document.list("nodes") = vec![
        json!({"name": "armature", "children": [1], "translation": [10, 0, 0]}),
        json!({"name": "low", "children": [2]}),
        json!({"name": "high", "translation": [0, 1, 0]}),
        json!({"mesh": 0, "skin": 0, "translation": [7, 7, 7]}),
    ];
    let matrices =
        [Affine3A::IDENTITY, Affine3A::from_translation(-Vec3::Y)].map(|m| glam::Mat4::from(m).to_cols_array());
    let matrices = document.floats("MAT4", &matrices.concat());
    document.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": matrices}]);
    document
}

fn bind(document: &mut Document, primitive: usize, with: Value) {
    let attributes = &mut document.json["meshes"][0]["primitives"][primitive]["attributes"];
    for (name, accessor) in with.as_object().expect("attributes") {
        attributes[name] = accessor.clone();
    }
}

/// Adds an animation "turn" of one channel.
fn animate(document: &mut Document, node: usize, path: &str, interpolation: &str, times: &[f32], values: usize) {
    let input = document.floats("SCALAR", times);
    document.list("animations").push(json!({
        "name": "turn",
        "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
        "samplers": [{"input": input, "output": values, "interpolation": interpolation}],
    }));
}

fn skeleton(document: Document) -> Result<Skeleton, ReadError> {
    let (_directory, file) = document.open()?;
    Ok(file.skin(0, None)?.expect("the square is skinned").skeleton)
}

#[track_caller]
fn skin_error(document: Document) -> String {
    let (_directory, file) = document.open().expect("the file itself is right");
    // The mesh can still be read.
    assert_eq!(file.mesh(0).expect("the mesh is right").mesh.triangles.len(), 2);
    match file.skin(0, None) {
        Ok(skin) => panic!("accepted: {skin:?}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn influences_and_joints_are_read_with_everything_above_them() -> Result<(), ReadError> {
    let mesh = bound_square().read()?.swap_remove(0);
    let skin = mesh.skin.expect("it is skinned");
    assert_eq!(skin.sets.len(), 1);
    assert_eq!(
        skin.sets[0].joints,
        [[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 1, 1]]
    );
    assert_eq!(skin.sets[0].weights[1], [0.25, 0.75, 0.0, 0.0]);
    let names: Vec<_> = skin.skeleton.nodes.iter().map(|node| &*node.name).collect();
    assert_eq!(names, ["armature", "low", "high"]);
    let parents: Vec<_> = skin.skeleton.nodes.iter().map(|node| node.parent).collect();
    assert_eq!(parents, [None, Some(0), Some(1)]);
    // The armature's translation counts; that of the node that shows the mesh does not.
    assert_eq!(skin.skeleton.at_rest(), [Affine3A::from_translation(Vec3::X * 10.0); 2]);
    Ok(())
}

#[test]
fn integers_count_as_the_weights_they_stand_for() -> Result<(), ReadError> {
    let mut document = bound_square();
    let joints: Vec<u8> = [1_u16; 16].iter().flat_map(|joint| joint.to_le_bytes()).collect();
    let joints = document.accessor(U16, "VEC4", 4, &joints);
    let weights = document.accessor(U8, "VEC4", 4, &[255, 0, 51, 0].repeat(4));
    document.list("accessors")[weights]["normalized"] = json!(true);
    bind(&mut document, 0, json!({"JOINTS_0": joints, "WEIGHTS_0": weights}));
    let skin = document.read()?.swap_remove(0).skin.expect("it is skinned");
    assert_eq!(skin.sets[0].joints, [[1; 4]; 4]);
    assert_eq!(skin.sets[0].weights, [[1.0, 0.0, 0.2, 0.0]; 4]);
    Ok(())
}

#[test]
fn a_second_set_and_a_second_primitive_are_numbered_like_the_vertices() -> Result<(), ReadError> {
    let mut document = bound_square();
    let first = document.json["meshes"][0]["primitives"][0].clone();
    document.json["meshes"][0]["primitives"] = json!([first, first.clone(), first.clone()]);
    let joints = document.accessor(U8, "VEC4", 4, &[1; 16]);
    let weights = document.floats("VEC4", &[0.125; 16]);
    // The third primitive shares the vertices of the first. The second has its own.
    bind(&mut document, 1, json!({"JOINTS_1": joints, "WEIGHTS_1": weights}));
    let mesh = document.read()?.swap_remove(0);
    assert_eq!(mesh.positions.len(), 8);
    let skin = mesh.skin.expect("it is skinned");
    assert_eq!(skin.sets.len(), 2);
    assert_eq!(skin.sets[0].weights[..4], skin.sets[0].weights[4..]);
    assert_eq!(skin.sets[1].weights, [[[0.0; 4]; 4], [[0.125; 4]; 4]].concat());
    assert_eq!(skin.sets[1].joints[4..], [[1; 4]; 4]);
    Ok(())
}

#[test]
fn clips_of_joints_and_of_what_is_above_them_are_read() -> Result<(), ReadError> {
    let mut document = bound_square();
    let rotations = document.accessor(
        0x1402,
        "VEC4",
        2,
        &[0, 0, 0, 0, 0, 0, 0xff, 0x7f, 0, 0, 0, 0, 0xff, 0x7f, 0, 0],
    );
    document.list("accessors")[rotations]["normalized"] = json!(true);
    animate(&mut document, 2, "rotation", "LINEAR", &[0.0, 1.0], rotations);
    let lift = document.floats("VEC3", &[0., 0., 0., 0., 0., 4.]);
    animate(&mut document, 0, "translation", "STEP", &[0.0, 1.0], lift);
    // The node that shows the mesh moves nothing.
    animate(&mut document, 3, "translation", "LINEAR", &[0.0, 1.0], lift);
    let skeleton = skeleton(document)?;
    assert_eq!(skeleton.clips.len(), 2);
    let [turn, lift] = [0, 1].map(|clip| &skeleton.clips[clip].channels[0]);
    assert_eq!(
        (turn.node, turn.property, turn.interpolation),
        (2, Property::Rotation, Interpolation::Linear)
    );
    assert_eq!(turn.values, [Vec4::W, Vec4::Z]);
    assert_eq!(
        (lift.node, lift.property, lift.interpolation),
        (0, Property::Translation, Interpolation::Step)
    );
    // Halfway through half a turn about z, "high" is still at (10, 1, 0), and its x axis points to +y.
    let high = skeleton.world_from_mesh(skeleton.clip("turn"), 0.5)[1];
    assert!(
        high.transform_point3a(Vec3A::new(1.0, 1.0, 0.0))
            .distance(Vec3A::new(10.0, 2.0, 0.0))
            < 1e-6
    );
    Ok(())
}

#[test]
fn a_matrix_of_a_node_is_taken_apart() -> Result<(), ReadError> {
    let mut document = bound_square();
    let turned =
        Affine3A::from_scale_rotation_translation(Vec3::new(2.0, 3.0, 4.0), Quat::from_rotation_x(1.0), Vec3::Z);
    document.list("nodes")[0] = json!({"children": [1], "matrix": glam::Mat4::from(turned).to_cols_array()});
    let low = skeleton(document)?.at_rest()[0];
    assert!(low.abs_diff_eq(turned, 1e-5), "{low:?}");
    Ok(())
}

#[test]
fn what_is_wrong_with_a_skin_is_named() {
    type Break<'a> = (&'a str, &'a dyn Fn(&mut Document));
    let breaks: [Break<'_>; 10] = [
        ("mesh 0 \"m\": skin 4 does not exist", &|d| {
            d.list("nodes")[3]["skin"] = json!(4);
        }),
        ("skin 0 is malformed", &|d| d.json["skins"][0]["joints"] = json!("all")),
        ("node 9 does not exist", &|d| {
            d.json["skins"][0]["joints"] = json!([1, 9]);
        }),
        ("node 0 is malformed", &|d| {
            d.list("nodes")[0]["translation"] = json!([1, 2]);
        }),
        ("is its own ancestor", &|d| d.list("nodes")[2]["children"] = json!([0])),
        ("skin 0 has 2 inverse bind matrices for 3 joints", &|d| {
            d.json["skins"][0]["joints"] = json!([1, 2, 1]);
        }),
        ("inverse bind matrices: accessor 0 holds VEC3 of F32", &|d| {
            d.json["skins"][0]["inverseBindMatrices"] = json!(0);
        }),
        (
            "primitive 0, WEIGHTS_0: accessor 0 holds VEC3 of F32 where VEC4",
            &|d| bind(d, 0, json!({"WEIGHTS_0": 0})),
        ),
        ("primitive 0 has no WEIGHTS_1 attribute", &|d| {
            bind(d, 0, json!({"JOINTS_1": 3}));
        }),
        ("primitive 0, JOINTS_0 has 3 entries for 4 vertices", &|d| {
            let joints = d.accessor(U8, "VEC4", 3, &[0; 12]);
            bind(d, 0, json!({"JOINTS_0": joints}));
        }),
    ];
    for (says, spoil) in breaks {
        let mut document = bound_square();
        spoil(&mut document);
        let message = skin_error(document);
        assert!(
            message.contains("the skin of mesh 0") && message.contains(says),
            "{message}, not {says}"
        );
    }
}

#[test]
fn a_primitive_without_influences_in_a_skinned_mesh_is_named() {
    let mut document = bound_square();
    let lone = document.floats("VEC3", &[0., 0., 0., 1., 0., 0., 1., 1., 0.]);
    let lift = document.floats("VEC3", &[0.0; 9]);
    let primitives = document.json["meshes"][0]["primitives"].as_array_mut().expect("a list");
    primitives.push(primitive(lone, None, &[lift]));
    let (_directory, file) = document.open().expect("the file itself is right");
    let message = file
        .skin(0, None)
        .expect_err("half of it has no influences")
        .to_string();
    assert!(message.contains("primitive 1 has no JOINTS_0 attribute"), "{message}");
}

#[test]
fn a_broken_clip_is_left_out_and_named() -> Result<(), ReadError> {
    type Break<'a> = (&'a str, &'a dyn Fn(&mut Document));
    let breaks: [Break<'_>; 5] = [
        ("channel 0 has 3 translations, but 2 keys need 2", &|d| {
            let values = d.floats("VEC3", &[0.0; 9]);
            animate(d, 1, "translation", "LINEAR", &[0.0, 1.0], values);
        }),
        ("channel 0 has 2 scales, but 2 keys need 6", &|d| {
            let values = d.floats("VEC3", &[0.0; 6]);
            animate(d, 1, "scale", "CUBICSPLINE", &[0.0, 1.0], values);
        }),
        ("channel 0, key 1: the rotations are not finite", &|d| {
            let values = d.floats("VEC4", &[0., 0., 0., 1., 0., f32::NAN, 0., 1.]);
            animate(d, 0, "rotation", "LINEAR", &[0.0, 1.0], values);
        }),
        ("channel 0, key 1 is at 0.5 s", &|d| {
            let values = d.floats("VEC3", &[0.0; 6]);
            animate(d, 1, "scale", "LINEAR", &[1.0, 0.5], values);
        }),
        ("channel 0 has an unknown interpolation", &|d| {
            let values = d.floats("VEC3", &[0.0; 6]);
            animate(d, 1, "scale", "BOUNCE", &[0.0, 1.0], values);
        }),
    ];
    for (says, spoil) in breaks {
        let mut document = bound_square();
        spoil(&mut document);
        let (_directory, file) = document.open()?;
        assert!(file.skin(0, None)?.is_some_and(|skin| skin.skeleton.clips.is_empty()));
        let broken = file.joint_clips(0, None).broken;
        assert_eq!(broken.len(), 1);
        let message = broken[0].to_string();
        assert!(
            message.contains("animation 0 \"turn\"") && message.contains(says),
            "{message}, not {says}"
        );
    }
    Ok(())
}

/// A file of a few hundred bytes that claims gigabytes.
fn claims(change: impl FnOnce(&mut Document)) -> (tempfile::TempDir, GltfFile) {
    let mut document = bound_square();
    change(&mut document);
    document.open().expect("the file itself is right")
}

#[test]
fn sizes_that_are_only_claimed_are_refused() {
    // A primitive of 30 million vertices without stored data, with two sets of influences.
    let (_directory, file) = claims(|d| {
        let mut unstored = |kind: u32, shape: &str| {
            let accessors = d.list("accessors");
            accessors.push(json!({"componentType": kind, "type": shape, "count": 30_000_000}));
            accessors.len() - 1
        };
        let (positions, joints, weights) = (unstored(F32, "VEC3"), unstored(U8, "VEC4"), unstored(F32, "VEC4"));
        let mut large = primitive(positions, Some(1), &[]);
        let attributes = json!({
            "POSITION": positions, "JOINTS_0": joints, "WEIGHTS_0": weights, "JOINTS_1": joints, "WEIGHTS_1": weights
        });
        large["attributes"] = attributes;
        d.json["meshes"][0]["primitives"] = json!([large]);
    });
    let error = file.skin(0, None).expect_err("1.4 GB");
    assert_eq!(error.remedy(), Some(Remedy::MoreMemory), "{error}");

    let (_directory, file) = claims(|d| {
        let accessors = d.list("accessors");
        accessors.push(json!({"componentType": F32, "type": "MAT4", "count": 99_000_000}));
        d.json["skins"][0]["inverseBindMatrices"] = json!(d.list("accessors").len() - 1);
    });
    let error = file.skin(0, None).expect_err("6 GB");
    assert_eq!(error.remedy(), Some(Remedy::MoreMemory), "{error}");

    let (_directory, file) = claims(|d| {
        let accessors = d.list("accessors");
        accessors.push(json!({"componentType": F32, "type": "SCALAR", "count": 99_000_000}));
        accessors.push(json!({"componentType": F32, "type": "VEC4", "count": 99_000_000}));
        let input = d.list("accessors").len() - 2;
        d.list("animations").push(json!({
            "channels": [{"sampler": 0, "target": {"node": 1, "path": "rotation"}}],
            "samplers": [{"input": input, "output": input + 1}],
        }));
    });
    let broken = file.joint_clips(0, None).broken;
    assert_eq!(
        broken.iter().map(ReadError::remedy).collect::<Vec<_>>(),
        [Some(Remedy::MoreMemory)]
    );
}

#[test]
fn a_deep_chain_of_nodes_with_many_joints_takes_no_time() -> Result<(), ReadError> {
    let mut document = bound_square();
    let depth = 20_000;
    let mut nodes: Vec<Value> = (0..depth).map(|node| json!({"children": [node + 1]})).collect();
    nodes.push(json!({"mesh": 0, "skin": 0}));
    *document.list("nodes") = nodes;
    let joints: Vec<usize> = (0..depth).rev().collect();
    document.json["skins"] = json!([{"joints": joints}]);
    let skeleton = skeleton(document)?;
    assert_eq!((skeleton.nodes.len(), skeleton.joints.len()), (depth, depth));
    assert_eq!(skeleton.joints[0].node, depth as u32 - 1);
    Ok(())
}
