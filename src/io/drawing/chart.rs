//! Charts: curves over one axis, alone or stacked.

use super::axis::{Marks, Scale, drawable};
use super::picture::{Align, Colour, GRID, INK, PALETTE, Picture, Place, WHITE_PAPER, text_width};
use super::plot::{Plot, TITLE_SIZE, marks_width};
use crate::io::file::IoError;
use std::collections::HashSet;
use std::path::Path;

/// How a [`Series`] is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A curve through the points.
    #[default]
    Line,
    /// A sign at every point.
    Markers,
    /// A curve and a sign at every point.
    Both,
}

/// A named list of points.
///
/// A point that is not finite, or not positive on a logarithmic axis, is left out and interrupts the line.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// The name in the legend; an empty name is not listed.
    pub name: String,
    /// Pairs (x, y) in the units of the axis labels.
    pub points: Vec<(f64, f64)>,
    /// Line, markers or both.
    pub style: Style,
}

/// A chart of one or more series; labels carry their units, as in `time [s]`.
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// The line above the chart; may be empty.
    pub title: String,
    /// What runs to the right, with its unit.
    pub x_label: String,
    /// What runs upwards, with its unit.
    pub y_label: String,
    /// The curves, first one at the bottom.
    pub series: Vec<Series>,
    /// Logarithmic x axis.
    pub log_x: bool,
    /// Logarithmic y axis.
    pub log_y: bool,
}

impl Chart {
    /// Writes the chart to `stem.png` (twice the size, for dense screens) and `stem.svg`, creating missing folders.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, stem: &Path) -> Result<(), IoError> {
        stacked(std::slice::from_ref(self), 400.0).write(stem)
    }
}

/// Writes several charts above each other, over one x axis, to `stem.png` and `stem.svg`.
///
/// The axis takes its range from all charts and its label from the last one that has any.
///
/// # Errors
/// No chart, charts that differ in `log_x`, or a file that cannot be written.
pub fn write_panels(charts: &[Chart], stem: &Path) -> Result<(), IoError> {
    let Some(first) = charts.first() else {
        return Err(IoError::new(stem, "there is no chart to stack"));
    };
    if let Some(other) = charts.iter().position(|chart| chart.log_x != first.log_x) {
        let cause = format!(
            "stacked charts share the x axis, but log_x is {} in chart 0 and {} in chart {other}",
            first.log_x, !first.log_x
        );
        return Err(IoError::new(stem, cause));
    }
    stacked(charts, 190.0).write(stem)
}

const WIDTH: f64 = 900.0;
const LEGEND_SIZE: f64 = 13.0;
const LEGEND_LINE: f64 = 20.0;

/// Where a chart of a stack stands, and its legend: in a corner of the plot that is free, else in columns above the plot.
struct Panel<'c> {
    chart: &'c Chart,
    plot: Plot,
    y_marks: Marks,
    legend: Legend,
    /// Height of the line of the title.
    title_at: f64,
}

/// Panels from above: title, legend that found no free corner, factor of the numbers, plot. Returns them with the lower end of the last.
fn panels(charts: &[Chart], x: Scale, plot_height: f64) -> (Vec<Panel<'_>>, f64) {
    let scale = |chart: &Chart| {
        let values = chart.series.iter().flat_map(|series| &series.points).filter(|point| drawable(point.0, x.log));
        let y = Scale::around(values.map(|point| point.1), chart.log_y, 0.05);
        (y, y.marks((plot_height / 40.0 + 2.0).round() as usize))
    };
    let scales: Vec<(Scale, Marks)> = charts.iter().map(scale).collect();
    let left = 46.0 + scales.iter().map(|(_, marks)| marks_width(marks)).fold(0.0, f64::max);
    let mut top = 8.0;
    let mut panels = Vec::new();
    for (chart, (y, y_marks)) in charts.iter().zip(scales) {
        top += if chart.title.is_empty() { 12.0 } else { 32.0 };
        let title_at = top - 10.0;
        let mut plot = Plot { left, right: WIDTH - 30.0, top, bottom: top + plot_height, x, y };
        let legend = Legend::of(chart, &plot);
        if let Legend::Above { rows, .. } = legend {
            top += rows as f64 * LEGEND_LINE + 8.0;
        }
        top += if y_marks.factor.is_empty() { 0.0 } else { 20.0 };
        (plot.top, plot.bottom) = (top, top + plot_height);
        // a free corner moves along with its plot
        let legend = legend.moved(top - title_at - 10.0);
        panels.push(Panel { chart, plot, y_marks, legend, title_at });
        top += plot_height + 4.0;
    }
    (panels, top)
}

fn stacked(charts: &[Chart], plot_height: f64) -> Picture {
    let points = || charts.iter().flat_map(|chart| &chart.series).flat_map(|series| &series.points);
    let log_x = charts.iter().any(|chart| chart.log_x);
    let markers = charts.iter().flat_map(|chart| &chart.series).any(|series| series.style != Style::Line);
    let x = Scale::around(points().map(|point| point.0), log_x, if markers { 0.03 } else { 0.0 });
    let x_marks = x.marks(9);
    let (panels, end) = panels(charts, x, plot_height);
    let labelled = charts.iter().rev().find(|chart| !chart.x_label.is_empty());
    let x_label = labelled.map_or("", |chart| &chart.x_label);
    let below = if x_label.is_empty() && x_marks.factor.is_empty() { 32.0 } else { 60.0 };

    let mut picture = Picture::new(WIDTH, (end + below).ceil());
    for Panel { chart, plot, y_marks, legend, title_at } in &panels {
        plot.draw_grid(&mut picture, &x_marks, y_marks);
        picture.text([plot.left, *title_at], &chart.title, TITLE_SIZE, INK, Align::Left);
        plot.draw_y_label(&mut picture, &chart.y_label);
        for (index, series) in chart.series.iter().enumerate() {
            draw_series(&mut picture, plot, series, index);
        }
        plot.draw_border(&mut picture);
        legend.draw(&mut picture, chart, plot, *title_at);
    }
    if let Some(Panel { plot, .. }) = panels.last() {
        plot.draw_x_labels(&mut picture, x_label, &x_marks);
    }
    picture
}

/// The unbroken pieces of a series in the picture, thinned to what can be seen.
fn pieces(plot: &Plot, series: &Series) -> Vec<Vec<Place>> {
    series
        .points
        .split(|&(x, y)| !drawable(x, plot.x.log) || !drawable(y, plot.y.log))
        .filter(|piece| !piece.is_empty())
        .map(|piece| {
            let places = piece.iter().map(|&point| plot.place(point));
            if series.style == Style::Markers { scattered(places) } else { thinned(places) }
        })
        .collect()
}

/// Of points without a line between them one for each pixel: more signs there look the same.
fn scattered(points: impl Iterator<Item = Place>) -> Vec<Place> {
    let mut taken = HashSet::new();
    points.filter(|at| taken.insert(at.map(|length| length.round() as i64))).collect()
}

/// Of all consecutive points within a quarter pixel in x only the first, lowest, highest and last.
fn thinned(points: impl Iterator<Item = Place>) -> Vec<Place> {
    let column = |point: &Place| (4.0 * point[0]).floor();
    let mut kept: Vec<Place> = Vec::new();
    let mut group: Vec<Place> = Vec::new();
    let mut close = |group: &mut Vec<Place>| {
        let height = |index: &usize| group[*index][1];
        let lowest = (0..group.len()).min_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(0);
        let highest = (0..group.len()).max_by(|a, b| height(a).total_cmp(&height(b))).unwrap_or(0);
        let mut chosen = [0, lowest, highest, group.len().saturating_sub(1)];
        chosen.sort_unstable();
        let mut last = None;
        for index in chosen {
            if last != Some(index) && !group.is_empty() {
                kept.push(group[index]);
            }
            last = Some(index);
        }
        group.clear();
    };
    for point in points {
        if group.first().is_some_and(|first| column(first) != column(&point)) {
            close(&mut group);
        }
        group.push(point);
    }
    close(&mut group);
    kept
}

fn colour_of(index: usize) -> Colour {
    PALETTE[index % PALETTE.len()]
}

fn draw_series(picture: &mut Picture, plot: &Plot, series: &Series, index: usize) {
    for piece in pieces(plot, series) {
        if series.style != Style::Markers {
            draw_stroke(picture, piece.clone(), index);
        }
        if series.style != Style::Line {
            for &at in &piece {
                draw_marker(picture, at, index);
            }
        }
    }
}

/// A line in the colour of the series; dashed where the palette starts again.
fn draw_stroke(picture: &mut Picture, points: Vec<Place>, index: usize) {
    if index < PALETTE.len() {
        picture.line(points, 1.8, colour_of(index));
    } else {
        for dash in dashes(&points, 7.0, 4.0) {
            picture.line(dash, 1.8, colour_of(index));
        }
    }
}

fn dashes(points: &[Place], on: f64, off: f64) -> Vec<Vec<Place>> {
    let mut dashes = Vec::new();
    let mut dash: Vec<Place> = points.first().copied().into_iter().collect();
    let (mut drawing, mut left) = (true, on);
    for pair in points.windows(2) {
        let [mut from, to] = [pair[0], pair[1]];
        loop {
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            if length < left {
                left -= length;
                break;
            }
            let part = left / length.max(f64::MIN_POSITIVE);
            from = [from[0] + part * (to[0] - from[0]), from[1] + part * (to[1] - from[1])];
            dash.push(from);
            if drawing {
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![from];
            }
            drawing = !drawing;
            left = if drawing { on } else { off };
        }
        if drawing {
            dash.push(to);
        }
    }
    if drawing && dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

/// Disc, square, triangle, diamond in turn, so that series differ without colour too.
fn draw_marker(picture: &mut Picture, [x, y]: Place, index: usize) {
    let colour = colour_of(index);
    match index % 4 {
        0 => picture.disc([x, y], 4.0, colour),
        1 => picture.block([x - 3.6, y - 3.6], [x + 3.6, y + 3.6], colour),
        2 => picture.area(vec![[x, y - 4.8], [x + 4.6, y + 3.4], [x - 4.6, y + 3.4]], colour),
        _ => picture.area(vec![[x, y - 5.2], [x + 5.2, y], [x, y + 5.2], [x - 5.2, y]], colour),
    }
}

/// The listed series with their place in the palette.
fn listed(chart: &Chart) -> impl Iterator<Item = (usize, &Series)> {
    chart.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty())
}

/// At most 40 letters of a name.
pub(super) fn short(name: &str) -> String {
    if name.chars().count() <= 40 { name.to_owned() } else { name.chars().take(39).chain(['…']).collect() }
}

fn legend_size(chart: &Chart) -> [f64; 2] {
    let widest = listed(chart).map(|(_, series)| text_width(&short(&series.name), LEGEND_SIZE)).fold(0.0, f64::max);
    let lines = listed(chart).count() as f64;
    if lines == 0.0 { [0.0, 0.0] } else { [widest + 56.0, lines * LEGEND_LINE + 10.0] }
}

/// The upper left corner of a legend that hides no curve, if there is such a place in a corner of the plot.
fn free_corner(chart: &Chart, plot: &Plot) -> Option<Place> {
    const GAP: f64 = 10.0;
    let [width, height] = legend_size(chart);
    let (left, right) = (plot.left + GAP, plot.right - GAP - width);
    let (top, bottom) = (plot.top + GAP, plot.bottom - GAP - height);
    if left > right || top > bottom {
        return None;
    }
    let curves: Vec<_> = chart.series.iter().flat_map(|series| pieces(plot, series)).collect();
    [[right, top], [left, top], [right, bottom], [left, bottom]].into_iter().find(|&[x, y]| {
        let hidden = |[px, py]: Place| px > x - 6.0 && px < x + width + 6.0 && py > y - 6.0 && py < y + height + 6.0;
        !curves.iter().any(|curve| curve.iter().any(|&at| hidden(at)) || curve.windows(2).any(|pair| crosses(pair, hidden)))
    })
}

/// Whether the straight line between two points meets a region, looked at every three pixels.
fn crosses(pair: &[Place], hidden: impl Fn(Place) -> bool) -> bool {
    let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
    let steps = ((x1 - x0).hypot(y1 - y0) / 3.0).ceil().max(1.0);
    (1..steps as usize).map(|step| step as f64 / steps).any(|part| hidden([x0 + part * (x1 - x0), y0 + part * (y1 - y0)]))
}

/// How the names of the series are listed.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Legend {
    None,
    /// Below each other in a free corner of the plot, from this place on.
    Inside(Place),
    /// Side by side above the plot.
    Above {
        columns: usize,
        rows: usize,
    },
}

impl Legend {
    fn of(chart: &Chart, plot: &Plot) -> Self {
        let count = listed(chart).count();
        if count == 0 {
            return Legend::None;
        }
        free_corner(chart, plot).map_or_else(
            || {
                let columns = ((plot.right - plot.left) / legend_size(chart)[0]).floor().max(1.0) as usize;
                let rows = count.div_ceil(columns);
                // as many in each row, but for the last
                Legend::Above { columns: count.div_ceil(rows), rows }
            },
            Legend::Inside,
        )
    }

    /// The same for a plot that stands lower.
    fn moved(self, by: f64) -> Self {
        if let Legend::Inside([x, y]) = self { Legend::Inside([x, y + by]) } else { self }
    }

    fn draw(self, picture: &mut Picture, chart: &Chart, plot: &Plot, title_at: f64) {
        let [width, height] = legend_size(chart);
        let ([left, top], columns) = match self {
            Legend::None => return,
            Legend::Inside([left, top]) => {
                picture.block([left, top], [left + width, top + height], WHITE_PAPER);
                picture.outline([left, top], [left + width, top + height], 1.0, GRID);
                ([left, top + 5.0], 1)
            }
            Legend::Above { columns, .. } => ([plot.left - 10.0, title_at + 8.0], columns),
        };
        for (place, (index, series)) in listed(chart).enumerate() {
            let (left, y) = (left + (place % columns) as f64 * width, top + ((place / columns) as f64 + 0.5) * LEGEND_LINE);
            if series.style != Style::Markers {
                draw_stroke(picture, vec![[left + 10.0, y], [left + 38.0, y]], index);
            }
            if series.style != Style::Line {
                draw_marker(picture, [left + 24.0, y], index);
            }
            picture.text([left + 46.0, y + 0.36 * LEGEND_SIZE], &short(&series.name), LEGEND_SIZE, INK, Align::Left);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::picture::tests::png_size;
    use super::*;
    use crate::io::file::tests::Folder;

    fn wave(name: &str, style: Style, scale: f64, phase: f64) -> Series {
        let count = if style == Style::Line { 400 } else { 25 };
        let points = (0..=count).map(|k| 10.0 * f64::from(k) / f64::from(count));
        Series {
            name: name.into(),
            style,
            points: points.map(|t| (t, scale * (t + phase).sin() * (-0.2 * t).exp())).collect(),
        }
    }

    #[test]
    fn signs_without_a_line_are_all_drawn_where_they_can_be_told_apart() {
        let points: Vec<(f64, f64)> = (0..9).map(|k| (1.0, f64::from(k))).collect();
        let scale = Scale { lo: 0.0, hi: 10.0, log: false };
        let plot = Plot { left: 0.0, right: 100.0, top: 0.0, bottom: 100.0, x: scale, y: scale };
        let drawn = |style| {
            let twice = [&points[..], &points].concat();
            pieces(&plot, &Series { name: String::new(), points: twice, style })[0].len()
        };
        assert_eq!(drawn(Style::Markers), 9);
        assert!(drawn(Style::Both) < 9, "a curve is thinned");
    }

    fn chart(series: Vec<Series>) -> Chart {
        let [title, x_label, y_label] = ["Tip of the beam", "time [s]", "deflection w [m]"].map(String::from);
        Chart { title, x_label, y_label, series, ..Chart::default() }
    }

    /// Set COSTATE_PICTURES to a folder to keep the pictures of these tests.
    fn keep(folder: &Folder) {
        if let Ok(kept) = std::env::var("COSTATE_PICTURES") {
            for name in folder.names() {
                std::fs::copy(folder.0.join(&name), Path::new(&kept).join(&name)).unwrap();
            }
        }
    }

    #[test]
    fn a_chart_is_written_twice_with_its_labels() {
        let folder = Folder::new("chart");
        let series = vec![
            wave("α-method", Style::Line, 2e-9, 0.0),
            wave("measured", Style::Markers, 2e-9, 0.3),
            wave("coarse", Style::Both, 6e-10, 1.0),
        ];
        chart(series).write(&folder.0.join("out/chart")).unwrap();
        assert_eq!(png_size(&folder.0.join("out/chart.png")).0, 1800);
        let svg = std::fs::read_to_string(folder.0.join("out/chart.svg")).unwrap();
        for label in ["Tip of the beam", "time [s]", "deflection w [m]", "α-method", "measured", "×10⁻⁹"] {
            assert!(svg.contains(label), "{label}");
        }
        keep(&Folder(folder.0.join("out")));
    }

    #[test]
    fn panels_share_the_x_axis() {
        let folder = Folder::new("panels");
        let mut energy = chart(vec![wave("kinetic", Style::Line, 4e7, 0.0), wave("elastic", Style::Line, 3e7, 1.5)]);
        energy.title = String::new();
        energy.y_label = "energy [J]".into();
        let mut residual = chart(vec![Series {
            name: "Newton".into(),
            points: (1..100).map(|k| (0.1 * f64::from(k), 10f64.powf(-0.1 * f64::from(k)))).collect(),
            style: Style::Line,
        }]);
        residual.log_y = true;
        residual.y_label = "residual [N]".into();
        residual.title = String::new();
        write_panels(&[chart(vec![wave("", Style::Line, 1.0, 0.0)]), energy, residual.clone()], &folder.0.join("panels"))
            .unwrap();
        let svg = std::fs::read_to_string(folder.0.join("panels.svg")).unwrap();
        assert_eq!(svg.matches("time [s]").count(), 1);
        assert!(svg.contains("×10⁶") && svg.contains("10⁻⁶"));
        keep(&folder);
        residual.log_x = true;
        let error = write_panels(&[chart(vec![]), residual], &folder.0.join("bad")).unwrap_err().to_string();
        assert!(error.contains("bad") && error.contains("log_x is false in chart 0 and true in chart 1"), "{error}");
        assert!(write_panels(&[], &folder.0.join("none")).is_err());
        assert_eq!(folder.names(), ["panels.png", "panels.svg"]);
    }

    #[test]
    fn points_without_a_place_interrupt_the_line() {
        let points = vec![
            (0.0, 1.0),
            (1.0, 2.0),
            (2.0, f64::NAN),
            (3.0, f64::INFINITY),
            (4.0, 1.0),
            (5.0, -1.0),
            (6.0, 2.0),
            (f64::NAN, 1.0),
            (6.0, 3.0),
        ];
        let series = Series { points, ..Series::default() };
        let x = Scale { lo: 0.0, hi: 6.0, log: false };
        let y = Scale { lo: 0.0, hi: 1.0, log: true };
        let plot = Plot { left: 0.0, right: 600.0, top: 0.0, bottom: 100.0, x, y };
        assert_eq!(pieces(&plot, &series).iter().map(Vec::len).collect::<Vec<_>>(), [2, 1, 1, 1]);
    }

    #[test]
    fn odd_data_still_give_a_chart() {
        let folder = Folder::new("odd");
        let with = |points: Vec<(f64, f64)>| chart(vec![Series { name: "s".into(), points, style: Style::Line }]);
        let cases = [
            chart(vec![]),
            with(vec![]),
            with(vec![(f64::NAN, 1.0), (0.0, f64::INFINITY)]),
            with(vec![(1.0, 2.0)]),
            with(vec![(0.0, 2.0), (1.0, 2.0)]),
            with(vec![(-1e299, -1e300), (1e299, 1e300)]),
            Chart { log_x: true, log_y: true, ..with(vec![(0.0, 1.0), (-1.0, 2.0)]) },
        ];
        for (index, case) in cases.iter().enumerate() {
            case.write(&folder.0.join(format!("odd{index}"))).unwrap();
        }
        assert_eq!(folder.names().len(), 2 * cases.len());
    }

    #[test]
    fn thinning_keeps_the_extremes_of_a_million_points() {
        let spike = |k: u32| if k == 777_777 { 1e3 } else { f64::from(k % 7) };
        let thin = thinned((0..1_000_000).map(|k| [f64::from(k) * 8e-4, spike(k)]));
        assert!(thin.len() < 13_000 && thin.iter().any(|point| point[1] == 1e3), "{}", thin.len());
        assert_eq!(thinned([[0.0, 0.0], [5.0, 1.0], [9.0, 2.0]].into_iter()).len(), 3);
    }

    #[test]
    fn a_legend_hides_no_curve() {
        let series: Vec<_> = (0..9).map(|k| wave(&format!("series {k}"), Style::Line, 1.0, 0.7 * f64::from(k))).collect();
        let crowded = chart(series);
        let folder = Folder::new("legend");
        crowded.write(&folder.0.join("crowded")).unwrap();
        keep(&folder);
        let x = Scale { lo: 0.0, hi: 1.0, log: false };
        let plot = Plot { left: 0.0, right: 800.0, top: 0.0, bottom: 400.0, x, y: x };
        let diagonal = chart(vec![Series { name: "d".into(), points: vec![(0.0, 0.0), (1.0, 1.0)], style: Style::Line }]);
        assert_eq!(free_corner(&diagonal, &plot).map(|[x, y]| [x < 400.0, y < 200.0]), Some([true, true]));
        let fence: Vec<_> = (0..=100).map(|k| (f64::from(k) / 100.0, f64::from(k % 2))).collect();
        let fenced = chart(vec![Series { name: "d".into(), points: fence, style: Style::Line }]);
        assert_eq!(free_corner(&fenced, &plot), None);
    }

    #[test]
    fn a_long_legend_takes_no_width_from_the_curves() {
        let name = |k: usize| format!("largest stress in the rear arm number {k}");
        let fence = |k: usize| (0..=100).map(|i| (f64::from(i) / 100.0, f64::from(i % 2) + 0.1 * k as f64)).collect();
        let series = (0..7).map(|k| Series { name: name(k), points: fence(k), style: Style::Line }).collect();
        let crowded = [chart(series), chart(vec![wave("alone", Style::Line, 1.0, 0.0)])];
        let x = Scale { lo: 0.0, hi: 1.0, log: false };
        let (panels, _) = panels(&crowded, x, 190.0);
        let Legend::Above { columns, rows } = panels[0].legend else { panic!("{:?}", panels[0].legend) };
        assert!(panels.iter().all(|panel| panel.plot.right == WIDTH - 30.0));
        assert!(columns >= 2 && columns * rows >= 7, "{columns} columns of {rows} rows");
        assert!(columns as f64 * legend_size(&crowded[0])[0] <= panels[0].plot.right - panels[0].plot.left);
        // title, rows and plot do not meet, and the next panel stands below
        assert!(panels[0].plot.top >= panels[0].title_at + rows as f64 * LEGEND_LINE + 8.0);
        assert!(panels[1].title_at > panels[0].plot.bottom);
    }
}
