//! The program itself as a process of its own, in a folder of its own.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A folder in which the program runs, removed with what is in it when dropped.
pub struct Place {
    program: PathBuf,
    pub folder: PathBuf,
}

/// How a process ended.
pub struct Ended {
    /// Its exit status; `None` after a signal.
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
    /// It was told to stop after its time, and did so.
    pub told: bool,
    /// It did not even stop then.
    pub hung: bool,
}

/// Seconds for a process that was told to stop.
const PATIENCE: Duration = Duration::from_secs(20);

impl Drop for Place {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl Place {
    /// An empty folder.
    pub fn new(name: &str) -> Result<Self, String> {
        let folder = std::env::temp_dir().join(format!("costate-robustness-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let program = std::env::current_exe().map_err(|error| format!("the program's own file: {error}"))?;
        Ok(Place { program, folder })
    }

    /// Removes what is in the folder.
    pub fn clear(&self) -> Result<(), String> {
        let cleared = fs::remove_dir_all(&self.folder).and_then(|()| fs::create_dir_all(&self.folder));
        cleared.map_err(|error| format!("{}: {error}", self.folder.display()))
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Starts the program, which may write files up to so many blocks of 512 bytes, as if the disk were full then.
    pub fn start(&self, arguments: &[String], blocks: Option<u64>) -> Result<Running, String> {
        let mut command = Command::new(&self.program);
        if let Some(blocks) = blocks {
            command = Command::new("sh");
            let shell = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
            command.args(["-c", &shell]).arg(&self.program);
        }
        // a count of its own: processes run beside each other
        static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        let logs = [".out", ".err"].map(|end| self.folder.with_extension(format!("{count}{end}")));
        let log = |path: &Path| File::create(path).map_err(|error| format!("{}: {error}", path.display()));
        let child = command
            .args(arguments)
            .current_dir(&self.folder)
            .stdin(Stdio::null())
            .stdout(log(&logs[0])?)
            .stderr(log(&logs[1])?)
            .spawn()
            .map_err(|error| format!("{}: {error}", self.program.display()))?;
        Ok(Running { child, logs })
    }

    /// Runs it to its end, or until it is told to stop.
    pub fn run(&self, arguments: &[String], blocks: Option<u64>, longest: Duration) -> Result<Ended, String> {
        self.start(arguments, blocks)?.end(longest)
    }
}

/// A process under way.
pub struct Running {
    child: Child,
    logs: [PathBuf; 2],
}

impl Running {
    fn wait(&mut self, longest: Duration) -> Result<bool, String> {
        let begun = Instant::now();
        loop {
            if self.child.try_wait().map_err(|error| error.to_string())?.is_some() {
                return Ok(true);
            }
            if begun.elapsed() >= longest {
                return Ok(false);
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Kills it after a while, as nothing can prevent; whether it was still running.
    pub fn kill_after(mut self, time: Duration) -> Result<bool, String> {
        let ended = self.wait(time)?;
        self.child.kill().and_then(|()| self.child.wait()).map_err(|error| error.to_string())?;
        self.log();
        Ok(!ended)
    }

    /// Waits for its end, or tells it to stop.
    pub fn end(mut self, longest: Duration) -> Result<Ended, String> {
        let (mut told, mut hung) = (false, false);
        if !self.wait(longest)? {
            told = true;
            let signal = Command::new("kill").arg(self.child.id().to_string()).status();
            signal.map_err(|error| format!("kill: {error}"))?;
            hung = !self.wait(PATIENCE)?;
            if hung {
                self.child.kill().map_err(|error| error.to_string())?;
            }
        }
        let status = self.child.wait().map_err(|error| error.to_string())?;
        let [out, err] = self.log();
        Ok(Ended { code: status.code(), out, err, told, hung })
    }

    /// What it wrote.
    fn log(&self) -> [String; 2] {
        [0, 1].map(|place| {
            let bytes = fs::read(&self.logs[place]).unwrap_or_default();
            let _ = fs::remove_file(&self.logs[place]);
            String::from_utf8_lossy(&bytes).into_owned()
        })
    }
}

impl Ended {
    /// The last line of a successful run with `--json`, and its histories: all that it found, digit by digit, but for what it cost.
    pub fn results(&self, histories: &Path) -> Option<String> {
        if self.code != Some(0) {
            return None;
        }
        let object: serde_json::Value = serde_json::from_str(self.out.lines().last()?).ok()?;
        let table = fs::read_to_string(histories).ok()?;
        // gradients stand with their functionals
        Some(format!("{}\n{table}", object["functionals"]))
    }

    /// What a user cannot do anything with: a panic, a signal, silence.
    pub fn is_wrong(&self) -> bool {
        let silent = self.code != Some(0) && self.err.trim().is_empty();
        let unknown = !self.told && !matches!(self.code, Some(0..=2));
        self.hung || silent || unknown || self.err.contains("panicked") || self.code == Some(101)
    }
}

/// Words of a command line.
pub fn words(line: &str) -> Vec<String> {
    line.split_whitespace().map(String::from).collect()
}
