//! Files changed at random: whatever stands in a file, it is read or refused, and nothing panics.

use costate::scenes::{AnyScene, FileScene};

/// Numbers scattered evenly, the same in every run.
struct Scatter(u64);

impl Scatter {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

/// Pieces that files are made of, and such as are not.
const PIECES: &[&str] = &[
    "",
    " ",
    "\n",
    "\"",
    "'",
    "\"\"\"",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    "{i}",
    "{i + 1}",
    "{1/0}",
    ",",
    "=",
    ".",
    "-",
    "^",
    "^^",
    "(",
    ")",
    "#",
    "0",
    "-1",
    "1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "0x7fffffffffffffff",
    "99999999999999999999",
    "1979-05-27",
    "true",
    "0.5",
    "1000",
    "sqrt(",
    "norm(",
    "cross(",
    "pi",
    "deg",
    "x",
    "\u{fc}",
    "\u{1f600}",
    "\u{0}",
    "ground",
    ".start",
    ".end",
    "[0]",
    "[1, 2]",
    "[0, 0, 0]",
    "name = \"",
    "type = \"",
    "for = { i = { from = 1, to = 3 } }\n",
    "for = { i = [1, 3] }\n",
    "for = { i = [] }\n",
    "for = { i = { from = 3, to = 1 } }\n",
    "mass = 0\n",
    "version = 1\n",
    "[[body]]\n",
    "[[joint]]\n",
    "[define]\n",
    "[variable.a]\n",
    "elements = 3\n",
    "position = ",
    "motion = {}\n",
    "section = \"\"\n",
    "[[mesh]]\n",
    "faces = [[0, 1, 2, 3]]\n",
    "points = [[0, 0, 0]]\n",
    "per_face = \"\"\n",
    "per_node = ",
    "groups = { a = [0] }\n",
    "groups = { a = \"x > 0\" }\n",
    "node_sets = { a = \"x < 1 and y >= 0 or z > 0\" }\n",
    "<",
    ">=",
    " and ",
    " or ",
    "parts = []\n",
    "reverse = []\n",
    "share",
    "stiffness = [1]\n",
];

/// A text with some changes: bytes, pieces, lines and words taken out, put in, doubled and exchanged.
fn mutated(text: &str, scatter: &mut Scatter) -> String {
    let mut own = text.to_string();
    for _ in 0..=scatter.below(4) {
        let boundary =
            |at: usize, own: &str| (0..=at.min(own.len())).rev().find(|&at| own.is_char_boundary(at)).unwrap_or(0);
        let (a, b) = (scatter.below(own.len() + 1), scatter.below(60));
        let (from, to) = (boundary(a, &own), boundary(a + b, &own));
        match scatter.below(7) {
            0 => own.replace_range(from..to, ""),
            1 => own.insert_str(from, PIECES[scatter.below(PIECES.len())]),
            2 => own.replace_range(from..to, PIECES[scatter.below(PIECES.len())]),
            3 => {
                let piece = own[from..to].to_string();
                own.insert_str(from, &piece);
            }
            4 => {
                // lines exchanged
                let mut lines: Vec<&str> = own.lines().collect();
                let (i, j) = (scatter.below(lines.len()), scatter.below(lines.len()));
                if !lines.is_empty() {
                    lines.swap(i, j);
                }
                own = lines.join("\n");
            }
            5 => {
                // a value by that of another key
                let values: Vec<(usize, usize)> = own
                    .match_indices(" = ")
                    .map(|(at, _)| (at + 3, own[at..].find('\n').map_or(own.len(), |end| at + end).max(at + 3)))
                    .collect();
                if !values.is_empty() {
                    let (to, from) = (values[scatter.below(values.len())], values[scatter.below(values.len())]);
                    let text = own[from.0..from.1].to_string();
                    own.replace_range(to.0..to.1, &text);
                }
            }
            _ => {
                // the end is missing
                let end = boundary(own.len() - scatter.below(own.len() / 4 + 1), &own);
                own.truncate(end);
            }
        }
    }
    own
}

/// Where the files stand that others name.
const NAME: &str = "examples/scenes/scene.toml";
/// A file that changes another.
const EXTENDING: &str = "version = 1\nextends = \"pendulum.toml\"\nvariable.length.initial = 2.0\npoint = [{ name = \"bob\", mass = 3 }]\n\
                         [[scenario]]\nname = \"short\"\nsettings.end = 0.1\n";

#[test]
fn whatever_is_changed_in_a_file_it_is_read_or_refused() {
    // a longer run: SCENE_MUTATIONS=1000000
    let count: usize = std::env::var("SCENE_MUTATIONS").ok().and_then(|own| own.parse().ok()).unwrap_or(4000);
    let mut texts: Vec<String> = super::files().iter().map(|path| std::fs::read_to_string(path).unwrap()).collect();
    texts.push(include_str!("coverage/meshes.toml").replace("tests/gmsh", "../../tests/gmsh"));
    // long files are slow and say nothing that short ones do not
    texts.retain(|text| text.len() < 12_000 && !text.contains("[1, 100]") && !text.contains("extends"));
    texts.push(EXTENDING.into());
    texts.sort();
    let (mut scatter, mut read, mut built) = (Scatter(1), 0, 0);
    for _ in 0..count {
        let text = mutated(&texts[scatter.below(texts.len())], &mut scatter);
        let outcome = std::panic::catch_unwind(|| match FileScene::parse(NAME, &text) {
            Ok(scene) => {
                let x: Vec<f64> = scene.variables().iter().map(|variable| variable.initial).collect();
                (true, scene.build_real(&x).is_ok())
            }
            Err(why) => {
                assert!(
                    why.lines()
                        .all(|line| ["examples/scenes/", "and ", "scenario \""].iter().any(|own| line.starts_with(own))),
                    "{why}"
                );
                (false, false)
            }
        });
        let Ok((was_read, was_built)) = outcome else { panic!("this file ends in a panic:\n{text}") };
        read += usize::from(was_read);
        built += usize::from(was_built);
    }
    println!("{count} files: {read} read, {built} built");
    // neither all nor none: the changes are neither too small nor too large to try the reader
    assert!(read > count / 50 && read < count / 2 && built > 0, "{count} files: {read} read, {built} built");
}
