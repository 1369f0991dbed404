//! How boxes of a body are mapped to a frame in which they are compared.

use fearless_simd::Simd;

use crate::bounds::{Aabb, BoxLanes, BoxMap, Frame, FrameLanes, LANES};

/// How a body's boxes are mapped to a frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Mapping {
    kind: Kind,
    map: BoxMap,
}

#[derive(Clone, Copy, Debug, Default)]
enum Kind {
    /// The frame is the body's own space.
    #[default]
    Own,
    /// The frame is another space.
    Mapped,
    /// The map exceeds the range of `f32`: nothing is culled.
    Unbounded,
}

impl Mapping {
    /// Replaces the map; `None` if the frame is the body's own space.
    pub(super) fn set(&mut self, frame: Option<&Frame>) {
        self.kind = match frame {
            None => Kind::Own,
            Some(frame) if self.map.set(frame) => Kind::Mapped,
            Some(_) => Kind::Unbounded,
        };
    }

    /// [`Mapping::set`] for a frame in registers.
    #[inline(always)]
    pub(super) fn set_lanes<S: Simd>(&mut self, simd: S, frame: Option<&FrameLanes<S>>) {
        self.kind = match frame {
            None => Kind::Own,
            Some(frame) if self.map.set_lanes(simd, frame) => Kind::Mapped,
            Some(_) => Kind::Unbounded,
        };
    }

    /// From now on, nothing is culled in this frame.
    pub(super) fn set_unbounded(&mut self) {
        self.kind = Kind::Unbounded;
    }

    #[inline(always)]
    pub(super) fn one(&self, one: &Aabb) -> Aabb {
        match self.kind {
            Kind::Own => *one,
            Kind::Mapped => self.map.one(one),
            Kind::Unbounded => Aabb::UNBOUNDED,
        }
    }

    #[inline(always)]
    pub(super) fn all<S: Simd>(&self, simd: S, source: &BoxLanes, mapped: &mut BoxLanes) {
        match self.kind {
            Kind::Own => *mapped = *source,
            Kind::Mapped => self.map.all(simd, source, mapped),
            Kind::Unbounded => (0..LANES).for_each(|lane| mapped.set(lane, &Aabb::UNBOUNDED)),
        }
    }
}
