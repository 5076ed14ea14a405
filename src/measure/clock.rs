//! Clocks: the processor time of this thread and of the whole process, where the system tells, else wall time.

use std::sync::OnceLock;
use std::time::Instant;

/// Seconds that this thread has computed, from any beginning. On a system that does not tell, wall time.
pub(crate) fn thread_seconds() -> f64 {
    #[cfg(unix)]
    return seconds(rustix::time::ClockId::ThreadCPUTime);
    #[cfg(not(unix))]
    wall_seconds()
}

/// Seconds that all threads of the program have computed together, from any beginning. On a system that does not tell,
/// wall time.
pub(crate) fn process_seconds() -> f64 {
    #[cfg(unix)]
    return seconds(rustix::time::ClockId::ProcessCPUTime);
    #[cfg(not(unix))]
    wall_seconds()
}

/// Seconds of wall time, from any beginning.
pub(crate) fn wall_seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed().as_secs_f64()
}

#[cfg(unix)]
fn seconds(clock: rustix::time::ClockId) -> f64 {
    let time = rustix::time::clock_gettime(clock);
    time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_do_not_run_backwards_and_work_is_seen() {
        for clock in [thread_seconds, process_seconds, wall_seconds] {
            let start = clock();
            let mut sum = 0u64;
            // Until the clock moves: a clock that stands still would hang here.
            while clock() <= start {
                sum = std::hint::black_box(sum.wrapping_add(1));
            }
            assert!(clock() > start);
        }
    }
}
