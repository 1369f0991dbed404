//! What a model is made of, and what tree it gets: numbers with a JSON form, and tables to read.
//!
//! ```
//! use std::path::Path;
//! use morph_collision_testkit::inspect::FileReport;
//! use morph_collision_testkit::models::dolphin;
//!
//! let report = FileReport::new(Path::new("dolphin.glb"), &[dolphin(0)]);
//! assert_eq!(report.meshes[0].triangles, 564);
//! assert_eq!(report.why_unusable(), None);
//! println!("{report}");
//! ```

mod report;
mod text;

pub use report::{
    AnimationReport, FileReport, MeshError, MeshReport, TargetReport, TreeReport, UsableReport, WeightRange,
};
