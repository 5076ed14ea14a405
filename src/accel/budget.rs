//! How much memory a structure may take unless told otherwise.

/// A quarter of the machine's memory, at most 8 GiB; 2 GiB where the machine does not say.
pub(crate) fn default_budget() -> u64 {
    const GIB: u64 = 1 << 30;
    machine_memory().map_or(2 * GIB, |bytes| (bytes / 4).min(8 * GIB))
}

/// Half of the machine's memory, for what the user has named: a scene, a film; 4 GiB where the machine does not say.
#[cfg(feature = "scene")]
pub(crate) fn half_the_memory() -> u64 {
    machine_memory().map_or(4 << 30, |bytes| bytes / 2)
}

/// Bytes.
fn machine_memory() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|l| l.starts_with("MemTotal:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok()?.checked_mul(1024)
}
