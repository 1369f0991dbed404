//! The relative placement of two bodies, in `f64`: the spaces in which their volumes can be compared, and the errors.

use glam::{Affine3A, DMat3, DVec3};

/// More than all rounding of a coordinate in `f64`, in units of the sum of its terms' magnitudes.
pub(super) const ROUNDINGS_F64: f64 = 64.0 * (f64::EPSILON / 2.0);

/// A map from one space to another, in `f64`.
#[derive(Clone, Debug)]
pub(super) struct Relative {
    pub(super) linear: DMat3,
    pub(super) translation: DVec3,
    /// The largest absolute coordinates that are mapped.
    pub(super) reach: DVec3,
    /// The largest distance of a placed vertex from its mapped one, per coordinate of the target space.
    pub(super) error: DVec3,
}

/// A space in which volumes of both bodies are compared. A side without a map is already in this space.
#[derive(Clone, Debug)]
pub(super) struct Frame<M> {
    pub(super) a: Option<M>,
    pub(super) b: Option<M>,
}

impl<M> Frame<M> {
    /// The spaces of both bodies, or world space if neither can be inverted. `map` makes the map of a volume, if possible.
    pub(super) fn all(body_a: &RoundedBody, body_b: &RoundedBody, map: impl Fn(&Relative) -> Option<M>) -> Vec<Self> {
        let error = body_a.error() + body_b.error();
        let mut frames = Vec::with_capacity(2);
        if let Some(b) = body_a.from(body_b, error).and_then(|relative| map(&relative)) {
            frames.push(Self { a: None, b: Some(b) });
        }
        if let Some(a) = body_b.from(body_a, error).and_then(|relative| map(&relative)) {
            frames.push(Self { a: Some(a), b: None });
        }
        if frames.is_empty() {
            // Relative to A's origin, so that distant bodies stay precise.
            let origin = body_a.translation;
            let [a, b] = [body_a, body_b].map(|body| map(&body.to_world(origin, error)));
            if a.is_some() && b.is_some() {
                frames.push(Self { a, b });
            }
        }
        frames
    }
}

/// A body's affine in `f64`, and how far it reaches in its own space.
#[derive(Clone, Debug)]
pub(super) struct RoundedBody {
    pub(super) linear: DMat3,
    pub(super) translation: DVec3,
    /// The largest absolute coordinates in model space.
    reach: DVec3,
}

impl RoundedBody {
    pub(super) fn new(world_from_model: &Affine3A, reach: DVec3) -> Self {
        let matrix = world_from_model.matrix3;
        Self {
            linear: DMat3::from_cols(
                matrix.x_axis.as_dvec3(),
                matrix.y_axis.as_dvec3(),
                matrix.z_axis.as_dvec3(),
            ),
            translation: world_from_model.translation.as_dvec3(),
            reach,
        }
    }

    /// The largest distance of world-space vertices from the exact images of model-space ones.
    pub(super) fn error(&self) -> DVec3 {
        ROUNDINGS_F64 * (abs(self.linear) * self.reach + self.translation.abs())
    }

    /// Maps to world space with another origin.
    pub(super) fn to_world(&self, origin: DVec3, error: DVec3) -> Relative {
        Relative {
            linear: self.linear,
            translation: self.translation - origin,
            reach: self.reach,
            error,
        }
    }

    /// The map of `other`'s volumes to this body's space; `None` if this body is too flat to invert.
    fn from(&self, other: &Self, world_error: DVec3) -> Option<Relative> {
        let largest = column_maxima(abs(self.linear)).max_element();
        let scaled = self.linear * (1.0 / largest);
        if largest == 0.0 || scaled.determinant().abs() < 1e-60 {
            return None;
        }
        let inverse = scaled.inverse() * (1.0 / largest);
        // |A^-1 y - N y| <= rho / (1 - rho) |N| |y| in the largest coordinate, with rho around |I - N A|.
        let residual = abs(DMat3::IDENTITY - inverse * self.linear);
        let rho = row_sum(residual) + ROUNDINGS_F64 * row_sum(abs(inverse) * abs(self.linear));
        if rho.is_nan() || rho > 0.01 {
            return None;
        }
        let offset = other.translation - self.translation;
        let reach = abs(other.linear) * other.reach + offset.abs() + world_error;
        let of_inverse = DVec3::splat(1.02 * rho * (abs(inverse) * reach).max_element());
        Some(Relative {
            linear: inverse * other.linear,
            translation: inverse * offset,
            reach: other.reach,
            error: of_inverse + abs(inverse) * (world_error + ROUNDINGS_F64 * reach),
        })
    }
}

pub(super) fn abs(m: DMat3) -> DMat3 {
    DMat3::from_cols(m.x_axis.abs(), m.y_axis.abs(), m.z_axis.abs())
}

/// The largest row sum of a matrix without negative entries.
pub(super) fn row_sum(m: DMat3) -> f64 {
    (m * DVec3::ONE).max_element()
}

pub(super) fn column_maxima(m: DMat3) -> DVec3 {
    DVec3::new(m.x_axis.max_element(), m.y_axis.max_element(), m.z_axis.max_element())
}
