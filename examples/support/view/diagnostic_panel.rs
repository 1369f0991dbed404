//! The plugin's own panel of diagnostics, which a key shows and hides.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::clock;
use super::stage::StageCamera;

pub(super) fn plugin(app: &mut App) {
    app.add_plugins(MorphDiagnosticsUiPlugin)
        .insert_resource(MorphDiagnosticsUiSettings {
            enabled: false,
            ..default()
        })
        .add_observer(|camera: On<Add<StageCamera>>, mut commands: Commands| {
            // It may draw into a picture.
            commands.entity(camera.entity).insert(IsDefaultUiCamera);
        })
        .add_systems(Update, show_by_key.run_if(not(clock::is_typing)));
}

fn show_by_key(keys: Res<ButtonInput<KeyCode>>, mut panel: ResMut<MorphDiagnosticsUiSettings>) {
    if keys.just_pressed(KeyCode::F3) {
        panel.enabled = !panel.enabled;
    }
}
