//! Charts as SVG: curves and points over one axis, alone or above each other, and bars beside names. Letters are those of whoever shows
//! them: labels have room by their number of letters.

use super::file::{IoError, write_file};
use super::xml::xml_text;
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

/// Named numbers between -1 and 1, from above.
#[derive(Debug, Clone, Default)]
pub struct Bars {
    /// The line above them.
    pub title: String,
    /// A name and a number for each bar; one that is not finite has no bar.
    pub bars: Vec<(String, f64)>,
}

/// Writes charts above each other over one x axis, which takes its range from all and its label from the last one that has any.
///
/// # Errors
/// A file that cannot be written.
pub fn write_charts(charts: &[Chart], path: &Path) -> Result<(), IoError> {
    write_file(path, svg_of_charts(charts).as_bytes())
}

/// Writes panels of bars below each other, over one axis from -1 to 1 with a label.
///
/// # Errors
/// A file that cannot be written.
pub fn write_bars(panels: &[Bars], label: &str, path: &Path) -> Result<(), IoError> {
    write_file(path, svg_of_bars(panels, label).as_bytes())
}

/// Width of a picture, and its plots from left to right [px].
const WIDTH: f64 = 900.0;
const LEFT: f64 = 100.0;
const RIGHT: f64 = 870.0;
/// Room for a letter of a label [px].
const LETTER: f64 = 7.5;
/// Height of a line of a legend, and of a bar with the gap around it [px].
const ROW: f64 = 20.0;
/// Most letters of a name.
const LETTERS: usize = 40;

const INK: &str = "#262a30";
const FRAME: &str = "stroke=\"#969ca4\"";
const GRID: &str = "stroke=\"#e4e7eb\"";
/// Okabe and Ito's colours, distinct for all common kinds of colour vision, without yellow (too faint for a thin line).
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#3c3c3c"];

fn svg_of_charts(charts: &[Chart]) -> String {
    let height = if charts.len() > 1 { 190.0 } else { 400.0 };
    let log_x = charts.iter().any(|chart| chart.log_x);
    let points = charts.iter().flat_map(|chart| &chart.series).flat_map(|series| &series.points);
    let x = Axis::around(points.map(|point| point.0), log_x, [LEFT, RIGHT]);
    let (mut svg, mut top) = (Svg::default(), 10.0);
    for chart in charts {
        if !chart.title.is_empty() {
            top += 24.0;
            svg.text([LEFT, top - 8.0], "start", 16.0, &chart.title);
        }
        top = svg.legend(chart, top);
        let shown = chart.series.iter().flat_map(|series| &series.points).filter(|point| has_place(point.0, log_x));
        let y = Axis::around(shown.map(|point| point.1), chart.log_y, [top + height, top]);
        svg.grid([&x, &y]);
        svg.numbers(&y, LEFT - 8.0);
        svg.upward([20.0, top + 0.5 * height], &chart.y_label);
        chart.series.iter().enumerate().for_each(|(index, series)| svg.series(series, index, [&x, &y]));
        top += height + 16.0;
    }
    let label = charts.iter().rev().map(|chart| chart.x_label.as_str()).find(|label| !label.is_empty());
    svg.ended(&x, label.unwrap_or_default(), top)
}

fn svg_of_bars(panels: &[Bars], label: &str) -> String {
    let letters = panels.iter().flat_map(|panel| &panel.bars).map(|bar| short(&bar.0).chars().count()).max().unwrap_or(0);
    let left = 24.0 + LETTER * letters as f64;
    let x = Axis { ends: [-1.15, 1.15], log: false, places: [left, RIGHT] };
    let (mut svg, mut top) = (Svg::default(), 10.0);
    for Bars { title, bars } in panels {
        top += 24.0;
        svg.text([left, top - 8.0], "start", 16.0, title);
        let height = ROW * bars.len().max(1) as f64;
        svg.grid([&x, &Axis { ends: [0.0; 2], log: false, places: [top + height, top] }]);
        for (row, (name, value)) in bars.iter().enumerate() {
            let middle = top + ROW * (row as f64 + 0.5);
            svg.text([left - 8.0, middle + 4.5], "end", 13.0, &short(name));
            if value.is_finite() {
                let (zero, end, is_below) = (x.place(0.0), x.place(*value), *value < 0.0);
                let (from, width, colour) = (fine(zero.min(end)), fine((end - zero).abs()), COLOURS[usize::from(is_below)]);
                let y = fine(middle - 6.0);
                svg.0 += &format!("<rect x=\"{from}\" y=\"{y}\" width=\"{width}\" height=\"12\" fill=\"{colour}\"/>\n");
                let (gap, anchor) = if is_below { (-5.0, "end") } else { (5.0, "start") };
                svg.text([end + gap, middle + 4.5], anchor, 13.0, &format!("{value:.2}"));
            }
        }
        svg.line(&[[x.place(0.0), top], [x.place(0.0), top + height]], FRAME);
        top += height + 12.0;
    }
    svg.ended(&x, label, top)
}

/// An axis between two places of the picture \[px\], linear or by the decimal logarithm.
struct Axis {
    /// Values at its ends; their decimal logarithms where it is logarithmic.
    ends: [f64; 2],
    log: bool,
    places: [f64; 2],
}

/// Whether a value has a place on an axis: finite, not absurdly large, and positive where it is logarithmic.
fn has_place(value: f64, log: bool) -> bool {
    value.abs() <= 1e300 && (!log || value >= 1e-300)
}

impl Axis {
    /// Around all values that have a place, with some room; 0 to 1 (1 to 10) where there is none.
    fn around(values: impl Iterator<Item = f64>, log: bool, places: [f64; 2]) -> Self {
        let scaled = values.filter(|&value| has_place(value, log)).map(|value| if log { value.log10() } else { value });
        let (least, most) = scaled.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), value| (a.min(value), b.max(value)));
        if least > most {
            return Axis { ends: [0.0, 1.0], log, places };
        }
        let size = least.abs().max(most.abs());
        // below this width numbers beside each other are not distinct: constant but for round-off
        let is_constant = most - least <= if log { 1e-9 } else { costate::program::tolerances::LONG_SUM * size };
        let room = match is_constant {
            true if log || size == 0.0 => 0.5,
            true => 0.05 * size,
            false => 0.03 * (most - least),
        };
        Axis { ends: [least - room, most + room], log, places }
    }

    /// Where a value lies.
    fn place(&self, value: f64) -> f64 {
        self.between(if self.log { value.log10() } else { value })
    }

    fn between(&self, scaled: f64) -> f64 {
        let ([least, most], [from, to]) = (self.ends, self.places);
        from + (scaled - least) / (most - least) * (to - from)
    }

    /// Places of round numbers and these numbers.
    fn marks(&self) -> Vec<(f64, String)> {
        let [least, most] = self.ends;
        let [from, to] = self.places;
        // numbers stand beside each other, or above
        let count = if from < to { (to - from) / 90.0 } else { (from - to) / 40.0 }.round();
        if self.log && most - least >= 2.0 {
            let stride = ((most - least) / (count + 2.0)).ceil() as i32;
            let decades = (least.ceil() as i32..=most.floor() as i32).filter(|decade| decade.rem_euclid(stride) == 0);
            return decades.map(|decade| (self.between(f64::from(decade)), format!("1e{decade}"))).collect();
        }
        let [least, most] = if self.log { [10f64.powf(least), 10f64.powf(most)] } else { [least, most] };
        let raw = (most - least) / count;
        let power = 10f64.powi(raw.log10().floor() as i32);
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|own| own * power).find(|step| *step >= raw).unwrap_or(raw);
        let numbers = (0..).map(|k| ((least / step).ceil() + f64::from(k)) * step).take_while(|number| *number <= most);
        let size = least.abs().max(most.abs());
        numbers.map(|number| (self.place(number), digits(number, step, size))).collect()
    }
}

/// A number among others up to a size in as many digits as show a step.
fn digits(number: f64, step: f64, size: f64) -> String {
    if number.abs() < 0.5 * step {
        return "0".into();
    }
    if (1e-3..1e5).contains(&size) {
        return format!("{number:.*}", (-step.log10() - 1e-9).ceil().max(0.0) as usize);
    }
    let figures = number.abs().log10().floor() - (step.log10() + 1e-9).floor();
    format!("{number:.*e}", figures.max(0.0) as usize)
}

/// A name of at most [`LETTERS`] letters.
fn short(name: &str) -> String {
    if name.chars().count() <= LETTERS { name.into() } else { name.chars().take(LETTERS - 1).chain(['…']).collect() }
}

/// Rounded to a tenth of a pixel.
fn fine(length: f64) -> f64 {
    (10.0 * length).round() / 10.0
}

/// Elements of a picture, later ones on top.
#[derive(Default)]
struct Svg(String);

impl Svg {
    fn text(&mut self, [x, y]: [f64; 2], anchor: &str, size: f64, text: &str) {
        let (x, y, text) = (fine(x), fine(y), xml_text(text));
        self.0 += &format!("<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\">{text}</text>\n");
    }

    /// A text that is read from below.
    fn upward(&mut self, [x, y]: [f64; 2], text: &str) {
        let (turn, text) = (format!("translate({x} {}) rotate(-90)", fine(y)), xml_text(text));
        self.0 += &format!("<text transform=\"{turn}\" text-anchor=\"middle\" font-size=\"14\">{text}</text>\n");
    }

    fn line(&mut self, points: &[[f64; 2]], stroke: &str) {
        let places: Vec<String> = points.iter().map(|[x, y]| format!("{},{}", fine(*x), fine(*y))).collect();
        self.0 += &format!("<polyline points=\"{}\" fill=\"none\" {stroke}/>\n", places.join(" "));
    }

    /// A sign of a series: disc, square, triangle and diamond in turn.
    fn sign(&mut self, [x, y]: [f64; 2], index: usize) {
        let corners = match index % 4 {
            0 => "-3.9,0a3.9,3.9 0 1 0 7.8,0a3.9,3.9 0 1 0 -7.8,0",
            1 => "-3.5,-3.5h7v7h-7",
            2 => "0,-4.8l4.6,8.2h-9.2",
            _ => "0,-5.2l5.2,5.2l-5.2,5.2l-5.2,-5.2",
        };
        let (x, y, colour) = (fine(x), fine(y), COLOURS[index % COLOURS.len()]);
        self.0 += &format!("<path transform=\"translate({x} {y})\" d=\"m{corners}z\" fill=\"{colour}\"/>\n");
    }

    /// A curve of a series, dashed where the colours begin again.
    fn curve(&mut self, points: &[[f64; 2]], index: usize) {
        let dashes = if index < COLOURS.len() { "" } else { " stroke-dasharray=\"7 4\"" };
        self.line(points, &format!("stroke=\"{}\" stroke-width=\"1.8\"{dashes}", COLOURS[index % COLOURS.len()]));
    }

    fn series(&mut self, series: &Series, index: usize, [x, y]: [&Axis; 2]) {
        let is_shown = |point: &(f64, f64)| has_place(point.0, x.log) && has_place(point.1, y.log);
        for piece in series.points.split(|point| !is_shown(point)).filter(|piece| !piece.is_empty()) {
            let mut places: Vec<[f64; 2]> = piece.iter().map(|&(a, b)| [x.place(a), y.place(b)]).collect();
            if series.style != Style::Markers {
                // what moves by less than half a pixel is not seen
                places.dedup_by_key(|place| place.map(|length| (2.0 * length).round() as i64));
                // a point alone is a line of no length, with round ends
                let only = if let [only] = places[..] { Some(only) } else { None };
                self.curve(&places.iter().copied().chain(only).collect::<Vec<_>>(), index);
            }
            if series.style != Style::Line {
                let mut seen = HashSet::new();
                places.retain(|place| seen.insert(place.map(|length| length.round() as i64)));
                places.into_iter().for_each(|place| self.sign(place, index));
            }
        }
    }

    /// Names of the series in columns; returns where they end.
    fn legend(&mut self, chart: &Chart, top: f64) -> f64 {
        let named: Vec<(usize, &Series)> = chart.series.iter().enumerate().filter(|own| !own.1.name.is_empty()).collect();
        let Some(letters) = named.iter().map(|own| short(&own.1.name).chars().count()).max() else { return top };
        let width = 56.0 + LETTER * letters as f64;
        let columns = ((RIGHT - LEFT) / width).floor().max(1.0) as usize;
        for (place, (index, series)) in named.iter().enumerate() {
            let (left, y) = (LEFT + (place % columns) as f64 * width, top + ((place / columns) as f64 + 0.5) * ROW);
            if series.style != Style::Markers {
                self.curve(&[[left, y], [left + 28.0, y]], *index);
            }
            if series.style != Style::Line {
                self.sign([left + 14.0, y], *index);
            }
            self.text([left + 34.0, y + 4.5], "start", 13.0, &short(&series.name));
        }
        top + named.len().div_ceil(columns) as f64 * ROW + 6.0
    }

    /// The frame of a plot with lines at the marks of its axes.
    fn grid(&mut self, [x, y]: [&Axis; 2]) {
        let ([left, right], [bottom, top]) = (x.places, y.places);
        x.marks().iter().for_each(|(at, _)| self.line(&[[*at, top], [*at, bottom]], GRID));
        if y.ends[0] < y.ends[1] {
            y.marks().iter().for_each(|(at, _)| self.line(&[[left, *at], [right, *at]], GRID));
        }
        self.line(&[[left, top], [right, top], [right, bottom], [left, bottom], [left, top]], FRAME);
    }

    /// Numbers at the left of a plot.
    fn numbers(&mut self, y: &Axis, right: f64) {
        y.marks().iter().for_each(|(at, number)| self.text([right, at + 4.5], "end", 13.0, number));
    }

    /// The whole picture, with the numbers of the x axis and its label at last.
    fn ended(mut self, x: &Axis, label: &str, top: f64) -> String {
        x.marks().iter().for_each(|(at, number)| self.text([*at, top + 4.0], "middle", 13.0, number));
        self.text([0.5 * (x.places[0] + x.places[1]), top + 28.0], "middle", 14.0, label);
        let height = (top + 40.0).ceil();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
             font-family=\"sans-serif\" fill=\"{INK}\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{}</svg>\n",
            self.0
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(points: Vec<(f64, f64)>, style: Style) -> Chart {
        let [title, x_label, y_label] = ["Tip <a>", "time [s]", "deflection [m]"].map(String::from);
        let series = vec![Series { name: "measured".into(), points, style }];
        Chart { title, x_label, y_label, series, ..Chart::default() }
    }

    fn marks(least: f64, most: f64, log: bool) -> Vec<String> {
        let axis = Axis::around([least, most].into_iter(), log, [400.0, 0.0]);
        axis.marks().into_iter().map(|mark| mark.1).collect()
    }

    #[test]
    fn charts_above_each_other_share_their_axis() {
        let both = [chart(vec![(0.0, 1.0), (2.0, 3.0)], Style::Both), chart(vec![(0.0, 1e-9), (1.0, 5e-9)], Style::Line)];
        let svg = svg_of_charts(&both);
        assert!(roxmltree::Document::parse(&svg).is_ok(), "{svg}");
        assert_eq!([svg.matches("time [s]").count(), svg.matches("deflection [m]").count()], [1, 2]);
        assert!(svg.contains("Tip &lt;a&gt;") && svg.contains("measured") && svg.contains(">4e-9<"), "{svg}");
    }

    #[test]
    fn marks_are_round_numbers_that_can_be_told_apart() {
        assert_eq!(marks(0.0, 5.0, false), ["0", "1", "2", "3", "4", "5"]);
        assert_eq!(marks(1e-3, 1e3, true), ["1e-3", "1e-2", "1e-1", "1e0", "1e1", "1e2", "1e3"]);
        let ends = [0.0, 1e-299, 1e-9, 1.0, 1.0 + 1e-9, 123456.7, 1e9, 1e299, -1.0, -1e-9, f64::NAN, f64::INFINITY];
        for (least, most) in ends.iter().flat_map(|a| ends.iter().map(move |b| (*a, *b))) {
            for log in [false, true] {
                let list = marks(least, most, log);
                let distinct: HashSet<&String> = list.iter().collect();
                assert!((2..=14).contains(&list.len()) && distinct.len() == list.len(), "{least} {most} {log}: {list:?}");
            }
        }
    }

    #[test]
    fn points_without_a_place_interrupt_the_line_and_odd_data_still_give_a_chart() {
        let points = vec![(0.0, 1.0), (1.0, 2.0), (2.0, f64::NAN), (3.0, 4.0), (5.0, -1.0), (6.0, 2.0), (6.0, 3.0)];
        let lines = |chart: Chart| svg_of_charts(&[chart]).matches("stroke-width=\"1.8\"").count();
        let plain = chart(points, Style::Line);
        // one of them in the legend
        assert_eq!(lines(Chart { log_y: true, ..plain.clone() }), 1 + 3);
        assert_eq!(lines(plain), 1 + 2);
        for points in
            [vec![], vec![(f64::NAN, 1.0), (0.0, f64::INFINITY)], vec![(1.0, 2.0)], vec![(-1e299, -1e300), (1e299, 1e300)]]
        {
            for style in [Style::Line, Style::Markers] {
                let svg =
                    svg_of_charts(&[Chart { log_x: true, ..chart(points.clone(), style) }, chart(points.clone(), style)]);
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            }
        }
    }

    #[test]
    fn a_bar_reaches_from_zero_as_far_as_its_number_says() {
        let bars = [("up", 0.5), ("none", f64::NAN), ("down", -1.0)].map(|(name, value)| (name.to_string(), value)).to_vec();
        let svg = svg_of_bars(&[Bars { title: "response".into(), bars }], "correlation");
        let document = roxmltree::Document::parse(&svg).unwrap();
        let boxes = document.descendants().filter(|node| node.attribute("height") == Some("12"));
        let widths: Vec<f64> = boxes.map(|node| node.attribute("width").unwrap().parse().unwrap()).collect();
        assert!(widths.len() == 2 && (widths[1] - 2.0 * widths[0]).abs() < 0.2, "{widths:?}");
        assert!(["up", "none", "down", "0.50", "-1.00", "response", "correlation"].iter().all(|word| svg.contains(word)));
    }
}
