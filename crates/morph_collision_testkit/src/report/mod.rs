//! What reports of measurements are made of: rows in files, tables and plots on pages of Markdown.
//!
//! - [`Store`]: the files of measured rows, and the plots beside them.
//! - [`Table`], and the numbers in its cells.
//! - [`Figure`]: plots as SVG.
//! - [`origin()`]: the day, the commit and the machine.
//! - [`Page`]: a page whose marked sections are replaced; [`rewrite`] measures and replaces them one after the other.

mod origin;
mod plot;
mod sections;
mod store;
mod table;

pub use origin::origin;
pub use plot::{Axis, Figure, Panel, Series, exponent};
pub use sections::{Page, Section, SectionOptions, rewrite};
pub use store::Store;
pub use table::{NOTHING, Table, percent, range, ratio, ratios, short};
