//! The ground truth of continuous collision: known times, symmetries, exact tests at single times, and recorded motions.

mod broken_files;
mod frames;
mod known_times;
mod recorded;
mod single_times;
mod symmetry;
