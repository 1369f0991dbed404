//! The ranges that fields have as attributes are those that the plugin accepts.

use std::ops::RangeInclusive;

use bevy::prelude::*;
use bevy::reflect::enums::VariantInfo;
use bevy::reflect::{NamedField, TypeInfo, Typed};
use bevy_morph_collision::prelude::*;
use serde_json::json;

use super::remote::Remote;
use crate::log::Errors;
use crate::support::{Edits, add_mesh, app, cube, settle};

/// The field of a component, or of a variant of one.
fn field<C: Typed>(variant: &str, field: &str) -> &'static NamedField {
    let found = match C::type_info() {
        TypeInfo::Struct(info) => info.field(field),
        TypeInfo::Enum(info) => match info.variant(variant) {
            Some(VariantInfo::Struct(info)) => info.field(field),
            _ => None,
        },
        _ => None,
    };
    found.unwrap_or_else(|| panic!("{} has no field {field}", C::type_path()))
}

/// Checks that the ends of a field's range are accepted, and that what is beyond is logged.
fn check<C: Component + Typed>(errors: &Errors, bundle: impl Bundle, variant: &str, name: &str) {
    let field = field::<C>(variant, name);
    assert_eq!(field.get_attribute::<MorphUnit>(), Some(&MorphUnit::Length), "{name}");
    let range = field.get_attribute::<RangeInclusive<f32>>().expect(name);
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    app.spawn((Mesh3d(mesh), MorphCollider::default()));
    let entity = app.spawn(bundle);
    settle(&mut app);
    let mut logged = |number: f32| {
        let value = if field.is::<Vec3>() {
            json!([1.0, number, 1.0])
        } else {
            json!(number)
        };
        app.set::<C>(entity, &format!(".{name}"), value);
        app.update();
        app.update();
        errors.take().len() + errors.take_warnings().len()
    };
    let (low, high) = (*range.start(), *range.end());
    assert_eq!(logged(low), 0, "{name} = {low}");
    assert_eq!(logged(low - 1.0), 1, "{name} is below {low}");
    // Infinity is no number in JSON.
    if high.is_finite() {
        assert_eq!(logged(high), 0, "{name} = {high}");
        assert_eq!(logged(high.next_up()), 1, "{name} is above {high}");
    }
}

#[test]
fn colliders_shapes_and_casters_accept_their_ranges() {
    Errors::collect(|errors| {
        for name in ["margin", "tolerance"] {
            check::<MorphCollider>(errors, (MorphShape::default(), MorphCollider::default()), "", name);
        }
        let cuboid = Cuboid::default();
        let frustum = ConicalFrustum::default();
        let shapes: [(MorphShape, &str, &[&str]); 7] = [
            (MorphShape::default(), "Ball", &["radius"]),
            (Capsule3d::default().into(), "Capsule", &["radius", "half_length"]),
            (cuboid.into(), "Cuboid", &["half_extents"]),
            (
                MorphShape::RoundCuboid {
                    half_extents: cuboid.half_size,
                    border_radius: 0.1,
                },
                "RoundCuboid",
                &["half_extents", "border_radius"],
            ),
            (Cylinder::default().into(), "Cylinder", &["radius", "half_height"]),
            (Cone::default().into(), "Cone", &["radius", "half_height"]),
            (
                frustum.into(),
                "ConicalFrustum",
                &["bottom_radius", "top_radius", "half_height"],
            ),
        ];
        for (shape, variant, fields) in shapes {
            for field in fields {
                check::<MorphShape>(errors, shape.clone(), variant, field);
            }
        }
        check::<MorphRayCaster>(errors, MorphRayCaster::default(), "", "max_distance");
        check::<MorphShapeCaster>(errors, MorphShapeCaster::default(), "", "max_distance");
    });
}

#[test]
fn trees_accept_their_range_of_leaf_sizes() {
    let range = field::<MorphTreeOptions>("", "leaf_size").get_attribute::<RangeInclusive<u8>>();
    assert_eq!(range, Some(&(1..=255)));
    Errors::collect(|errors| {
        let mut app = app();
        let mesh = add_mesh(&mut app, &cube());
        let entity = app.spawn((Mesh3d(mesh), MorphCollider::default(), MorphTreeOptions::default()));
        for (leaf_size, logged) in [(1, 0), (0, 1), (255, 0)] {
            app.set::<MorphTreeOptions>(entity, ".leaf_size", leaf_size);
            settle(&mut app);
            assert_eq!(errors.take().len(), logged, "{leaf_size}");
        }
    });
}
