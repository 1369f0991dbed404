//! The machine that runs the benchmark.

use std::collections::HashMap;
use std::time::Duration;

/// The processor's name, if the system reports it.
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

/// The core that a thread is pinned to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinned {
    /// The core's number.
    pub core: usize,
    /// The share of the last moments in which it was busy, 0 to 1, if the system reports it.
    pub busy: Option<f64>,
}

/// How long the load of the cores is observed.
const OBSERVED: Duration = Duration::from_millis(300);

/// Pins this thread to the core that is least busy; of equal ones the last, because the first ones have more other work. Returns `None`
/// if that fails.
#[must_use]
pub fn pin() -> Option<Pinned> {
    let before = processor_times();
    std::thread::sleep(if before.is_empty() { Duration::ZERO } else { OBSERVED });
    let after = processor_times();
    let busy = |core: usize| {
        let ((busy_before, all_before), (busy_after, all_after)) = (before.get(&core)?, after.get(&core)?);
        let all = all_after.checked_sub(*all_before).filter(|all| *all > 0)?;
        Some(busy_after.saturating_sub(*busy_before) as f64 / all as f64)
    };
    let cores = core_affinity::get_core_ids()?;
    let load = |core: &core_affinity::CoreId| busy(core.id).unwrap_or(0.0);
    let idlest = cores
        .into_iter()
        .rev()
        .min_by(|one, other| load(one).total_cmp(&load(other)))?;
    let pinned = Pinned {
        core: idlest.id,
        busy: busy(idlest.id),
    };
    core_affinity::set_for_current(idlest).then_some(pinned)
}

/// For each core the time that it was busy, and all its time, in ticks of the system. Empty if the system does not tell.
fn processor_times() -> HashMap<usize, (u64, u64)> {
    let stat = std::fs::read_to_string("/proc/stat").unwrap_or_default();
    stat.lines().filter_map(processor_time).collect()
}

/// A line such as `cpu1 user nice system idle iowait irq softirq steal ..`.
fn processor_time(line: &str) -> Option<(usize, (u64, u64))> {
    let mut words = line.split_ascii_whitespace();
    let core = words.next()?.strip_prefix("cpu")?.parse().ok()?;
    let ticks: Vec<u64> = words.take(8).map_while(|word| word.parse().ok()).collect();
    let idle = ticks.get(3)? + ticks.get(4)?;
    let all: u64 = ticks.iter().sum();
    Some((core, (all - idle, all)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn busy_time_is_all_but_idling_and_waiting() {
        let line = "cpu1 100 20 30 800 40 1 2 7 0 0";
        assert_eq!(processor_time(line), Some((1, (160, 1000))));
        assert_eq!(processor_time("cpu  100 20 30 800 40 1 2 7 0 0"), None);
        assert_eq!(processor_time("intr 1 2 3"), None);
    }
}
