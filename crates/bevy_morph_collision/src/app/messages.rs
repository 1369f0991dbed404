//! Messages that nobody has read.

use bevy::prelude::*;

/// Forgets all messages of a kind. Readers skip them.
pub(crate) fn forget_messages<M: Message>(world: &mut World) {
    if let Some(mut messages) = world.get_resource_mut::<Messages<M>>() {
        messages.clear();
    }
}
