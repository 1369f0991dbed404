//! Catches and silences panics.

use std::panic::{self, AssertUnwindSafe, PanicHookInfo};

type Hook = Box<dyn Fn(&PanicHookInfo<'_>) + Sync + Send + 'static>;

/// Silences panic messages while it lives. It affects the whole process, so only a program should hold one.
pub struct Silence {
    hook: Option<Hook>,
}

impl std::fmt::Debug for Silence {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Silence")
    }
}

impl Silence {
    /// Starts the silence.
    #[must_use]
    pub fn new() -> Self {
        let hook = Some(panic::take_hook());
        panic::set_hook(Box::new(|_| {}));
        Self { hook }
    }
}

impl Default for Silence {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Silence {
    fn drop(&mut self) {
        // A panicking thread cannot change hooks.
        if let Some(hook) = self.hook.take()
            && !std::thread::panicking()
        {
            panic::set_hook(hook);
        }
    }
}

/// The function's result, or its panic message.
pub(super) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(ToString::to_string);
        text.or_else(|| payload.downcast_ref::<String>().cloned())
            .unwrap_or_default()
    })
}
