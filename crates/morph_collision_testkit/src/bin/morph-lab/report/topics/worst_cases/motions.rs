//! Bodies that move.

use std::error::Error;
use std::ops::ControlFlow;

use glam::DVec3;
use morph_collision::motion::{LimitReached, MotionQuery, MovingBall, MovingBody, MovingPoint};
use morph_collision::{Pose, WorldFromModel};
use morph_collision_testkit::extremes::extremes;

use super::{Case, MOST, Subjects, bodies, milliseconds, placed};

/// As in the plugin, for a single pair in a frame.
const LIMIT: u64 = 3_200_000;
const TOLERANCE: f64 = 1e-6;

type Moving<'a> = Result<[MovingBody<'a>; 2], Box<dyn Error>>;

pub(super) fn measure(rounds: usize, measured: &str) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut subjects = Subjects::new()?;
    let mut query = MotionQuery::new().with_limit(LIMIT);
    let ball = MovingBall::new(MovingPoint::new(DVec3::X * -3.0, DVec3::X * 3.0), 0.3)?;
    let mut cases = Vec::new();
    for extreme in extremes() {
        let [a, b] = extreme.places;
        let places = [placed([a[0], b[0]])?, placed([a[1], b[1]])?];
        let mut add = |name: &str, work: &mut dyn FnMut([MovingBody<'_>; 2]) -> Result<String, LimitReached>| {
            let (milliseconds, answer) = milliseconds(rounds, || {
                for pose in subjects.poses.as_flattened_mut() {
                    *pose = Pose::new(pose.bvh().clone());
                }
                match moving(&mut subjects.poses, &places) {
                    Ok(bodies) => work(bodies).unwrap_or_else(|_| "limit".to_owned()),
                    Err(error) => error.to_string(),
                }
            });
            cases.push(Case {
                situation: extreme.name.to_owned(),
                query: name.to_owned(),
                milliseconds,
                answer,
                measured: measured.to_owned(),
            });
        };
        add("first", &mut |[a, b]| {
            Ok(match query.first(a, b, TOLERANCE)? {
                None => "apart".to_owned(),
                Some(contact) if contact.time.latest - contact.time.earliest > TOLERANCE => "limit".to_owned(),
                Some(contact) => format!("at {:.1e}", contact.time.latest),
            })
        });
        add("any", &mut |[a, b]| {
            Ok(if query.any(a, b)? { "yes" } else { "no" }.to_owned())
        });
        add("all", &mut |[a, b]| {
            let mut contacts = Vec::new();
            query.up_to(a, b, TOLERANCE, MOST, &mut contacts)?;
            Ok(contacts.len().to_string())
        });
        add("ball", &mut |[a, _]| {
            let first = query.first_of_ball(&ball, a, TOLERANCE)?;
            Ok(first.map_or_else(|| "apart".to_owned(), |impact| format!("at {:.1e}", impact.time.latest)))
        });
        add("within", &mut |[a, _]| {
            let mut contacts = Vec::new();
            let mut listed = 0;
            query.visit_within(a, TOLERANCE, |contact| {
                contacts.push(contact);
                listed += 1;
                if listed == MOST {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            })?;
            Ok(contacts.len().to_string())
        });
    }
    Ok(cases)
}

/// Both bodies, from the placements at the start to those at the end.
fn moving<'a>([a, b]: &'a mut [[Pose; 2]; 2], [start, end]: &'a [[WorldFromModel; 2]; 2]) -> Moving<'a> {
    let ([start_a, end_a], [start_b, end_b]) = (a, b);
    let [start_a, start_b] = bodies([start_a, start_b], start);
    let [end_a, end_b] = bodies([end_a, end_b], end);
    Ok([MovingBody::new(start_a, end_a)?, MovingBody::new(start_b, end_b)?])
}
