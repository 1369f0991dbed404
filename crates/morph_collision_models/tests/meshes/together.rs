//! Several meshes as one.

use glam::Vec4;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::generated::random::random_blob;
use morph_collision_models::generated::rigs::tube;
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::mesh::{MorphMesh, Together, TogetherError};
use morph_collision_models::skeleton::{Interpolation, JointChannel, JointClip, Property};
use morph_collision_testkit::oracle;

fn named(seed: u64, names: [&str; 3], weights: [f32; 3]) -> MorphMesh {
    let mut mesh = random_blob(seed, 1, 3, 0.5);
    mesh.target_names = names.map(str::to_owned).to_vec();
    mesh.animations = vec![WeightAnimation {
        name: "clip".to_owned(),
        times: vec![0.0, 1.0],
        weights: vec![vec![0.0; 3], weights.to_vec()],
        ..WeightAnimation::default()
    }];
    mesh
}

#[test]
fn targets_of_a_name_are_one_unless_a_clip_moves_them_apart() -> Result<(), TogetherError> {
    let one = named(1, ["a", "b", "c"], [0.5, 1.0, 0.0]);
    let other = named(2, ["c", "b", "d"], [0.0, 0.25, 0.0]);
    let parts = vec![one.clone(), other.clone()];
    let together = Together::of(parts, &MemoryBudget::default())?;
    let b = format!("b ({})", other.name);
    assert_eq!(together.mesh.target_names, ["a", "b", "c", &b, "d"]);
    assert_eq!(together.leaders, [0, 1, 2, 1, 4]);
    assert_eq!(together.targets, [[0, 1, 2], [2, 3, 4]]);
    assert_eq!(together.clip_targets, together.targets);
    let posed = together.mesh.posed(&[0.5, 0.25, 0.75, 1.0, -0.5]);
    let (first, second) = posed.split_at(one.positions.len());
    assert_eq!(first, one.posed(&[0.5, 0.25, 0.75]));
    assert_eq!(second, other.posed(&[0.75, 1.0, -0.5]));
    assert!(together.mesh.to_model().is_ok());
    Ok(())
}

#[test]
fn each_part_follows_its_own_joints() -> Result<(), TogetherError> {
    let parts = vec![tube(3, 6, 2, 1), tube(3, 6, 8, 1), tube(5, 4, 4, 1)];
    let together = Together::of(parts.clone(), &MemoryBudget::default())?;
    let skin = together.mesh.skin.as_ref().expect("the parts have skins");
    assert_eq!(skin.joint_count(), 6 + 4, "two have the same skeleton");
    let whole = oracle::skinned_vertices(&together.mesh.positions, &skin.sets, &skin.skeleton.at_rest());
    let mut expected = Vec::new();
    for part in &parts {
        let skin = part.skin.as_ref().expect("it has a skin");
        let rest = skin.skeleton.at_rest();
        expected.extend(oracle::skinned_vertices(&part.positions, &skin.sets, &rest));
    }
    assert_eq!(whole, expected);
    assert!(together.mesh.to_model().is_ok());
    let mut rigid = parts;
    rigid[1].skin = None;
    let error = Together::of(rigid, &MemoryBudget::default());
    assert!(matches!(error, Err(TogetherError::OneSkin(_))));
    Ok(())
}

#[test]
fn memory_is_counted_before_it_is_taken() {
    let parts = vec![random_blob(1, 3, 4, 0.5), random_blob(2, 3, 4, 0.5)];
    let error = Together::of(parts, &MemoryBudget::new(10_000));
    assert!(matches!(error, Err(TogetherError::OverBudget(_))));
}

#[test]
fn copies_of_clips_of_joints_are_counted() {
    let mut part = tube(3, 6, 2, 1);
    let keys = 100_000;
    let channel = JointChannel {
        node: 0,
        property: Property::Translation,
        interpolation: Interpolation::Linear,
        times: (0..keys).map(|key| key as f32).collect(),
        values: vec![Vec4::ZERO; keys],
    };
    let clip = |name: &str| JointClip {
        name: name.to_owned(),
        channels: vec![channel.clone()],
        end: 0.0,
    };
    let skin = part.skin.as_mut().expect("a tube has a skin");
    skin.skeleton.clips = vec![clip("walk"), clip("walk"), clip("run")];
    let parts = vec![part.clone(), part];
    let together = |bytes| Together::of(parts.clone(), &MemoryBudget::new(bytes));
    // Only the two skeletons' clips take so much, and they are the same.
    assert!(matches!(together(4_000_000), Err(TogetherError::OverBudget(_))));
    let whole = together(8_000_000).expect("there is room for one copy");
    let clips = whole.mesh.skin.map(|skin| skin.skeleton.clips).unwrap_or_default();
    let channels: Vec<(&str, usize)> = clips.iter().map(|clip| (&*clip.name, clip.channels.len())).collect();
    assert_eq!(channels, [("walk", 1), ("run", 1)]);
}
