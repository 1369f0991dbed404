//! Worlds in other units of length: everything is larger or smaller, and behaves the same.

use morph_collision_workspace::physics::behaviour::Behaviour;

use crate::support::Method;

#[test]
fn bodies_behave_alike_in_every_unit() {
    for unit in [0.01, 1.0, 10.0, 100.0] {
        let found = Behaviour::of(&Method::Ours, unit);
        println!("{}", found.row(&unit.to_string()));
        assert!((found.rise - 0.5).abs() < 0.01, "{unit}: {found:?}");
        assert!(found.gap.abs() < 2e-3, "{unit}: {found:?}");
        assert!((found.slide - 1.0).abs() < 0.01, "{unit}: {found:?}");
        assert!((found.slap - 5.0).abs() < 0.1, "{unit}: {found:?}");
        assert!(found.highest < 0.71, "{unit}: {found:?}");
        assert!((found.glide - 3.0).abs() < 0.01, "{unit}: {found:?}");
        assert!(found.wave < 0.08, "{unit}: {found:?}");
    }
}
