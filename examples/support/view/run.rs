//! Runs a demo as a program: in a window, or into pictures.

use super::{Demo, pictures, window};
use crate::error::ExampleError;
use crate::options::ViewOptions;

/// Shows it according to the options.
///
/// # Errors
/// There is no display for a window, there is no graphics driver, a model cannot be loaded, or a picture cannot be written.
pub fn run(demo: Demo, options: &ViewOptions) -> Result<(), ExampleError> {
    match &options.screenshots {
        Some(folder) => {
            leave_the_desktop();
            pictures::write(demo, options, folder)
        }
        None => window::run(demo, options),
    }
}

/// Keeps Mesa's device selection from asking a Wayland desktop which GPU it uses.
///
/// There may be no desktop: without `XDG_RUNTIME_DIR`, libwayland would complain on stderr. The layer reads the environment when
/// the Vulkan loader finds it, and a running program cannot safely change its environment. So the program re-executes itself.
#[cfg(target_os = "linux")]
fn leave_the_desktop() {
    use std::os::unix::process::CommandExt;

    const DISABLE_LAYER: &str = "NODEVICE_SELECT";
    if std::env::var_os("XDG_RUNTIME_DIR").is_some() || std::env::var_os(DISABLE_LAYER).is_some() {
        return;
    }
    if let Ok(program) = std::env::current_exe() {
        let mut arguments = std::env::args_os();
        let mut again = std::process::Command::new(program);
        if let Some(name) = arguments.next() {
            again.arg0(name);
        }
        // Returns only on failure. Then the complaint on stderr stays, which is harmless.
        let _failed = again.args(arguments).env(DISABLE_LAYER, "1").exec();
    }
}

#[cfg(not(target_os = "linux"))]
fn leave_the_desktop() {}
