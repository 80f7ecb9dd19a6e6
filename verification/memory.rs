//! Memory that this process takes.

use std::fs;

/// A line of what the kernel says about this process [bytes]; `None` where there is no such kernel.
fn status(name: &str) -> Option<f64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: f64 = line.trim_start_matches(':').trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(1024.0 * kilobytes)
}

/// Memory of this process [bytes].
pub fn memory_of_now() -> Option<f64> {
    status("VmRSS")
}

/// The most since the last [`forget_peak`] [bytes].
pub fn peak_memory() -> Option<f64> {
    status("VmHWM")
}

/// Begins a new peak; where that is not allowed the peak of the whole process is reported.
pub fn forget_peak() {
    fs::write("/proc/self/clear_refs", "5").ok();
}
