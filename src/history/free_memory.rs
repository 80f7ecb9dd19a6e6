use std::fs;

/// Memory that this process may still take \[bytes\]: what the system has available, or less where a control group limits it; `None` where
/// the system does not tell.
pub(super) fn free_memory() -> Option<usize> {
    let information = fs::read_to_string("/proc/meminfo").ok()?;
    let line = information.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kilobytes: usize = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    let available = 1024 * kilobytes;
    let number = |name: &str| fs::read_to_string(format!("/sys/fs/cgroup/memory.{name}")).ok()?.trim().parse::<usize>().ok();
    let of_group = number("max").map(|most| most.saturating_sub(number("current").unwrap_or(0)));
    Some(of_group.map_or(available, |own| own.min(available)))
}
