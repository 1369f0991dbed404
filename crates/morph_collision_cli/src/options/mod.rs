//! Options that commands share.

pub(crate) mod expression;
pub(crate) mod frame_times;
pub(crate) mod shape;
pub(crate) mod tree;
