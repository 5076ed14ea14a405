//! How much memory a structure may take unless told otherwise.

/// A quarter of the machine's memory, at most 8 GiB; 2 GiB where the machine does not say.
pub(crate) fn default_budget() -> u64 {
    const GIB: u64 = 1 << 30;
    let total = std::fs::read_to_string("/proc/meminfo").ok().and_then(|text| {
        let line = text.lines().find(|l| l.starts_with("MemTotal:"))?;
        line.split_whitespace().nth(1)?.parse::<u64>().ok()
    });
    total.map_or(2 * GIB, |kib| (kib * 1024 / 4).min(8 * GIB))
}
