//! Files that extend the hub's flights.

use super::HUB;
use costate::scenes::FileScene;
use std::path::PathBuf;

const FLIGHT: &str = include_str!("../../examples/scenes/rotor-hub-flight.toml");

/// A scene that extends the flights, read from a folder of its own.
pub fn extended(name: &str, text: &str) -> Result<FileScene, String> {
    let folder: PathBuf = std::env::temp_dir().join(format!("costate-rotor-hub-{}", std::process::id()));
    let wrong = |error: std::io::Error| format!("{}: {error}", folder.display());
    std::fs::create_dir_all(&folder).map_err(wrong)?;
    let own = format!("{name}.toml");
    let text = format!("version = 1\nextends = \"rotor-hub-flight.toml\"\n{text}");
    for (file, text) in [("rotor-hub.toml", HUB), ("rotor-hub-flight.toml", FLIGHT), (&own, &text)] {
        std::fs::write(folder.join(file), text).map_err(wrong)?;
    }
    let scene = FileScene::read(&folder.join(own));
    std::fs::remove_dir_all(&folder).map_err(wrong)?;
    scene
}
