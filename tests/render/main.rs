//! What is drawn: the examples' pictures, and whether the GPU and the core mean the same shape. Needs a graphics driver; one without a GPU
//! will do (Debian: `apt install mesa-vulkan-drivers libvulkan1`).

mod controls;
mod depth;
mod desktop;
mod frames;
mod own;
mod page;
mod references;
mod silhouettes;
mod support;
