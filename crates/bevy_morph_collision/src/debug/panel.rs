//! A panel that shows what the plugin does.

use std::time::Duration;

use bevy::prelude::*;
use bevy::text::FontSize;

use super::panel_rows::Section;
use crate::app::{Names, missing};
use crate::state::{MorphCollisionDiagnostics, MorphPairCosts};

/// Shows what the last run did in a small panel: counts, the time of each stage, and the pairs that took the most work.
///
/// [`MorphDiagnosticsUiSettings`] says what is shown, and can be changed at any time. While the panel is off, it has no entity, and the work of
/// pairs is not counted.
///
/// It needs [`MorphCollisionPlugin`](crate::plugins::MorphCollisionPlugin), and it is not part of
/// [`MorphPlugins`](crate::plugins::MorphPlugins). Drawing it takes Bevy's features `bevy_ui_render` and `default_font`, which are on by default.
///
/// ```no_run
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// fn toggle(keys: Res<ButtonInput<KeyCode>>, mut panel: ResMut<MorphDiagnosticsUiSettings>) {
///     if keys.just_pressed(KeyCode::F3) {
///         panel.enabled = !panel.enabled;
///     }
/// }
/// # let mut app = App::new();
/// app.add_plugins((DefaultPlugins, MorphPlugins, MorphDiagnosticsUiPlugin)).add_systems(Update, toggle);
/// ```
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphDiagnosticsUiPlugin;

/// What [`MorphDiagnosticsUiPlugin`] shows.
#[derive(Resource, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphDiagnosticsUiSettings {
    /// Whether there is a panel. On by default.
    pub enabled: bool,
    /// Whether it shows counts. On by default.
    pub counts: bool,
    /// Whether it shows times. On by default.
    pub times: bool,
    /// How many of the costliest pairs it shows; 5 by default. The plugin sets [`MorphPairCosts::limit`] to it, or to 0 without a panel, when
    /// these settings change.
    pub pairs: usize,
}

impl Default for MorphDiagnosticsUiSettings {
    fn default() -> Self {
        Self {
            enabled: true,
            counts: true,
            times: true,
            pairs: 5,
        }
    }
}

/// The panel of [`MorphDiagnosticsUiPlugin`]. Change its `Node` to put it elsewhere; by default it is in the upper right corner.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphDiagnosticsUi;

/// A text with the names or the values of a section.
#[derive(Component, Clone, Copy)]
struct Column(Section, usize);

/// The text is replaced this often, so that it can be read.
const PERIOD: Duration = Duration::from_millis(250);

impl Plugin for MorphDiagnosticsUiPlugin {
    fn build(&self, app: &mut App) {
        let run_exists = resource_exists::<MorphCollisionDiagnostics>;
        app.init_resource::<MorphDiagnosticsUiSettings>()
            .register_type::<MorphDiagnosticsUiSettings>()
            .register_type::<MorphDiagnosticsUi>()
            .add_systems(
                Last,
                (
                    rebuild.run_if(resource_changed::<MorphDiagnosticsUiSettings>),
                    update.run_if(any_with_component::<MorphDiagnosticsUi>),
                )
                    .chain()
                    .run_if(run_exists),
            );
    }

    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<MorphCollisionDiagnostics>() {
            missing(
                app,
                "MorphDiagnosticsUiPlugin shows nothing without MorphCollisionPlugin: add it to the app",
            );
        }
    }
}

/// Replaces the panel by one for the current settings.
fn rebuild(
    settings: Res<MorphDiagnosticsUiSettings>,
    mut costs: ResMut<MorphPairCosts>,
    panels: Query<Entity, With<MorphDiagnosticsUi>>,
    mut commands: Commands,
) {
    costs.limit = if settings.enabled { settings.pairs } else { 0 };
    for panel in &panels {
        commands.entity(panel).despawn();
    }
    if !settings.enabled {
        return;
    }
    let sections = [
        (Section::Counts, settings.counts),
        (Section::Times, settings.times),
        (Section::Pairs, settings.pairs > 0),
    ];
    let panel = Node {
        position_type: PositionType::Absolute,
        top: px(8),
        right: px(8),
        padding: UiRect::all(px(8)),
        flex_direction: FlexDirection::Column,
        row_gap: px(8),
        ..default()
    };
    let background = BackgroundColor(Color::BLACK.with_alpha(0.75));
    commands
        .spawn((
            MorphDiagnosticsUi,
            panel,
            background,
            GlobalZIndex(i32::MAX),
            unpickable(),
        ))
        .with_children(|panel| {
            for (section, _) in sections.into_iter().filter(|(_, shown)| *shown) {
                let row = Node {
                    justify_content: JustifyContent::SpaceBetween,
                    column_gap: px(16),
                    ..default()
                };
                panel.spawn((row, unpickable())).with_children(|row| {
                    for column in [0, 1] {
                        let justify = if column == 0 { Justify::Left } else { Justify::Right };
                        let font = TextFont {
                            font_size: FontSize::Px(12.0),
                            ..default()
                        };
                        row.spawn((
                            Column(section, column),
                            Text::default(),
                            font,
                            TextColor(Color::WHITE),
                            TextLayout::justify(justify),
                            unpickable(),
                        ));
                    }
                });
            }
        });
}

/// Pointers go through the panel.
#[cfg(feature = "picking")]
fn unpickable() -> impl Bundle {
    Pickable::IGNORE
}

#[cfg(not(feature = "picking"))]
fn unpickable() -> impl Bundle {}

/// Writes the texts of a new panel, and from then on a few times per second.
fn update(
    diagnostics: Res<MorphCollisionDiagnostics>,
    costs: Res<MorphPairCosts>,
    names: Names,
    time: Option<Res<Time<Real>>>,
    mut texts: Query<(Ref<Column>, &mut Text)>,
    mut age: Local<Duration>,
) {
    *age += time.map_or(PERIOD, |time| time.delta());
    let is_due = *age >= PERIOD || texts.iter().any(|(column, _)| column.is_added());
    if !is_due {
        return;
    }
    *age = Duration::ZERO;
    for (column, mut text) in &mut texts {
        let Column(section, number) = *column;
        let [names, values] = section.columns(&diagnostics, &costs, &names);
        text.set_if_neq(Text(if number == 0 { names } else { values }));
    }
}
