//! The inside of closed surfaces: which side of their triangles is outside, and what is inside.

use morph_collision::Body;

use parry3d::math::Pose as Isometry;
use parry3d::math::{Real, Vector};
use parry3d::shape::Shape;

use super::layout::volume;
use super::posed::Posed;
use super::surface::MorphSurface;

impl Posed {
    /// Whether the mesh has an inside.
    pub fn is_closed(&self) -> bool {
        self.layout.closed
    }

    /// Whether the inside counts as touching.
    pub fn is_solid(&self) -> bool {
        self.solid
    }

    /// Whether normals, by the triangles' winding, point outward (1) or inward (-1). `None` if contacts push both ways.
    pub fn outward(&self) -> Option<Real> {
        self.outward
    }

    /// Sets whether the inside of the surface is solid and whether at least contacts push outward only. Returns whether either
    /// has changed. A mesh that is not closed has no inside. `reshaped` says whether the pose may have changed since the last
    /// call.
    pub fn set_sides(&mut self, solid: bool, outward_alone: bool, reshaped: bool) -> bool {
        let closed = self.is_closed();
        self.is_flat &= !reshaped;
        let outward = (closed && (solid || outward_alone)).then(|| self.find_outward());
        let new = (solid && closed, outward);
        let old = (self.solid, self.outward);
        (self.solid, self.outward) = new;
        old != new
    }

    fn find_outward(&mut self) -> Real {
        let is_mirrored = match self.pose.joints() {
            Some(joints) => joints.is_mirrored(),
            None => self.mirrored,
        };
        let mirror = if is_mirrored { -1.0 } else { 1.0 };
        if self.winding.is_none() && !self.is_flat {
            let volume = volume(self.pose.get());
            let is_mirrored = is_mirrored && self.pose.is_skinned();
            // A mesh that encloses no volume in this pose may do so in another.
            self.winding = volume.map(|volume| if (volume < 0.0) == is_mirrored { 1.0 } else { -1.0 });
            self.is_flat = self.winding.is_none();
        }
        self.winding.map_or(1.0, |winding| winding * mirror)
    }

    /// Whether a point in the collider's space is inside a solid surface.
    pub fn encloses(&mut self, point: Vector) -> bool {
        if !self.solid || !self.bounds().contains_local_point(point) {
            return false;
        }
        let body = Body::new(self.pose.get(), &self.collider_from_model);
        self.queries.ray.encloses(body, point.as_dvec3()).unwrap_or(false)
    }
}

/// The log message for an entity whose surface should be solid but cannot be.
pub fn not_closed(name: &str) -> String {
    format!(
        "the surface of entity `{name}` is not solid, because its mesh is not closed: along some edge there are not as many triangles that run one \
         way as there are that run the other; close the mesh, or leave `solid` off"
    )
}

/// Whether one of two shapes is a solid surface that encloses the other, assuming that their boundaries do not cross.
pub fn one_encloses_other(pos12: &Isometry, g1: &dyn Shape, g2: &dyn Shape) -> bool {
    let is_in = |surface: &dyn Shape, isometry: &Isometry, other: &dyn Shape| {
        let Some(surface) = surface.as_shape::<MorphSurface>().filter(|it| it.lock().is_solid()) else {
            return false;
        };
        // Before the surface is locked again, because the other shape may be the same surface.
        let point = Probe::of(other).map(|probe| isometry.transform_point(probe.point));
        point.is_some_and(|point| surface.lock().encloses(point))
    };
    is_in(g1, pos12, g2) || is_in(g2, &pos12.inverse(), g1)
}

/// A point of a shape that is tested to decide whether the shape is inside something.
pub struct Probe {
    /// In the shape's own space: the middle of a convex shape, otherwise of one of its parts.
    pub point: Vector,
    /// Whether the point is on the outside of the shape. It may then be slightly inside something that the shape lies on.
    pub is_outside: bool,
}

impl Probe {
    /// A point of a shape that has any.
    pub fn of(shape: &dyn Shape) -> Option<Self> {
        let on_skin = |point| Self {
            point,
            is_outside: true,
        };
        if let Some(surface) = shape.as_shape::<MorphSurface>() {
            let mut posed = surface.lock();
            let corner = posed.pose.get().triangle(0)?[0];
            return Some(on_skin(posed.collider_from_model.transform_point(corner).as_vec3()));
        }
        let middle = |shape: &dyn Shape| Self {
            point: shape.compute_local_bounding_sphere().center(),
            is_outside: shape.as_triangle().is_some(),
        };
        let Some(composite) = shape.as_composite_shape() else {
            return Some(middle(shape));
        };
        let mut probe = None;
        composite.map_part_at(0, &mut |isometry, part, _| {
            let Self { point, is_outside } = middle(part);
            let point = isometry.map_or(point, |isometry| isometry.transform_point(point));
            probe = Some(Self { point, is_outside });
        });
        probe
    }
}
