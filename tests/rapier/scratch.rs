use bevy::prelude::*;
use bevy_rapier3d::prelude::*;
use morph_collision_workspace::physics::*;
#[test]
fn scratch() {
    let mesh = sheet(32);
    for method in Method::ALL {
        for friction in [true, false] {
            let mut app = crate::support::app();
            let mut s = Surface::spawn(&mut app, method, &mesh, Vec3::ZERO, &mut None);
            settle(&mut app);
            s.pose(&mut app, &[0.0, 0.0]);
            let b = body(&mut app, Collider::cuboid(0.3, 0.3, 0.3), Vec3::new(-2.0, 0.31, 0.05));
            let f = Friction {
                coefficient: if friction { 0.5 } else { 0.0 },
                combine_rule: CoefficientCombineRule::Min,
            };
            app.world_mut()
                .entity_mut(b)
                .insert((f, Velocity::linear(Vec3::X * 3.0)));
            for i in 0..60 {
                app.update();
                if i % 10 == 0 {
                    print!("{:?} ", state(&app, b).1);
                }
            }
            println!("{} friction {friction}: {:?}", method.name(), state(&app, b));
        }
    }
}
