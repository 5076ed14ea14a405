//! Mitsuba 3, by its Python module.

use super::output;
use crate::converge::run::Shot;
use crate::error::{Error, Result};
use crate::measure::wall_seconds;
use crate::picture::io;
use std::path::Path;
use std::process::Command;

/// Says the version, or fails.
const VERSION: &str = "import mitsuba, numpy; mitsuba.set_variant('scalar_rgb'); print(mitsuba.__version__)";

/// Renders `FILE SAMPLES OUT SEED..` on one thread, prints the seconds, and writes OUT-0.pfm and so on.
///
/// Its own files are not used: with one thread, Mitsuba 3.9.1 hangs when it writes a second one.
const RENDER: &str = "\
import sys, time
import drjit, mitsuba, numpy
mitsuba.set_variant('scalar_rgb')
drjit.set_thread_count(1)
file, samples, out, *seeds = sys.argv[1:]
scene = mitsuba.load_file(file)
start = time.perf_counter()
pictures = [numpy.array(mitsuba.render(scene, seed=int(s), spp=int(samples)), '<f4') for s in seeds]
print(time.perf_counter() - start, flush=True)
for i, picture in enumerate(pictures):
    height, width, _ = picture.shape
    with open(f'{out}-{i}.pfm', 'wb') as f:
        f.write(f'PF\\n{width} {height}\\n-1.0\\n'.encode() + picture[::-1, :, :3].tobytes())
";

fn python() -> Command {
    Command::new(if cfg!(windows) { "python" } else { "python3" })
}

pub(super) fn version() -> std::result::Result<String, String> {
    let said = output(python().args(["-c", VERSION])).map_err(|e| e.to_string())?;
    Ok(format!("Mitsuba {}", said.trim()))
}

/// Both halves in one run. Of its wall time, what is not rendering (start of Python, reading the scene) is the build.
pub(super) fn render(file: &Path, samples: u32, seeds: [u64; 2]) -> Result<Shot> {
    let out = file.with_extension("");
    // Mitsuba's seeds have 32 bits.
    let seeds = seeds.map(|seed| (seed & u64::from(u32::MAX)).to_string());
    let start = wall_seconds();
    let mut command = python();
    command.args(["-c", RENDER]).arg(file).arg((samples / 2).to_string()).arg(&out).args(seeds);
    let said = output(&mut command)?;
    let wall = wall_seconds() - start;
    let trace: f64 = said
        .trim()
        .parse()
        .map_err(|_| Error::invalid(format!("Mitsuba said `{}` where seconds were awaited", said.trim())))?;
    let half = |i: u32| {
        let mut name = out.clone().into_os_string();
        name.push(format!("-{i}.pfm"));
        io::read(Path::new(&name))
    };
    Ok(Shot { halves: vec![half(0)?, half(1)?], build: (wall - trace).max(0.0), trace, wall })
}
