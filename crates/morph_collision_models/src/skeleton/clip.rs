//! Clips that move the nodes of a skeleton.

use glam::{DVec4, Quat, Vec4};

use super::transform::LocalTransform;

/// A clip: the nodes that it moves, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointClip {
    /// The clip's name.
    pub name: String,
    /// One channel per animated property of a node.
    pub channels: Vec<JointChannel>,
    /// The time at which the clip ends, in seconds, if that is later than the last key. The last keys hold until then.
    pub end: f32,
}

/// The keys of one property of one node.
#[derive(Clone, Debug, PartialEq)]
pub struct JointChannel {
    /// The node's index among [`Skeleton::nodes`](super::Skeleton::nodes).
    pub node: u32,
    /// The property that it sets.
    pub property: Property,
    /// The interpolation between two keys.
    pub interpolation: Interpolation,
    /// Key times in seconds, ascending.
    pub times: Vec<f32>,
    /// One value per key. With [`Interpolation::CubicSpline`] there are three: the tangent before the key, the value and the
    /// tangent after it.
    ///
    /// The last component is 0, except for rotations, which are quaternions.
    pub values: Vec<Vec4>,
}

/// The property that a channel sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Property {
    /// [`LocalTransform::translation`].
    Translation,
    /// [`LocalTransform::rotation`].
    Rotation,
    /// [`LocalTransform::scale`].
    Scale,
}

/// The interpolation between two keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Linear; for rotations, the shortest arc at constant speed.
    Linear,
    /// A key holds until the next one.
    Step,
    /// A cubic Hermite spline; rotations are normalised.
    CubicSpline,
}

impl JointClip {
    /// Its length in seconds: the time of the last key, or [`JointClip::end`] if that is later.
    #[must_use]
    pub fn duration(&self) -> f32 {
        let ends = self.channels.iter().filter_map(|channel| channel.times.last());
        ends.copied().fold(self.end, f32::max)
    }

    /// The same clip with a key at its end, for formats in which a clip ends with its last key.
    #[must_use]
    pub fn with_key_at_end(&self) -> Self {
        let mut clip = self.clone();
        clip.end = 0.0;
        // One channel is enough, because all others hold.
        let channel = clip.channels.iter_mut().find(|channel| !channel.times.is_empty());
        if let Some(channel) = channel
            && self.end
                > self
                    .channels
                    .iter()
                    .filter_map(|channel| channel.times.last())
                    .copied()
                    .fold(0.0, f32::max)
            && let Some(last) = channel.value(channel.times.len() - 1)
        {
            channel.times.push(self.end);
            if channel.interpolation == Interpolation::CubicSpline {
                if let Some(leaving) = channel.values.last_mut() {
                    *leaving = Vec4::ZERO;
                }
                channel.values.extend([Vec4::ZERO, last, Vec4::ZERO]);
            } else {
                channel.values.push(last);
            }
        }
        clip
    }

    /// Sets the properties that the clip moves to their values at a time.
    ///
    /// Before a channel's first key its first value holds, and after the last key the last value.
    pub(super) fn apply(&self, seconds: f32, locals: &mut [LocalTransform]) {
        for channel in &self.channels {
            let (Some(value), Some(local)) = (channel.at(seconds), locals.get_mut(channel.node as usize)) else {
                continue;
            };
            match channel.property {
                Property::Translation => local.translation = value.truncate(),
                Property::Rotation => local.rotation = Quat::from_vec4(value),
                Property::Scale => local.scale = value.truncate(),
            }
        }
    }
}

impl JointChannel {
    /// The value at a time; `None` if there are no keys.
    fn at(&self, time: f32) -> Option<Vec4> {
        let last = self.times.len().checked_sub(1)?;
        let next = self.times.partition_point(|&key| key <= time);
        let Some(before) = next.checked_sub(1) else {
            return self.value(0);
        };
        if before == last || self.interpolation == Interpolation::Step {
            return self.value(before);
        }
        let length = self.times[next] - self.times[before];
        let t = (time - self.times[before]) / length;
        let (from, to) = (self.value(before)?, self.value(next)?);
        let is_rotation = self.property == Property::Rotation;
        Some(match self.interpolation {
            Interpolation::CubicSpline => {
                let leaving = *self.values.get(3 * before + 2)? * length;
                let arriving = *self.values.get(3 * next)? * length;
                let value = hermite(from, leaving, to, arriving, t);
                if is_rotation { normalized(value) } else { value }
            }
            _ if is_rotation => slerp(from, to, t),
            _ => from + (to - from) * t,
        })
    }

    /// The value of a key.
    fn value(&self, key: usize) -> Option<Vec4> {
        let cubic = self.interpolation == Interpolation::CubicSpline;
        self.values.get(if cubic { 3 * key + 1 } else { key }).copied()
    }
}

/// A quaternion divided by its length. Like [`slerp`], it has the same bits on every machine: `f64`, because vector instructions add in
/// different orders.
pub(crate) fn normalized(quaternion: Vec4) -> Vec4 {
    quaternion.as_dvec4().normalize_or(DVec4::W).as_vec4()
}

/// The rotation at a share of the shortest way between two. The sines are those of `libm`, because the standard library's differ between machines.
fn slerp(from: Vec4, to: Vec4, t: f32) -> Vec4 {
    let (from, to, t) = (from.as_dvec4(), to.as_dvec4(), f64::from(t));
    let cosine = from.dot(to);
    let (to, cosine) = if cosine < 0.0 { (-to, -cosine) } else { (to, cosine) };
    // Stored quaternions are only nearly of length 1.
    let angle = libm::acos(cosine.min(1.0));
    let sine = libm::sin(angle);
    if sine < 1e-6 {
        return (from + (to - from) * t).normalize_or(DVec4::W).as_vec4();
    }
    ((from * libm::sin((1.0 - t) * angle) + to * libm::sin(t * angle)) / sine).as_vec4()
}

/// The cubic from one value to another with these slopes per unit of `t`, as glTF defines it.
fn hermite(from: Vec4, leaving: Vec4, to: Vec4, arriving: Vec4, t: f32) -> Vec4 {
    let (t2, t3) = (t * t, t * t * t);
    from * (2.0 * t3 - 3.0 * t2 + 1.0)
        + leaving * (t3 - 2.0 * t2 + t)
        + to * (3.0 * t2 - 2.0 * t3)
        + arriving * (t3 - t2)
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn channel(property: Property, interpolation: Interpolation, values: Vec<Vec4>) -> JointChannel {
        JointChannel {
            node: 0,
            property,
            interpolation,
            times: vec![1.0, 3.0],
            values,
        }
    }

    fn pose(channel: JointChannel, time: f32) -> LocalTransform {
        let mut locals = [LocalTransform::default()];
        let clip = JointClip {
            name: "clip".into(),
            channels: vec![channel],
            end: 0.0,
        };
        clip.apply(time, &mut locals);
        locals[0]
    }

    #[test]
    fn translations_move_on_a_line_and_hold_before_and_after_it() {
        let keys = || {
            let values = vec![Vec4::X, Vec4::X * 5.0];
            channel(Property::Translation, Interpolation::Linear, values)
        };
        for (time, x) in [
            (0.0, 1.0),
            (1.0, 1.0),
            (1.5, 2.0),
            (2.75, 4.5),
            (3.0, 5.0),
            (4.5, 5.0),
            (-0.25, 1.0),
        ] {
            assert_eq!(pose(keys(), time).translation, Vec3::X * x, "at {time}");
        }
    }

    #[test]
    fn the_last_keys_hold_until_the_clip_ends() {
        let values = |keys: usize| (0..keys).map(|key| Vec4::X * key as f32).collect();
        for (interpolation, keys) in [
            (Interpolation::Linear, 2),
            (Interpolation::Step, 2),
            (Interpolation::CubicSpline, 6),
        ] {
            let clip = JointClip {
                channels: vec![channel(Property::Translation, interpolation, values(keys))],
                end: 5.0,
                ..JointClip::default()
            };
            assert_eq!(clip.duration(), 5.0);
            let keyed = clip.with_key_at_end();
            assert_eq!((keyed.channels[0].times.len(), keyed.end), (3, 0.0));
            for time in [0.0, 1.5, 3.0, 4.5, 6.5] {
                let at = |clip: &JointClip| {
                    let mut locals = [LocalTransform::default()];
                    clip.apply(time, &mut locals);
                    locals[0].translation
                };
                assert_eq!(at(&keyed), at(&clip), "{interpolation:?} at {time}");
            }
        }
    }

    #[test]
    fn a_step_holds_until_the_next_key() {
        let keys = || channel(Property::Scale, Interpolation::Step, vec![Vec4::ONE, Vec4::ONE * 2.0]);
        assert_eq!(pose(keys(), 2.999).scale, Vec3::ONE);
        let mut longer = keys();
        longer.times = vec![1.0, 2.0, 9.0];
        longer.values.push(Vec4::ZERO);
        assert_eq!(pose(longer, 2.0).scale, Vec3::splat(2.0));
    }

    #[test]
    fn rotations_take_the_shortest_arc_at_constant_speed() {
        let to = Quat::from_rotation_y(1.2);
        // The same rotation with the opposite sign: a line between the two would pass near zero.
        for to in [to, -to] {
            let values = vec![Quat::IDENTITY.into(), to.into()];
            let turned = pose(channel(Property::Rotation, Interpolation::Linear, values), 1.5).rotation;
            assert!(turned.angle_between(Quat::from_rotation_y(0.3)) < 1e-3, "{turned}");
        }
    }

    #[test]
    fn a_spline_follows_its_tangents_scaled_by_the_time_between_keys() {
        let values = [9.0, 0.0, 2.0, -1.0, 1.0, 9.0].map(|x| Vec4::X * x).to_vec();
        let spline = channel(Property::Translation, Interpolation::CubicSpline, values);
        let expected = |t: f32| {
            let (t2, t3) = (t * t, t * t * t);
            4.0 * (t3 - 2.0 * t2 + t) + (3.0 * t2 - 2.0 * t3) - 2.0 * (t3 - t2)
        };
        for t in [0.0, 0.125, 0.5, 0.75] {
            let found = pose(spline.clone(), 1.0 + 2.0 * t).translation.x;
            assert!((found - expected(t)).abs() < 1e-6, "{found} at {t}");
        }
        let turn = Quat::from_rotation_x(2.0).into();
        let values = vec![Vec4::ZERO, Vec4::W, Vec4::ZERO, Vec4::ZERO, turn, Vec4::ZERO];
        let turned = pose(channel(Property::Rotation, Interpolation::CubicSpline, values), 2.0).rotation;
        assert!(turned.is_normalized());
        assert!(turned.angle_between(Quat::from_rotation_x(1.0)) < 1e-3, "{turned}");
    }

    #[test]
    fn channels_without_keys_or_of_nodes_that_do_not_exist_change_nothing() {
        let mut empty = channel(Property::Scale, Interpolation::Linear, Vec::new());
        empty.times.clear();
        assert_eq!(pose(empty, 1.0), LocalTransform::default());
        let mut stray = channel(Property::Scale, Interpolation::Linear, vec![Vec4::ZERO; 2]);
        stray.node = 7;
        assert_eq!(pose(stray, 1.0), LocalTransform::default());
    }
}
