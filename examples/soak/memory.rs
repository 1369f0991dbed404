//! Memory and entities, each time that the stage is empty.

use std::fs;

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use serde::Serialize;

/// By how many bytes later samples may exceed the first ones. Over the cycles of eight hours, less than 400 bytes per cycle.
const ALLOWED: usize = 1 << 20;

/// Bytes that are allocated while nothing is on the stage.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Memory {
    /// The largest of the samples that later ones are compared with. Lists have not grown to their sizes in those before them.
    pub(crate) first: usize,
    /// The largest of all later samples.
    pub(crate) largest: usize,
    pub(crate) last: usize,
    pub(crate) samples: u64,
    /// The most memory that the process took at any time, if the system tells.
    pub(crate) peak_rss: Option<u64>,
    /// The sets of components that entities have had. Bevy never forgets one, so memory grows with them.
    pub(crate) archetypes: usize,
    #[serde(skip)]
    warm_up: u64,
    #[serde(skip)]
    compared_from: u64,
    #[serde(skip)]
    entities: usize,
}

impl Memory {
    pub(crate) fn new(cycles: u64) -> Self {
        let warm_up = (cycles / 4).min(20);
        Self {
            first: 0,
            largest: 0,
            last: 0,
            samples: 0,
            peak_rss: None,
            archetypes: 0,
            warm_up,
            compared_from: warm_up + (cycles / 4).clamp(1, 30),
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
        if self.samples >= self.compared_from {
            self.largest = self.largest.max(bytes);
        } else if self.samples >= self.warm_up {
            self.first = self.first.max(bytes);
        }
        self.samples += 1;
        self.peak_rss = peak_rss();
        match self.largest > self.first + ALLOWED {
            true => Err(format!(
                "{bytes} bytes on the empty stage after {} cycles, and at most {} in the first ones; {} archetypes",
                self.samples, self.first, self.archetypes
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
