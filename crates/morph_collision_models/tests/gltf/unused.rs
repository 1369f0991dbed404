//! Broken parts that are not used do not keep the rest from being read.

use crate::support::{Document, primitive};
use morph_collision_models::gltf::read::ReadError;
use serde_json::json;

#[test]
fn a_channel_without_a_node_is_passed_over() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    let channel = json!({"sampler": 0, "target": {"path": "weights"}});
    let channels = document.json["animations"][0]["channels"]
        .as_array_mut()
        .expect("a list");
    channels.insert(0, channel);
    let (_directory, file) = document.open()?;
    assert_eq!(file.mesh(0)?.mesh.triangles.len(), 2);
    let clips = file.clips(0, None, 1);
    assert_eq!(
        (clips.clips.len(), clips.broken.len(), file.stray_animations().len()),
        (1, 0, 0)
    );
    Ok(())
}

#[test]
fn a_broken_animation_leaves_the_meshes_and_the_other_animations() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    document.animate("LINEAR", &[0.0, 1.0], &[0.0, 1.0]);
    let animations = document.list("animations");
    animations.insert(0, json!({"channels": 7}));
    animations.insert(
        0,
        json!({"channels": [{"sampler": 0}, {"sampler": 5, "target": {"node": 0, "path": "weights"}}]}),
    );
    let (_directory, file) = document.open()?;
    let clips = file.clips(0, None, 1);
    assert_eq!((clips.clips.len(), clips.broken.len()), (1, 1));
    assert!(
        clips.broken[0].to_string().contains("animation 0"),
        "{:?}",
        clips.broken
    );
    let strays: Vec<String> = file.stray_animations().iter().map(ToString::to_string).collect();
    assert!(
        strays.len() == 2 && strays[0].contains("channel 0 is malformed") && strays[1].contains("animation 1"),
        "{strays:?}"
    );
    Ok(())
}

#[test]
fn a_broken_second_mesh_and_a_missing_buffer_that_only_it_needs_leave_the_first() -> Result<(), ReadError> {
    let mut document = Document::square(1);
    let length = document.bin.len();
    let lost = document.view(&[0; 36]);
    document.json["bufferViews"][lost] = json!({"buffer": 1, "byteLength": 36});
    document.json["buffers"] = json!([
        {"byteLength": length, "uri": "model.bin"},
        {"byteLength": 36, "uri": "lost.bin"},
        {"byteLength": "many"},
    ]);
    let accessors = document.list("accessors");
    accessors.push(json!({"bufferView": lost, "componentType": 5126, "type": "VEC3", "count": 3}));
    let positions = accessors.len() - 1;
    accessors.push(json!("no accessor"));
    document.mesh("lost", vec![primitive(positions, None, &[])]);
    document.mesh("malformed", vec![primitive(positions + 1, None, &[])]);
    document.list("meshes").push(json!({"primitives": 1}));
    document.json["materials"] = json!("none");
    let (_directory, file) = document.open()?;
    assert_eq!(file.mesh(0)?.mesh.triangles.len(), 2);
    for (mesh, says) in [
        (1, "buffer 1 \"lost.bin\""),
        (2, "is malformed"),
        (3, "mesh 3 \"mesh_3\": it is malformed"),
        (4, "mesh 4 \"mesh_4\": it does not exist"),
    ] {
        let error = file.mesh(mesh).expect_err("it is broken").to_string();
        assert!(error.contains(says), "{error}");
    }
    Ok(())
}

#[test]
fn a_mesh_of_points_or_lines_says_so() -> Result<(), ReadError> {
    for (modes, says) in [
        (&[0][..], Some("points")),
        (&[1, 3], Some("lines")),
        (&[2, 0], Some("points and lines")),
        (&[0, 4], None),
        (&[], None),
    ] {
        let mut document = Document::square(0);
        let primitives = document.json["meshes"][0]["primitives"].as_array_mut().expect("a list");
        let one = primitives.remove(0);
        for mode in modes {
            let mut one = one.clone();
            one["mode"] = json!(mode);
            primitives.push(one);
        }
        let (_directory, file) = document.open()?;
        assert_eq!(file.mesh(0)?.not_triangles, says);
    }
    Ok(())
}

#[test]
fn a_skin_counts_where_vertices_are_bound_and_a_node_has_it() -> Result<(), ReadError> {
    for (bound, node, skinned) in [
        (true, json!({"mesh": 0, "skin": 0}), true),
        (true, json!({"mesh": 0}), false),
        (true, json!({"mesh": 1, "skin": 0}), false),
        (false, json!({"mesh": 0, "skin": 0}), false),
    ] {
        let mut document = Document::square(1);
        if bound {
            let attributes = &mut document.json["meshes"][0]["primitives"][0]["attributes"];
            attributes["JOINTS_0"] = json!(0);
            attributes["WEIGHTS_0"] = json!(0);
        }
        document.list("nodes").push(node.clone());
        let (_directory, file) = document.open()?;
        assert_eq!(file.mesh(0)?.skinned, skinned, "{bound} {node}");
    }
    Ok(())
}
