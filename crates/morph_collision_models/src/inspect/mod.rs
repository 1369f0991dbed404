//! What a model contains and what tree it gets: numbers with a JSON form, and readable tables.
//!
//! ```
//! use std::path::Path;
//! use morph_collision_models::gltf::read::{GltfFile, ReadOptions};
//! use morph_collision_models::gltf::write::{Appearance, to_glb};
//! use morph_collision_models::inspect::FileReport;
//! use morph_collision_models::generated::dolphin;
//!
//! let glb = to_glb(&dolphin(0), &Appearance::default()).unwrap();
//! let file = GltfFile::parse(&glb, Path::new("dolphin.glb"), &ReadOptions::default()).unwrap();
//! let report = FileReport::read(&file);
//! assert_eq!(report.meshes[0].triangles, 564);
//! assert_eq!(report.why_unusable(), None);
//! println!("{report}");
//! ```

mod animation;
mod expression;
mod node;
mod report;
mod skin;
mod summary;
mod text;
mod usable;

pub use animation::{AnimationReport, FileAnimationReport, WeightRange};
pub use expression::ExpressionReport;
pub use node::NodeReport;
pub use report::{FileReport, MeshError, MeshReport};
pub use skin::{JointClipReport, SkinReport};
pub use summary::{Summary, SummaryRow};
pub use usable::{BoundsReport, TargetReport, TreeReport, UsableReport};
