//! The joint matrices of skeletons, computed as Bevy computes them for drawing, and shared by the meshes of a skeleton.

use bevy::asset::AssetId;
use bevy::ecs::change_detection::Tick;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::{SystemChangeTick, SystemParam};
use bevy::math::{Affine3A, Mat3A, Vec3A};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use morph_collision::{InputError, JointMatrices};

use crate::app::{Column, is_long_ago};

/// Inverse bind poses of all skeletons.
pub(crate) type BindPoses = Assets<SkinnedMeshInverseBindposes>;

/// The skins of all meshes.
pub(crate) type AllSkins<'w, 's> = Query<'w, 's, &'static SkinnedMesh, Allow<Disabled>>;

/// The skeletons in use, shared by all systems: the first one that reads a skeleton in a frame computes it for the others. Meshes with the
/// same joints and the same inverse bind poses share a skeleton.
#[derive(Resource, Default)]
#[allow(missing_debug_implementations)]
pub struct Skeletons {
    /// Keyed by bind poses and first joint, which nearly always identifies a skeleton.
    pub(super) by_start: HashMap<(PosesId, Option<Entity>), Vec<Skeleton>>,
    /// Shared by all skeletons with the same bind poses.
    bind_poses: HashMap<PosesId, KnownPoses>,
    /// How often a system has looked for changes.
    looks: u64,
    /// Increases when joints may have moved.
    moment: u32,
    /// When transforms were last looked at, and how many there were.
    seen: Option<(Tick, usize)>,
    /// How many skeletons there are, and how many the last clean-up left.
    pub(super) count: usize,
    kept: usize,
}

pub(super) type PosesId = AssetId<SkinnedMeshInverseBindposes>;

/// Inverse bind poses, as they were last found.
#[derive(Default)]
struct KnownPoses {
    matrices: Vec<Mat4>,
    /// Another number after each change.
    version: u64,
    /// The look in which they were last compared.
    look: Option<u64>,
}

impl KnownPoses {
    /// Compares them with the current ones, once per look: assets do not say which of them changed before the end of the frame.
    fn look(&mut self, look: u64, current: &[Mat4]) {
        if self.look.replace(look) != Some(look) && self.matrices != current {
            current.clone_into(&mut self.matrices);
            self.version += 1;
        }
    }
}

/// One skeleton.
#[derive(Default)]
#[allow(missing_debug_implementations)]
pub struct Skeleton {
    pub(super) joints: Vec<Entity>,
    /// The version of the inverse bind poses of the last update.
    poses_version: u64,
    /// The last computed matrices, valid or not.
    pub(super) world_from_mesh: Vec<Affine3A>,
    /// The last valid matrices.
    pub(super) matrices: Option<JointMatrices>,
    /// Why the current matrices are invalid, with the index of the joint.
    pub(super) problem: Option<(usize, InputError)>,
    /// Whether the problem has been reported.
    pub(crate) is_reported: bool,
    /// When the skeleton was last updated.
    moment: Option<u32>,
    is_used: bool,
}

impl Skeleton {
    /// The matrices of the joints. While some are invalid, the last valid ones; `None` if they were never valid.
    pub(crate) fn matrices(&self) -> Option<&JointMatrices> {
        self.matrices.as_ref()
    }

    /// The current matrices; `None` while some are invalid.
    #[must_use]
    pub fn current_matrices(&self) -> Option<&JointMatrices> {
        self.matrices.as_ref().filter(|_| self.problem.is_none())
    }

    /// A joint whose current matrix is invalid, and why.
    pub(crate) fn problem(&self) -> Option<(Entity, &InputError)> {
        let (joint, error) = self.problem.as_ref()?;
        Some((*self.joints.get(*joint)?, error))
    }

    /// Updates the matrices from the current transforms of the joints. While these stay the same, the matrices stay the same object.
    fn update(&mut self, bind_poses: &[Mat4], global_of: impl Fn(Entity) -> Option<Affine3A>) {
        let is_known = self.matrices.is_some() || self.problem.is_some();
        self.world_from_mesh.resize(self.joints.len(), Affine3A::IDENTITY);
        let mut changed = !is_known;
        for (i, (&joint, known)) in self.joints.iter().zip(&mut self.world_from_mesh).enumerate() {
            let matrix = bind_poses.get(i).zip(global_of(joint)).map(|(bind_pose, global)| {
                // The last row of a bind pose does not affect where vertices are drawn.
                let columns = (global * *bind_pose).to_cols_array_2d();
                let [x, y, z, t] = columns.map(|[x, y, z, _]| Vec3A::new(x, y, z));
                Affine3A {
                    matrix3: Mat3A::from_cols(x, y, z),
                    translation: t,
                }
            });
            // In Bevy's buffers, a despawned joint keeps its matrix.
            if let Some(matrix) = matrix
                && matrix != *known
            {
                *known = matrix;
                changed = true;
            }
        }
        if changed {
            self.check();
        }
    }

    /// Takes over the last computed matrices if they are valid.
    pub(super) fn check(&mut self) {
        match JointMatrices::new(&self.world_from_mesh) {
            Ok(matrices) => {
                self.matrices = Some(matrices);
                self.problem = None;
                self.is_reported = false;
            }
            Err(error) => {
                let is_bad = |matrix| JointMatrices::new(std::slice::from_ref(matrix)).is_err();
                let joint = self.world_from_mesh.iter().position(is_bad);
                self.problem = Some((joint.unwrap_or_default(), error));
            }
        }
    }
}

impl Skeletons {
    /// Looks whether any entity has moved since the last call. Then every skeleton is updated on its next request.
    pub(crate) fn notice(&mut self, globals: &Query<Ref<GlobalTransform>>, skins: &AllSkins, this_run: Tick) {
        self.drop_unused(skins);
        self.looks += 1;
        let mut count = 0;
        // Also true if the last call was so long ago that nobody knows.
        let mut any_moved = self.seen.is_none_or(|(seen, _)| is_long_ago(seen, this_run));
        match (globals.contiguous_iter(), self.seen) {
            (Ok(columns), Some((last_seen, _))) => {
                for column in columns.map(|column| Column::changed_since(&column, last_seen)) {
                    count += column.len();
                    any_moved = any_moved || column.any_new();
                }
            }
            _ => any_moved = true,
        }
        // Entities may have been disabled until now.
        if any_moved || self.seen.is_none_or(|(_, before)| before != count) {
            self.outdate();
        }
        self.seen = Some((this_run, count));
    }

    /// Updates every skeleton again on its next request, because the system that asks has moved joints itself.
    pub(crate) fn outdate(&mut self) {
        self.moment = self.moment.wrapping_add(1);
    }

    /// The skeleton of a mesh. `global_of` returns the global transform of an entity that exists.
    ///
    /// Computes one matrix per joint if any entity has moved since the last request.
    pub(crate) fn of(
        &mut self,
        skin: &SkinnedMesh,
        bind_poses: Option<&BindPoses>,
        global_of: impl Fn(Entity) -> Option<Affine3A>,
    ) -> &mut Skeleton {
        let id = skin.inverse_bindposes.id();
        let start = (id, skin.joints.first().copied());
        let skeletons = self.by_start.entry(start).or_default();
        let known = skeletons.iter().position(|skeleton| skeleton.joints == skin.joints);
        let place = known.unwrap_or_else(|| {
            self.count += 1;
            skeletons.push(Skeleton {
                joints: skin.joints.clone(),
                ..default()
            });
            skeletons.len() - 1
        });
        let skeleton = &mut skeletons[place];
        let current = bind_poses.and_then(|assets| assets.get(id));
        let known = self.bind_poses.entry(id).or_default();
        known.look(self.looks, current.map_or(&[], |poses| poses));
        let is_old = skeleton.moment.replace(self.moment) != Some(self.moment);
        if std::mem::replace(&mut skeleton.poses_version, known.version) != known.version || is_old {
            skeleton.update(&known.matrices, global_of);
        }
        skeleton
    }

    /// Drops the skeletons of which no mesh is left, if there are twice as many as after the last time.
    fn drop_unused(&mut self, skins: &AllSkins) {
        if self.count <= 2 * self.kept + FEW {
            return;
        }
        for skin in skins {
            let start = (skin.inverse_bindposes.id(), skin.joints.first().copied());
            for skeleton in self.by_start.get_mut(&start).into_iter().flatten() {
                skeleton.is_used |= skeleton.joints == skin.joints;
            }
        }
        self.by_start.retain(|_, skeletons| {
            skeletons.retain_mut(|skeleton| std::mem::take(&mut skeleton.is_used));
            !skeletons.is_empty()
        });
        let used: HashSet<PosesId> = self.by_start.keys().map(|&(id, _)| id).collect();
        self.bind_poses.retain(|id, _| used.contains(id));
        self.count = self.by_start.values().map(Vec::len).sum();
        self.kept = self.count;
    }
}

/// So many skeletons more are kept than are used.
const FEW: usize = 8;

/// Skeletons as a system finds them.
#[derive(SystemParam)]
#[allow(missing_debug_implementations)]
pub struct CurrentSkeletons<'w, 's> {
    globals: Query<'w, 's, Ref<'static, GlobalTransform>>,
    skins: AllSkins<'w, 's>,
    bind_poses: Option<Res<'w, BindPoses>>,
    skeletons: ResMut<'w, Skeletons>,
    ticks: SystemChangeTick,
}

impl CurrentSkeletons<'_, '_> {
    /// Looks whether any entity has moved. A system calls it once, before it asks for skeletons.
    ///
    /// Cost: one comparison for each entity with a transform.
    pub fn notice(&mut self) {
        let now = self.ticks.this_run();
        self.skeletons.notice(&self.globals, &self.skins, now);
    }

    /// The skeleton of a mesh. Computes one matrix per joint unless a system has asked for it since any entity moved.
    pub fn of(&mut self, skin: &SkinnedMesh) -> &mut Skeleton {
        let Self {
            globals,
            bind_poses,
            skeletons,
            ..
        } = self;
        let global_of = |joint: Entity| Some(globals.get(joint).ok()?.affine());
        skeletons.of(skin, bind_poses.as_deref(), global_of)
    }
}

#[cfg(test)]
mod tests {
    use bevy::ecs::system::SystemId;

    use super::*;

    /// A world with one skin of one joint, and two systems that read it.
    struct Stage {
        world: World,
        skin: SkinnedMesh,
        readers: [SystemId<(), Option<Affine3A>>; 2],
    }

    fn read(mut skeletons: CurrentSkeletons, skins: Query<&SkinnedMesh>) -> Option<Affine3A> {
        skeletons.notice();
        let mut last = None;
        for skin in &skins {
            last = skeletons
                .of(skin)
                .current_matrices()
                .and_then(|matrices| matrices.iter().next());
        }
        last
    }

    impl Stage {
        fn new() -> Self {
            let mut world = World::new();
            world.init_resource::<Skeletons>();
            let mut poses = BindPoses::default();
            let inverse_bindposes = poses.add(vec![Mat4::IDENTITY]);
            world.insert_resource(poses);
            let joints = vec![world.spawn(GlobalTransform::IDENTITY).id()];
            let skin = SkinnedMesh {
                inverse_bindposes,
                joints,
            };
            world.spawn(skin.clone());
            let readers = [(); 2].map(|()| world.register_system(read));
            Self { world, skin, readers }
        }

        /// What both systems read, which is the same.
        fn read(&mut self) -> Vec3 {
            let [first, second] = self.readers.map(|reader| self.world.run_system(reader).unwrap());
            assert_eq!(first, second);
            first.expect("the joint is valid").translation.into()
        }

        fn moment(&self) -> u32 {
            self.world.resource::<Skeletons>().moment
        }
    }

    #[test]
    fn only_the_first_system_of_a_moment_computes_skeletons() {
        let mut stage = Stage::new();
        assert_eq!(stage.read(), Vec3::ZERO);
        let before = stage.moment();
        assert_eq!(stage.read(), Vec3::ZERO);
        assert_eq!(stage.moment(), before);
        stage
            .world
            .entity_mut(stage.skin.joints[0])
            .insert(GlobalTransform::from_xyz(1.0, 2.0, 3.0));
        assert_eq!(stage.read(), Vec3::new(1.0, 2.0, 3.0));
        assert_eq!(stage.moment(), before + 1);
    }

    #[test]
    fn a_joint_that_is_enabled_and_other_bind_poses_are_noticed() {
        let mut stage = Stage::new();
        let joint = stage.skin.joints[0];
        stage.world.entity_mut(joint).insert(Disabled);
        stage.read();
        *stage.world.get_mut::<GlobalTransform>(joint).unwrap() = GlobalTransform::from_xyz(5.0, 0.0, 0.0);
        assert_eq!(stage.read(), Vec3::ZERO, "a disabled joint keeps its matrix");
        stage.world.entity_mut(joint).remove::<Disabled>();
        assert_eq!(stage.read().x, 5.0);
        let id = stage.skin.inverse_bindposes.id();
        let mut poses = stage.world.resource_mut::<BindPoses>();
        let lifted = vec![Mat4::from_translation(Vec3::Y)];
        poses.insert(id, lifted.into()).unwrap();
        assert_eq!(stage.read(), Vec3::new(5.0, 1.0, 0.0));
    }

    #[test]
    fn skeletons_of_meshes_that_are_gone_are_dropped() {
        let mut stage = Stage::new();
        for _ in 0..3 * FEW {
            let joints = vec![stage.world.spawn(GlobalTransform::IDENTITY).id()];
            let skin = SkinnedMesh {
                joints,
                ..stage.skin.clone()
            };
            let mesh = stage.world.spawn(skin).id();
            stage.read();
            stage.world.despawn(mesh);
        }
        stage.read();
        let count = stage.world.resource::<Skeletons>().count;
        assert!(count <= FEW + 3, "{count}");
        assert_eq!(stage.read(), Vec3::ZERO);
    }
}
