//! Joints: their rest transforms, how clips move them, and the matrices that move a mesh with them.
//!
//! ```text
//! nodes at rest + clip at a time -> local transforms -> global transforms (f32) -> times inverse bind matrices
//! ```
//!
//! The arithmetic is that of Bevy: `f32`, a parent's affine map times the child's, and `Mat4` products with the inverse bind
//! matrices. Only
//! rotations between keys are rounded otherwise, so that they have the same bits on every machine.

mod clip;
mod transform;

use glam::{Affine3A, Mat4};

pub(crate) use self::clip::normalized;
pub use self::clip::{Interpolation, JointChannel, JointClip, Property};
pub use self::transform::LocalTransform;

/// The joints of a skin and all their ancestors.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// The joints and all their ancestors, parents before children.
    pub nodes: Vec<SkeletonNode>,
    /// The joints, in the order of the influences' joint indices.
    pub joints: Vec<Joint>,
    /// Clips that move nodes.
    pub clips: Vec<JointClip>,
    /// Animations of the file that were to move nodes and cannot be played.
    pub broken: Vec<BrokenClip>,
}

/// An animation of a file that cannot be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BrokenClip {
    /// Its index in the file.
    pub animation: usize,
    /// Why; names the file, the animation and the channel.
    pub reason: String,
}

/// A node of a skeleton: a joint, or an ancestor of one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkeletonNode {
    /// Its name.
    pub name: String,
    /// The index of its parent, which comes earlier in the list; `None` for a root.
    pub parent: Option<u32>,
    /// Its transform relative to its parent while no clip moves it.
    pub rest: LocalTransform,
}

/// A joint of a skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Its index among [`Skeleton::nodes`].
    pub node: u32,
    /// Maps the mesh's space to the joint's, in the bind pose.
    pub inverse_bind: Mat4,
}

impl Skeleton {
    /// The clip with this name.
    #[must_use]
    pub fn clip(&self, name: &str) -> Option<&JointClip> {
        self.clips.iter().find(|clip| clip.name == name)
    }

    /// The matrix of every joint at rest: its global transform times its inverse bind matrix.
    #[must_use]
    pub fn at_rest(&self) -> Vec<Affine3A> {
        self.world_from_mesh(None, 0.0)
    }

    /// The matrix of every joint at a time of a clip, in seconds: its global transform times its inverse bind matrix.
    ///
    /// Nodes that the clip does not move are at rest. Before the first key its pose holds, and after the last key that of the last; to play the
    /// clip in a loop, pass [`looped`](crate::clip::looped) times.
    ///
    /// # Panics
    /// If a node's parent does not come before it, or a joint names a node that does not exist.
    #[must_use]
    pub fn world_from_mesh(&self, clip: Option<&JointClip>, seconds: f32) -> Vec<Affine3A> {
        let mut locals: Vec<LocalTransform> = self.nodes.iter().map(|node| node.rest).collect();
        if let Some(clip) = clip {
            clip.apply(seconds, &mut locals);
        }
        let mut globals: Vec<Affine3A> = Vec::with_capacity(self.nodes.len());
        for (node, local) in self.nodes.iter().zip(&locals) {
            globals.push(match node.parent {
                Some(parent) => globals[parent as usize] * local.affine(),
                None => local.affine(),
            });
        }
        let matrix = |joint: &Joint| Mat4::from(globals[joint.node as usize]) * joint.inverse_bind;
        self.joints
            .iter()
            .map(|joint| Affine3A::from_mat4(matrix(joint)))
            .collect()
    }

    /// A skeleton of joints without a hierarchy, all at the origin.
    #[must_use]
    pub fn separate(joint_count: usize) -> Self {
        let node = |joint: usize| SkeletonNode {
            name: format!("joint_{joint}"),
            ..SkeletonNode::default()
        };
        let joint = |node: u32| Joint {
            node,
            inverse_bind: Mat4::IDENTITY,
        };
        Self {
            nodes: (0..joint_count).map(node).collect(),
            joints: (0..joint_count as u32).map(joint).collect(),
            ..Self::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3, Vec3A, Vec4};

    use super::*;

    /// A node above the joints that rotates and doubles the size, a shoulder and an elbow, bound in the rest pose.
    fn arm() -> Skeleton {
        let node = |name: &str, parent, translation| SkeletonNode {
            name: name.into(),
            parent,
            rest: LocalTransform {
                translation,
                ..LocalTransform::default()
            },
        };
        let mut skeleton = Skeleton {
            nodes: vec![
                node("armature", None, Vec3::Z),
                node("shoulder", Some(0), Vec3::X),
                node("elbow", Some(1), Vec3::X * 2.0),
            ],
            ..Skeleton::default()
        };
        skeleton.nodes[0].rest.scale = Vec3::splat(2.0);
        skeleton.nodes[0].rest.rotation = Quat::from_xyzw(0.0, 0.0, 1.0, 0.0);
        // The elbow is joint 0.
        skeleton.joints = [2, 1]
            .map(|node| Joint {
                node,
                inverse_bind: Mat4::IDENTITY,
            })
            .to_vec();
        skeleton
    }

    #[test]
    fn transforms_of_all_ancestors_come_before_a_joint_s_own() {
        let skeleton = arm();
        let [elbow, shoulder] = <[Affine3A; 2]>::try_from(skeleton.at_rest()).expect("two joints");
        // Half a turn about z, doubled, lifted by 1.
        assert_eq!(shoulder.transform_point3a(Vec3A::ZERO), Vec3A::new(-2.0, 0.0, 1.0));
        assert_eq!(elbow.transform_point3a(Vec3A::Y), Vec3A::new(-6.0, -2.0, 1.0));
    }

    #[test]
    fn a_skeleton_bound_where_it_rests_leaves_points_where_they_are() {
        let mut skeleton = arm();
        let rest = skeleton.at_rest();
        for (joint, matrix) in skeleton.joints.iter_mut().zip(rest) {
            joint.inverse_bind = Mat4::from(matrix.inverse());
        }
        for matrix in skeleton.at_rest() {
            assert!(matrix.abs_diff_eq(Affine3A::IDENTITY, 1e-6), "{matrix:?}");
        }
    }

    #[test]
    fn a_clip_of_an_ancestor_moves_the_joints_below() {
        let mut skeleton = arm();
        skeleton.clips.push(JointClip {
            name: "lift".into(),
            channels: vec![JointChannel {
                node: 0,
                property: Property::Translation,
                interpolation: Interpolation::Linear,
                times: vec![0.0, 2.0],
                values: vec![Vec4::ZERO, Vec4::new(0.0, 8.0, 0.0, 0.0)],
            }],
            ..JointClip::default()
        });
        let matrices = skeleton.world_from_mesh(skeleton.clip("lift"), 0.5);
        assert_eq!(matrices[1].transform_point3a(Vec3A::ZERO), Vec3A::new(-2.0, 2.0, 0.0));
        assert_eq!(skeleton.world_from_mesh(skeleton.clip("none"), 0.5), skeleton.at_rest());
    }
}
