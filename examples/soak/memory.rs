//! Memory and entities, each time that the stage is empty.

use std::fs;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use serde::Serialize;

/// By how many bytes samples of the second half of a run may exceed those of the first: in a run of eight hours, by 1,500 bytes for each of its cycles.
/// Lists grow until each has held the most that the game asks of it, which takes hours.
const ALLOWED: usize = 2 << 20;

/// Bytes that are allocated while nothing is on the stage.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Memory {
    pub(crate) largest_in_first_half: usize,
    pub(crate) largest_in_second_half: usize,
    pub(crate) last: usize,
    pub(crate) samples: u64,
    /// The most memory that the process took at any time, if the system tells.
    pub(crate) peak_rss: Option<u64>,
    /// The sets of components that entities have had. Bevy never forgets one, so memory grows with them.
    pub(crate) archetypes: usize,
    #[serde(skip)]
    half: u64,
    #[serde(skip)]
    entities: usize,
}

impl Memory {
    pub(crate) fn new(cycles: u64) -> Self {
        Self {
            largest_in_first_half: 0,
            largest_in_second_half: 0,
            last: 0,
            samples: 0,
            peak_rss: None,
            archetypes: 0,
            half: cycles / 2,
            entities: 0,
        }
    }

    /// Looks at an empty stage.
    pub(crate) fn sample(&mut self, bytes: usize, world: &mut World) -> Result<(), String> {
        let mut entities = world.query_filtered::<(), Allow<Disabled>>();
        let entities = entities.iter(world).count();
        self.archetypes = world.archetypes().len();
        if self.samples == 0 {
            self.entities = entities;
        }
        if entities != self.entities {
            let before = self.entities;
            return Err(format!("{entities} entities on the empty stage instead of {before}"));
        }
        self.last = bytes;
        // A run of one cycle compares nothing.
        let largest = if self.samples < self.half.max(1) {
            &mut self.largest_in_first_half
        } else {
            &mut self.largest_in_second_half
        };
        *largest = bytes.max(*largest);
        self.samples += 1;
        self.peak_rss = peak_rss();
        match self.largest_in_second_half > self.largest_in_first_half + ALLOWED {
            true => Err(format!(
                "{bytes} bytes on the empty stage after {} cycles, and at most {} in the first half of the run; {} archetypes",
                self.samples, self.largest_in_first_half, self.archetypes
            )),
            false => Ok(()),
        }
    }
}

/// In bytes. Linux only.
fn peak_rss() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kib)
}
