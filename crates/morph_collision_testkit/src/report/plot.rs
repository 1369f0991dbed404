//! Figures as SVG.

use std::error::Error;
use std::ops::Range;
use std::path::Path;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{AsRangedCoord, Ranged, ValueFormatter};
use plotters::prelude::*;

/// A figure of panels, two in a row.
#[derive(Clone, Debug)]
pub struct Figure {
    /// The base name of its file.
    pub name: String,
    /// The panels, from left to right, then down.
    pub panels: Vec<Panel>,
}

/// A chart.
#[derive(Clone, Debug)]
pub struct Panel {
    /// The title above it.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The lines.
    pub series: Vec<Series>,
}

/// An axis.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// The label: quantity and unit.
    pub label: &'static str,
    /// Whether it is logarithmic.
    pub log: bool,
}

/// A line through points.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// The points, in the order of the line.
    pub points: Vec<(f64, f64)>,
    /// Whether points are marked.
    pub marked: bool,
}

/// Colours that are distinguishable with any colour vision (Okabe and Ito).
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(80, 80, 80),
];

const PANEL: (u32, u32) = (520, 420);
/// Where the plotting area starts; to the left are the labels.
const LEFT: i32 = 70;
const LEGEND_TOP: i32 = 38;
const LEGEND_ROW: i32 = 18;
const LEGEND_COLUMNS: usize = 2;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

impl Figure {
    /// Draws it as an SVG file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn draw(&self, file: &Path) -> Result<(), Box<dyn Error>> {
        let columns = self.panels.len().clamp(1, 2);
        let rows = self.panels.len().div_ceil(columns);
        let size = (PANEL.0 * columns as u32, PANEL.1 * rows as u32);
        let root = SVGBackend::new(file, size).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, panel) in root.split_evenly((rows, columns)).iter().zip(&self.panels) {
            panel.draw(area)?;
        }
        root.present()?;
        Ok(())
    }
}

impl Panel {
    fn draw(&self, area: &Area<'_>) -> Result<(), Box<dyn Error>> {
        let rows = self.series.len().div_ceil(LEGEND_COLUMNS) as i32;
        let (head, area) = area.split_vertically(LEGEND_TOP + rows * LEGEND_ROW);
        self.draw_head(&head)?;
        let area = &area;
        let (x, y) = (
            self.range(|point| point.0, self.x.log),
            self.range(|point| point.1, self.y.log),
        );
        match (self.x.log, self.y.log) {
            (false, false) => self.draw_over(area, x, y),
            (true, false) => self.draw_over(area, x.log_scale(), y),
            (false, true) => self.draw_over(area, x, y.log_scale()),
            (true, true) => self.draw_over(area, x.log_scale(), y.log_scale()),
        }
    }

    /// Title and legend.
    fn draw_head(&self, area: &Area<'_>) -> Result<(), Box<dyn Error>> {
        area.draw(&Text::new(self.title.as_str(), (LEFT, 12), text(16)))?;
        let column = (PANEL.0 as i32 - LEFT) / LEGEND_COLUMNS as i32;
        for (index, (series, color)) in self.series.iter().zip(COLORS.iter().cycle()).enumerate() {
            let (row, x) = (index / LEGEND_COLUMNS, LEFT + (index % LEGEND_COLUMNS) as i32 * column);
            let y = LEGEND_TOP + row as i32 * LEGEND_ROW;
            area.draw(&PathElement::new([(x, y + 6), (x + 20, y + 6)], color.stroke_width(2)))?;
            area.draw(&Text::new(series.name.as_str(), (x + 26, y), text(13)))?;
        }
        Ok(())
    }

    /// The range of an axis; a linear one starts at 0.
    fn range(&self, of: fn(&(f64, f64)) -> f64, log: bool) -> Range<f64> {
        let values = || self.series.iter().flat_map(|series| series.points.iter().map(of));
        let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        match log {
            true if least > 0.0 && most > least => round_beyond(least, false)..round_beyond(most, true),
            true => 0.1..10.0,
            false if most > 0.0 => 0.0..most * 1.05,
            false => 0.0..1.0,
        }
    }

    fn draw_over<X, Y>(&self, area: &Area<'_>, x: X, y: Y) -> Result<(), Box<dyn Error>>
    where
        X: AsRangedCoord<Value = f64>,
        Y: AsRangedCoord<Value = f64>,
        X::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y::CoordDescType: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        let mut chart = ChartBuilder::on(area)
            .margin(12)
            .x_label_area_size(42)
            .y_label_area_size(LEFT - 12)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .x_desc(self.x.label)
            .y_desc(self.y.label)
            .axis_desc_style(text(14))
            .label_style(text(12))
            .x_label_formatter(&|value| number(*value))
            .y_label_formatter(&|value| number(*value))
            .x_labels(8)
            .y_labels(6)
            .light_line_style(TRANSPARENT)
            .bold_line_style(BLACK.mix(0.15))
            .draw()?;
        for (series, &color) in self.series.iter().zip(COLORS.iter().cycle()) {
            let line = LineSeries::new(series.points.iter().copied(), color.stroke_width(2));
            chart.draw_series(line)?;
            if series.marked {
                let marks = series.points.iter().map(|&point| Circle::new(point, 3, color.filled()));
                chart.draw_series(marks)?;
            }
        }
        Ok(())
    }
}

fn text(size: i32) -> TextStyle<'static> {
    ("sans-serif", size).into_font().color(&BLACK)
}

/// The nearest of 1, 2 and 5 times a power of ten at or beyond a value, upwards or downwards.
fn round_beyond(value: f64, up: bool) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * power);
    if up {
        steps.into_iter().find(|step| *step >= value).unwrap_or(value)
    } else {
        steps.into_iter().rfind(|step| *step <= value).unwrap_or(value)
    }
}

/// A tick's number as a short text.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if size >= 1e6 => format!("{}M", value / 1e6),
        size if size >= 1e4 => format!("{}k", (value / 100.0).round() / 10.0),
        size if size >= 1.0 => format!("{}", (value * 100.0).round() / 100.0),
        _ => format!("{}", (value * 1e6).round() / 1e6),
    }
}

/// The exponent `e` of the best fit `y = c x^e`, by least squares over logarithms.
#[must_use]
pub fn exponent(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len().max(1) as f64;
    let (mean_x, mean_y) = logs
        .iter()
        .fold((0.0, 0.0), |(sx, sy), (x, y)| (sx + x / count, sy + y / count));
    let (mut over, mut under) = (0.0, 0.0);
    for (x, y) in logs {
        over += (x - mean_x) * (y - mean_y);
        under += (x - mean_x) * (x - mean_x);
    }
    over / under
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponent_is_that_of_the_power() {
        let points = [1.0, 3.0, 10.0, 40.0].map(|x: f64| (x, 5.0 * x.powf(0.7)));
        assert!((exponent(&points) - 0.7).abs() < 1e-12);
    }
}
