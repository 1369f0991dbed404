//! Clips: weights that change over time.

/// The time in a loop of `length` seconds that stands for a time outside it, for clips that are played in a loop: they are sampled there.
///
/// The end of a loop is its beginning. Of a loop without a length, and for a time that is not finite, it is 0.
#[must_use]
pub fn looped(seconds: f32, length: f32) -> f32 {
    let wrapped = if length > 0.0 { seconds.rem_euclid(length) } else { 0.0 };
    // `rem_euclid` of a tiny negative time rounds up to the length itself.
    if wrapped < length { wrapped } else { 0.0 }
}

/// A clip. Each key holds one weight vector; interpolation between keys is linear or cubic.
///
/// Two keys at the same time are a jump. Stepped animation is stored this way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WeightAnimation {
    /// The clip's name.
    pub name: String,
    /// Key times in seconds, ascending.
    pub times: Vec<f32>,
    /// One weight vector per key.
    pub weights: Vec<Vec<f32>>,
    /// For a cubic Hermite spline, the in-tangent and the out-tangent of every key, in weight per second. Empty for a linear
    /// clip.
    pub tangents: Vec<[Vec<f32>; 2]>,
    /// The time at which the clip ends, in seconds, if that is later than the last key. The last key holds until then.
    pub end: f32,
}

/// One target's weight between two keys: `a t^3 + b t^2 + c t + d`, with `t` from 0 to 1.
#[derive(Clone, Copy, Debug)]
struct Cubic {
    a: f64,
    b: f64,
    c: f64,
    d: f64,
}

impl Cubic {
    /// Goes through two values with these slopes, which are per unit of `t`.
    fn hermite([from, to]: [f64; 2], [out_slope, in_slope]: [f64; 2]) -> Self {
        Self {
            a: 2.0 * (from - to) + out_slope + in_slope,
            b: 3.0 * (to - from) - 2.0 * out_slope - in_slope,
            c: out_slope,
            d: from,
        }
    }

    fn line(from: f64, to: f64) -> Self {
        Self {
            a: 0.0,
            b: 0.0,
            c: to - from,
            d: from,
        }
    }

    fn at(self, t: f64) -> f64 {
        ((self.a * t + self.b) * t + self.c) * t + self.d
    }

    fn plus(self, other: Self) -> Self {
        Self {
            a: self.a + other.a,
            b: self.b + other.b,
            c: self.c + other.c,
            d: self.d + other.d,
        }
    }

    /// The places where it may be smallest or largest: the ends, and the places in between where its slope is 0.
    fn extremes(self) -> impl Iterator<Item = f64> {
        // Solves 3 a t^2 + 2 b t + c = 0 without cancellation.
        let root = (self.b * self.b - 3.0 * self.a * self.c).sqrt();
        let q = -(self.b + root.copysign(self.b));
        let inside = [q / (3.0 * self.a), self.c / q]
            .into_iter()
            .filter(|t| *t > 0.0 && *t < 1.0);
        [0.0, 1.0].into_iter().chain(inside).map(move |t| self.at(t))
    }
}

impl WeightAnimation {
    /// Its length in seconds: the time of the last key, or [`WeightAnimation::end`] if that is later.
    pub fn duration(&self) -> f32 {
        self.times.last().map_or(0.0, |&last| last.max(self.end))
    }

    /// The same clip with a key at its end, for formats in which a clip ends with its last key.
    #[must_use]
    pub fn with_key_at_end(&self) -> Self {
        let mut clip = self.clone();
        let (Some(&time), Some(last)) = (self.times.last(), self.weights.last()) else {
            return clip;
        };
        if self.end > time {
            clip.times.push(self.end);
            clip.weights.push(last.clone());
            let flat = vec![0.0; last.len()];
            if let Some([_, leaving]) = clip.tangents.last_mut() {
                leaving.clone_from(&flat);
                clip.tangents.push([flat.clone(), flat]);
            }
        }
        clip.end = 0.0;
        clip
    }

    /// The weights at `time` seconds. Before the first key they are those of the first key, and from the last key on those of the last.
    ///
    /// To play the clip in a loop, sample it at [`looped`] times. A clip without keys gives no weights.
    pub fn sample(&self, time: f32) -> Vec<f32> {
        let next = self.times.partition_point(|&key| key <= time);
        let (Some(after), Some(&end)) = (self.weights.get(next), self.times.get(next)) else {
            return self.weights.last().cloned().unwrap_or_default();
        };
        let Some(previous) = next.checked_sub(1) else {
            return after.clone();
        };
        let (before, start) = (&self.weights[previous], self.times[previous]);
        if self.tangents.is_empty() {
            let t = (time - start) / (end - start);
            return before.iter().zip(after).map(|(&a, &b)| a + (b - a) * t).collect();
        }
        let t = (f64::from(time) - f64::from(start)) / (f64::from(end) - f64::from(start));
        let of_target = |target: usize| self.segment(previous, target).at(t) as f32;
        (0..before.len().min(after.len())).map(of_target).collect()
    }

    /// The smallest and the largest weight of a target, including overshoots between keys; `None` for a clip without keys.
    #[must_use]
    pub fn range(&self, target: usize) -> Option<(f64, f64)> {
        self.extremes(
            |key| self.weights[key].get(target).map_or(0.0, |&weight| f64::from(weight)),
            |key| self.segment(key, target),
        )
    }

    /// The smallest and the largest sum of all weights; `None` for a clip without keys.
    #[must_use]
    pub fn range_of_sum(&self) -> Option<(f64, f64)> {
        self.extremes(
            |key| self.weights[key].iter().map(|&weight| f64::from(weight)).sum(),
            |key| {
                let targets = self.weights[key].len();
                let all = (0..targets).map(|target| self.segment(key, target));
                all.fold(Cubic::line(0.0, 0.0), Cubic::plus)
            },
        )
    }

    fn extremes(&self, at_key: impl Fn(usize) -> f64, segment: impl Fn(usize) -> Cubic) -> Option<(f64, f64)> {
        let keys = (0..self.weights.len()).map(at_key);
        let between = 1..if self.tangents.is_empty() { 0 } else { self.times.len() };
        let all = keys.chain(between.flat_map(|next| segment(next - 1).extremes()));
        all.map(|weight| (weight, weight))
            .reduce(|range, weight| (range.0.min(weight.0), range.1.max(weight.1)))
    }

    /// The curve from a key to the next one; 0 if the clip has no such key or target.
    fn segment(&self, key: usize, target: usize) -> Cubic {
        let value = |key: usize| self.weights.get(key).and_then(|key| key.get(target));
        let values = [key, key + 1].map(|key| value(key).map_or(0.0, |&weight| f64::from(weight)));
        let length = match self.times.get(key..key + 2) {
            Some(&[start, end]) => f64::from(end) - f64::from(start),
            _ => 0.0,
        };
        let tangent = |key: usize, side: usize| self.tangents.get(key).and_then(|both| both[side].get(target));
        match (tangent(key, 1), tangent(key + 1, 0)) {
            (Some(&leaving), Some(&arriving)) => {
                Cubic::hermite(values, [f64::from(leaving) * length, f64::from(arriving) * length])
            }
            _ => Cubic::line(values[0], values[1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clip(times: &[f32], weights: &[f32]) -> WeightAnimation {
        WeightAnimation {
            name: "clip".into(),
            times: times.to_vec(),
            weights: weights.iter().map(|&w| vec![w]).collect(),
            ..WeightAnimation::default()
        }
    }

    #[test]
    fn sampling_is_linear_between_keys_and_holds_beyond_them() {
        let clip = clip(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.5]);
        for (time, weight) in [
            (0.25, 0.25),
            (1.5, 0.75),
            (2.0, 0.5),
            (2.25, 0.5),
            (f32::INFINITY, 0.5),
            (-0.5, 0.0),
        ] {
            assert_eq!(clip.sample(time), [weight], "at {time}");
        }
    }

    #[test]
    fn a_looped_time_is_in_the_loop() {
        for (time, wrapped) in [
            (0.5, 0.5),
            (2.0, 0.0),
            (2.25, 0.25),
            (-0.5, 1.5),
            (-1e-30, 0.0),
            (f32::NAN, 0.0),
        ] {
            assert_eq!(looped(time, 2.0), wrapped, "at {time}");
        }
        assert_eq!((looped(7.0, 0.0), looped(f32::INFINITY, 1.0)), (0.0, 0.0));
    }

    #[test]
    fn the_last_key_holds_until_the_clip_ends() {
        let mut clip = clip(&[0.0, 1.0], &[0.0, 1.0]);
        clip.end = 4.0;
        assert_eq!(clip.duration(), 4.0);
        assert_eq!(clip.sample(3.75), [1.0]);
        assert_eq!(clip.sample(looped(4.25, clip.duration())), [0.25]);
        let mut cubic = clip.clone();
        cubic.tangents = vec![[vec![0.0], vec![1.0]], [vec![1.0], vec![7.0]]];
        for clip in [clip, cubic] {
            let keyed = clip.with_key_at_end();
            assert_eq!((keyed.times.len(), keyed.end), (3, 0.0));
            for time in [0.0, 0.5, 1.0, 2.5, 3.75, 4.25] {
                assert_eq!(keyed.sample(time), clip.sample(time), "at {time}");
            }
        }
    }

    #[test]
    fn the_first_key_holds_before_its_time() {
        assert_eq!(clip(&[1.0, 2.0], &[3.0, 5.0]).sample(0.5), [3.0]);
    }

    #[test]
    fn two_keys_at_one_time_are_a_jump() {
        let clip = clip(&[0.0, 1.0, 1.0, 2.0], &[0.0, 0.0, 1.0, 1.0]);
        assert_eq!(clip.sample(0.999), [0.0]);
        assert_eq!(clip.sample(1.0), [1.0]);
    }

    #[test]
    fn clips_of_one_key_or_none_do_not_panic() {
        assert_eq!(clip(&[0.0], &[2.0]).sample(7.0), [2.0]);
        assert!(clip(&[], &[]).sample(7.0).is_empty());
        assert_eq!(clip(&[0.0, 1.0], &[2.0, 3.0]).sample(f32::NAN), [2.0]);
    }

    #[test]
    fn a_cubic_clip_follows_its_tangents_scaled_by_the_time_between_keys() {
        let mut cubic = clip(&[1.0, 3.0], &[0.0, 1.0]);
        cubic.tangents = vec![[vec![9.0], vec![2.0]], [vec![-1.0], vec![9.0]]];
        // glTF's formula, written out. The tangents are scaled by 2 s.
        let expected = |t: f64| {
            let (t2, t3) = (t * t, t * t * t);
            2.0 * (t3 - 2.0 * t2 + t) * 2.0 + (-2.0 * t3 + 3.0 * t2) - 2.0 * (t3 - t2)
        };
        for t in [0.0, 0.125, 0.5, 0.75] {
            let sampled = f64::from(cubic.sample(1.0 + 2.0 * t as f32)[0]);
            assert!((sampled - expected(t)).abs() < 1e-6, "{sampled} at {t}");
        }
        assert_ne!(cubic.sample(2.0), [0.5]);
        let (min, max) = cubic.range(0).expect("there are keys");
        let samples = (0..=1000).map(|i| expected(f64::from(i) / 1000.0));
        let (low, high) = samples.fold((0.0_f64, 1.0_f64), |(low, high), w| (low.min(w), high.max(w)));
        assert!(
            (min - low).abs() < 1e-5 && (max - high).abs() < 1e-5,
            "{min} {max}, {low} {high}"
        );
        assert!(max > 1.1, "it overshoots its keys");
        assert_eq!(cubic.range_of_sum(), cubic.range(0));
    }

    #[test]
    fn a_sum_of_large_weights_is_finite() {
        let mut large = clip(&[0.0], &[0.0]);
        large.weights = vec![vec![3e38; 10]];
        let (_, max) = large.range_of_sum().expect("there is a key");
        assert!(max.is_finite() && max > 2.9e39);
        assert_eq!(clip(&[], &[]).range(0), None);
    }
}
