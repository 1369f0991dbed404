//! Whether components have changed, and whether a query returns other entities: whole columns of Bevy's tables at once.
//!
//! PERF: a filter such as `Changed` looks at one entity after the other. That took most of the time of a frame in which nothing happens.
//! The ticks of a column lie side by side, so a block of them is compared at once.

use std::ops::Range;

use bevy::ecs::change_detection::{ContiguousRef, Tick};
use bevy::ecs::system::SystemChangeTick;
use bevy::prelude::*;

/// How many ticks are compared before looking whether one of them is new.
const BLOCK: usize = 64;

/// The ticks of one component in a table.
#[derive(Clone, Copy)]
pub(crate) struct Column<'w> {
    ticks: &'w [Tick],
    last_run: Tick,
    this_run: Tick,
}

impl<'w> Column<'w> {
    /// When the components were changed or added.
    pub(crate) fn changed<C>(column: &ContiguousRef<'w, C>) -> Self {
        Self {
            ticks: column.changed_ticks_slice(),
            last_run: column.last_run_tick(),
            this_run: column.this_run_tick(),
        }
    }

    /// The same, compared with a time of which the caller keeps account.
    pub(crate) fn changed_since<C>(column: &ContiguousRef<'w, C>, last_run: Tick) -> Self {
        Self {
            last_run,
            ..Self::changed(column)
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.ticks.len()
    }

    /// When the components were added.
    pub(crate) fn added<C>(column: &ContiguousRef<'w, C>) -> Self {
        Self {
            ticks: column.added_ticks_slice(),
            ..Self::changed(column)
        }
    }

    /// Whether it happened to a row since the system last ran.
    pub(crate) fn is_new(&self, row: usize) -> bool {
        self.any_new_in(row..row + 1)
    }

    /// Whether it happened to any of these rows, at most [`BLOCK`] of them.
    pub(crate) fn any_new_in(&self, rows: Range<usize>) -> bool {
        let now = self.this_run.get();
        let age = now.wrapping_sub(self.last_run.get());
        // As `Tick::is_newer_than`, but for the largest age, which Bevy's own checks keep all ticks below.
        let mut any = false;
        for tick in &self.ticks[rows] {
            any |= now.wrapping_sub(tick.get()) < age;
        }
        any
    }

    /// The rows to which it happened since the system last ran.
    pub(crate) fn new_rows(&self) -> impl Iterator<Item = usize> {
        let new = blocks(self.ticks.len()).filter(|block| self.any_new_in(block.clone()));
        new.flatten().filter(|&row| self.is_new(row))
    }

    /// Whether it happened to any row.
    pub(crate) fn any_new(&self) -> bool {
        blocks(self.ticks.len()).any(|block| self.any_new_in(block))
    }
}

/// The rows of a table of this length, in blocks.
pub(crate) fn blocks(rows: usize) -> impl Iterator<Item = Range<usize>> {
    let starts = (0..rows).step_by(BLOCK);
    starts.map(move |start| start..rows.min(start + BLOCK))
}

/// Whether a component of a table was changed or added since the system last ran. False if the table does not have the component.
pub(crate) fn any_changed<C>(column: Option<&ContiguousRef<C>>) -> bool {
    column.is_some_and(|column| Column::changed(column).any_new())
}

/// The same if it was added.
pub(crate) fn any_added<C>(column: Option<&ContiguousRef<C>>) -> bool {
    column.is_some_and(|column| Column::added(column).any_new())
}

/// Whether a system has not run for so long that Bevy may have forgotten when components changed.
pub(crate) fn ran_long_ago(ticks: &SystemChangeTick) -> bool {
    is_long_ago(ticks.last_run(), ticks.this_run())
}

/// The same for another time than the last run.
pub(crate) fn is_long_ago(then: Tick, now: Tick) -> bool {
    now.get().wrapping_sub(then.get()) > 1 << 30
}

/// The entities that a query returned.
#[derive(Default)]
pub(crate) struct Rows {
    entities: Vec<Entity>,
    /// The number of entities of each table, and which optional components it has.
    tables: Vec<(usize, u32)>,
}

impl Rows {
    pub(crate) fn len(&self) -> usize {
        self.entities.len()
    }

    /// Takes the entities of all tables; the number of each says which optional components it has. Returns whether all of it is the
    /// same as before, in the same order.
    pub(crate) fn replace<'w>(&mut self, tables: impl Iterator<Item = (&'w [Entity], u32)>) -> bool {
        let (mut row, mut count, mut is_same) = (0, 0, true);
        for (entities, has) in tables {
            let table = (entities.len(), has);
            is_same = is_same
                && self.tables.get(count) == Some(&table)
                && self.entities.get(row..row + entities.len()) == Some(entities);
            if !is_same {
                self.entities.truncate(row);
                self.tables.truncate(count);
                self.entities.extend_from_slice(entities);
                self.tables.push(table);
            }
            row += entities.len();
            count += 1;
        }
        is_same &= self.tables.len() == count;
        self.entities.truncate(row);
        self.tables.truncate(count);
        is_same
    }
}

/// A number that says which of some components a table has.
pub(crate) fn has<const N: usize>(components: [bool; N]) -> u32 {
    components.iter().fold(0, |bits, &has| 2 * bits + u32::from(has))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_entities_orders_and_components_are_noticed() {
        let entities: Vec<Entity> = (1..6).filter_map(Entity::from_raw_u32).collect();
        let swapped = [entities[1], entities[0]];
        let first = [(&entities[..2], 0), (&entities[2..4], 1)];
        let others: [&[(&[Entity], u32)]; 6] = [
            &[(&entities[..2], 0)],
            &[(&entities[..2], 0), (&entities[2..5], 1)],
            &[(&entities[..3], 0), (&entities[3..4], 1)],
            &[(&entities[..2], 0), (&entities[2..4], 2)],
            &[(&swapped, 0), (&entities[2..4], 1)],
            &[],
        ];
        for other in others {
            let mut rows = Rows::default();
            assert!(!rows.replace(first.into_iter()));
            assert!(rows.replace(first.into_iter()));
            assert!(!rows.replace(other.iter().copied()), "{other:?}");
            assert!(rows.replace(other.iter().copied()), "{other:?}");
            assert_eq!(
                rows.len(),
                other.iter().map(|(entities, _)| entities.len()).sum::<usize>()
            );
        }
    }
}
