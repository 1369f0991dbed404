//! What is measured on.

/// The processor's name, as far as the system tells it.
#[must_use]
pub fn cpu() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info
        .lines()
        .find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or_else(
        || format!("unknown {} processor", std::env::consts::ARCH),
        |(_, name)| name.trim().to_owned(),
    )
}

/// Keeps this thread on one core, the last of those it may use: the first ones have more to do besides. `None` if that cannot be done.
#[must_use]
pub fn pin() -> Option<usize> {
    let core = core_affinity::get_core_ids()?.into_iter().last()?;
    core_affinity::set_for_current(core).then_some(core.id)
}
