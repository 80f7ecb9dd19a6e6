//! Bars beside names: numbers between -1 and 1, a panel for each of several things that they are about.

use super::axis::{Mark, Marks, Scale};
use super::chart::short;
use super::picture::{Align, FRAME, GREY_INK, INK, PALETTE, Picture, text_width};
use super::plot::{MARK_SIZE, Plot, TITLE_SIZE, marks_width};
use crate::io::file::IoError;
use std::path::Path;

/// Named numbers between -1 and 1, from above.
#[derive(Debug, Clone, Default)]
pub struct Bars {
    /// The line above them.
    pub title: String,
    /// A name and a number for each bar; one that is not finite has no bar.
    pub bars: Vec<(String, f64)>,
}

const WIDTH: f64 = 900.0;
/// Height of a bar with the gap around it, and of the bar [px].
const ROW: f64 = 22.0;
const BAR: f64 = 13.0;

/// Writes panels of bars below each other, over one axis from -1 to 1 with a label, to `stem.png` and `stem.svg`.
///
/// # Errors
/// A file that cannot be written.
pub fn write_bars(panels: &[Bars], label: &str, stem: &Path) -> Result<(), IoError> {
    drawn(panels, label).write(stem)
}

fn drawn(panels: &[Bars], label: &str) -> Picture {
    // numbers stand beside the ends of bars
    let x = Scale { lo: -1.15, hi: 1.15, log: false };
    let x_marks = x.marks(9);
    let named = |bars: &Bars| -> Marks {
        let mark = |(place, (name, _)): (usize, &(String, f64))| Mark { value: place as f64, label: short(name) };
        Marks { list: bars.bars.iter().enumerate().map(mark).collect(), factor: String::new() }
    };
    let names: Vec<Marks> = panels.iter().map(named).collect();
    let left = 24.0 + names.iter().map(marks_width).fold(0.0, f64::max);
    let mut plots = Vec::new();
    let mut top = 8.0;
    for panel in panels {
        top += 32.0;
        let rows = panel.bars.len().max(1) as f64;
        // the first one is above
        let y = Scale { lo: rows - 0.5, hi: -0.5, log: false };
        plots.push(Plot { left, right: WIDTH - 30.0, top, bottom: top + rows * ROW, x, y });
        top += rows * ROW + 4.0;
    }
    let mut picture = Picture::new(WIDTH, (top + 60.0).ceil());
    for ((panel, plot), names) in panels.iter().zip(&plots).zip(&names) {
        plot.draw_grid(&mut picture, &x_marks, names);
        picture.text([left, plot.top - 10.0], &panel.title, TITLE_SIZE, INK, Align::Left);
        panel.bars.iter().enumerate().for_each(|(place, (_, value))| draw_bar(&mut picture, plot, place, *value));
        let zero = plot.place((0.0, 0.0))[0];
        picture.line(vec![[zero, plot.top], [zero, plot.bottom]], 1.0, FRAME);
        plot.draw_border(&mut picture);
    }
    if let Some(plot) = plots.last() {
        plot.draw_x_labels(&mut picture, label, &x_marks);
    }
    picture
}

/// One bar with its number beside its end.
fn draw_bar(picture: &mut Picture, plot: &Plot, place: usize, value: f64) {
    if !value.is_finite() {
        return;
    }
    let [zero, y] = plot.place((0.0, place as f64));
    let end = plot.place((value, 0.0))[0];
    let colour = PALETTE[usize::from(value < 0.0)];
    picture.block([zero.min(end), y - 0.5 * BAR], [zero.max(end), y + 0.5 * BAR], colour);
    let text = format!("{value:.2}").replace('-', "\u{2212}");
    let gap = if value < 0.0 { -5.0 - text_width(&text, MARK_SIZE) } else { 5.0 };
    picture.text([end + gap, y + 0.36 * MARK_SIZE], &text, MARK_SIZE, GREY_INK, Align::Left);
}

#[cfg(test)]
mod tests {
    use super::super::picture::Shape;
    use super::*;

    #[test]
    fn a_bar_reaches_from_zero_as_far_as_its_number_says() {
        let bars = [("up", 0.5), ("none", f64::NAN), ("down", -1.0)].map(|(name, value)| (name.to_string(), value)).to_vec();
        let picture = drawn(&[Bars { title: "response".into(), bars }], "correlation");
        let widths: Vec<f64> = picture
            .shapes
            .iter()
            .filter_map(
                |shape| if let Shape::Area { points, .. } = shape { Some(points[1][0] - points[0][0]) } else { None },
            )
            .collect();
        assert!(widths.len() == 2 && (widths[1] - 2.0 * widths[0]).abs() < 1e-9, "{widths:?}");
        let said =
            |wanted: &str| picture.shapes.iter().any(|shape| matches!(shape, Shape::Text { text, .. } if text == wanted));
        assert!(["up", "none", "down", "0.50", "\u{2212}1.00", "response", "correlation"].into_iter().all(said));
    }
}
