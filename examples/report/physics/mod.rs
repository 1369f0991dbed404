//! Rigid bodies on a morphing surface, with any engine: how they behave, how many go through, and what a step costs.

mod drops;
mod times;

use morph_collision_testkit::report::{Section, Table};
use morph_collision_workspace::physics::behaviour::Behaviour;
use morph_collision_workspace::physics::bullets::Shots;
use morph_collision_workspace::physics::engine::Engine;

/// What a page compares.
pub(crate) struct Comparison<E: 'static> {
    /// This plugin, and what a game can do without it.
    pub(crate) methods: &'static [E],
    /// Those at whose surfaces bullets are shot.
    pub(crate) shot_at: &'static [E],
    /// Those on whose surfaces bodies are dropped.
    pub(crate) dropped: &'static [E],
    /// The settings of continuous collision detection of these bodies; `None` leaves the engine's default.
    pub(crate) ccd: &'static [Option<bool>],
    /// How many times their usual speed they have.
    pub(crate) speeds: &'static [f32],
}

impl<E: Engine> Comparison<E> {
    /// The sections of the page.
    pub(crate) fn sections(&self, quick: bool) -> Vec<Section<'_>> {
        vec![
            ("behaviour", Box::new(|| Ok(self.behaviour()))),
            ("units", Box::new(|| Ok(self.units()))),
            ("bullets", Box::new(|| Ok(self.bullets().to_string()))),
            ("drops", Box::new(move || Ok(drops::table(self, quick).to_string()))),
            (
                "time",
                Box::new(move || Ok(times::table(self.methods, quick).to_string())),
            ),
        ]
    }

    /// How a surface acts on a body that rests on it.
    fn behaviour(&self) -> String {
        let row = |method: &E| Behaviour::of(method, 1.0).row(method.name());
        Behaviour::head("method") + &self.methods.iter().map(row).collect::<String>()
    }

    /// The same with this plugin in worlds of other length units.
    fn units(&self) -> String {
        let row = |unit: f32| Behaviour::of(&self.methods[0], unit).row(&unit.to_string());
        Behaviour::head("length unit") + &[0.01, 1.0, 10.0, 100.0].map(row).concat()
    }

    /// How many of 40 bullets of radius 0.02 go through a surface that comes towards them.
    fn bullets(&self) -> Table {
        const COLUMNS: [(f32, f32); 5] = [(5.0, 5.0), (20.0, 1.0), (20.0, 5.0), (100.0, 1.0), (100.0, 5.0)];
        let columns = COLUMNS.map(|(speed, rise)| format!("{speed}/s, rising at {rise}/s"));
        let mut table = Table::new(["method", "CCD"].map(str::to_owned).into_iter().chain(columns));
        for method in self.shot_at {
            for ccd in [false, true] {
                let through = COLUMNS.map(|(speed, rise)| {
                    let shots = Shots {
                        speed,
                        rise,
                        ccd,
                        ..Shots::SMALL
                    };
                    shots.fire(method, 40).through.to_string()
                });
                let names = [method.name(), if ccd { "on" } else { "off" }].map(str::to_owned);
                table.row(names.into_iter().chain(through));
            }
        }
        table
    }
}
