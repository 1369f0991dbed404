//! Which changes of a surface are motion, and which are jumps.

use bevy::math::DVec3;
use morph_collision::WorldFromModel;

use super::moment::posed_vertices;
use super::surface::MovingSurface;
use crate::math::{between, continuous};

impl MovingSurface {
    /// Whether vertices move and do not jump. `start` are their positions before the step, and `velocities` those to the end of it.
    pub fn is_motion(&mut self, vertices: &[u32], start: &[DVec3], velocities: &[DVec3]) -> bool {
        if self.looks_between_frames() {
            return self.is_continuous(vertices);
        }
        let limit = self.velocity_limit();
        if continuous(velocities, None, limit) {
            return true;
        }
        let Some(time) = self.moved_for else { return false };
        let (mut earlier, mut last_velocities) = (Vec::new(), Vec::new());
        self.moments.earlier.vertices(vertices, &mut earlier);
        between(&earlier, start, time, &mut last_velocities);
        continuous(velocities, Some(&last_velocities), limit)
    }

    /// Whether vertices move continuously, through the frames that a step covers, from the frame before.
    ///
    /// A frame that changes a velocity by more than `max_acceleration` allows is a jump and not motion, however many steps it
    /// covers.
    pub fn is_continuous(&mut self, vertices: &[u32]) -> bool {
        let Some(span) = self.span else { return true };
        if !self.transform_is_continuous(vertices) {
            return false;
        }
        // The oldest moment is not needed any more in this step.
        let frame = &mut self.moments.earlier;
        // If a body carries it, only what it is drawn with counts.
        frame.world_from_model = self.moments.end;
        frame.pose.take(&self.surface.lock().pose);
        let (mut last_velocities, mut last): (Option<Vec<DVec3>>, Option<(f64, Vec<DVec3>)>) = (None, None);
        for time in self.drawn.frames_around(span) {
            frame.set_from_history(&self.drawn, time);
            let mut now = Vec::new();
            frame.vertices(vertices, &mut now);
            if let Some((last_time, last)) = &last {
                let dt = time - last_time;
                let mut velocities = Vec::new();
                between(last, &now, dt, &mut velocities);
                let limit = f64::from(self.max_acceleration) * dt;
                if time > span.begin && !continuous(&velocities, last_velocities.as_deref(), limit) {
                    return false;
                }
                last_velocities = Some(velocities);
            }
            last = Some((time, now));
        }
        true
    }

    /// Whether vertices move continuously with a transform that frames do not change, such as that of a body.
    fn transform_is_continuous(&mut self, vertices: &[u32]) -> bool {
        let (end, start) = (self.moments.end, self.moments.start.world_from_model);
        if !self.drawn.has_live_transform() || end == start {
            return true;
        }
        let earlier = self.last_transform.filter(|_| !self.carried);
        let mut posed = self.surface.lock();
        let mut at = |world_from_model: &WorldFromModel| {
            let mut points = Vec::new();
            posed_vertices(posed.pose.get(), world_from_model, vertices, &mut points);
            points
        };
        let velocities = |from: &[DVec3], to: &[DVec3], dt: f64| {
            let mut velocities = Vec::new();
            between(from, to, dt, &mut velocities);
            velocities
        };
        let [now, before] = [&end, &start].map(&mut at);
        let earlier = earlier.map(|(transform, dt)| velocities(&at(&transform), &before, dt));
        let velocities = velocities(&before, &now, f64::from(self.last_step()));
        continuous(&velocities, earlier.as_deref(), self.velocity_limit())
    }
}
