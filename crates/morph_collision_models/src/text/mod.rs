//! Text for people: names that are safe to print, numbers, and suggestions for misspelt names.

mod nearest;
mod numbers;
mod printable;

pub use nearest::suggestion;
pub use numbers::{Grouped, number, numbers};
pub use printable::{Printable, is_printable};
