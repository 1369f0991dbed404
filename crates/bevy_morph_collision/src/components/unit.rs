//! Units of settings.

use bevy::prelude::*;

/// The unit of a setting: an attribute of its field, for editors. Bevy has none of its own.
///
/// A field with a limited range also has a `RangeInclusive` of its own type as an attribute; for a vector, it is that of each component.
///
/// ```
/// # use bevy::reflect::{Typed, structs::StructInfo};
/// # use bevy_morph_collision::prelude::*;
/// use std::ops::RangeInclusive;
///
/// let info: &StructInfo = MorphCollider::type_info().as_struct().unwrap();
/// let margin = info.field("margin").unwrap();
/// assert_eq!(margin.get_attribute::<MorphUnit>(), Some(&MorphUnit::Length));
/// assert_eq!(margin.get_attribute::<RangeInclusive<f32>>().unwrap().start(), &0.0);
/// ```
#[derive(Reflect, Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[reflect(Debug, Clone, PartialEq, Hash)]
pub enum MorphUnit {
    /// World units. In physics, multiplied by the engine's length unit.
    Length,
    /// World units per second squared, likewise.
    Acceleration,
    /// Radians.
    Angle,
}
