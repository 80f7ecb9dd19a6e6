//! A picture as a list of shapes, drawn once for the screen (PNG) and once for print (SVG).

use crate::io::file::{Aside, IoError};
use crate::io::xml::xml_text;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use ttf_parser::{Face, OutlineBuilder};
use zeno::{Cap, Command, Join, Mask, PathBuilder, Placement, Stroke, Transform};

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
        std::fs::write(&svg_aside.part, self.svg()).map_err(|cause| IoError::new(&svg, cause))?;
        self.write_png(&png_aside.part).map_err(|cause| IoError::new(&png, cause))?;
        svg_aside.publish()?;
        png_aside.publish()
    }

    fn svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        let mut svg = format!(
            "<svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
             xmlns=\"http://www.w3.org/2000/svg\" font-family=\"{FAMILY}\" stroke-linejoin=\"round\" \
             stroke-linecap=\"round\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        );
        for shape in &self.shapes {
            svg += &shape.svg();
        }
        svg + "</svg>\n"
    }

    fn write_png(&self, path: &Path) -> Result<(), png::EncodingError> {
        const SCALE: f64 = 2.0;
        let [width, height] = [self.width, self.height].map(|length| (length.round() * SCALE) as usize);
        let file = std::io::BufWriter::new(std::fs::File::create(path)?);
        let mut encoder = png::Encoder::new(file, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        // lines on paper: what filters win on photographs they lose here
        encoder.set_compression(png::Compression::Default);
        encoder.set_filter(png::FilterType::NoFilter);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.pixels(SCALE, width, height))?;
        writer.finish()
    }

    /// The picture in `scale` times its size, three bytes a pixel.
    fn pixels(&self, scale: f64, width: usize, height: usize) -> Vec<u8> {
        let mut pixels = vec![255; 3 * width * height];
        for shape in &self.shapes {
            let (mask, Placement { left, top, width: columns, .. }) = shape.mask(scale as f32);
            for (row, coverage) in (i64::from(top)..).zip(mask.chunks(columns.max(1) as usize)) {
                for (column, &share) in (i64::from(left)..).zip(coverage) {
                    if share == 0 || !(0..height as i64).contains(&row) || !(0..width as i64).contains(&column) {
                        continue;
                    }
                    let first = 3 * (row as usize * width + column as usize);
                    for (byte, target) in pixels[first..first + 3].iter_mut().zip(shape.colour()) {
                        let (paper, ink) = (u32::from(255 - share), u32::from(share));
                        *byte = ((u32::from(*byte) * paper + u32::from(target) * ink + 127) / 255) as u8;
                    }
                }
            }
        }
        pixels
    }
}

/// Writes pictures of one size as a film in APNG that lasts some time \[s\] and is played over and over.
pub(super) fn write_film(
    pictures: impl ExactSizeIterator<Item = Picture>,
    duration: f64,
    path: &Path,
) -> Result<(), IoError> {
    let (count, mut pictures) = (pictures.len(), pictures.peekable());
    let Some(first) = pictures.peek() else { return Ok(()) };
    let [width, height] = [first.width, first.height].map(|length| length.round() as usize);
    let aside = Aside::beside(path)?;
    let written = || -> Result<(), png::EncodingError> {
        let file = std::io::BufWriter::new(std::fs::File::create(&aside.part)?);
        let mut encoder = png::Encoder::new(file, width as u32, height as u32);
        encoder.set_color(png::ColorType::Rgb);
        // lines on paper: what filters win on photographs they lose here
        encoder.set_compression(png::Compression::Default);
        encoder.set_filter(png::FilterType::NoFilter);
        encoder.set_animated(count as u32, 0)?;
        let milliseconds = (1e3 * duration / count as f64).round().clamp(10.0, 60_000.0);
        encoder.set_frame_delay(milliseconds as u16, 1000)?;
        let mut writer = encoder.write_header()?;
        for picture in pictures {
            writer.write_image_data(&picture.pixels(1.0, width, height))?;
        }
        writer.finish()
    };
    written().map_err(|cause| IoError::new(path, cause))?;
    aside.publish()
}

impl Shape {
    fn colour(&self) -> Colour {
        let (Self::Line { colour, .. } | Self::Area { colour, .. } | Self::Disc { colour, .. } | Self::Text { colour, .. }) =
            self;
        *colour
    }

    /// The element that draws it.
    fn svg(&self) -> String {
        let [r, g, b] = self.colour();
        let colour = format!("#{r:02x}{g:02x}{b:02x}");
        match self {
            Self::Line { width, .. } => {
                format!("<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>\n", self.path())
            }
            Self::Area { .. } | Self::Disc { .. } => format!("<path d=\"{}\" fill=\"{colour}\"/>\n", self.path()),
            Self::Text { at: [x, y], text, size, align, upward, .. } => {
                let [x, y] = [x, y].map(|&length| fine(length));
                let anchor = match align {
                    Align::Left => "start",
                    Align::Centre => "middle",
                    Align::Right => "end",
                };
                let turn = if *upward { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
                let text = xml_text(text);
                format!(
                    "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{colour}\"{turn}>\
                     {text}</text>\n"
                )
            }
        }
    }

    /// Its course in the language of SVG; of a text none.
    fn path(&self) -> String {
        match self {
            Self::Line { points, .. } | Self::Area { points, .. } => {
                let places: Vec<_> = points.iter().map(|&[x, y]| format!("{},{}", fine(x), fine(y))).collect();
                format!("M{}", places.join(" "))
            }
            Self::Disc { centre: [x, y], radius, .. } => {
                let [x, y, r] = [x - radius, *y, *radius].map(fine);
                let d = 2.0 * r;
                format!("M{x},{y}a{r},{r} 0 1 0 {d},0a{r},{r} 0 1 0 -{d},0z")
            }
            Self::Text { .. } => String::new(),
        }
    }

    /// How much of each pixel it covers, of 255, in the picture `scale` times its size.
    fn mask(&self, scale: f32) -> (Vec<u8>, Placement) {
        let enlarged = Transform::scale(scale, scale);
        match self {
            Self::Text { at, text, size, align, upward, .. } => {
                let Typeset { path, x: length, .. } = set_type(text, *size);
                let before = match align {
                    Align::Left => 0.0,
                    Align::Centre => 0.5 * length,
                    Align::Right => length,
                };
                let [x, y] = at.map(|length| length as f32);
                let [along, down] = if *upward { [0.0, -1.0] } else { [1.0, 0.0] };
                let placed = Transform::new(along, down, -down, along, x - before * along, y - before * down);
                Mask::new(&path).transform(Some(placed.then(&enlarged))).render()
            }
            Self::Line { width, .. } => {
                let mut stroke = Stroke::new(*width as f32);
                stroke.cap(Cap::Round).join(Join::Round);
                Mask::new(self.path().as_str()).style(stroke).transform(Some(enlarged)).render()
            }
            Self::Area { .. } | Self::Disc { .. } => Mask::new(self.path().as_str()).transform(Some(enlarged)).render(),
        }
    }
}

/// Rounded to a hundredth of a pixel, which no eye resolves, so that files stay small.
fn fine(length: f64) -> f64 {
    (100.0 * length).round() / 100.0
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

const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// The embedded font; `None` only if the file in the source tree is broken, which a test excludes.
static FONT: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("font/DejaVuSans-subset.ttf"), 0).ok());

/// Outlines of letters side by side, the baseline at y = 0 with y downwards \[px\].
#[derive(Default)]
struct Typeset {
    path: Vec<Command>,
    /// Where the next letter begins.
    x: f32,
    /// Size of a unit of the font.
    unit: f32,
}

impl Typeset {
    fn at(&self, x: f32, y: f32) -> [f32; 2] {
        [self.x + self.unit * x, -self.unit * y]
    }
}

impl OutlineBuilder for Typeset {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.at(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.at(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.at(x1, y1), self.at(x, y));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.curve_to(self.at(x1, y1), self.at(x2, y2), self.at(x, y));
    }

    fn close(&mut self) {
        self.path.close();
    }
}

/// `text` in letters whose em is `size` \[px\].
fn set_type(text: &str, size: f64) -> Typeset {
    let mut set = Typeset::default();
    let Some(font) = FONT.as_ref() else { return set };
    set.unit = size as f32 / f32::from(font.units_per_em());
    for c in text.chars() {
        let letter = font.glyph_index(c).unwrap_or_default();
        font.outline_glyph(letter, &mut set);
        set.x += set.unit * f32::from(font.glyph_hor_advance(letter).unwrap_or(0));
    }
    set
}

/// Width of a text \[px\].
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    f64::from(set_type(text, size).x)
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
            assert!(font.glyph_index(c).is_some(), "{c}");
        }
        assert!((text_width("mm", 20.0) - 2.0 * text_width("m", 20.0)).abs() < 1e-3);
    }

    #[test]
    fn text_is_drawn_where_it_was_asked_for() {
        for upward in [false, true] {
            let mut picture = Picture::new(100.0, 100.0);
            let (at, text) = ([50.0, 60.0], "HHH".to_owned());
            picture.shapes.push(Shape::Text { at, text, size: 20.0, colour: [0; 3], align: Align::Left, upward });
            let pixels = picture.pixels(1.0, 100, 100);
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
        assert!(svg.starts_with("<svg width=\"120\" height=\"80\"") && svg.contains("viewBox=\"0 0 120 80\""));
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
