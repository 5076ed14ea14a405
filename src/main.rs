//! The program `skipgrid`.

fn main() -> std::process::ExitCode {
    skipgrid::cli::main()
}
