//! Continuous collision: contacts that happen while bodies move from one pose to another.
//!
//! A [`MovingBody`] is a body at the start and at the end of a step. In between, every vertex moves on a straight line from its old to
//! its new world position. (If weights change linearly under a fixed placement, this is the true motion.) A [`MotionQuery`] finds what
//! touches during that motion, however fast it is. Its answers are exact for these lines: nothing is missed, and nothing is reported that
//! does not touch. (Only a ball or another shape may be reported although it passes by very closely.)
//!
//! Straight lines flatten what turns far in one step: a body that turns by half a turn passes through its own axis. Use steps so short that
//! bodies turn by a few degrees.
//!
//! Surfaces that are apart first touch where a vertex meets a face or two edges meet, so contacts are between such [`Features`].
//! Triangles that cross each other during the whole motion need not have such a contact; only [`MotionQuery::first`] and
//! [`MotionQuery::any`] also look for triangles that intersect when the motion starts.
//!
//! [`MotionQuery::first_of_ball`] finds the first contact of a point or a ball, for example a bullet; [`MotionQuery::first_of_shape`] that of any
//! shape, which may turn.
//! [`vertex_face_touch`], [`edge_edge_touch`] and their `_impact` variants are the tests of one vertex and face, or of two edges.

mod ball;
mod candidate;
mod collapsed;
mod contact;
mod earliest;
mod leaves;
mod limit;
mod moving_body;
mod query;
mod shape_box;
mod triangle;
mod walk;

pub use ball::MovingBall;
pub use contact::{Features, MotionContact};
pub use limit::LimitReached;
pub use moving_body::MovingBody;
pub use query::MotionQuery;

pub use super::shape::{MovingShape, MovingShapeImpact, SurfaceImpact};
pub use crate::exact::motion::{
    MovingPoint, StageCounts, TimeOfImpact, edge_edge_impact, edge_edge_impact_counting, edge_edge_touch,
    edge_edge_touch_counting, vertex_face_impact, vertex_face_impact_counting, vertex_face_touch,
    vertex_face_touch_counting,
};
