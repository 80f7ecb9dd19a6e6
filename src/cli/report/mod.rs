//! One page in one file that shows a result: `report.html`, to be opened from the disk, without a network.
//!
//! The page is `page.html` with its style, its script and the libraries in it, and one JSON object with everything that it shows; arrays of
//! numbers stand in it as base64. Long histories are thinned to what a screen can show, and the page says so.

mod clip;
mod run_report;
mod sections;

pub use clip::Clip;
pub use run_report::RunReport;
pub use sections::Shown;

use super::failure::Failure;
use crate::io::{Chart, Series, Style, Table, base64, write_file};
use costate::scenes::AnyScene;
use flate2::read::GzDecoder;
use serde_json::{Map, Value, json};
use std::io::Read;
use std::path::{Path, PathBuf};

const PAGE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");
const CHART_STYLE: &str = include_str!("uplot.css");
const LICENSES: &str = include_str!("LICENSES");
/// three.js and uPlot as one script: README.md says how it is made.
const VIEWER: &[u8] = include_bytes!("viewer.js.gz");

const MOST_POINTS: usize = 2000;

/// What a page shows, in the order in which it was added within each section.
pub struct Page {
    object: Map<String, Value>,
    notes: Vec<String>,
    /// Whether histories lie beside it.
    has_files: bool,
}

/// Single precision: seven digits are more than a screen shows.
fn floats(numbers: impl IntoIterator<Item = f64>) -> Value {
    let bytes: Vec<u8> = numbers.into_iter().flat_map(|number| (number as f32).to_le_bytes()).collect();
    base64(&bytes).into()
}

/// The command that is being carried out, as a shell takes it.
fn command() -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./=:,+@%".contains(c);
    let quoted = |word: String| match word.chars().all(is_plain) && !word.is_empty() {
        true => word,
        false => format!("'{}'", word.replace('\'', r"'\''")),
    };
    let mut words = std::env::args_os().map(|word| word.to_string_lossy().into_owned());
    let program = words.next().map(PathBuf::from);
    let program = program.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
    program.chain(words).map(quoted).collect::<Vec<_>>().join(" ")
}

/// JSON that a script element may hold whatever stands in it: these characters occur in texts alone, where they are written
/// by their numbers. (A `<!--` with a `<script` behind it would keep `</script>` from ending the element.)
fn in_script(value: &Value) -> String {
    let mut text = String::new();
    for letter in value.to_string().chars() {
        match letter {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => text += &format!("\\u{:04x}", u32::from(letter)),
            _ => text.push(letter),
        }
    }
    text
}

impl Page {
    /// A page about a scene: `what` a command did to it.
    pub fn new(scene: &dyn AnyScene, what: &str) -> Self {
        let mut object = Map::new();
        object.insert("title".into(), scene.name().into());
        object.insert("summary".into(), scene.summary().into());
        object.insert("what".into(), what.into());
        object.insert("version".into(), env!("CARGO_PKG_VERSION").into());
        Page { object, notes: Vec::new(), has_files: false }
    }

    /// The same, made by the command that is being carried out.
    pub fn by_command(scene: &dyn AnyScene, what: &str) -> Self {
        let mut page = Page { has_files: true, ..Page::new(scene, what) };
        page.object.insert("command".into(), command().into());
        page
    }

    /// Adds to one of the lists of the page.
    fn push(&mut self, list: &str, entry: Value) {
        if let Value::Array(all) = self.object.entry(list).or_insert_with(|| json!([])) {
            all.push(entry);
        }
    }

    /// A name and a value below the title.
    pub fn fact(&mut self, name: &str, value: impl Into<String>) {
        self.push("facts", json!([name, value.into()]));
    }

    /// Something that a reader must not miss.
    pub fn warning(&mut self, text: impl Into<String>) {
        self.push("warnings", text.into().into());
    }

    /// What was left out, once.
    fn note(&mut self, text: String) {
        if !self.notes.contains(&text) {
            self.notes.push(text);
        }
    }

    pub fn table(&mut self, heading: &str, table: &Table) {
        self.push("tables", table.for_page(heading));
    }

    /// Bars to both sides of zero below a heading, with what they show; a number that is not finite has none.
    pub fn bars(&mut self, heading: &str, label: &str, bars: &[(String, f64)]) {
        if bars.iter().any(|(_, value)| value.is_finite()) {
            self.push("bars", json!({"heading": heading, "label": label, "bars": bars}));
        }
    }

    pub fn charts(&mut self, heading: &str, charts: &[Chart]) {
        for Chart { title, x_label, y_label, series, log_y, .. } in charts {
            let longest = series.iter().map(|own| own.points.len()).max().unwrap_or_default();
            let stride = longest.div_ceil(MOST_POINTS).max(1);
            if stride > 1 {
                let all = if self.has_files { "; histories.csv has all" } else { "" };
                self.note(format!("Charts show one of {stride} of {longest} kept points{all}."));
            }
            let kept = |own: &Series| -> Vec<(f64, f64)> {
                let last = own.points.len().saturating_sub(1);
                let points = own.points.iter().enumerate();
                points.filter(|(i, _)| i % stride == 0 || *i == last).map(|(_, point)| *point).collect()
            };
            let curves: Vec<Value> = series
                .iter()
                .map(|own| json!({"name": own.name, "dots": own.style == Style::Markers, "y": floats(kept(own).into_iter().map(|point| point.1))}))
                .collect();
            let x = series.first().map(kept).unwrap_or_default();
            let x = floats(x.into_iter().map(|point| point.0));
            let chart = json!({"heading": heading, "title": title, "x_label": x_label, "y_label": y_label, "log": log_y, "x": x, "series": curves});
            self.push("charts", chart);
        }
    }

    /// Writes the page, with links to the files that belong to it.
    pub fn write(mut self, path: &Path, files: &[PathBuf]) -> Result<(), Failure> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = files.iter().filter(|file| *file != path).filter_map(|file| file.strip_prefix(folder).ok());
        let links = beside.map(|file| file.display().to_string().replace('\\', "/"));
        self.object.insert("files".into(), links.collect::<Vec<_>>().into());
        Ok(write_file(path, self.html().as_bytes())?)
    }

    pub fn html(mut self) -> String {
        self.object.insert("notes".into(), json!(self.notes));
        let mut viewer = String::new();
        GzDecoder::new(VIEWER).read_to_string(&mut viewer).expect("the viewer is a part of the program");
        let data = in_script(&Value::from(self.object));
        let parts = [
            ("{{STYLE}}", STYLE),
            ("{{CHART_STYLE}}", CHART_STYLE),
            ("{{LICENSES}}", &LICENSES.replace('<', "&lt;")),
            ("{{VIEWER}}", &viewer),
            ("{{SCRIPT}}", SCRIPT),
            ("{{DATA}}", &data),
        ];
        let (mut html, mut rest) = (String::with_capacity(data.len() + viewer.len() + 100_000), PAGE);
        // in one pass, so that nothing in a part is taken for a place
        while let Some((at, name, text)) =
            parts.iter().filter_map(|(name, text)| Some((rest.find(name)?, *name, *text))).min_by_key(|found| found.0)
        {
            html += &rest[..at];
            html += text;
            rest = &rest[at + name.len()..];
        }
        html += rest;
        html
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::scenes::built_in;

    #[test]
    fn the_page_is_whole_and_texts_cannot_end_its_script() {
        let text = "</script><b>{{SCRIPT}}<!--<script>--> ]]> & \u{2028}\u{2029} ` ' \" \\";
        let mut page = Page::by_command(built_in::named("pendulum").unwrap(), text);
        let points = (0..5000).map(|i| (f64::from(i), 1.0)).collect();
        let series = vec![Series { name: "x".into(), points, style: Style::Line }];
        page.charts("histories", &[Chart { series, ..Chart::default() }]);
        let folder = std::env::temp_dir().join(format!("costate-page-{}", std::process::id()));
        let files = ["report.html", "meshes/a b.vtu"].map(|name| folder.join(name));
        page.write(&files[0], &files).unwrap();
        let html = std::fs::read_to_string(folder.join("report.html")).unwrap();
        std::fs::remove_dir_all(folder).unwrap();
        assert_eq!(html.matches("</script>").count(), PAGE.matches("</script>").count());
        let data = html.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).unwrap();
        let object: Value = serde_json::from_str(data).unwrap();
        assert_eq!(object["what"], text);
        assert!(!data.contains(['<', '>', '&', '\u{2028}', '\u{2029}']), "{data}");
        assert_eq!(object["files"], json!(["meshes/a b.vtu"]));
        assert!(object["command"].as_str().is_some_and(|words| words.starts_with("costate_cli-")), "{}", object["command"]);
        assert!(object["notes"][0].as_str().unwrap().contains("one of 3 of 5000 kept points"));
        // 1667 of them, and the last: 5000 - 1 is a third one anyway
        assert_eq!(object["charts"][0]["x"].as_str().unwrap().len(), (4 * 1668_usize).div_ceil(3) * 4);
    }
}
