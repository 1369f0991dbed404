//! Touching triangles, drawn over the models from the vertices that the collision code blended.
//!
//! The rest of a mesh is never blended on the CPU. If both blend alike, the overlay lies on what the GPU draws.

use std::collections::BTreeSet;

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::NoFrustumCulling;
use bevy::light::NotShadowCaster;
use bevy::mesh::PrimitiveTopology;
use bevy::picking::Pickable;
use bevy::prelude::*;
use bevy_morph_collision::contacts::MorphContact;
use bevy_morph_collision::prelude::*;

use super::clock;

/// How the overlay is drawn.
#[derive(Resource, Clone, Copy, Debug)]
pub struct Overlay {
    /// Whether it is drawn.
    pub shown: bool,
    /// World-space offset. Zero except in tests.
    pub offset: Vec3,
    /// Number of its triangles.
    pub triangles: usize,
}

impl Default for Overlay {
    fn default() -> Self {
        Self {
            shown: true,
            offset: Vec3::ZERO,
            triangles: 0,
        }
    }
}

/// Other triangles of a collider to draw, along with those in [`MorphCollisions`] and [`MorphSelfCollisions`].
#[derive(Component, Clone, Debug, Default)]
pub struct SelfTouching(pub Vec<TrianglePair>);

/// Marks the overlay's entity.
#[derive(Component, Clone, Copy, Debug)]
pub struct OverlayMesh;

/// The systems that make the overlay, in [`PostUpdate`].
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct OverlaySystems;

/// Moves the overlay nearer by this many steps of the depth buffer, so that it wins over the surface in the same place.
const DEPTH_BIAS: f32 = 256.0;

pub(super) fn plugin(app: &mut App) {
    app.init_resource::<Overlay>()
        .configure_sets(
            PostUpdate,
            OverlaySystems
                .after(MorphCollisionSystems::Anchors)
                .before(bevy::camera::visibility::VisibilitySystems::VisibilityPropagate),
        )
        .add_systems(Startup, spawn)
        .add_systems(PostUpdate, draw.in_set(OverlaySystems))
        .add_systems(Update, show_by_key.run_if(not(clock::is_typing)));
}

fn show_by_key(keys: Res<ButtonInput<KeyCode>>, mut overlay: ResMut<Overlay>) {
    if keys.just_pressed(KeyCode::KeyT) {
        overlay.shown = !overlay.shown;
    }
}

fn spawn(mut commands: Commands, mut meshes: ResMut<Assets<Mesh>>, mut materials: ResMut<Assets<StandardMaterial>>) {
    let red = materials.add(StandardMaterial {
        base_color: Color::srgb(0.9, 0.05, 0.05),
        unlit: true,
        double_sided: true,
        cull_mode: None,
        depth_bias: DEPTH_BIAS,
        ..default()
    });
    commands.spawn((
        OverlayMesh,
        Mesh3d(meshes.add(triangles(Vec::new()))),
        MeshMaterial3d(red),
        Visibility::Hidden,
        NoFrustumCulling,
        NotShadowCaster,
        Pickable::IGNORE,
    ));
}

fn draw(
    mut overlay: ResMut<Overlay>,
    collisions: Res<MorphCollisions>,
    itself: Query<(Entity, &MorphSelfCollisions)>,
    shown: Query<(Entity, &SelfTouching)>,
    mut access: ParamSet<(
        MorphSpatialQuery,
        (
            ResMut<Assets<Mesh>>,
            Single<(&mut Mesh3d, &mut Visibility), With<OverlayMesh>>,
        ),
    )>,
    mut events: MessageWriter<AssetEvent<Mesh>>,
) {
    let mut touching = BTreeSet::new();
    if overlay.shown {
        for contact in collisions.iter() {
            for pair in &contact.triangles {
                touching.insert((contact.collider1, pair.triangle_a));
                touching.insert((contact.collider2, pair.triangle_b));
            }
        }
        let regions = itself
            .iter()
            .flat_map(|(entity, found)| found.regions().iter().map(move |region| (entity, &region.triangles)));
        for (entity, pairs) in regions.chain(shown.iter().map(|(entity, SelfTouching(pairs))| (entity, pairs))) {
            touching.extend(
                pairs
                    .iter()
                    .flat_map(|pair| [(entity, pair.triangle_a), (entity, pair.triangle_b)]),
            );
        }
    }
    let spatial = access.p0();
    let mut corners = Vec::with_capacity(3 * touching.len());
    for (collider, triangle) in touching {
        if triangle != MorphContact::NO_TRIANGLE
            && let Some(triangle) = spatial.posed_triangle(collider, triangle)
        {
            corners.extend(triangle.map(|corner| corner + overlay.offset));
        }
    }

    overlay.triangles = corners.len() / 3;
    let (mut meshes, mut drawn) = access.p1();
    let (mesh, visibility) = &mut *drawn;
    let wanted = if corners.is_empty() {
        Visibility::Hidden
    } else {
        Visibility::Visible
    };
    visibility.set_if_neq(wanted);
    if wanted == Visibility::Visible
        && let Some(mut asset) = meshes.get_mut(&mesh.0)
    {
        *asset = triangles(corners);
        mesh.set_changed();
        // Bevy has already checked for changes in this frame, and would draw the overlay one frame late.
        events.write(AssetEvent::Modified { id: mesh.id() });
    }
}

/// A mesh of triangles with three corners each. If there are none, it has one triangle without area.
fn triangles(mut corners: Vec<Vec3>) -> Mesh {
    if corners.is_empty() {
        corners = vec![Vec3::ZERO; 3];
    }
    let normals = vec![Vec3::Y; corners.len()];
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::default())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, corners)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
}
