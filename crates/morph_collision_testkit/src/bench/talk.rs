//! The weights of a talking face, for targets with the names of `ARKit`.

use std::f64::consts::TAU;

/// The motion of one target, or of a left and right pair: a wave whose lower part is cut off at 0.
struct Motion {
    /// The prefix of the target's name.
    stem: &'static str,
    /// Waves per second.
    hertz: f64,
    /// The phase at the start. Of two opposing targets, one is half a wave ahead.
    phase: f64,
    /// How far the middle of the wave is above 0, in amplitudes: 1 is always active, 0 half of the time.
    lift: f64,
    /// The largest weight.
    most: f64,
}

const fn motion(stem: &'static str, hertz: f64, phase: f64, lift: f64, most: f64) -> Motion {
    Motion {
        stem,
        hertz,
        phase,
        lift,
        most,
    }
}

/// The jaw and lips move with the syllables, brows and cheeks with the sentence. Ranges are roughly those of captured
/// speech.
const MOTIONS: [Motion; 36] = [
    motion("eyeBlink", 0.35, 0.0, -0.5, 0.95),
    motion("eyeLookDown", 0.3, 0.1, 0.0, 0.4),
    motion("eyeLookUp", 0.3, 0.6, 0.0, 0.3),
    // Both eyes look to one side, then to the other.
    motion("eyeLookInLeft", 0.4, 0.3, 0.0, 0.4),
    motion("eyeLookOutRight", 0.4, 0.3, 0.0, 0.4),
    motion("eyeLookOutLeft", 0.4, 0.8, 0.0, 0.4),
    motion("eyeLookInRight", 0.4, 0.8, 0.0, 0.4),
    motion("eyeSquint", 0.5, 0.2, 1.05, 0.4),
    motion("eyeWide", 0.45, 0.7, 0.1, 0.6),
    motion("jawForward", 0.8, 0.4, 1.05, 0.3),
    motion("jawLeft", 0.6, 0.1, 0.0, 0.2),
    motion("jawRight", 0.6, 0.6, 0.0, 0.2),
    motion("jawOpen", 3.3, 0.0, 0.9, 0.7),
    motion("mouthClose", 3.3, 0.5, 1.05, 0.15),
    motion("mouthFunnel", 1.7, 0.2, 0.9, 0.3),
    motion("mouthPucker", 1.3, 0.7, 0.9, 0.3),
    motion("mouthLeft", 0.5, 0.9, 0.0, 0.3),
    motion("mouthRight", 0.5, 0.4, 0.0, 0.3),
    motion("mouthSmile", 0.3, 0.5, 1.05, 0.8),
    motion("mouthFrown", 0.3, 0.0, -0.8, 0.1),
    motion("mouthDimple", 0.9, 0.1, 1.05, 0.3),
    motion("mouthStretch", 1.1, 0.6, 1.05, 0.5),
    motion("mouthRollLower", 2.1, 0.3, 1.05, 0.2),
    motion("mouthRollUpper", 1.9, 0.8, 1.05, 0.2),
    motion("mouthShrugLower", 1.5, 0.0, 1.05, 0.15),
    motion("mouthShrugUpper", 1.6, 0.5, 1.05, 0.4),
    motion("mouthPress", 2.3, 0.9, 1.05, 0.2),
    motion("mouthLowerDown", 3.3, 0.05, 1.05, 0.8),
    motion("mouthUpperUp", 3.3, 0.1, 1.05, 0.5),
    motion("browDown", 0.4, 0.6, 0.2, 0.5),
    motion("browInnerUp", 0.4, 0.1, 1.05, 0.8),
    motion("browOuterUp", 0.4, 0.2, 0.3, 0.7),
    motion("cheekPuff", 1.2, 0.4, 1.05, 0.1),
    motion("cheekSquint", 0.3, 0.55, 1.05, 0.45),
    motion("noseSneer", 0.7, 0.3, 1.05, 0.45),
    motion("tongueOut", 1.4, 0.2, -0.9, 0.05),
];

/// The right side lags behind the left one by this share of a wave, because no face is quite symmetric.
const RIGHT: f64 = 0.03;

/// The weights of targets with these names at a time in seconds, each in 0..1. Targets that `ARKit` does not have stay 0.
pub(super) fn weights(names: &[String], seconds: f64) -> Vec<f32> {
    let weight = |name: &String| {
        let Some(motion) = MOTIONS.iter().find(|motion| name.starts_with(motion.stem)) else {
            return 0.0;
        };
        let side = if name.ends_with("Right") { RIGHT } else { 0.0 };
        let wave = (TAU * (motion.hertz * seconds + motion.phase - side)).sin();
        let share = (motion.lift + wave).max(0.0) / (motion.lift + 1.0);
        (motion.most * share) as f32
    };
    names.iter().map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str], seconds: f64) -> Vec<f32> {
        let names: Vec<String> = names.iter().map(ToString::to_string).collect();
        weights(&names, seconds)
    }

    #[test]
    fn opposite_targets_are_never_active_at_once() {
        for (one, other) in [
            ("eyeLookUpLeft", "eyeLookDownLeft"),
            ("eyeLookInLeft", "eyeLookOutLeft"),
            ("eyeLookInRight", "eyeLookOutRight"),
            ("jawLeft", "jawRight"),
            ("mouthLeft", "mouthRight"),
        ] {
            for step in 0..400 {
                let both = of(&[one, other], f64::from(step) / 60.0);
                // The right side is a little late.
                assert!(both[0].min(both[1]) < 0.1, "{one} and {other}: {both:?}");
            }
        }
    }

    #[test]
    fn the_jaw_opens_and_shuts_and_unknown_targets_rest() {
        let jaw: Vec<f32> = (0..400)
            .map(|step| of(&["jawOpen"], f64::from(step) / 60.0)[0])
            .collect();
        assert!(jaw.iter().any(|open| *open > 0.6) && jaw.contains(&0.0));
        assert!(jaw.iter().all(|open| (0.0..=0.7).contains(open)));
        assert_eq!(of(&["tail_up", ""], 1.0), [0.0, 0.0]);
    }
}
