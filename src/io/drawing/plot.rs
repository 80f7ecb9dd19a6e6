//! The frame of a plot: grid, ticks, numbers and labels.

use super::axis::{Marks, Scale};
use super::picture::{Align, FRAME, GREY_INK, GRID, INK, Picture, Place, text_width};

pub(super) const TITLE_SIZE: f64 = 17.0;
pub(super) const LABEL_SIZE: f64 = 14.0;
pub(super) const MARK_SIZE: f64 = 12.5;

/// A rectangle of the picture [px] and its axes.
#[derive(Debug, Clone)]
pub(super) struct Plot {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
    pub x: Scale,
    pub y: Scale,
}

impl Plot {
    /// Where the point (x, y) lies in the picture.
    pub fn place(&self, (x, y): (f64, f64)) -> Place {
        [self.left + self.x.at(x) * (self.right - self.left), self.bottom - self.y.at(y) * (self.bottom - self.top)]
    }

    /// Grid lines, ticks, the numbers at the left and the factor that they leave out.
    pub fn draw_grid(&self, picture: &mut Picture, x_marks: &Marks, y_marks: &Marks) {
        let weight = |label: &str| if label.is_empty() { [0.5, 3.0] } else { [1.0, 5.0] };
        for mark in &x_marks.list {
            let at = self.left + self.x.at(mark.value) * (self.right - self.left);
            let [width, tick] = weight(&mark.label);
            picture.line(vec![[at, self.top], [at, self.bottom]], width, GRID);
            picture.line(vec![[at, self.bottom], [at, self.bottom + tick]], 1.0, FRAME);
        }
        for mark in &y_marks.list {
            let at = self.bottom - self.y.at(mark.value) * (self.bottom - self.top);
            let [width, tick] = weight(&mark.label);
            picture.line(vec![[self.left, at], [self.right, at]], width, GRID);
            picture.line(vec![[self.left - tick, at], [self.left, at]], 1.0, FRAME);
            picture.text([self.left - 9.0, at + 0.36 * MARK_SIZE], &mark.label, MARK_SIZE, GREY_INK, Align::Right);
        }
        picture.text([self.left, self.top - 8.0], &y_marks.factor, MARK_SIZE, GREY_INK, Align::Left);
    }

    /// The border, over whatever was drawn to the edge.
    pub fn draw_border(&self, picture: &mut Picture) {
        picture.outline([self.left, self.top], [self.right, self.bottom], 1.0, FRAME);
    }

    /// The quantity that runs upwards.
    pub fn draw_y_label(&self, picture: &mut Picture, label: &str) {
        picture.upward_text([22.0, 0.5 * (self.top + self.bottom)], label, LABEL_SIZE, INK);
    }

    /// The numbers below the plot and the quantity that runs to the right.
    pub fn draw_x_labels(&self, picture: &mut Picture, label: &str, marks: &Marks) {
        for mark in marks.list.iter().filter(|mark| !mark.label.is_empty()) {
            let at = self.left + self.x.at(mark.value) * (self.right - self.left);
            picture.text([at, self.bottom + 20.0], &mark.label, MARK_SIZE, GREY_INK, Align::Centre);
        }
        let middle = 0.5 * (self.left + self.right);
        picture.text([middle, self.bottom + 45.0], label, LABEL_SIZE, INK, Align::Centre);
        picture.text([self.right, self.bottom + 43.0], &marks.factor, MARK_SIZE, GREY_INK, Align::Right);
    }
}

/// Width of the widest number [px].
pub(super) fn marks_width(marks: &Marks) -> f64 {
    marks.list.iter().map(|mark| text_width(&mark.label, MARK_SIZE)).fold(0.0, f64::max)
}
