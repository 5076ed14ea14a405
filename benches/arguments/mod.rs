//! What benches are told on the command line.

/// Whether to measure, and the scenes named. Without `--bench`, which `cargo bench` adds and `cargo test --benches` does
/// not, a look at whether all of it runs is enough.
pub fn arguments() -> (bool, Vec<String>) {
    let bench = std::env::args().any(|argument| argument == "--bench");
    (bench, std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect())
}
