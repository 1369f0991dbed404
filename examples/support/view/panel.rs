//! The panel: description, time, what to draw, weights by hand, counts of skipped work, and keys.

use bevy::gizmos::config::GizmoConfigStore;
use bevy::prelude::*;
use bevy_egui::egui::{FontData, FontDefinitions, FontFamily};
use bevy_egui::input::EguiWantsInput;
use bevy_egui::{EguiContext, EguiContexts, EguiPlugin, EguiPrimaryContextPass, PrimaryEguiContext, egui};
use bevy_morph_collision::prelude::*;

use super::clock::{self, Clock, PauseKey, Typing};
use super::counts;
use super::overlay::Overlay;
use super::sliders::Sliders;
use super::stage::{Notes, Playbill, StageCamera};
use super::volumes::{self, DEEPEST};

/// Keys that all shows share.
const KEYS: &[(&str, &str)] = &[
    ("right drag", "orbit"),
    ("middle drag", "pan"),
    ("wheel", "zoom"),
    ("fingers", "one orbits, two pan and zoom"),
    (".", "one frame, when paused"),
    ("- =", "slower, faster"),
    ("T", "touching triangles"),
    ("V, Shift V", "volumes one level deeper, higher"),
    #[cfg(feature = "render_ui")]
    ("F3", "diagnostics"),
];

/// The largest width of a value, in points.
const LONGEST: f32 = 200.0;

pub(super) fn plugin(app: &mut App) {
    app.add_plugins(EguiPlugin::default())
        .add_observer(set_fonts)
        .add_observer(|camera: On<Add<StageCamera>>, mut commands: Commands| {
            commands.entity(camera.entity).insert(PrimaryEguiContext);
        })
        .add_systems(First, |wants: Res<EguiWantsInput>, mut typing: ResMut<Typing>| {
            typing.0 = wants.wants_keyboard_input();
        })
        .add_systems(EguiPrimaryContextPass, panel);
}

/// Uses one font for everything: egui is built without any.
fn set_fonts(added: On<Add<EguiContext>>, mut contexts: Query<&mut EguiContext>) {
    let name = "Ubuntu-Light";
    let mut fonts = FontDefinitions::empty();
    let data = FontData::from_static(epaint_default_fonts::UBUNTU_LIGHT);
    fonts.font_data.insert(name.to_owned(), data.into());
    for family in [FontFamily::Proportional, FontFamily::Monospace] {
        fonts.families.insert(family, vec![name.to_owned()]);
    }
    if let Ok(mut context) = contexts.get_mut(added.entity) {
        context.get_mut().set_fonts(fonts);
    }
}

fn panel(
    mut contexts: EguiContexts,
    bill: Res<Playbill>,
    notes: Res<Notes>,
    diagnostics: Res<MorphCollisionDiagnostics>,
    mut clock: ResMut<Clock>,
    mut time: ResMut<Time<Virtual>>,
    mut overlay: ResMut<Overlay>,
    mut sliders: ResMut<Sliders>,
    mut store: ResMut<GizmoConfigStore>,
    (real, pause): (Res<Time<Real>>, Res<PauseKey>),
) -> Result {
    let context = contexts.ctx_mut()?;
    context.set_visuals(egui::Visuals::light());
    // The window's height without title and frame.
    let room = context.content_rect().height() - 64.0;
    egui::Window::new(bill.name)
        .anchor(egui::Align2::LEFT_TOP, [8.0, 8.0])
        .default_size([230.0, room])
        .resizable(false)
        .show(context, |ui| {
            egui::ScrollArea::vertical().max_height(room).show(ui, |ui| {
                ui.label(bill.about);
                if !clock.started {
                    ui.horizontal(|ui| {
                        ui.spinner();
                        ui.label("loading");
                    });
                    return;
                }
                ui.separator();
                time_row(ui, &bill, &mut clock, &mut time);
                ui.checkbox(&mut overlay.shown, "touching triangles in red");
                volumes_row(ui, &mut store);
                if !sliders.weights.is_empty() {
                    weights(ui, &mut sliders);
                }
                ui.separator();
                rows(ui, "notes", notes.0.iter().map(|(name, value)| (*name, value.clone())));
                rows(ui, "counts", counts::work(&diagnostics));
                // In pictures, nothing that depends on the machine.
                if bill.live {
                    rows(ui, "times", counts::times(&diagnostics, &real));
                }
                egui::CollapsingHeader::new("keys")
                    .default_open(bill.live)
                    .show(ui, |ui| {
                        let pause = (pause.1, "pause");
                        let own = bill.keys.iter().chain([&pause]).chain(KEYS);
                        rows(ui, "keys", own.map(|&(key, what)| (key, what.to_owned())));
                    });
            });
        });
    Ok(())
}

fn time_row(ui: &mut egui::Ui, bill: &Playbill, clock: &mut Clock, time: &mut Time<Virtual>) {
    ui.horizontal(|ui| {
        if bill.live {
            if ui.button(if time.is_paused() { "play" } else { "pause" }).clicked() {
                clock::pause(time);
            }
            if ui.button("step").clicked() {
                time.pause();
                clock.step = true;
            }
        }
        ui.label(format!("frame {:.0}", clock.frame));
    });
    if bill.live {
        let mut speed = time.relative_speed();
        let slider = egui::Slider::new(&mut speed, 0.0625..=4.0)
            .logarithmic(true)
            .text("speed");
        if ui.add(slider).changed() {
            time.set_relative_speed(speed);
        }
    }
}

fn volumes_row(ui: &mut egui::Ui, store: &mut GizmoConfigStore) {
    let mut level = volumes::level(store).map_or(-1, |depth| depth as i32);
    let slider = egui::Slider::new(&mut level, -1..=DEEPEST as i32).text("volumes");
    let shown = slider.custom_formatter(|level, _| {
        if level < 0.0 {
            "none".into()
        } else {
            format!("level {level}")
        }
    });
    if ui.add(shown).changed() {
        volumes::set(store, usize::try_from(level).ok());
    }
}

fn weights(ui: &mut egui::Ui, sliders: &mut Sliders) {
    egui::CollapsingHeader::new("weights").show(ui, |ui| {
        ui.checkbox(&mut sliders.in_hand, "by hand, for all models");
        egui::ScrollArea::vertical().max_height(200.0).show(ui, |ui| {
            ui.add_enabled_ui(sliders.in_hand, |ui| {
                for (name, weight) in &mut sliders.weights {
                    ui.add(egui::Slider::new(weight, -0.5..=1.5).text(name.as_str()));
                }
            });
        });
    });
}

fn rows(ui: &mut egui::Ui, name: &str, rows: impl IntoIterator<Item = (&'static str, String)>) {
    // Long values wrap instead of hiding the show.
    let grid = egui::Grid::new(name).num_columns(2).max_col_width(LONGEST);
    grid.show(ui, |ui| {
        for (name, value) in rows {
            ui.label(name);
            let long = value.chars().count() > 32;
            let label = egui::Label::new(value);
            ui.add(if long { label.wrap() } else { label.extend() });
            ui.end_row();
        }
    });
}
