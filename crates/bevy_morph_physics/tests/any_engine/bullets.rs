//! Small fast bodies do not pass through moving surfaces.

use morph_collision_workspace::physics::bullets::Shots;
use morph_collision_workspace::physics::drops::Kind;

use crate::support::Method;

const SHOTS: usize = 40;

#[test]
fn no_bullet_goes_through_a_surface_that_comes_towards_it() {
    let mut wrong = Vec::new();
    let mut shoot = |shots: Shots| {
        let hits = shots.fire(&Method::Ours, SHOTS);
        // They neither stick nor bounce off. Cuboids tumble.
        let slow = if shots.kind == Kind::Ball { 1.0 } else { 3.0 };
        if hits.through > 0 || hits.fastest > slow {
            wrong.push(format!("{hits:?} of {SHOTS}: {shots:?}"));
        }
    };
    for ccd in [false, true] {
        for (speed, rise) in [
            (5.0, 5.0),
            (20.0, 5.0),
            (20.0, 1.0),
            (20.0, -1.0),
            (100.0, 1.0),
            (100.0, 5.0),
            (300.0, 0.0),
        ] {
            for radius in [0.005, 0.02, 0.1] {
                shoot(Shots {
                    speed,
                    radius,
                    rise,
                    ccd,
                    ..Shots::SMALL
                });
            }
        }
        for (speed, rise) in [(20.0, 5.0), (100.0, 1.0)] {
            let kind = Kind::Cuboid;
            shoot(Shots {
                kind,
                speed,
                rise,
                ccd,
                ..Shots::SMALL
            });
        }
        for unit in [0.01, 10.0, 100.0] {
            shoot(Shots {
                unit,
                ccd,
                ..Shots::SMALL
            });
        }
        for rate in [10.0, 30.0, 240.0] {
            shoot(Shots {
                rate,
                ccd,
                ..Shots::SMALL
            });
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
