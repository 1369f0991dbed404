//! Values of channels between keys, by the formulas of the specification's appendix C.

use super::description::{Channel, Interpolation};

/// The two keys around a time, and how far it is between them; the same key twice at and beyond the ends.
fn around(channel: &Channel, seconds: f64) -> (usize, usize, f64) {
    let key = |key: usize| channel.times.element(key)[0];
    let last = channel.times.count() - 1;
    if seconds <= key(0) {
        return (0, 0, 0.0);
    }
    if seconds >= key(last) {
        return (last, last, 0.0);
    }
    let next = (0..=last)
        .find(|&next| key(next) > seconds)
        .expect("the last one is later");
    (next - 1, next, (seconds - key(next - 1)) / (key(next) - key(next - 1)))
}

/// A value of some numbers; rotations are not yet normalised.
pub(super) fn value(channel: &Channel, width: usize, seconds: f64) -> Vec<f64> {
    let (from, to, t) = around(channel, seconds);
    let is_cubic = channel.interpolation == Interpolation::Cubic;
    // The in-tangent, the value or the out-tangent of a key.
    let vector = |key: usize, part: usize| {
        let vector = if is_cubic { 3 * key + part } else { key };
        let start = vector * width / channel.values.components;
        let elements = start..start + width / channel.values.components;
        elements
            .flat_map(|element| channel.values.element(element))
            .collect::<Vec<f64>>()
    };
    let (a, b) = (vector(from, 1), vector(to, 1));
    let mix = |of: &dyn Fn(usize) -> f64| (0..width).map(of).collect::<Vec<f64>>();
    match channel.interpolation {
        _ if from == to => a,
        Interpolation::Step => a,
        Interpolation::Linear => mix(&|c| (1.0 - t) * a[c] + t * b[c]),
        Interpolation::Cubic => {
            let seconds = channel.times.element(to)[0] - channel.times.element(from)[0];
            let (leaving, arriving) = (vector(from, 2), vector(to, 0));
            let (t2, t3) = (t * t, t * t * t);
            mix(&|c| {
                (2.0 * t3 - 3.0 * t2 + 1.0) * a[c]
                    + seconds * (t3 - 2.0 * t2 + t) * leaving[c]
                    + (-2.0 * t3 + 3.0 * t2) * b[c]
                    + seconds * (t3 - t2) * arriving[c]
            })
        }
    }
}

/// A rotation between two keys, at constant speed on the shorter way.
pub(super) fn rotation(channel: &Channel, seconds: f64) -> [f64; 4] {
    let (from, to, t) = around(channel, seconds);
    let a = normalized(&channel.values.element(from));
    if from == to {
        return a;
    }
    let b = normalized(&channel.values.element(to));
    let cosine: f64 = (0..4).map(|c| a[c] * b[c]).sum();
    let angle = cosine.abs().acos();
    let sign = if cosine < 0.0 { -1.0 } else { 1.0 };
    let [of_a, of_b] = [
        ((1.0 - t) * angle).sin() / angle.sin(),
        sign * (t * angle).sin() / angle.sin(),
    ];
    [0, 1, 2, 3].map(|c| of_a * a[c] + of_b * b[c])
}

pub(super) fn normalized(turn: &[f64]) -> [f64; 4] {
    let length = turn.iter().map(|c| c * c).sum::<f64>().sqrt();
    [0, 1, 2, 3].map(|c| turn[c] / length)
}
