//! The expressions of VRM avatars.

use morph_collision_models::gltf::read::{Expression, ExpressionBind, ReadError};
use serde_json::{Value, json};

use crate::support::Document;

/// The expressions of a document with two meshes, of which node 1 shows mesh 0 and node 2 shows mesh 1.
fn expressions(extensions: Value) -> Result<Vec<Expression>, ReadError> {
    let mut document = Document::square(3);
    let second = document.json["meshes"][0].clone();
    document.list("meshes").push(second);
    document.json["nodes"] = json!([{}, {"mesh": 0}, {"mesh": 1}, {"mesh": "m"}, {"mesh": 7}]);
    document.json["extensions"] = extensions;
    let (_directory, file) = document.open()?;
    let found = file.expressions();
    assert_eq!(found, file.expressions());
    Ok(found)
}

fn bind(mesh: usize, node: Option<usize>, target: usize, weight: f32) -> ExpressionBind {
    ExpressionBind {
        mesh,
        node,
        target,
        weight,
    }
}

#[test]
fn expressions_of_vrm_0_name_meshes_and_weigh_in_percent() -> Result<(), ReadError> {
    let found = expressions(
        json!({"VRM": {"exporterVersion": "UniVRM", "blendShapeMaster": {"blendShapeGroups": [
            {"name": "Joy", "presetName": "joy", "binds": [
                {"mesh": 0, "index": 2, "weight": 100}, {"mesh": 1.0, "index": 0, "weight": 25.5}
            ], "materialValues": [], "isBinary": true},
            {"name": "Surprised", "presetName": "unknown", "binds": []},
            {"name": "", "presetName": "blink"},
            {"presetName": ""},
        ]}}}),
    )?;
    let named = |name: &str, preset: Option<&str>| Expression {
        name: name.into(),
        preset: preset.map(Into::into),
        ..Expression::default()
    };
    let joy = Expression {
        binds: vec![bind(0, None, 2, 1.0), bind(1, None, 0, 0.255)],
        is_binary: true,
        ..named("Joy", Some("joy"))
    };
    assert_eq!(
        found,
        [
            joy,
            named("Surprised", None),
            named("blink", Some("blink")),
            named("expression_3", None)
        ]
    );
    Ok(())
}

#[test]
fn expressions_of_vrm_1_name_nodes() -> Result<(), ReadError> {
    let happy = json!({"morphTargetBinds": [
        {"node": 2, "index": 1, "weight": 0.5}, {"node": 1, "index": 0}
    ], "isBinary": false, "overrideBlink": "block"});
    let found = expressions(json!({
        "VRMC_vrm": {"specVersion": "1.0", "expressions": {
            "preset": {"happy": happy, "aa": {}},
            "custom": {"Wide Eyes": {"morphTargetBinds": [{"node": 2, "index": 2, "weight": 1}]}},
        }},
        "VRM": {"blendShapeMaster": {"blendShapeGroups": [{"name": "the same for older programs"}]}},
    }))?;
    let names: Vec<(&str, Option<&str>)> = found.iter().map(|e| (&*e.name, e.preset.as_deref())).collect();
    assert_eq!(names.len(), 3);
    assert!(names.contains(&("aa", Some("aa"))) && names[2] == ("Wide Eyes", None));
    let happy = found.iter().find(|expression| expression.name == "happy");
    let happy = happy.expect("it is a preset");
    assert_eq!(happy.binds, [bind(1, Some(2), 1, 0.5), bind(0, Some(1), 0, 1.0)]);
    assert_eq!(found[2].binds, [bind(1, Some(2), 2, 1.0)]);
    assert!(found.iter().all(|expression| expression.problems.is_empty()));
    Ok(())
}

#[test]
fn broken_binds_and_expressions_are_reported_and_leave_the_others() -> Result<(), ReadError> {
    let binds = json!([
        {"mesh": -1, "index": 0, "weight": 100},
        {"mesh": 9, "index": 0, "weight": 100},
        {"mesh": 0, "weight": 100},
        {"mesh": 0, "index": 0, "weight": 1e39},
        7,
        {"mesh": 0, "index": 0, "weight": 100},
    ]);
    let found = expressions(json!({"VRM": {"blendShapeMaster": {"blendShapeGroups": [
        {"name": "a", "binds": binds}, {"name": 5}, {"name": "b", "binds": 5}, "c", {"name": "d"},
    ]}}}))?;
    assert_eq!(found.len(), 5);
    assert_eq!(found[0].binds, [bind(0, None, 0, 1.0)]);
    let says = found[0].problems.join("\n");
    for part in [
        "bind 0: it is malformed: mesh: invalid value: integer `-1`",
        "bind 1: mesh 9 does not exist",
        "bind 2: it is malformed: missing field `index`",
        "bind 3: it",
        "bind 4: it is malformed",
    ] {
        assert!(says.contains(part), "{says}");
    }
    assert_eq!(found[1].name, "expression_1");
    assert!(found[1].problems[0].starts_with("it is malformed: name: invalid type"));
    assert!(found[2].problems[0].starts_with("it is malformed: binds: invalid type"));
    assert!(found[3].problems.len() == 1 && found[4].problems.is_empty());

    let of_nodes = json!([0, 3, 4, 5].map(|node| json!({"node": node, "index": 0})));
    let found = expressions(json!({"VRMC_vrm": {"expressions": {"custom": {
        "a": {"morphTargetBinds": of_nodes}, "b": 5,
    }}}}))?;
    assert_eq!(found[0].problems[0], "bind 0: node 0 shows no mesh");
    assert!(found[0].problems[1].starts_with("bind 1: node 3 is malformed: mesh: invalid type"));
    assert_eq!(
        found[0].problems[2..],
        ["bind 2: mesh 7 does not exist", "bind 3: node 5 does not exist"]
    );
    assert!(found[0].binds.is_empty() && found[1].problems.len() == 1);
    Ok(())
}

#[test]
fn files_without_expressions_have_none() -> Result<(), ReadError> {
    for extensions in [
        json!(null),
        json!([]),
        json!({}),
        json!({"VRM": null}),
        json!({"VRM": {}}),
        json!({"VRM": {"blendShapeMaster": {}}}),
        json!({"VRM": {"blendShapeMaster": 5}}),
        json!({"VRMC_vrm": {"expressions": {}}}),
        json!({"VRMC_vrm": {"expressions": {"preset": []}}}),
    ] {
        assert_eq!(expressions(extensions)?, []);
    }
    Ok(())
}
