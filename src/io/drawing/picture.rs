//! A picture as a list of shapes, drawn once for the screen (PNG) and once for print (SVG).

use crate::io::file::{Aside, IoError};
use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Red, green, blue.
pub(super) type Colour = [u8; 3];
/// A place in the picture [px]: to the right, and down.
pub(super) type Place = [f64; 2];

pub(super) const WHITE_PAPER: Colour = [255, 255, 255];
pub(super) const INK: Colour = [38, 42, 48];
pub(super) const GREY_INK: Colour = [96, 102, 110];
pub(super) const FRAME: Colour = [150, 156, 164];
pub(super) const GRID: Colour = [228, 231, 235];

/// Okabe and Ito's colours, distinct for all common kinds of colour vision, without yellow (too faint for a thin line).
pub(super) const PALETTE: [Colour; 7] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [86, 180, 233], [230, 159, 0], [60, 60, 60]];

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// What can be drawn; lengths and places in pixels of the SVG (half a pixel of the PNG).
#[derive(Debug, Clone)]
pub(super) enum Shape {
    Line {
        points: Vec<Place>,
        width: f64,
        colour: Colour,
    },
    Area {
        points: Vec<Place>,
        colour: Colour,
    },
    Disc {
        centre: Place,
        radius: f64,
        colour: Colour,
    },
    /// `at` lies on the baseline; an `upward` text reads from below.
    Text {
        at: Place,
        text: String,
        size: f64,
        colour: Colour,
        align: Align,
        upward: bool,
    },
}

/// Shapes on white paper, later ones on top.
#[derive(Debug, Clone)]
pub(super) struct Picture {
    pub width: f64,
    pub height: f64,
    pub shapes: Vec<Shape>,
}

impl Picture {
    pub fn new(width: f64, height: f64) -> Self {
        Self { width, height, shapes: Vec::new() }
    }

    pub fn line(&mut self, points: Vec<Place>, width: f64, colour: Colour) {
        match points[..] {
            [] => {}
            [centre] => self.disc(centre, width, colour),
            _ => self.shapes.push(Shape::Line { points, width, colour }),
        }
    }

    pub fn area(&mut self, points: Vec<Place>, colour: Colour) {
        self.shapes.push(Shape::Area { points, colour });
    }

    pub fn disc(&mut self, centre: Place, radius: f64, colour: Colour) {
        self.shapes.push(Shape::Disc { centre, radius, colour });
    }

    pub fn text(&mut self, at: Place, text: &str, size: f64, colour: Colour, align: Align) {
        self.shapes.push(Shape::Text { at, text: text.to_owned(), size, colour, align, upward: false });
    }

    pub fn upward_text(&mut self, at: Place, text: &str, size: f64, colour: Colour) {
        self.shapes.push(Shape::Text { at, text: text.to_owned(), size, colour, align: Align::Centre, upward: true });
    }

    /// A filled box from its upper left to its lower right corner.
    pub fn block(&mut self, [x0, y0]: Place, [x1, y1]: Place, colour: Colour) {
        self.area(vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1]], colour);
    }

    /// The outline of a box.
    pub fn outline(&mut self, [x0, y0]: Place, [x1, y1]: Place, width: f64, colour: Colour) {
        self.line(vec![[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], width, colour);
    }

    /// Writes `stem.png` (twice the size, for dense screens) and `stem.svg`.
    pub fn write(&self, stem: &Path) -> Result<(), IoError> {
        let svg = with_ending(stem, ".svg")?;
        let png = with_ending(stem, ".png")?;
        let (svg_aside, png_aside) = (Aside::beside(&svg)?, Aside::beside(&png)?);
        let text = self.svg().map_err(|cause| IoError::new(&svg, cause))?;
        std::fs::write(&svg_aside.part, text).map_err(|cause| IoError::new(&svg, cause))?;
        self.write_png(&png_aside.part).map_err(|cause| IoError::new(&png, cause))?;
        svg_aside.publish()?;
        png_aside.publish()
    }

    fn svg(&self) -> Result<String, String> {
        // plotters counts whole pixels: draw large, and scale down by the view box
        const FINE: f64 = 16.0;
        let whole = |length: f64| (length * FINE).round() as i32;
        let place = |[x, y]: Place| (whole(x), whole(y));
        let (width, height) = (whole(self.width) as u32, whole(self.height) as u32);
        let mut text = String::new();
        let mut out = SVGBackend::with_string(&mut text, (width, height));
        out.draw_rect((0, 0), (width as i32, height as i32), &WHITE, true).map_err(as_text)?;
        for shape in &self.shapes {
            match shape {
                Shape::Line { points, width, colour } => {
                    let style = ink(colour).stroke_width(whole(*width) as u32);
                    out.draw_path(points.iter().map(|&at| place(at)), &style).map_err(as_text)?;
                }
                Shape::Area { points, colour } => {
                    out.fill_polygon(points.iter().map(|&at| place(at)), &ink(colour)).map_err(as_text)?;
                }
                Shape::Disc { centre, radius, colour } => {
                    out.draw_circle(place(*centre), whole(*radius) as u32, &ink(colour), true).map_err(as_text)?;
                }
                Shape::Text { at, text, size, colour, align, upward } => {
                    let h_pos = match align {
                        Align::Left => HPos::Left,
                        Align::Centre => HPos::Center,
                        Align::Right => HPos::Right,
                    };
                    // the backend divides the size by 1.24 and centres on half the height of an x
                    let font = FontDesc::new(FontFamily::Name(FAMILY), size * FINE * 1.24, FontStyle::Normal);
                    let half_x = 0.27 * size;
                    let (font, at) = if *upward {
                        (font.transform(FontTransform::Rotate270), [at[0] - half_x, at[1]])
                    } else {
                        (font, [at[0], at[1] - half_x])
                    };
                    let colour = rgb(colour);
                    let style = TextStyle::from(font).color(&colour).pos(Pos::new(h_pos, VPos::Center));
                    out.draw_text(text, &style, place(at)).map_err(as_text)?;
                }
            }
        }
        out.present().map_err(as_text)?;
        drop(out);
        let shown = format!(
            "<svg width=\"{}\" height=\"{}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"",
            self.width, self.height
        );
        Ok(text.replacen(&format!("<svg width=\"{width}\" height=\"{height}\""), &shown, 1))
    }

    fn write_png(&self, path: &Path) -> Result<(), String> {
        const SCALE: u32 = 2;
        const SAMPLES: usize = 3;
        let (width, height) = (self.width.round() as u32 * SCALE, self.height.round() as u32 * SCALE);
        let fine = self.pixels(f64::from(SCALE) * SAMPLES as f64, width as usize * SAMPLES, height as usize * SAMPLES)?;
        let pixels = averaged(&fine, width as usize, height as usize, SAMPLES);
        let file = std::fs::File::create(path).map_err(as_text)?;
        let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), width, height);
        encoder.set_color(png::ColorType::Rgb);
        let mut writer = encoder.write_header().map_err(as_text)?;
        writer.write_image_data(&pixels).and_then(|()| writer.finish()).map_err(as_text)
    }

    /// The picture in `scale` times its size, three bytes a pixel.
    fn pixels(&self, scale: f64, width: usize, height: usize) -> Result<Vec<u8>, String> {
        let mut pixels = vec![255; 3 * width * height];
        let place = |[x, y]: Place| ((x * scale).round() as i32, (y * scale).round() as i32);
        for shape in &self.shapes {
            if let Shape::Text { at, text, size, colour, align, upward } = shape {
                draw_text(&mut pixels, width, at.map(|x| x * scale), text, size * scale, *colour, *align, *upward);
                continue;
            }
            let mut out = BitMapBackend::with_buffer(&mut pixels, (width as u32, height as u32));
            match shape {
                Shape::Line { points, width, colour } => {
                    let half = 0.5 * width;
                    let joint = (half * scale).round() as u32;
                    for pair in points.windows(2) {
                        let [[x0, y0], [x1, y1]] = [pair[0], pair[1]];
                        let length = (x1 - x0).hypot(y1 - y0);
                        if length == 0.0 {
                            continue;
                        }
                        // each piece by itself: pieces that overlap in one long outline would cancel
                        let [nx, ny] = [(y0 - y1) / length * half, (x1 - x0) / length * half];
                        let corners = [[x0 + nx, y0 + ny], [x1 + nx, y1 + ny], [x1 - nx, y1 - ny], [x0 - nx, y0 - ny]];
                        out.fill_polygon(corners.map(place), &ink(colour)).map_err(as_text)?;
                        if joint > 2 {
                            out.draw_circle(place(pair[0]), joint, &ink(colour), true).map_err(as_text)?;
                            out.draw_circle(place(pair[1]), joint, &ink(colour), true).map_err(as_text)?;
                        }
                    }
                }
                Shape::Area { points, colour } => {
                    out.fill_polygon(points.iter().map(|&at| place(at)), &ink(colour)).map_err(as_text)?;
                }
                Shape::Disc { centre, radius, colour } => {
                    let radius = (radius * scale).round() as u32;
                    out.draw_circle(place(*centre), radius, &ink(colour), true).map_err(as_text)?;
                }
                Shape::Text { .. } => {}
            }
        }
        Ok(pixels)
    }
}

fn rgb(&[r, g, b]: &Colour) -> RGBColor {
    RGBColor(r, g, b)
}

fn ink(colour: &Colour) -> ShapeStyle {
    rgb(colour).filled()
}

/// `stem` with `ending` appended; a dot in the stem stays, unlike in `Path::with_extension`.
fn with_ending(stem: &Path, ending: &str) -> Result<PathBuf, IoError> {
    let Some(name) = stem.file_name() else {
        return Err(IoError::new(stem, "the path does not end in a file name"));
    };
    let mut name: OsString = name.to_owned();
    name.push(ending);
    Ok(stem.with_file_name(name))
}

fn as_text(error: impl std::error::Error) -> String {
    root_cause(&error)
}

/// The innermost error: the outer ones only say that drawing failed.
fn root_cause(error: &dyn std::error::Error) -> String {
    error.source().map_or_else(|| error.to_string(), root_cause)
}

/// Means of `samples` by `samples` squares of a finer picture.
fn averaged(fine: &[u8], width: usize, height: usize, samples: usize) -> Vec<u8> {
    let mut coarse = Vec::with_capacity(3 * width * height);
    let mut sums = vec![0u32; 3 * width];
    for rows in fine.chunks_exact(3 * width * samples * samples) {
        sums.fill(0);
        for row in rows.chunks_exact(3 * width * samples) {
            for (sum, square) in sums.chunks_exact_mut(3).zip(row.chunks_exact(3 * samples)) {
                for pixel in square.chunks_exact(3) {
                    for (total, &byte) in sum.iter_mut().zip(pixel) {
                        *total += u32::from(byte);
                    }
                }
            }
        }
        let count = (samples * samples) as u32;
        coarse.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    coarse
}

const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// The embedded font; `None` only if the file in the source tree is broken, which a test excludes.
static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(include_bytes!("font/DejaVuSans-subset.ttf")).ok());

/// The glyphs of `text` side by side from x = 0 and the width of the whole; `size` is the em [px].
fn set_type(font: &FontRef, text: &str, size: f64) -> (Vec<Glyph>, f64) {
    let em = font.units_per_em().unwrap_or(2048.0);
    let scale = PxScale::from(size as f32 * font.height_unscaled() / em);
    let scaled = font.as_scaled(scale);
    let mut x = 0.0;
    let mut glyphs = Vec::new();
    for c in text.chars() {
        let id = font.glyph_id(c);
        glyphs.push(id.with_scale_and_position(scale, point(x, 0.0)));
        x += scaled.h_advance(id);
    }
    (glyphs, f64::from(x))
}

/// Width of a text [px].
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    FONT.as_ref().map_or(0.0, |font| set_type(font, text, size).1)
}

/// The text layout of plotters leaves out the space before each glyph, which makes words look uneven; hence this one.
#[allow(clippy::too_many_arguments)]
fn draw_text(pixels: &mut [u8], width: usize, at: Place, text: &str, size: f64, colour: Colour, align: Align, upward: bool) {
    let Some(font) = FONT.as_ref() else { return };
    let (glyphs, length) = set_type(font, text, size);
    let before = match align {
        Align::Left => 0.0,
        Align::Centre => 0.5 * length,
        Align::Right => length,
    };
    for outline in glyphs.into_iter().filter_map(|glyph| font.outline_glyph(glyph)) {
        let corner = outline.px_bounds().min;
        outline.draw(|column, row, coverage| {
            let along = f64::from(corner.x) + f64::from(column) - before;
            let down = f64::from(corner.y) + f64::from(row);
            let (x, y) = if upward { (at[0] + down, at[1] - along) } else { (at[0] + along, at[1] + down) };
            if x < 0.0 || y < 0.0 || x as usize >= width {
                return;
            }
            let first = 3 * (y as usize * width + x as usize);
            let Some(pixel) = pixels.get_mut(first..first + 3) else { return };
            for (byte, target) in pixel.iter_mut().zip(colour) {
                *byte = (f32::from(*byte) + (f32::from(target) - f32::from(*byte)) * coverage.clamp(0.0, 1.0)).round() as u8;
            }
        });
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::io::file::tests::Folder;

    /// Width and height from the header of a PNG file.
    pub fn png_size(path: &Path) -> (u32, u32) {
        let bytes = std::fs::read(path).unwrap();
        assert_eq!(bytes[..8], *b"\x89PNG\r\n\x1a\n");
        assert_eq!(bytes[12..16], *b"IHDR");
        let number = |first: usize| u32::from_be_bytes(bytes[first..first + 4].try_into().unwrap());
        (number(16), number(20))
    }

    #[test]
    fn the_font_has_every_sign_we_use() {
        let font = FONT.as_ref().unwrap();
        for c in "Az0 äöüßé αβγθλφψωΔΩ −×·²³°±≤≥∫∂∑√∞ ⁰¹⁴⁵⁶⁷⁸⁹⁻⁺₀₉ →…".chars()
        {
            assert_ne!(font.glyph_id(c).0, 0, "{c}");
        }
        assert!((text_width("mm", 20.0) - 2.0 * text_width("m", 20.0)).abs() < 1e-3);
    }

    #[test]
    fn text_is_drawn_where_it_was_asked_for() {
        for upward in [false, true] {
            let mut picture = Picture::new(100.0, 100.0);
            let (at, text) = ([50.0, 60.0], "HHH".to_owned());
            picture.shapes.push(Shape::Text { at, text, size: 20.0, colour: [0; 3], align: Align::Left, upward });
            let pixels = picture.pixels(1.0, 100, 100).unwrap();
            let dark = |x: usize, y: usize| pixels[3 * (y * 100 + x)] < 128;
            let found: Vec<_> = (0..10_000).map(|i| (i % 100, i / 100)).filter(|&(x, y)| dark(x, y)).collect();
            let (x0, x1) = (found.iter().map(|p| p.0).min().unwrap(), found.iter().map(|p| p.0).max().unwrap());
            let (y0, y1) = (found.iter().map(|p| p.1).min().unwrap(), found.iter().map(|p| p.1).max().unwrap());
            let expected = if upward { [35, 50, 16, 58] } else { [51, 94, 45, 60] };
            for (found, expected) in [x0, x1, y0, y1].into_iter().zip(expected) {
                assert!(found.abs_diff(expected) <= 2, "{upward}: {:?} {expected:?}", [x0, x1, y0, y1]);
            }
        }
    }

    #[test]
    fn both_files_have_the_right_size_and_nothing_remains() {
        let folder = Folder::new("picture");
        let mut picture = Picture::new(120.0, 80.0);
        picture.line(vec![[10.0, 10.0], [110.0, 70.0]], 2.0, PALETTE[0]);
        picture.text([60.0, 40.0], "a < b & c", 12.0, INK, Align::Centre);
        picture.write(&folder.0.join("run.1")).unwrap();
        assert_eq!(folder.names(), ["run.1.png", "run.1.svg"]);
        assert_eq!(png_size(&folder.0.join("run.1.png")), (240, 160));
        let svg = std::fs::read_to_string(folder.0.join("run.1.svg")).unwrap();
        assert!(svg.starts_with("<svg width=\"120\" height=\"80\"") && svg.contains("viewBox=\"0 0 1920 1280\""));
        assert!(svg.contains("a &lt; b &amp; c") && svg.trim_end().ends_with("</svg>"));
    }

    #[test]
    fn a_picture_that_cannot_be_written_says_which() {
        let folder = Folder::new("picture-error");
        std::fs::create_dir(folder.0.join("taken.png")).unwrap();
        let error = Picture::new(10.0, 10.0).write(&folder.0.join("taken")).unwrap_err().to_string();
        assert!(error.contains("taken.png"), "{error}");
        assert_eq!(folder.names(), ["taken.png"]);
        assert!(Picture::new(10.0, 10.0).write(Path::new("..")).unwrap_err().to_string().contains("file name"));
    }
}
