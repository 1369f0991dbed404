//! Users' own models: a valid one is shown twice. An invalid one is refused, and the previous model
//! stays.

use std::path::Path;

use bevy::ecs::system::RunSystemOnce;
use bevy::mesh::morph::MorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::{random, rigid};
use morph_collision_models::gltf::write::{Appearance, to_glb};
use morph_collision_workspace::demos::{Inbox, Verdict, own};
use morph_collision_workspace::view::offscreen::Offscreen;
use morph_collision_workspace::view::overlay::Overlay;
use morph_collision_workspace::view::stage::Notes;

use crate::support::{alone, offscreen};

const SIZE: (u32, u32) = (160, 90);

/// The demo with its first file, and access to its inbox and verdict.
struct Own {
    demo: Offscreen,
    inbox: Inbox,
    verdict: Verdict,
}

impl Own {
    fn new(name: &str, bytes: Vec<u8>) -> Self {
        let (inbox, verdict) = (Inbox::default(), Verdict::default());
        inbox.put(name.into(), bytes);
        let demo = offscreen(own(inbox.clone(), verdict.clone()), SIZE);
        Self { demo, inbox, verdict }
    }

    /// Puts a file into the inbox and waits for the verdict; returns the reason if it is refused.
    fn bring(&mut self, name: &str, bytes: Vec<u8>) -> Result<(), String> {
        let number = self.verdict.now().number + 1;
        self.inbox.put(name.into(), bytes);
        for _ in 0..10_000 {
            self.demo.advance(1);
            let judged = self.verdict.now();
            if judged.number == number {
                assert_eq!(judged.name, name);
                match judged.error {
                    Some(error) => return Err(error),
                    None if judged.shown => return Ok(()),
                    None => {}
                }
            }
        }
        panic!("nothing is said about {name}");
    }

    fn diagnostics(&mut self) -> MorphCollisionDiagnostics {
        *self.demo.app_mut().world().resource()
    }

    /// Runs until the copies touch, which they do every eight seconds.
    fn until_they_touch(&mut self) {
        for _ in 0..600 {
            self.demo.advance(1);
            if self.diagnostics().triangle_pairs > 0 {
                return;
            }
        }
        panic!("the copies never touch");
    }

    /// The rotations of a character's left knees.
    fn knees(&mut self) -> Vec<Quat> {
        let knees = |joints: Query<(&Name, &Transform)>| -> Vec<Quat> {
            let knees = joints.iter().filter(|(name, _)| name.as_str() == "calf_l");
            knees.map(|(_, place)| place.rotation).collect()
        };
        self.demo.app_mut().world_mut().run_system_once(knees).unwrap()
    }

    fn weights(&mut self) -> Vec<Vec<f32>> {
        let all = |weights: Query<&MorphWeights>| -> Vec<Vec<f32>> {
            weights.iter().map(|weights| weights.weights().to_vec()).collect()
        };
        self.demo.app_mut().world_mut().run_system_once(all).unwrap()
    }
}

fn asset(name: &str) -> Vec<u8> {
    std::fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(name)).unwrap()
}

#[test]
fn a_model_is_shown_twice_and_costs_less_than_a_refit_of_the_whole() {
    let _alone = alone();
    let mut own = Own::new("head.glb", asset("mh_head_eyes_teeth_arkit52.glb"));
    let judged = own.verdict.now();
    assert!(judged.shown && judged.error.is_none());
    assert!(judged.report.unwrap().contains("jawOpen"));
    own.until_they_touch();
    assert_eq!(own.diagnostics().colliders, 2);
    assert!(own.demo.app_mut().world().resource::<Overlay>().triangles > 0);
    let before = own.weights();
    own.demo.advance(31);
    assert_ne!(own.weights(), before, "without a clip, weights wave");

    let notes = own.demo.app_mut().world().resource::<Notes>().0.clone();
    let vertices = |name: &str| -> f64 {
        let (_, line) = notes
            .iter()
            .find(|(of, _)| *of == name)
            .unwrap_or_else(|| panic!("{notes:?}"));
        let (_, vertices) = line.split_once("ms, ").unwrap();
        vertices.trim_end_matches(" vertices").parse().unwrap()
    };
    assert!(0.0 < vertices("morph trees") && vertices("morph trees") < vertices("whole mesh refitted"));
}

#[test]
fn a_skinned_model_plays_its_clip_and_runs_into_its_copy() {
    let _alone = alone();
    let mut own = Own::new("character.glb", asset("mh_character_low.glb"));
    let judged = own.verdict.now();
    assert!(judged.shown && judged.error.is_none());
    own.until_they_touch();
    assert_eq!(own.diagnostics().colliders, 2);
    assert!(own.demo.app_mut().world().resource::<Overlay>().triangles > 0);
    // Its joints move it; each copy has its own skeleton.
    let first = own.knees();
    let mut most = [0.0_f32; 2];
    for _ in 0..4 {
        own.demo.advance(11);
        for ((most, first), now) in most.iter_mut().zip(&first).zip(own.knees()) {
            *most = most.max(first.angle_between(now));
        }
    }
    assert!(first.len() == 2 && most.iter().all(|&most| most > 0.2), "{most:?}");
    let notes = own.demo.app_mut().world().resource::<Notes>().0.clone();
    assert!(notes.iter().any(|(name, _)| *name == "not compared"), "{notes:?}");
}

#[test]
fn a_bad_file_is_refused_and_the_model_before_it_stays() {
    let _alone = alone();
    let dolphin = asset("dolphin_564.glb");
    let mut own = Own::new("dolphin.glb", dolphin.clone());
    let mut refused = |name: &str, bytes: Vec<u8>| {
        let error = own.bring(name, bytes).unwrap_err();
        assert!(error.starts_with(name) && !error.contains('\n'), "{error}");
        let notes = own.demo.app_mut().world().resource::<Notes>().0.clone();
        assert!(notes.contains(&("refused", error.clone())), "{notes:?}");
        error
    };
    refused("empty.glb", Vec::new());
    refused("text.glb", b"this is no model".to_vec());
    for cut in (1..8).map(|eighth| dolphin.len() * eighth / 8) {
        refused("cut.glb", dolphin[..cut].to_vec());
    }
    let still = to_glb(&rigid::box_mesh(Vec3::ONE), &Appearance::default()).unwrap();
    assert!(refused("still.glb", still).contains("morph targets"));
    own.until_they_touch();
    assert_eq!(own.diagnostics().colliders, 2);

    // Another valid model replaces it, and nothing is left of the first.
    own.bring("other.glb", asset("pass_through_20480.glb")).unwrap();
    own.until_they_touch();
    assert_eq!(own.diagnostics().colliders, 2);
    assert_eq!(own.weights().len(), 2);
}

#[test]
fn what_bevy_cannot_load_is_refused_under_its_own_name() {
    let _alone = alone();
    let mut own = Own::new("dolphin.glb", asset("dolphin_564.glb"));
    // The mesh is valid but its texture is missing; the reader of meshes does not look at it.
    let glb = asset("dolphin_564.glb");
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    json["images"] = serde_json::json!([{ "uri": "elsewhere.png" }]);
    json["textures"] = serde_json::json!([{ "source": 0 }]);
    let mut text = serde_json::to_vec(&json).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut changed = glb[..12].to_vec();
    changed.extend((text.len() as u32).to_le_bytes());
    changed.extend(b"JSON");
    changed.extend(&text);
    changed.extend(&glb[20 + length..]);
    let total = changed.len() as u32;
    changed[8..12].copy_from_slice(&total.to_le_bytes());

    let error = own.bring("textured.glb", changed).unwrap_err();
    assert!(
        error.contains("textured.glb") && error.contains("elsewhere.png"),
        "{error}"
    );
    assert!(!error.contains("brought"), "nobody knows that name: {error}");
    own.until_they_touch();
}

#[test]
fn a_model_without_normals_and_clips_is_shown_all_the_same() {
    let _alone = alone();
    let blob = random::random_blob(3, 2, 4, 0.6);
    let plain = to_glb(&blob, &Appearance::default()).unwrap();
    let mut own = Own::new("blob.glb", plain);
    own.until_they_touch();
    let weights = own.weights();
    assert_eq!(weights.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
    assert!(weights.iter().flatten().any(|&weight| weight > 0.0));
}

#[test]
fn a_first_file_that_is_no_good_ends_the_show() {
    let _alone = alone();
    let inbox = Inbox::default();
    inbox.put("broken.glb".into(), b"no glTF".to_vec());
    let error = Offscreen::new(own(inbox, Verdict::default()), SIZE, true).unwrap_err();
    assert!(error.to_string().starts_with("broken.glb"), "{error}");
}
