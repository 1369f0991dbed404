//! temporary
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use morph_collision::motion::{MotionQuery, MovingBody};
use morph_collision::{Body, BuildOptions, MorphBvh, Pose, WorldFromModel};
use morph_collision_testkit::gltf_read::read_meshes;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which model?")?;
    let meshes = read_meshes(Path::new(&path))?;
    let bvh = Arc::new(MorphBvh::build(Arc::new(meshes[0].to_model()?), &BuildOptions::default()));
    let (mut start, mut end) = (Pose::new(bvh.clone()), Pose::new(bvh));
    end.set_weights(&[1.0])?;
    let mut query = MotionQuery::new();
    counted_query(&mut query, &mut start, &mut end)
}

#[inline(never)]
fn counted_query(query: &mut MotionQuery, start: &mut Pose, end: &mut Pose) -> Result<(), Box<dyn Error>> {
    const WORLD: WorldFromModel = WorldFromModel::IDENTITY;
    let mut contacts = Vec::new();
    let body = MovingBody::new(Body::new(start, &WORLD), Body::new(end, &WORLD))?;
    query.all_within(body, 1e-6, &mut contacts);
    println!("{} contacts, {:?}", contacts.len(), query.stats());
    Ok(())
}
