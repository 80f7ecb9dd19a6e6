//! The report in a browser: opens without a message on the console, plays, takes its colours and its keys.
//!
//! A test writes reports, puts a script behind that of the page, and lets Chromium print the page that comes out of it: no driver is
//! needed, only the browser, of which `COSTATE_BROWSER` is the path where it is not called `chromium`. Ignored where none is:
//!
//! ```sh
//! cargo test --release --test report -- --ignored
//! ```

use base64::Engine;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Collects what the page complains about; stands before all its scripts.
const LISTEN: &str = r#"<script>
window.complaints = [];
addEventListener("error", (event) => complaints.push(String(event.message)));
for (const level of ["error", "warn"]) {
  const own = console[level];
  console[level] = (...words) => { complaints.push(words.join(" ")); own(...words); };
}
</script>"#;

/// What a reader does, and what is seen then; stands behind all scripts of the page.
const READ: &str = r#"<script>
const seen = { complaints, title: document.title, tables: document.querySelectorAll("section table").length,
  command: document.getElementById("command").textContent,
  links: [...document.getElementById("files").querySelectorAll("a")].map((link) => link.getAttribute("href")),
  bars: [...document.getElementById("bars").querySelectorAll("section")].map((section) => ({
    heading: section.querySelector("h2").textContent,
    rows: [...section.querySelectorAll(".bars i")].map((bar) => ({ name: bar.parentElement.previousElementSibling.textContent,
      number: bar.parentElement.nextElementSibling.textContent, width: bar.getBoundingClientRect().width, below: bar.className === "below" })),
  })),
  parts: [...document.getElementById("legend").querySelectorAll("i.part")].map((own) => own.style.color),
  charts: document.querySelectorAll(".uplot").length, webgl: costate.state.webgl };
const canvas = document.getElementById("canvas"), slider = document.getElementById("time"), colour = document.getElementById("colour");
const look = () => ({ frame: Number(canvas.dataset.frame), time: costate.state.time, clock: document.getElementById("clock").textContent,
  picture: canvas.toDataURL("image/png") });
if (!document.getElementById("space").hidden) {
  seen.frames = costate.report.clips[0].times.length;
  seen.start = look();
  slider.value = 0.5 * (Number(slider.min) + Number(slider.max));
  slider.dispatchEvent(new Event("input"));
  seen.half = look();
  slider.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true, cancelable: true }));
  seen.key = look();
  seen.colours = [...colour.options].map((option) => {
    colour.value = option.value;
    colour.dispatchEvent(new Event("change"));
    return { name: option.textContent, picture: look().picture, key: document.getElementById("key").innerText };
  });
}
const result = document.createElement("script");
result.type = "application/json";
result.id = "seen";
result.textContent = JSON.stringify(seen);
document.body.append(result);
</script>"#;

/// A folder of its own for one test, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("costate-report-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    /// The report of a command in this folder, which ends with a code.
    fn report_with_code(&self, code: i32, arguments: &[&str], name: &str) -> PathBuf {
        let mut run = Command::new(env!("CARGO_BIN_EXE_costate"));
        let output = run.args(arguments).args(["--out", "out"]).current_dir(&self.0).output().unwrap();
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        self.0.join("out").join(name)
    }
    fn report(&self, arguments: &[&str], name: &str) -> PathBuf {
        self.report_with_code(0, arguments, name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Chromium with a page and some more arguments.
fn browser(folder: &Folder, page: &Path, arguments: &[&str]) -> String {
    let program = std::env::var("COSTATE_BROWSER").unwrap_or_else(|_| "chromium".into());
    let profile = format!("--user-data-dir={}", folder.0.join("profile").display());
    let common = "--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
        --disable-component-update --disable-sync --use-angle=swiftshader --enable-unsafe-swiftshader --hide-scrollbars \
        --virtual-time-budget=4000";
    let run = Command::new(&program)
        .args(common.split_whitespace())
        .arg(profile)
        .args(arguments)
        .arg(format!("file://{}", page.display()))
        .output();
    let output = run.unwrap_or_else(|error| panic!("{program}: {error}; COSTATE_BROWSER names another browser"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// What a reader sees of a report.
fn read(folder: &Folder, report: &Path) -> Value {
    let size = fs::metadata(report).unwrap().len();
    assert!(size < 10_000_000, "{} has {size} bytes", report.display());
    let html = fs::read_to_string(report).unwrap();
    assert!(!html.contains("src=\"http") && !html.contains("href=\"http"), "the page is whole");
    let page = html.replacen("<head>", &format!("<head>{LISTEN}"), 1).replacen("</body>", &format!("{READ}</body>"), 1);
    let path = folder.0.join("page.html");
    fs::write(&path, page).unwrap();
    let shown = browser(folder, &path, &["--dump-dom", "--window-size=1200,1000"]);
    let seen = shown.split("id=\"seen\">").nth(1).and_then(|rest| rest.split("</script>").next());
    serde_json::from_str(seen.unwrap_or_else(|| panic!("the script did not end: {}", &shown[..shown.len().min(2000)])))
        .unwrap()
}

/// Red, green, blue and cover of each point of a picture.
fn pixels(picture: &Value) -> Vec<u8> {
    let bytes = base64::prelude::BASE64_STANDARD.decode(picture.as_str().unwrap().split(',').nth(1).unwrap()).unwrap();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size()];
    reader.next_frame(&mut pixels).unwrap();
    pixels
}

/// Number of colours in a picture: an empty canvas has one.
fn colours(picture: &Value) -> usize {
    let pixels = pixels(picture);
    let all: std::collections::HashSet<&[u8]> = pixels.chunks_exact(4).collect();
    all.len()
}

/// Pixels of a picture for each of 36 hues; grey ones have none.
fn hues(picture: &Value) -> [usize; 36] {
    let mut count = [0; 36];
    for pixel in pixels(picture).chunks_exact(4) {
        let [r, g, b] = [0, 1, 2].map(|k| f64::from(pixel[k]));
        if let Some(hue) = hue([r, g, b]) {
            count[hue] += 1;
        }
    }
    count
}

/// Which ten degrees of the colour circle a colour is in; none of what is nearly grey.
fn hue([r, g, b]: [f64; 3]) -> Option<usize> {
    let (most, least) = (r.max(g).max(b), r.min(g).min(b));
    let turn = match most {
        _ if most - least < 60.0 => return None,
        _ if most == r => (g - b) / (most - least),
        _ if most == g => 2.0 + (b - r) / (most - least),
        _ => 4.0 + (r - g) / (most - least),
    };
    Some((6.0 * turn.rem_euclid(6.0)) as usize % 36)
}

fn check_motion(seen: &Value) {
    assert_eq!(seen["complaints"], json!([]));
    assert_eq!(seen["webgl"], true, "the browser draws in space");
    assert!(colours(&seen["start"]["picture"]) > 50, "something is drawn");
    assert!(seen["half"]["frame"].as_u64().unwrap() > seen["start"]["frame"].as_u64().unwrap());
    assert_ne!(seen["start"]["picture"], seen["half"]["picture"], "the slider moves the mechanism");
    assert_ne!(seen["half"]["clock"], seen["start"]["clock"]);
    assert!(seen["key"]["time"].as_f64().unwrap() > seen["half"]["time"].as_f64().unwrap(), "a key moves the slider");
}

/// The moment and the colours of the README's picture.
const POSE: &str = r#"<script>
addEventListener("load", () => setTimeout(() => {
  const slider = document.getElementById("time"), colour = document.getElementById("colour");
  slider.value = 1.75;
  slider.dispatchEvent(new Event("input"));
  colour.selectedIndex = 2;
  colour.dispatchEvent(new Event("change"));
}, 300));
</script>"#;

/// Takes the picture examples/report.png of the README anew, beside the other files of tests.
fn take_picture(folder: &Folder, report: &Path) {
    let html = fs::read_to_string(report).unwrap().replacen("</body>", &format!("{POSE}</body>"), 1);
    let page = folder.0.join("pose.html");
    fs::write(&page, html).unwrap();
    let picture = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report.png");
    let _ = fs::remove_file(&picture);
    browser(folder, &page, &[&format!("--screenshot={}", picture.display()), "--window-size=1180,1355"]);
    let pixels = png::Decoder::new(std::io::BufReader::new(fs::File::open(&picture).unwrap())).read_info().unwrap();
    assert_eq!((pixels.info().width, pixels.info().height), (1180, 1355), "{}", picture.display());
}

fn names(seen: &Value) -> Vec<&str> {
    seen["colours"].as_array().unwrap().iter().map(|colour| colour["name"].as_str().unwrap()).collect()
}

#[test]
#[ignore = "needs Chromium"]
fn the_report_of_a_gradient_plays_and_is_coloured() {
    let folder = Folder::new("gradient");
    let report = folder.report(&["gradient", "five-bar", "--check"], "report.html");
    let seen = read(&folder, &report);
    check_motion(&seen);
    assert_eq!(seen["title"], "five-bar: simulation and gradient");
    // functionals and gradient; x, y, energy, forces of joints, whose moments are rounding
    assert_eq!((&seen["tables"], &seen["charts"]), (&json!(2), &json!(4)));
    assert_eq!(names(&seen)[..2], ["part", "displacement [m]"]);
    assert!(names(&seen)[2].starts_with("d psi by a relative change"), "{:?}", names(&seen));
    let pictures: Vec<&Value> = seen["colours"].as_array().unwrap().iter().map(|colour| &colour["picture"]).collect();
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2], "colours differ");
    assert_eq!(seen["command"], "costate gradient five-bar --check --out out");
    let links: Vec<&str> = seen["links"].as_array().unwrap().iter().map(|link| link.as_str().unwrap()).collect();
    assert!(
        links.contains(&"summary.json") && links.contains(&"histories.csv") && !links.contains(&"report.html"),
        "{links:?}"
    );
    assert!(links.iter().all(|link| report.with_file_name(link).exists()), "{links:?}");
    // bars are as long as x / f df/dx, and the longest fills its half
    let summary: Value = serde_json::from_str(&fs::read_to_string(report.with_file_name("summary.json")).unwrap()).unwrap();
    let functional = &summary["functionals"][0];
    let (bars, value) = (seen["bars"].as_array().unwrap(), functional["value"].as_f64().unwrap());
    let rows = bars[0]["rows"].as_array().unwrap();
    assert_eq!(
        (bars.len(), &bars[0]["heading"], rows.len()),
        (1, &json!("What changes psi"), summary["design"].as_object().unwrap().len())
    );
    let widest = rows[0]["width"].as_f64().unwrap();
    let relative = |row: &Value| {
        let name = row["name"].as_str().unwrap();
        summary["design"][name].as_f64().unwrap() * functional["gradient"][name].as_f64().unwrap() / value
    };
    for row in rows {
        let (exact, number) = (relative(row), row["number"].as_str().unwrap().parse::<f64>().unwrap());
        assert!((number - exact).abs() <= 1e-4 * exact.abs(), "{row} {exact}");
        assert_eq!(row["below"], exact < 0.0);
        let width = widest * (exact / relative(&rows[0])).abs();
        assert!((row["width"].as_f64().unwrap() - width).abs() < 1.0, "{row} {width}");
    }
    // each body has a colour of its own, which is seen
    let parts: Vec<&str> = seen["parts"].as_array().unwrap().iter().map(|own| own.as_str().unwrap()).collect();
    let own: std::collections::BTreeSet<usize> = parts
        .iter()
        .map(|colour| {
            let numbers =
                colour.trim_start_matches("rgb(").trim_end_matches(')').split(',').map(|word| word.trim().parse().unwrap());
            hue(numbers.collect::<Vec<f64>>().try_into().unwrap()).unwrap()
        })
        .collect();
    let seen_hues = hues(&seen["start"]["picture"]);
    let near = |hue: usize| (hue + 35..=hue + 37).map(|hue| seen_hues[hue % 36]).sum::<usize>();
    assert!(parts.len() == 4 && own.len() == 4 && own.iter().all(|hue| near(*hue) > 30), "{parts:?} {own:?} {seen_hues:?}");
    take_picture(&folder, &report);
}

#[test]
#[ignore = "needs Chromium"]
fn shells_and_beams_show_their_stress() {
    for scene in ["plate-pendulum", "right-angle-cantilever"] {
        let folder = Folder::new(scene);
        let seen = read(&folder, &folder.report(&["run", scene], "report.html"));
        check_motion(&seen);
        if scene == "plate-pendulum" {
            assert_eq!(names(&seen), ["part", "displacement [m]", "stress [N/m2]"]);
        }
    }
}

#[test]
#[ignore = "needs Chromium"]
fn modes_swing_and_an_optimization_shows_its_history() {
    let folder = Folder::new("modes");
    let seen = read(&folder, &folder.report(&["modes", "von-mises-truss"], "modes.html"));
    check_motion(&seen);
    let folder = Folder::new("optimize");
    let report = folder.report_with_code(3, &["optimize", "five-bar", "--iterations", "3"], "optimization.html");
    let seen = read(&folder, &report);
    check_motion(&seen);
    assert!(seen["charts"].as_u64().unwrap() >= 2);
}
