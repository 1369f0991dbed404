//! A picture of a finding as SVG: the triangles around it, with those that touch in colour.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use glam::{DQuat, DVec3};
use morph_collision::{Body, Pose, Triangle, WorldFromModel};

use super::findings::Finding;

/// The width and height of a picture.
const SIZE: f64 = 240.0;
/// At most this many triangles are drawn: those that are closest to the middle.
const MOST_TRIANGLES: usize = 400;
/// How much of the surroundings is shown, as a multiple of the finding's size.
const SURROUNDINGS: f64 = 1.25;
/// Triangles are drawn in one of these many shades.
const SHADES: f64 = 6.0;

/// The styles that all pictures share.
pub(super) const STYLE: &str = "svg path{stroke-width:.4;stroke-linejoin:round}\
.s0{fill:#4b4f55}.s1{fill:#666b72}.s2{fill:#82878e}.s3{fill:#9da2a8}.s4{fill:#b8bcc1}.s5{fill:#d3d6d9}\
svg .g{stroke:#fff;stroke-opacity:.35}\
svg .t{fill:#d8352a;fill-opacity:.62;stroke:#6d0f08}\
svg .u{fill:#2468c8;fill-opacity:.62;stroke:#0b2a5c}";

/// Draws the worst shape of a finding. The pose must have it.
pub(super) fn draw(pose: &mut Pose, finding: &Finding) -> String {
    let count = pose.bvh().model().triangle_count() as u32;
    let mut body = Body::new(pose, &WorldFromModel::IDENTITY);
    let touching: Vec<(u32, Triangle)> = with_corners(&mut body, finding.worst.triangles.iter().copied());
    let points = || touching.iter().flat_map(|(_, corners)| corners);
    let low = points().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    let middle = (low + high) * 0.5;
    let radius = (low.distance(high) * 0.5 * SURROUNDINGS).max(f64::MIN_POSITIVE);
    let is_touching: BTreeSet<u32> = finding.worst.triangles.iter().copied().collect();
    let (mut near, mut mesh_middle) = (Vec::new(), DVec3::ZERO);
    for (triangle, corners) in with_corners(&mut body, 0..count) {
        let centre = centre(&corners);
        mesh_middle += centre / f64::from(count);
        if !is_touching.contains(&triangle) && centre.distance(middle) < 1.5 * radius {
            near.push((centre.distance(middle), corners));
        }
    }
    near.sort_by(|one, other| one.0.total_cmp(&other.0));
    near.truncate(MOST_TRIANGLES);
    let view = View::new(&touching, middle, mesh_middle, radius);

    let mut svg = format!("<svg viewBox=\"0 0 {SIZE} {SIZE}\" role=\"img\">");
    let mut order: Vec<(f64, String)> = near.iter().map(|(_, corners)| view.path(corners, None)).collect();
    // What touches is drawn last, so that nothing hides it.
    order.sort_by(|one, other| one.0.total_cmp(&other.0));
    let mut coloured: Vec<(f64, String)> = touching
        .iter()
        .map(|(triangle, corners)| view.path(corners, Some(if is_first_side(finding, *triangle) { "t" } else { "u" })))
        .collect();
    coloured.sort_by(|one, other| one.0.total_cmp(&other.0));
    for (_, path) in order.into_iter().chain(coloured) {
        svg += &path;
    }
    svg + "</svg>"
}

/// Triangles of one side are red, those that they touch are blue.
fn is_first_side(finding: &Finding, triangle: u32) -> bool {
    finding.worst.first_side.binary_search(&triangle).is_ok()
}

fn with_corners(body: &mut Body<'_>, triangles: impl Iterator<Item = u32>) -> Vec<(u32, Triangle)> {
    triangles
        .filter_map(|triangle| Some((triangle, body.triangle(triangle)?)))
        .collect()
}

fn centre([a, b, c]: &Triangle) -> DVec3 {
    (a + b + c) / 3.0
}

fn area_normal([a, b, c]: &Triangle) -> DVec3 {
    (b - a).cross(c - a)
}

/// Looks along the mean normal of what touches, from the outside of the mesh.
struct View {
    view_from_world: DQuat,
    middle: DVec3,
    scale: f64,
}

impl View {
    fn new(touching: &[(u32, Triangle)], middle: DVec3, mesh_middle: DVec3, radius: f64) -> Self {
        let outwards = (middle - mesh_middle).normalize_or(DVec3::Z);
        // Both sides count with the sign that shows them, because surfaces that touch often face each other.
        let mean: DVec3 = touching
            .iter()
            .map(|(_, corners)| area_normal(corners))
            .map(|normal| if normal.dot(outwards) < 0.0 { -normal } else { normal })
            .sum();
        let towards_eye = (mean.normalize_or_zero() + outwards * 0.5).normalize_or(DVec3::Z);
        // Keeps y up, unless it looks along y.
        let up = if towards_eye.y.abs() > 0.95 { DVec3::Z } else { DVec3::Y };
        let right = up.cross(towards_eye).normalize_or(DVec3::X);
        let axes = glam::DMat3::from_cols(right, towards_eye.cross(right), towards_eye);
        Self {
            view_from_world: DQuat::from_mat3(&axes).inverse(),
            middle,
            scale: SIZE * 0.5 / radius,
        }
    }

    /// The depth of a triangle, larger towards the eye, and its path.
    fn path(&self, corners: &Triangle, class: Option<&str>) -> (f64, String) {
        let seen = corners.map(|corner| self.view_from_world * (corner - self.middle) * self.scale);
        let mut path = String::from("<path class=\"");
        // Writing to a string cannot fail.
        let _ = match class {
            Some(class) => write!(path, "{class}"),
            None => {
                let lit = area_normal(&seen).normalize_or_zero().dot(DVec3::new(0.3, 0.4, 0.87));
                write!(path, "g s{}", (lit.abs() * SHADES).min(SHADES - 1.0).floor())
            }
        };
        path += "\" d=\"M";
        for corner in seen {
            let [x, y] = [SIZE * 0.5 + corner.x, SIZE * 0.5 - corner.y].map(|place| place.clamp(-SIZE, 2.0 * SIZE));
            let _ = write!(path, "{x:.0} {y:.0} ");
        }
        path.pop();
        path += "z\"/>";
        (seen.iter().map(|corner| corner.z).sum(), path)
    }
}
