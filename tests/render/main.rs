//! Checks drawing: the examples' pictures, and whether the GPU and the core library agree on shapes. Needs a graphics driver,
//! which may be a software renderer (Debian: `apt install mesa-vulkan-drivers libvulkan1`).

mod controls;
mod depth;
mod desktop;
mod frames;
mod own;
mod page;
mod references;
mod silhouettes;
mod support;
mod types;
