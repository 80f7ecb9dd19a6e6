//! A motion in one picture: earlier positions faint, the last one strong, the paths of points as thin lines.

use super::axis::{Mark, Marks, Scale, drawable, round_step};
use super::picture::{Align, Colour, FRAME, GREY_INK, GRID, INK, Picture, Place, WHITE_PAPER, text_width, write_film};
use super::plot::{LABEL_SIZE, MARK_SIZE, Plot, TITLE_SIZE, marks_width};
use crate::io::file::IoError;
use crate::io::table::number;
use std::path::Path;

/// What a line of a picture is drawn for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// The only body, or what is none, as a beam.
    #[default]
    Plain,
    /// One of several bodies, in a colour of its own.
    Body(usize),
    /// A spring, damper or link.
    Link,
}

/// A line through points of a body at one time.
#[derive(Debug, Clone, Default)]
pub struct Polyline {
    /// Positions x, y, z \[m\].
    pub points: Vec<[f64; 3]>,
    /// What it is drawn for, which tells its colour.
    pub role: Role,
    /// An edge of a solid: thinner than a line that stands for a body, and without joints at its ends.
    pub is_edge: bool,
}

/// The system at one time.
#[derive(Debug, Clone, Default)]
pub struct Frame {
    /// Time \[s\].
    pub time: f64,
    /// All lines of the system.
    pub lines: Vec<Polyline>,
}

/// A piece of a surface in the last frame.
#[derive(Debug, Clone)]
pub struct Facet {
    /// Its corners, all the way around \[m\].
    pub corners: [[f64; 3]; 4],
    /// Whether a line is drawn from each corner to the next.
    pub outlined: [bool; 4],
    /// What it is coloured by; not a number where there is nothing.
    pub value: f64,
}

/// Surfaces of the last frame, coloured by a quantity.
#[derive(Debug, Clone, Default)]
pub struct ColouredSurface {
    /// The quantity and its unit.
    pub quantity: String,
    /// The pieces.
    pub facets: Vec<Facet>,
    /// Least and largest value of the colours; those of the pieces.
    pub range: Option<[f64; 2]>,
}

/// The path of a point through the whole motion.
#[derive(Debug, Clone, Default)]
pub struct Trail {
    /// The name in the key; an empty name is not listed.
    pub name: String,
    /// Positions x, y, z \[m\].
    pub points: Vec<[f64; 3]>,
}

/// From where the motion is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum View {
    /// x to the right, y upwards.
    #[default]
    Xy,
    /// x to the right, z upwards.
    Xz,
    /// y to the right, z upwards.
    Yz,
    /// From the direction (1, 1, 1), z upwards.
    Isometric,
}

/// The picture of a motion, with the same scale in all directions.
#[derive(Debug, Clone, Default)]
pub struct MotionPicture {
    /// The line above the picture.
    pub title: String,
    /// The system in order of time; 40 frames evenly spread over time are drawn, or of many lines those few that lie farthest apart.
    pub frames: Vec<Frame>,
    /// Paths of points.
    pub trails: Vec<Trail>,
    /// Points fixed to the ground, x, y, z \[m\].
    pub anchors: Vec<[f64; 3]>,
    /// Surfaces of the last frame, or of the only one.
    pub surface: Option<ColouredSurface>,
    /// The one frame that is drawn, of all for which there is room; all of them.
    pub only: Option<usize>,
    /// From where the motion is seen.
    pub view: View,
}

impl MotionPicture {
    /// Writes the picture to `stem.png` (twice the size, for dense screens) and `stem.svg`, creating missing folders.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, stem: &Path) -> Result<(), IoError> {
        self.picture().write(stem)
    }

    /// Writes a film to a file in APNG, of frames one after the other with their surfaces, in the same axes and colours. It lasts some time \[s\] and
    /// is played over and over.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_film(
        &self,
        shots: Vec<(usize, Option<ColouredSurface>)>,
        duration: f64,
        path: &Path,
    ) -> Result<(), IoError> {
        let ranges = shots.iter().filter_map(|(_, surface)| surface.as_ref()?.range());
        let range = ranges.reduce(|[least, most], [a, b]| [least.min(a), most.max(b)]);
        let shots = shots.into_iter().map(|(only, surface)| {
            let surface = surface.map(|surface| ColouredSurface { range, ..surface });
            MotionPicture { only: Some(only), surface, ..self.clone() }.picture()
        });
        write_film(shots, duration, path)
    }

    fn picture(&self) -> Picture {
        match self.view {
            View::Isometric => self.spatial(),
            View::Xy => self.planar(["x [m]", "y [m]"]),
            View::Xz => self.planar(["x [m]", "z [m]"]),
            View::Yz => self.planar(["y [m]", "z [m]"]),
        }
    }

    fn points(&self) -> impl Iterator<Item = &[f64; 3]> {
        let frames = self.frames.iter().flat_map(|frame| &frame.lines).flat_map(|line| &line.points);
        let trails = self.trails.iter().flat_map(|trail| &trail.points);
        // in a film all pictures have the axes of the lines
        let surface = self.surface.iter().filter(|_| self.only.is_none());
        let surface = surface.flat_map(|surface| &surface.facets).flat_map(|facet| &facet.corners);
        frames.chain(trails).chain(&self.anchors).chain(surface).filter(|point| shown(point))
    }

    fn planar(&self, [x_label, y_label]: [&str; 2]) -> Picture {
        let axis = |index: usize| Scale::around(self.points().map(|&point| flat(self.view, point)[index]), false, 0.0);
        let (mut x, mut y) = (axis(0), axis(1));
        // a straight motion still gets some room sideways
        let longest = (x.hi - x.lo).max(y.hi - y.lo);
        widen(&mut x, 0.2 * longest);
        widen(&mut y, 0.2 * longest);
        let (width, height, metre) = fitted(x.hi - x.lo, y.hi - y.lo);
        widen(&mut x, width / metre);
        widen(&mut y, height / metre);
        let step = round_step(longest, 8);
        let most = |scale: &Scale| ((scale.hi - scale.lo) / step).ceil() as usize;
        let (x_marks, y_marks) = (x.marks(most(&x)), y.marks(most(&y)));

        let left = 46.0 + marks_width(&y_marks);
        let top = self.head_height() + if y_marks.factor.is_empty() { 0.0 } else { 20.0 };
        let plot = Plot { left, right: left + width, top, bottom: top + height, x, y };
        let mut picture = Picture::new((plot.right + 30.0).ceil(), (plot.bottom + 60.0).ceil());
        plot.draw_grid(&mut picture, &x_marks, &y_marks);
        plot.draw_y_label(&mut picture, y_label);
        plot.draw_x_labels(&mut picture, x_label, &x_marks);
        self.draw_system(&mut picture, |point| {
            let [x, y] = flat(self.view, point);
            plot.place((x, y))
        });
        plot.draw_border(&mut picture);
        self.draw_head(&mut picture, plot.left, plot.right);
        picture
    }

    /// The three rear faces of a box around the motion carry the grid.
    fn spatial(&self) -> Picture {
        let mut axes = [0, 1, 2].map(|index| Scale::around(self.points().map(|point| point[index]), false, 0.06));
        let longest = axes.iter().map(|axis| axis.hi - axis.lo).fold(0.0, f64::max);
        axes.iter_mut().for_each(|axis| widen(axis, 0.3 * longest));
        let seen = |point| flat(View::Isometric, point);
        let corners: Vec<Place> = (0..8)
            .map(|corner| [0, 1, 2].map(|index| if corner >> index & 1 == 0 { axes[index].lo } else { axes[index].hi }))
            .map(seen)
            .collect();
        let ends = |index: usize| Scale::around(corners.iter().map(|corner| corner[index]), false, 0.0);
        let (across, up) = (ends(0), ends(1));
        let (width, height, metre) = fitted(across.hi - across.lo, up.hi - up.lo);
        let (left, top) = (76.0, self.head_height() - 10.0);
        let place = |point| {
            let [u, v] = seen(point);
            [
                left + 0.5 * width + (u - 0.5 * (across.lo + across.hi)) * metre,
                top + 0.5 * height - (v - 0.5 * (up.lo + up.hi)) * metre,
            ]
        };
        let mut picture = Picture::new((left + width + 46.0).ceil(), (top + height + 30.0).ceil());

        let step = round_step(longest, 9);
        let marks = [0, 1, 2].map(|index| axes[index].marks(((axes[index].hi - axes[index].lo) / step).ceil() as usize));
        draw_rear_faces(&mut picture, &axes, &marks, place);
        draw_labels(&mut picture, &axes, &marks, place);
        self.draw_system(&mut picture, place);
        self.draw_head(&mut picture, 30.0, left + width + 16.0);
        picture
    }

    /// Frames, trails, the last frame and the anchors, in this order.
    fn draw_system(&self, picture: &mut Picture, place: impl Fn([f64; 3]) -> Place) {
        let drawn = match self.only {
            Some(only) => self.frames.get(only).into_iter().collect(),
            None => spread(&self.frames),
        };
        let (first, last) = self.times();
        let Some((final_frame, earlier)) = drawn.split_last() else {
            self.draw_trails(picture, &place);
            return self.draw_anchors(picture, &place);
        };
        for frame in earlier {
            let age = if last > first { (frame.time - first) / (last - first) } else { 0.0 };
            for line in &frame.lines {
                for piece in pieces(&line.points, &place) {
                    picture.line(piece, if line.is_edge { 1.0 } else { 1.7 }, faded(line.role.colour(), age));
                }
            }
        }
        if let Some(surface) = &self.surface {
            surface.draw(picture, self.view, &place);
        }
        self.draw_trails(picture, &place);
        self.draw_anchors(picture, &place);
        for line in &final_frame.lines {
            for piece in pieces(&line.points, &place) {
                picture.line(piece, if line.is_edge { 1.5 } else { 3.4 }, line.role.colour());
            }
        }
        // rings at the ends of all lines show the joints
        for line in final_frame.lines.iter().filter(|line| !line.is_edge) {
            let ends = [line.points.first(), line.points.last()];
            for &end in ends.into_iter().flatten().filter(|point| shown(point)) {
                picture.disc(place(end), 4.2, line.role.colour());
                picture.disc(place(end), 2.2, WHITE_PAPER);
            }
        }
    }

    fn draw_trails(&self, picture: &mut Picture, place: impl Fn([f64; 3]) -> Place) {
        for (index, trail) in self.trails.iter().enumerate() {
            for piece in pieces(&trail.points, &place) {
                picture.line(piece, 1.2, self.trail_colour(index));
            }
        }
    }

    /// A triangle on hatched ground at every anchor, on the side away from the motion.
    fn draw_anchors(&self, picture: &mut Picture, place: impl Fn([f64; 3]) -> Place) {
        let heights = || self.points().map(|&point| place(point)[1]);
        let mean = heights().sum::<f64>() / heights().count().max(1) as f64;
        for &anchor in self.anchors.iter().filter(|point| shown(point)) {
            let [x, y] = place(anchor);
            // the motion hangs clearly below: the ground is a ceiling
            let down = if mean > y + 25.0 { -1.0 } else { 1.0 };
            let base = y + 15.0 * down;
            for step in 0..5 {
                let foot = x - 9.0 + 5.5 * f64::from(step);
                picture.line(vec![[foot, base], [foot - 5.0 * down, base + 6.0 * down]], 1.0, GREY_INK);
            }
            picture.area(vec![[x, y], [x + 9.0, base], [x - 9.0, base]], [222, 226, 231]);
            picture.line(vec![[x, y], [x + 9.0, base], [x - 9.0, base], [x, y]], 1.3, INK);
            picture.line(vec![[x - 14.0, base], [x + 14.0, base]], 1.6, INK);
            picture.disc([x, y], 3.4, INK);
        }
    }

    fn named_trails(&self) -> impl Iterator<Item = (usize, &Trail)> {
        self.trails.iter().enumerate().filter(|(_, trail)| !trail.name.is_empty())
    }

    fn head_height(&self) -> f64 {
        let has_key = self.surface.as_ref().is_some_and(|surface| surface.range().is_some());
        let rows = [self.named_trails().next().is_some(), has_key];
        46.0 + 20.0 * rows.into_iter().filter(|&row| row).count() as f64
    }

    /// Title and names of the trails at the left, the key to the times at the right.
    fn draw_head(&self, picture: &mut Picture, left: f64, right: f64) {
        picture.text([left, 28.0], &self.title, TITLE_SIZE, INK, Align::Left);
        let mut x = left;
        for (index, trail) in self.named_trails() {
            picture.line(vec![[x, 50.0], [x + 22.0, 50.0]], 1.6, self.trail_colour(index));
            picture.text([x + 28.0, 54.5], &trail.name, MARK_SIZE, GREY_INK, Align::Left);
            x += 50.0 + text_width(&trail.name, MARK_SIZE);
        }
        if let Some(surface) = &self.surface {
            surface.draw_key(picture, [right, self.head_height() - 12.0]);
        }
        if self.frames.is_empty() {
            return;
        }
        if let Some(only) = self.only.and_then(|only| self.frames.get(only)) {
            picture.text(
                [right, 27.5],
                &format!("t = {} s", number(round_time(only.time))),
                MARK_SIZE,
                GREY_INK,
                Align::Right,
            );
            return;
        }
        let (first, last) = self.times();
        let (from, to) = (format!("t = {} s", number(round_time(first))), format!("{} s", number(round_time(last))));
        let end = right - text_width(&to, MARK_SIZE) - 8.0;
        let (start, top, bottom) = (end - 130.0, 17.0, 29.0);
        picture.text([right, 27.5], &to, MARK_SIZE, GREY_INK, Align::Right);
        picture.text([start - 8.0, 27.5], &from, MARK_SIZE, GREY_INK, Align::Right);
        let mut roles: Vec<_> = self.frames.iter().flat_map(|frame| &frame.lines).map(|line| line.role).collect();
        roles.sort_unstable();
        roles.dedup();
        roles.truncate(MOST_STRIPS);
        let strip = (bottom - top) / roles.len().max(1) as f64;
        for (line, &role) in roles.iter().enumerate() {
            let y = top + strip * line as f64;
            for step in 0..60 {
                // each block reaches to the end, so that no paper shows between it and the next
                let from = start + 124.0 / 60.0 * f64::from(step);
                picture.block([from, y], [end, y + strip], faded(role.colour(), f64::from(step) / 59.0));
            }
            picture.block([end - 6.0, y], [end, y + strip], role.colour());
        }
    }

    fn times(&self) -> (f64, f64) {
        let time = |frame: Option<&Frame>| frame.map_or(0.0, |frame| frame.time);
        (time(self.frames.first()), time(self.frames.last()))
    }

    /// Trails take the colours that no body has, where one is left.
    fn trail_colour(&self, index: usize) -> Colour {
        let body = |line: &Polyline| if let Role::Body(body) = line.role { body + 1 } else { 1 };
        let bodies = self.frames.iter().flat_map(|frame| &frame.lines).map(body).max().unwrap_or(1);
        let first = if bodies < BODIES.len() { bodies } else { 1 };
        BODIES[(first + index) % BODIES.len()]
    }
}

/// Grid and edges of the three faces of a box that are seen from inside.
fn draw_rear_faces(picture: &mut Picture, axes: &[Scale; 3], marks: &[Marks; 3], place: impl Fn([f64; 3]) -> Place) {
    let [x, y, z] = axes;
    let mut draw = |corners: [[f64; 3]; 3], colour| picture.line(corners.map(&place).to_vec(), 1.0, colour);
    for (index, marks) in marks.iter().enumerate() {
        for &Mark { value: at, .. } in &marks.list {
            let grid = match index {
                0 => [[at, y.hi, z.lo], [at, y.lo, z.lo], [at, y.lo, z.hi]],
                1 => [[x.hi, at, z.lo], [x.lo, at, z.lo], [x.lo, at, z.hi]],
                _ => [[x.hi, y.lo, at], [x.lo, y.lo, at], [x.lo, y.hi, at]],
            };
            draw(grid, GRID);
        }
    }
    draw([[x.hi, y.lo, z.hi], [x.lo, y.lo, z.hi], [x.lo, y.hi, z.hi]], GRID);
    draw([[x.hi, y.lo, z.lo], [x.lo, y.lo, z.lo], [x.lo, y.hi, z.lo]], FRAME);
    draw([[x.lo, y.lo, z.lo], [x.lo, y.lo, z.hi], [x.lo, y.lo, z.hi]], FRAME);
    draw([[x.lo, y.hi, z.lo], [x.lo, y.hi, z.hi], [x.lo, y.hi, z.hi]], GRID);
    draw([[x.hi, y.lo, z.lo], [x.hi, y.hi, z.lo], [x.lo, y.hi, z.lo]], FRAME);
    draw([[x.hi, y.lo, z.lo], [x.hi, y.lo, z.hi], [x.hi, y.lo, z.hi]], FRAME);
}

/// Numbers and names below the two near edges of the floor and to the left of the upright edge.
fn draw_labels(picture: &mut Picture, axes: &[Scale; 3], marks: &[Marks; 3], place: impl Fn([f64; 3]) -> Place) {
    let [x, y, z] = axes;
    for (index, name) in ["x", "y", "z"].into_iter().enumerate() {
        let (axis, Marks { list, factor }) = (&axes[index], &marks[index]);
        let (near, far, align) = match index {
            0 => ([7.0, 9.0], [32.0, 34.0], Align::Left),
            1 => ([-7.0, 9.0], [-32.0, 34.0], Align::Right),
            _ => ([-8.0, 0.0], [-20.0 - marks_width(&marks[2]), 0.0], Align::Right),
        };
        let mut label = |value: f64, [dx, dy]: Place, text: &str, size: f64, colour| {
            let [px, py] = place(match index {
                0 => [value, y.hi, z.lo],
                1 => [x.hi, value, z.lo],
                _ => [x.hi, y.lo, value],
            });
            picture.text([px + dx, py + dy + 0.36 * size], text, size, colour, align);
        };
        // the numbers at the ends would meet those of the next axis
        for mark in list.iter().filter(|mark| (0.02..=0.98).contains(&axis.at(mark.value))) {
            label(mark.value, near, &mark.label, MARK_SIZE, GREY_INK);
        }
        let unit = if factor.is_empty() { format!("{name} [m]") } else { format!("{name} [m] {factor}") };
        label(0.5 * (axis.lo + axis.hi), far, &unit, LABEL_SIZE, INK);
    }
}

/// Colours from the least to the largest value, equally far apart: those of viridis (Smith & van der Walt 2015).
const MAP: [Colour; 5] = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
/// Where there is no value.
const NO_VALUE: Colour = [222, 226, 231];

/// The colour of a share of the range.
fn map_colour(share: f64) -> Colour {
    if share.is_nan() {
        return NO_VALUE;
    }
    let place = share.clamp(0.0, 1.0) * (MAP.len() - 1) as f64;
    let below = (place as usize).min(MAP.len() - 2);
    let mix = place - below as f64;
    [0, 1, 2].map(|k| {
        let [from, to] = [MAP[below][k], MAP[below + 1][k]].map(f64::from);
        (from + (to - from) * mix).round() as u8
    })
}

impl ColouredSurface {
    /// Least and largest value; `None` where there is none.
    fn range(&self) -> Option<[f64; 2]> {
        if self.range.is_some() {
            return self.range;
        }
        let values = self.facets.iter().map(|facet| facet.value).filter(|value| value.is_finite());
        let [least, most] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], value| [least.min(value), most.max(value)]);
        (least <= most).then_some([least, most])
    }

    /// The far pieces first, so that near ones cover them.
    fn draw(&self, picture: &mut Picture, view: View, place: impl Fn([f64; 3]) -> Place) {
        let [least, most] = self.range().unwrap_or([0.0, 1.0]);
        let nearness = |facet: &&Facet| facet.corners.iter().map(|&corner| nearness(view, corner)).sum::<f64>();
        let mut facets: Vec<&Facet> = self.facets.iter().filter(|facet| facet.corners.iter().all(shown)).collect();
        facets.sort_by(|a, b| nearness(a).total_cmp(&nearness(b)));
        for Facet { corners, outlined, value } in facets {
            let colour = map_colour(if most > least { (value - least) / (most - least) } else { value - least });
            let corners = corners.map(&place);
            // no paper shows between neighbours
            picture.line(corners.iter().chain(corners.first()).copied().collect(), 0.8, colour);
            picture.area(corners.to_vec(), colour);
            for side in (0..4).filter(|&side| outlined[side]) {
                picture.line(vec![corners[side], corners[(side + 1) % 4]], 0.6, WHITE_PAPER);
            }
        }
    }

    /// Quantity, least and largest value, on a line that ends at a place.
    fn draw_key(&self, picture: &mut Picture, [right, line]: Place) {
        let Some([least, most]) = self.range() else { return };
        let short = |value: f64| if value == 0.0 { "0".into() } else { format!("{value:.2e}") };
        let (from, to) = (format!("{}: {}", self.quantity, short(least)), short(most));
        let end = right - text_width(&to, MARK_SIZE) - 8.0;
        let (start, top, bottom) = (end - 130.0, line - 10.5, line + 1.5);
        picture.text([right, line], &to, MARK_SIZE, GREY_INK, Align::Right);
        picture.text([start - 8.0, line], &from, MARK_SIZE, GREY_INK, Align::Right);
        for step in 0..65 {
            // each block reaches to the end, so that no paper shows between it and the next
            picture.block([start + 2.0 * f64::from(step), top], [end, bottom], map_colour(f64::from(step) / 64.0));
        }
    }
}

/// How near a point is to who looks.
fn nearness(view: View, [x, y, z]: [f64; 3]) -> f64 {
    match view {
        View::Xy => z,
        View::Xz => -y,
        View::Yz => x,
        View::Isometric => x + y + z,
    }
}

fn shown(point: &[f64; 3]) -> bool {
    point.iter().all(|&x| drawable(x, false))
}

/// To the right and upwards, as seen from the given side \[m\].
fn flat(view: View, [x, y, z]: [f64; 3]) -> Place {
    match view {
        View::Xy => [x, y],
        View::Xz => [x, z],
        View::Yz => [y, z],
        View::Isometric => [(y - x) / 2f64.sqrt(), (2.0 * z - x - y) / 6f64.sqrt()],
    }
}

/// Width and height of the drawing [px] and pixels per metre for `across` by `up` metres.
fn fitted(across: f64, up: f64) -> (f64, f64, f64) {
    // room for line widths and the ground signs
    const EDGE: f64 = 60.0;
    let metre = (720.0 / across).min(520.0 / up);
    ((across * metre + EDGE).max(460.0), (up * metre + EDGE).max(240.0), metre)
}

fn widen(scale: &mut Scale, least: f64) {
    let missing = 0.5 * (least - (scale.hi - scale.lo)).max(0.0);
    (scale.lo, scale.hi) = (scale.lo - missing, scale.hi + missing);
}

/// Colours of bodies, those of the report.
const BODIES: [Colour; 7] = [
    [0x0b, 0x6b, 0xcb],
    [0xd1, 0x60, 0x0a],
    [0x2c, 0x8a, 0x3d],
    [0x9a, 0x3f, 0xb5],
    [0xc2, 0x33, 0x4d],
    [0x0f, 0x8b, 0x8d],
    [0x7a, 0x6a, 0x00],
];

/// Colour of springs, dampers and links.
const LINK: Colour = [112, 118, 128];

/// Most roles whose fading the key to the times shows.
const MOST_STRIPS: usize = 4;

impl Role {
    /// Of more bodies than there are colours in the list these go around the circle by the golden angle, as in the report.
    fn colour(self) -> Colour {
        match self {
            Role::Plain => BODIES[0],
            Role::Link => LINK,
            Role::Body(body) => BODIES.get(body).copied().unwrap_or_else(|| {
                let [hue, saturation, lightness] = [137.5 * body as f64 % 360.0, 0.6, 0.42];
                [0.0, 8.0, 4.0].map(|sector| {
                    let k = (sector + hue / 30.0) % 12.0;
                    (255.0 * (lightness - saturation * lightness * (k - 3.0).min(9.0 - k).clamp(-1.0, 1.0))).round() as u8
                })
            }),
        }
    }
}

/// The colour of an earlier frame: nearly white at age 0, just lighter than the last frame at age 1.
fn faded(colour: Colour, age: f64) -> Colour {
    let strength = 0.2 + 0.45 * age.clamp(0.0, 1.0).powf(1.3);
    colour.map(|byte| (255.0 + (f64::from(byte) - 255.0) * strength).round() as u8)
}

/// Frames to draw, the first and the last included: at most 40 evenly spread over time, and of a system of many lines so few that each can
/// be told from the others, by their poses.
fn spread(frames: &[Frame]) -> Vec<&Frame> {
    const MOST: usize = 40;
    const FEWEST: usize = 6;
    const MOST_LINES: usize = 160;
    let (Some(first), Some(last)) = (frames.first(), frames.last()) else { return Vec::new() };
    let most = (MOST_LINES / first.lines.len().max(1)).clamp(FEWEST, MOST);
    if frames.len() <= most {
        return frames.iter().collect();
    }
    if most < MOST {
        return farthest(frames, most);
    }
    let wanted = |k: usize| first.time + (last.time - first.time) * k as f64 / (most - 1) as f64;
    let mut chosen: Vec<usize> = (0..most - 1).map(|k| frames.partition_point(|frame| frame.time < wanted(k))).collect();
    chosen.push(frames.len() - 1);
    chosen.iter_mut().for_each(|index| *index = (*index).min(frames.len() - 1));
    chosen.dedup();
    chosen.into_iter().map(|index| &frames[index]).collect()
}

/// Some frames in order of time, each as far as can be from those before it in the choice: equal times would show a motion whose period they
/// meet in one pose.
fn farthest(frames: &[Frame], count: usize) -> Vec<&Frame> {
    let points = |frame: &Frame| -> Vec<[f64; 3]> {
        frame.lines.iter().flat_map(|line| [line.points.first(), line.points.last()]).flatten().copied().collect()
    };
    let poses: Vec<Vec<[f64; 3]>> = frames.iter().map(points).collect();
    let apart = |a: &[[f64; 3]], b: &[[f64; 3]]| -> f64 {
        let squares = a.iter().zip(b).map(|(a, b)| (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>());
        squares.filter(|square| square.is_finite()).sum()
    };
    let (mut chosen, mut distances) = (Vec::new(), vec![f64::INFINITY; frames.len()]);
    let mut next = Some(frames.len() - 1);
    while let Some(own) = next {
        chosen.push(own);
        distances.iter_mut().zip(&poses).for_each(|(distance, pose)| *distance = distance.min(apart(pose, &poses[own])));
        let farthest = (0..frames.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b]));
        next = if chosen.len() == 1 { Some(0) } else { farthest };
        next = next.filter(|&next| chosen.len() < count && (distances[next] > 0.0 || chosen.len() == 1));
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen.into_iter().map(|index| &frames[index]).collect()
}

/// The unbroken pieces of a line; consecutive points closer than a fifth of a pixel become one.
fn pieces(points: &[[f64; 3]], place: impl Fn([f64; 3]) -> Place) -> Vec<Vec<Place>> {
    let thinned = |piece: &[[f64; 3]]| {
        let mut kept: Vec<Place> = Vec::new();
        for (index, &point) in piece.iter().enumerate() {
            let [x, y] = place(point);
            if index + 1 == piece.len() || kept.last().is_none_or(|last| (x - last[0]).hypot(y - last[1]) >= 0.2) {
                kept.push([x, y]);
            }
        }
        kept
    };
    points.split(|point| !shown(point)).filter(|piece| !piece.is_empty()).map(thinned).collect()
}

/// Three decimals are enough for a key, and hide the rounding of summed steps.
fn round_time(time: f64) -> f64 {
    let rounded = (time * 1e3).round() / 1e3;
    if rounded == 0.0 || time.abs() > 1e9 { time } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::super::picture::Shape;
    use super::super::picture::tests::png_size;
    use super::*;
    use crate::io::file::tests::Folder;
    use std::f64::consts::TAU;

    #[test]
    fn near_pieces_of_surfaces_cover_far_ones_in_the_colours_of_their_values() {
        let square = |x: f64, value: f64| Facet {
            corners: [[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 1.0], [x, 0.0, 1.0]],
            outlined: [true; 4],
            value,
        };
        // seen along -x: the one at x = 2 is the nearest
        let facets = vec![square(2.0, 30.0), square(0.0, 10.0), square(1.0, f64::NAN)];
        let surface = ColouredSurface { quantity: "stress".into(), facets, range: None };
        let mut picture = Picture::new(100.0, 100.0);
        surface.draw(&mut picture, View::Yz, |point| flat(View::Yz, point));
        let colours: Vec<Colour> = picture
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Area { colour, .. } => Some(*colour),
                _ => None,
            })
            .collect();
        assert_eq!(colours, [MAP[0], NO_VALUE, MAP[4]]);
        let lines = picture.shapes.iter().filter(|shape| matches!(shape, Shape::Line { colour: WHITE_PAPER, .. })).count();
        assert_eq!(lines, 12);
        assert_eq!(surface.range(), Some([10.0, 30.0]));
        // a picture has a key to the values, and one without values has none
        let with_key = |value: f64| {
            let surface = Some(ColouredSurface { quantity: "stress".into(), facets: vec![square(0.0, value)], range: None });
            let picture = MotionPicture { surface, frames: vec![Frame::default()], ..MotionPicture::default() }.picture();
            picture.shapes.iter().any(|shape| matches!(shape, Shape::Text { text, .. } if text.starts_with("stress")))
        };
        assert!(with_key(1.0) && !with_key(f64::NAN));
    }

    /// A made-up flexible double pendulum; not a solution of any equation.
    fn pendulum(view: View) -> MotionPicture {
        let mut motion = MotionPicture {
            title: "Flexible double pendulum".into(),
            view,
            anchors: vec![[0.0; 3]],
            ..MotionPicture::default()
        };
        let bar = |from: [f64; 3], angle: f64, swing: f64, bend: f64| -> Vec<[f64; 3]> {
            (0..=16)
                .map(|k| f64::from(k) / 16.0)
                .map(|s| {
                    let across = bend * (std::f64::consts::PI * s).sin();
                    let (sin, cos) = angle.sin_cos();
                    let plane = s * sin + across * cos;
                    let vertical = -s * cos + across * sin;
                    match view {
                        View::Xy => [from[0] + plane, from[1] + vertical, 0.0],
                        _ => [from[0] + plane * swing.cos(), from[1] + plane * swing.sin(), from[2] + vertical],
                    }
                })
                .collect()
        };
        let mut tip = Vec::new();
        for step in 0..=300 {
            let t = 0.005 * f64::from(step);
            let upper = bar([0.0; 3], 1.4 * (3.0 * t).cos(), 0.9 * t, 0.05 * (17.0 * t).sin());
            let lower =
                bar(upper[16], 1.4 * (3.0 * t + 0.4).cos() - 0.5 * (6.5 * t).sin(), 1.6 * t, 0.09 * (13.0 * t).sin());
            tip.push(lower[16]);
            if step % 12 == 0 {
                let lines = vec![
                    Polyline { points: upper, role: Role::Body(0), is_edge: false },
                    Polyline { points: lower, role: Role::Body(1), is_edge: false },
                ];
                motion.frames.push(Frame { time: t, lines });
            }
        }
        motion.trails.push(Trail { name: "tip".into(), points: tip });
        motion
    }

    #[test]
    fn each_body_has_the_colour_that_the_report_gives_it() {
        let page = include_str!("../../cli/report/page.js");
        for [r, g, b] in BODIES {
            assert!(page.contains(&format!("\"#{r:02x}{g:02x}{b:02x}\"")), "{r} {g} {b}");
        }
        // hsl(242.5, 60%, 42%)
        assert_eq!(Role::Body(7).colour(), [48, 43, 171]);
        let folder = Folder::new("motion-colours");
        let mut motion = pendulum(View::Xy);
        let link = Polyline { points: vec![[0.0; 3], [1.0, 0.0, 0.0]], role: Role::Link, is_edge: false };
        motion.frames.iter_mut().for_each(|frame| frame.lines.push(link.clone()));
        motion.write(&folder.0.join("motion")).unwrap();
        let svg = std::fs::read_to_string(folder.0.join("motion.svg")).unwrap();
        // two bodies, the link and the path of the tip
        for [r, g, b] in [BODIES[0], BODIES[1], LINK, BODIES[2]] {
            assert!(svg.contains(&format!("stroke=\"#{r:02x}{g:02x}{b:02x}\"")), "{r} {g} {b}");
        }
    }

    #[test]
    fn a_motion_is_written_twice_with_its_labels() {
        for (view, labels) in [
            (View::Xy, ["x [m]", "y [m]"]),
            (View::Xz, ["x [m]", "z [m]"]),
            (View::Yz, ["y [m]", "z [m]"]),
            (View::Isometric, ["x [m]", "z [m]"]),
        ] {
            let folder = Folder::new(&format!("motion-{view:?}"));
            let stem = folder.0.join(format!("motion-{view:?}"));
            pendulum(view).write(&stem).unwrap();
            let svg = std::fs::read_to_string(folder.0.join(format!("motion-{view:?}.svg"))).unwrap();
            for label in labels.into_iter().chain(["Flexible double pendulum", "tip", "t = 0 s", "1.5 s"]) {
                assert!(svg.contains(label), "{view:?}: {label}");
            }
            let picture = pendulum(view).picture();
            let size = png_size(&folder.0.join(format!("motion-{view:?}.png")));
            assert_eq!(size, (2 * picture.width as u32, 2 * picture.height as u32));
            if let Ok(kept) = std::env::var("COSTATE_PICTURES") {
                for name in folder.names() {
                    std::fs::copy(folder.0.join(&name), Path::new(&kept).join(&name)).unwrap();
                }
            }
        }
    }

    #[test]
    fn all_directions_have_the_same_scale() {
        // seen from (1, 1, 1) the unit vectors have the same length and enclose equal angles
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| flat(View::Isometric, axis));
        for (a, b) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)] {
            let expected = if a == b { 2.0 / 3.0 } else { -1.0 / 3.0 };
            let product = axes[a][0] * axes[b][0] + axes[a][1] * axes[b][1];
            assert!((product - expected).abs() < 1e-15, "{a} {b}: {product}");
        }
        // a square stays one: the trail is the only line of width 1.2
        let points = vec![[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 3.0, 0.0]];
        let square = MotionPicture { trails: vec![Trail { name: String::new(), points }], ..MotionPicture::default() };
        let lines = square.picture().shapes.into_iter().filter_map(|shape| match shape {
            super::super::picture::Shape::Line { points, width: 1.2, .. } => Some(points),
            _ => None,
        });
        let [line] = &lines.collect::<Vec<_>>()[..] else { panic!("one trail") };
        assert!(((line[1][0] - line[0][0]) - (line[1][1] - line[2][1])).abs() < 1e-9, "{line:?}");
    }

    #[test]
    fn many_frames_are_spread_over_time() {
        let frames: Vec<_> = (0..5000).map(|k| Frame { time: (f64::from(k) / 5000.0).powi(2), lines: vec![] }).collect();
        let chosen = spread(&frames);
        assert!(chosen.len() == 40 && chosen[0].time == 0.0 && chosen[39].time == frames[4999].time);
        assert!(chosen.windows(2).all(|pair| (pair[1].time - pair[0].time) * 39.0 < 1.1));
    }

    #[test]
    fn of_many_lines_frames_are_drawn_that_lie_apart_where_equal_times_meet_the_period() {
        // 60 lines that swing 25 times in 5001 frames, and slowly drift
        let at = |k: usize| {
            let x = (TAU * k as f64 / 200.0).sin() + 1e-4 * k as f64;
            let line = |j: usize| Polyline {
                points: vec![[x, j as f64, 0.0], [x + 1.0, j as f64, 0.0]],
                role: Role::Body(0),
                is_edge: false,
            };
            Frame { time: k as f64, lines: (0..60).map(line).collect() }
        };
        let frames: Vec<Frame> = (0..5001).map(at).collect();
        let chosen = spread(&frames);
        assert_eq!(chosen.len(), 6);
        let places: Vec<f64> = chosen.iter().map(|frame| frame.lines[0].points[0][0]).collect();
        let apart = |i: usize| (0..i).map(move |j| (i, j));
        let least = (0..6).flat_map(apart).map(|(i, j)| (places[i] - places[j]).abs()).fold(f64::INFINITY, f64::min);
        assert!(least > 0.25, "{places:?}");
    }

    #[test]
    fn odd_motions_still_give_a_picture() {
        let folder = Folder::new("motion-odd");
        for view in [View::Xy, View::Isometric] {
            let broken = Polyline {
                points: vec![[f64::NAN; 3], [1.0, 2.0, 3.0], [f64::INFINITY, 0.0, 0.0]],
                role: Role::Body(99),
                is_edge: false,
            };
            let frame = Frame { time: 0.0, lines: vec![broken] };
            let motion = MotionPicture { frames: vec![frame.clone(), frame], view, ..MotionPicture::default() };
            motion.write(&folder.0.join("one")).unwrap();
            MotionPicture { view, ..MotionPicture::default() }.write(&folder.0.join("none")).unwrap();
            let line = Polyline { points: vec![[1e-9, 5.0, 0.0], [2e-9, 5.0, 0.0]], role: Role::Body(0), is_edge: false };
            let frames = vec![Frame { time: 0.0, lines: vec![line] }];
            MotionPicture { frames, view, ..MotionPicture::default() }.write(&folder.0.join("small")).unwrap();
        }
        assert_eq!(folder.names().len(), 6);
    }
}
