//! Contacts with triangles that a body has not reached yet.

use bevy_rapier3d::parry::math::{Real, Vector};
use bevy_rapier3d::parry::query::ContactManifold;

/// The cosine of the angle up to which Rapier joins manifolds for its solver.
const SAME_NORMAL: Real = 0.996;

/// The number of contacts of joined manifolds that Rapier's solver uses.
const MOST: usize = 4;

/// Leaves only the outermost contacts of a body that is about to land, so that it lands on all of them at once.
///
/// Rapier joins manifolds with similar normals. If they have more than four contacts, it takes the closest one, and others only if
/// they are within its `prediction`. A flat box above many triangles would land on one point and be turned by it.
pub(crate) fn keep_outermost<ManifoldData, ContactData>(
    prediction: Real,
    manifolds: &mut [ContactManifold<ManifoldData, ContactData>],
) {
    let mut groups: Vec<Group> = Vec::new();
    for (number, manifold) in manifolds.iter().enumerate() {
        if manifold.points.is_empty() {
            continue;
        }
        let normal = manifold.local_n1;
        let index = groups.iter().position(|group| group.normal.dot(normal) >= SAME_NORMAL);
        let index = index.unwrap_or_else(|| {
            groups.push(Group {
                normal,
                contacts: Vec::new(),
            });
            groups.len() - 1
        });
        let contacts = manifold.points.iter().map(|contact| UpcomingContact {
            manifold: number,
            point: contact.local_p1,
            distance: contact.dist,
            kept: false,
        });
        groups[index].contacts.extend(contacts);
    }
    for mut group in groups {
        let touches = |contact: &UpcomingContact| contact.distance <= prediction;
        if group.contacts.len() <= MOST || group.contacts.iter().any(touches) {
            continue;
        }
        group.choose(prediction);
        // In the order in which they were collected.
        let mut manifold = usize::MAX;
        let mut contacts = group.contacts.iter().peekable();
        while let Some(contact) = contacts.peek() {
            if contact.manifold == manifold {
                break;
            }
            manifold = contact.manifold;
            manifolds[manifold]
                .points
                .retain(|_| contacts.next().is_some_and(|contact| contact.kept));
        }
    }
}

/// Contacts with similar normals.
struct Group {
    normal: Vector,
    contacts: Vec<UpcomingContact>,
}

struct UpcomingContact {
    manifold: usize,
    point: Vector,
    distance: Real,
    kept: bool,
}

impl Group {
    /// Keeps the closest contact, the one farthest from it, and the two farthest on either side of the line between them. If several
    /// are the closest to within `margin`, the outermost of them counts.
    fn choose(&mut self, margin: Real) {
        let contacts = &self.contacts;
        let center = contacts.iter().map(|contact| contact.point).sum::<Vector>() / contacts.len() as Real;
        let closest = contacts
            .iter()
            .map(|contact| contact.distance)
            .fold(Real::INFINITY, Real::min);
        let best = |rank: &dyn Fn(&UpcomingContact) -> Real| {
            let ranks = contacts.iter().map(rank).enumerate();
            ranks.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(index, _)| index)
        };
        let first = best(&|contact| {
            let is_close = contact.distance <= closest + margin;
            if is_close {
                contact.point.distance_squared(center)
            } else {
                -1.0
            }
        });
        let from = contacts[first].point;
        let farthest = best(&|contact| contact.point.distance_squared(from));
        let across = (contacts[farthest].point - from).cross(self.normal);
        let sides = [1.0, -1.0].map(|side| best(&|contact| side * across.dot(contact.point - from)));
        for index in [first, farthest, sides[0], sides[1]] {
            self.contacts[index].kept = true;
        }
    }
}
