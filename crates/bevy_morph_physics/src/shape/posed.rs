//! The current state of a surface, and queries about it.

use std::sync::Arc;

use bevy::math::Vec3;
use morph_collision::{Body, ConvexRegion, Facing, InputError, RayQuery, ShapeQuery, WorldFromModel};
use parry3d::bounding_volume::Aabb;
use parry3d::mass_properties::MassProperties;
use parry3d::math::{Pose as Isometry, Real, Vector};
use parry3d::query::{PointProjection, Ray, RayIntersection};
use parry3d::shape::{FeatureId, Triangle};

use super::layout::MeshLayout;
use super::mass::{Mass, MassBudget, MassComputation};
use super::range::box_in_range;
use super::triangles::{Triangles, pseudo_normals};
use crate::math::largest;
use crate::posing::LazyPose;

/// The current state of a surface.
pub struct Posed {
    pub(crate) layout: Arc<MeshLayout>,
    /// For a skinned mesh, the pose is in the collider's space.
    pub pose: LazyPose,
    /// Maps the mesh to the collider, which has its own position and rotation. This leaves scale and shear.
    pub collider_from_model: WorldFromModel,
    pub(crate) queries: Queries,
    /// Whether the game wants it to have an inside, and it has one.
    pub(crate) solid: bool,
    /// If contacts push one way only: whether normals, by the triangles' winding, point outward (1) or inward (-1).
    pub(crate) outward: Option<Real>,
    /// The same for the mesh without mirroring, once it is known.
    pub(crate) winding: Option<Real>,
    /// Whether `winding` is unknown because the pose encloses no volume.
    pub(crate) is_flat: bool,
    /// Whether its transform mirrors it. Joints are asked when that matters.
    pub(crate) mirrored: bool,
    mass: Mass,
    /// Whether a dynamic body carries it, or has, which depends on its mass.
    is_mass_needed: bool,
    /// Whether its mass has become known since this was last asked.
    mass_changed: bool,
}

#[derive(Default)]
pub(crate) struct Queries {
    pub(crate) ray: RayQuery,
    shape: ShapeQuery,
    found: Vec<u32>,
}

impl Posed {
    pub(super) fn new(pose: LazyPose, collider_from_model: WorldFromModel, layout: Arc<MeshLayout>) -> Self {
        Self {
            winding: layout.winding,
            layout,
            pose,
            collider_from_model,
            queries: Queries::default(),
            solid: false,
            outward: None,
            is_flat: false,
            mirrored: false,
            mass: Mass::default(),
            is_mass_needed: false,
            mass_changed: false,
        }
    }

    /// Sets the transform from mesh to collider. Returns whether it has changed.
    pub fn set_transform(&mut self, collider_from_model: WorldFromModel) -> bool {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let [old, new] = [&self.collider_from_model, &collider_from_model]
            .map(|transform| corners.map(|p| transform.transform_point(p)));
        let size = largest(new.iter().map(|p| p.length()));
        // Rounding errors from removing a rotation are not a change.
        let changed = old.iter().zip(&new).any(|(old, new)| old.distance(*new) > 1e-5 * size);
        if changed {
            self.collider_from_model = collider_from_model;
            // It may be larger now.
            self.reset_mass();
        }
        let [origin, axes @ ..] = new;
        let [x, y, z] = axes.map(|axis| axis - origin);
        self.mirrored = x.cross(y).dot(z) < 0.0;
        changed
    }

    /// Recomputes the enclosed volume on the next request.
    pub fn reset_mass(&mut self) {
        self.mass = Mass::Unknown;
    }

    /// The triangles that intersect a box in the collider's space. With `for_contacts`, also the neighbours' data that contacts
    /// need.
    pub fn triangles_in(&mut self, region: &Aabb, for_contacts: bool) -> Triangles {
        let Self {
            pose,
            collider_from_model,
            queries,
            ..
        } = self;
        queries.found.clear();
        let bounds = morph_collision::Aabb {
            min: region.mins,
            max: region.maxs,
        };
        if let Ok(region) = ConvexRegion::from_aabb(&bounds) {
            let body = Body::new(pose.get(), collider_from_model);
            queries.shape.all_in_region(body, &region, &mut queries.found);
        }
        self.gather(for_contacts)
    }

    /// All triangles.
    pub fn all_triangles(&mut self, for_contacts: bool) -> Triangles {
        self.queries.found.clear();
        self.queries
            .found
            .extend(0..self.pose.bvh().model().triangle_count() as u32);
        self.gather(for_contacts)
    }

    pub(super) fn mass(&mut self, density: Real) -> MassProperties {
        let is_in_range = box_in_range(&self.bounds());
        let Self {
            pose,
            collider_from_model,
            is_mass_needed,
            ..
        } = self;
        let mut mass = self.mass.request(*is_mass_needed, || {
            if is_in_range {
                Mass::InProgress(Box::new(MassComputation::new(pose.get(), collider_from_model)))
            } else {
                Mass::Known(MassProperties::default())
            }
        });
        mass.set_mass(density * mass.mass(), true);
        mass
    }

    /// Continues to compute the mass if someone has requested it: within the budget, or all of it if a dynamic body carries the surface.
    /// Returns whether the mass has become known, so that physics has to request it again.
    pub(crate) fn advance_mass(&mut self, on_dynamic: bool, budget: &mut MassBudget) -> bool {
        self.is_mass_needed |= on_dynamic;
        let is_new = self.mass.advance((!self.is_mass_needed).then_some(budget));
        self.mass_changed |= is_new;
        is_new
    }

    /// From now on, computes its mass at once when it is requested.
    pub fn need_mass(&mut self) {
        self.is_mass_needed = true;
    }

    /// Whether its mass has become known since the last call.
    pub fn take_mass_changed(&mut self) -> bool {
        std::mem::take(&mut self.mass_changed)
    }

    fn gather(&mut self, for_contacts: bool) -> Triangles {
        let Self {
            layout,
            pose,
            collider_from_model,
            queries,
            outward,
            ..
        } = self;
        let pose = pose.get();
        let to_collider = |corner| collider_from_model.transform_point(corner).as_vec3();
        let (mut numbers, mut corners, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for &number in &queries.found {
            let Some(triangle) = pose.triangle(number) else {
                continue;
            };
            let triangle = triangle.map(to_collider);
            if triangle.iter().all(|corner| corner.is_finite()) {
                numbers.push(number);
                corners.push(Triangle::from(triangle));
                if for_contacts {
                    let across = layout.across[number as usize].map(|vertex| pose.vertex(vertex).map(to_collider));
                    normals.push(pseudo_normals(triangle, across, *outward));
                }
            }
        }
        Triangles::new(numbers, corners, normals)
    }

    /// A box around it, in the collider's space.
    pub fn bounds(&mut self) -> Aabb {
        finite(&self.pose.local_bounds(&self.collider_from_model))
    }

    /// A box around it while its collider is at `place`.
    pub(super) fn bounds_at(&mut self, place: &Isometry) -> Aabb {
        let bounds = self.pose.bounds_at(place);
        bounds.map_or_else(|| self.bounds().transform_by(place), |bounds| finite(&bounds))
    }

    pub(super) fn ray(
        &mut self,
        ray: &Ray,
        max_time_of_impact: Real,
        solid: bool,
    ) -> Result<Option<RayIntersection>, InputError> {
        if solid && self.encloses(ray.origin) {
            // Like Parry's own solid shapes.
            return Ok(Some(RayIntersection::new(0.0, Vector::ZERO, FeatureId::Unknown)));
        }
        let (origin, direction) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
        let core_ray = morph_collision::Ray::new(origin, direction, f64::from(max_time_of_impact))?;
        let body = Body::new(self.pose.get(), &self.collider_from_model);
        let hit = self.queries.ray.closest(body, &core_ray);
        Ok(hit.map(|hit| {
            // Like Parry's triangles: the normal of the side that was hit, and which side it was.
            let (side, feature) = match hit.facing {
                Facing::Back => (-1.0, FeatureId::Face(1)),
                _ => (1.0, FeatureId::Face(0)),
            };
            let mut intersection = RayIntersection::new(hit.t as Real, side * hit.normal.as_vec3(), feature);
            intersection.subshape = hit.triangle;
            intersection
        }))
    }

    pub(super) fn project(&mut self, point: Vector, solid: bool) -> Option<PointProjection> {
        let is_inside = self.encloses(point);
        if is_inside && solid {
            return Some(PointProjection::new(true, point));
        }
        let body = Body::new(self.pose.get(), &self.collider_from_model);
        let closest = self.queries.shape.closest_point(body, point.as_dvec3(), f64::INFINITY);
        let closest = closest.ok()??;
        Some(PointProjection::new(is_inside, closest.point.as_vec3()).with_subshape(closest.triangle))
    }
}

/// A finite box. Rapier would quarantine any other, together with its collider.
fn finite(bounds: &Aabb) -> Aabb {
    let finite = |v: Vec3| v.clamp(Vec3::splat(-1e18), Vec3::splat(1e18));
    Aabb::new(finite(bounds.mins), finite(bounds.maxs))
}
