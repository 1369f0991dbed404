//! The scripted motions make the contacts that they are meant to make.

use std::{error::Error, sync::Arc};

use morph_collision::{Body, BuildOptions, MorphBvh, PairQuery, Pose, TrianglePair, WorldFromModel};
use morph_collision_models::generated;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::scenes::{dolphins, pass_through};

fn poses(mesh: &MorphMesh, count: usize) -> Result<Vec<Pose>, Box<dyn Error>> {
    let bvh = Arc::new(MorphBvh::build(Arc::new(mesh.to_model()?), &BuildOptions::default()));
    Ok((0..count).map(|_| Pose::new(bvh.clone())).collect())
}

#[test]
fn passing_bodies_touch_from_step_41_to_step_364() -> Result<(), Box<dyn Error>> {
    let [mut a, mut b] = <[Pose; 2]>::try_from(poses(&generated::pass_through_body(), 2)?)
        .map_err(|poses| format!("{} poses", poses.len()))?;
    let mut query = PairQuery::new();
    for step in 0..pass_through::STEPS {
        let weights = pass_through::weights(step, pass_through::STEPS);
        a.set_weights(&weights)?;
        b.set_weights(&weights)?;
        let [place_a, place_b] = pass_through::placements(step, pass_through::STEPS).map(WorldFromModel::new);
        let touching = query.any(Body::new(&mut a, &place_a?), Body::new(&mut b, &place_b?));
        assert_eq!(touching, (41..=364).contains(&step), "step {step}");
    }
    Ok(())
}

#[test]
fn swimming_dolphins_touch_now_and_then_with_fins_and_tails() -> Result<(), Box<dyn Error>> {
    const BODY_TRIANGLES: u32 = 432;
    let mut poses = poses(&generated::dolphin(0), dolphins::COUNT)?;
    let mut query = PairQuery::new();
    let (mut touching, mut bodies_touching, mut frames_without) = (0, 0, 0);
    for frame in 0..dolphins::FRAMES {
        let mut places = Vec::new();
        for (index, pose) in poses.iter_mut().enumerate() {
            pose.set_weights(&dolphins::weights(index, frame, dolphins::FRAMES))?;
            places.push(WorldFromModel::new(dolphins::placement(
                index,
                dolphins::COUNT,
                frame,
                dolphins::FRAMES,
            ))?);
        }
        let before = touching;
        for j in 1..poses.len() {
            let (others, rest) = poses.split_at_mut(j);
            for (i, other) in others.iter_mut().enumerate() {
                let mut pairs: Vec<TrianglePair> = Vec::new();
                query.all(
                    Body::new(other, &places[i]),
                    Body::new(&mut rest[0], &places[j]),
                    &mut pairs,
                );
                let of_bodies = |p: &TrianglePair| p.triangle_a < BODY_TRIANGLES && p.triangle_b < BODY_TRIANGLES;
                touching += usize::from(!pairs.is_empty());
                bodies_touching += usize::from(pairs.iter().any(of_bodies));
            }
        }
        frames_without += usize::from(touching == before);
    }
    let per_frame = touching as f32 / dolphins::FRAMES as f32;
    assert!(
        (2.0..8.0).contains(&per_frame),
        "{per_frame} of 66 pairs touch per frame"
    );
    assert!(
        bodies_touching * 50 < touching,
        "{bodies_touching} of {touching} contacts are between bodies"
    );
    assert!(
        frames_without < dolphins::FRAMES / 10,
        "{frames_without} frames without a contact"
    );
    Ok(())
}
