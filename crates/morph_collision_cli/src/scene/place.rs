//! Parses placements: where a body stands, and how that changes over the frames.

use std::str::FromStr;

use glam::{Quat, Vec3};
use morph_collision_models::scenes::BodyState;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

/// A placement that may change at constant speed: the values at the first and at the last frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Place {
    translation: [Vec3; 2],
    /// Turns about the axes in degrees, in the order given.
    turns: Vec<(Vec3, [f32; 2])>,
    scale: Option<[Vec3; 2]>,
}

const KEYS: [&str; 10] = [
    "x", "y", "z", "turn-x", "turn-y", "turn-z", "scale", "scale-x", "scale-y", "scale-z",
];

impl Place {
    /// Whether it changes over the frames.
    pub(crate) fn moves(&self) -> bool {
        self.translation[0] != self.translation[1]
            || self.turns.iter().any(|(_, [from, to])| from != to)
            || self.scale.is_some_and(|[from, to]| from != to)
    }

    /// Adds the placement at `share` of the frames, 0 to 1, to a state.
    pub(crate) fn apply(&self, share: f32, state: &mut BodyState) {
        let between = |[from, to]: [Vec3; 2]| from + (to - from) * share;
        let translation = between(self.translation);
        if translation != Vec3::ZERO || self.moves() {
            state.translation = Some(translation.to_array());
        }
        if !self.turns.is_empty() {
            let turn = |(axis, [from, to]): &(Vec3, [f32; 2])| {
                Quat::from_axis_angle(*axis, (from + (to - from) * share).to_radians())
            };
            // The first turn happens first.
            let rotation = self
                .turns
                .iter()
                .map(turn)
                .fold(Quat::IDENTITY, |so_far, next| next * so_far);
            state.rotation = Some(rotation.normalize().to_array().map(seven_digits));
        }
        if let Some(scale) = self.scale {
            state.scale = Some(between(scale).to_array());
        }
    }

    /// Sets one value. `before` are the keys that were given before it: those of turns may be repeated, because each is another turn.
    fn set(&mut self, key: &str, values: [f32; 2], before: &[&str]) -> Result<(), String> {
        if before.contains(&key) && !key.starts_with("turn-") {
            return Err(format!("{key} is given twice"));
        }
        if let Some(axis) = before
            .iter()
            .find(|before| before.starts_with("scale-") && key == "scale")
        {
            return Err(format!("scale would replace {axis}; give it before {axis}"));
        }
        let axis = |name: &str| match name {
            "x" => Some(0),
            "y" => Some(1),
            "z" => Some(2),
            _ => None,
        };
        let set = |to: &mut [Vec3; 2], axis: usize| (to[0][axis], to[1][axis]) = (values[0], values[1]);
        if let Some(axis) = axis(key) {
            set(&mut self.translation, axis);
        } else if let Some(axis) = key.strip_prefix("turn-").and_then(axis) {
            self.turns.push((Vec3::AXES[axis], values));
        } else if key == "scale" {
            self.scale = Some(values.map(Vec3::splat));
        } else if let Some(axis) = key.strip_prefix("scale-").and_then(axis) {
            set(self.scale.get_or_insert([Vec3::ONE; 2]), axis);
        } else {
            let known = KEYS.join(", ");
            let hint = suggestion(key, KEYS);
            return Err(format!(
                "unknown key \"{}\"{hint}; expected one of {known}",
                Printable(key)
            ));
        }
        Ok(())
    }
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut place = Self::default();
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        if !text.contains('=') {
            let [x, y, z] = parts[..] else {
                return Err(format!("expected X,Y,Z or KEY=VALUE,.., found \"{}\"", Printable(text)));
            };
            for (key, text) in [("x", x), ("y", y), ("z", z)] {
                place.set(key, range(text)?, &[])?;
            }
            return Ok(place);
        }
        let mut before = Vec::new();
        for part in parts {
            let (key, value) = part.split_once('=').ok_or_else(|| {
                let part = Printable(part);
                format!("expected KEY=VALUE, found \"{part}\"")
            })?;
            let key = key.trim();
            place.set(key, range(value.trim())?, &before)?;
            before.push(key);
        }
        Ok(place)
    }
}

/// Without the noise of a rounded sine, so that half a turn is 0, 1, 0, 0.
fn seven_digits(value: f32) -> f32 {
    // Adding zero turns -0 into 0.
    ((f64::from(value) * 1e7).round() / 1e7) as f32 + 0.0
}

/// `A` or `A..B`.
fn range(text: &str) -> Result<[f32; 2], String> {
    let number = |text: &str| {
        let number = text.trim().parse().ok().filter(|number: &f32| number.is_finite());
        number.ok_or_else(|| format!("\"{}\" is not a finite number", Printable(text)))
    };
    match text.split_once("..") {
        Some((from, to)) => Ok([number(from)?, number(to)?]),
        None => Ok([number(text)?; 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(place: &str, share: f32) -> Result<BodyState, String> {
        let mut state = BodyState::default();
        place.parse::<Place>()?.apply(share, &mut state);
        Ok(state)
    }

    #[test]
    fn three_numbers_are_a_translation_and_keys_are_anything() -> Result<(), String> {
        assert_eq!(state("1,-2, 3e0", 0.5)?.translation, Some([1.0, -2.0, 3.0]));
        assert_eq!(state("y=2", 0.0)?.translation, Some([0.0, 2.0, 0.0]));
        let scaled = state("scale=2,scale-y=-1", 0.0)?;
        assert_eq!((scaled.scale, scaled.translation), (Some([2.0, -1.0, 2.0]), None));
        let turned = state("turn-y=90,turn-x=90", 0.0)?.world_from_model();
        // x goes to -z about y, and then to y about x.
        assert!(
            turned.transform_vector3(Vec3::X).abs_diff_eq(Vec3::Y, 1e-6),
            "{turned:?}"
        );
        // Two turns about the same axis add up.
        let twice = state("turn-y=45,turn-y=45", 0.0)?.world_from_model();
        assert!(twice.transform_vector3(Vec3::X).abs_diff_eq(Vec3::NEG_Z, 1e-6));
        assert_eq!(state("0,0,0", 0.0)?, BodyState::default());
        Ok(())
    }

    #[test]
    fn ranges_move_at_constant_speed() -> Result<(), String> {
        let place: Place = "x=-1..1,turn-z=0..90,scale=1..3".parse()?;
        assert!(place.moves());
        assert!(!"1,2,3".parse::<Place>()?.moves());
        let middle = state("x=-1..1,turn-z=0..90,scale=1..3", 0.5)?;
        assert_eq!((middle.translation, middle.scale), (Some([0.0; 3]), Some([2.0; 3])));
        let turned = middle.world_from_model().transform_vector3(Vec3::X).normalize();
        assert!(turned.abs_diff_eq(Vec3::new(1.0, 1.0, 0.0).normalize(), 1e-6));
        Ok(())
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (text, part) in [
            ("1,2", "expected X,Y,Z"),
            ("1,2,up", "\"up\" is not a finite number"),
            ("x=inf", "not a finite number"),
            ("trun-x=90", "did you mean \"turn-x\", "),
            ("x=1,x=2", "x is given twice"),
            ("scale-y=2,scale=3", "scale would replace scale-y"),
            ("x=1,5", "expected KEY=VALUE, found \"5\""),
        ] {
            let error = text.parse::<Place>().expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
