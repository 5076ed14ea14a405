//! What a measurement was made on.

/// The machine and the build that a measurement was made with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Name of the processor, or the architecture where the system does not tell.
    pub cpu: String,
    /// Threads that run at once, at least 1.
    pub threads: usize,
    /// Instruction sets that the compiler was allowed to use beyond the architecture's baseline.
    pub features: &'static str,
    /// True for a build with debug assertions: its times mean little.
    pub debug: bool,
}

impl Machine {
    /// This machine.
    pub fn this() -> Self {
        let features = if cfg!(target_feature = "avx512f") {
            "avx512"
        } else if cfg!(target_feature = "avx2") {
            "avx2"
        } else {
            "baseline"
        };
        let cpu = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| cpu_name(&text));
        Self {
            cpu: cpu.unwrap_or_else(|| std::env::consts::ARCH.to_string()),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            features,
            debug: cfg!(debug_assertions),
        }
    }
}

impl std::fmt::Display for Machine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let debug = if self.debug { ", DEBUG BUILD" } else { "" };
        write!(f, "{}, {} threads, {} {} code{debug}", self.cpu, self.threads, std::env::consts::ARCH, self.features)
    }
}

/// The value of the first `model name` line of Linux's list of processors.
fn cpu_name(text: &str) -> Option<String> {
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_processor_name() {
        assert_eq!(cpu_name("processor\t: 0\nmodel name\t: Some CPU 9\n").as_deref(), Some("Some CPU 9"));
        assert_eq!(cpu_name("Hardware: x"), None);
        assert!(Machine::this().threads >= 1);
    }
}
