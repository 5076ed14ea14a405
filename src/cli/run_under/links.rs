//! Which files among all that a program loads link Embree, and where the dynamic loader looks for it: ld.so(8).

use super::elf::{self, Binary};
use crate::error::Result;
use std::collections::{HashMap, HashSet, VecDeque};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::rc::Rc;

/// Where libraries are if nothing else says so.
const USUAL: [&str; 4] = ["/lib64", "/usr/lib64", "/lib", "/usr/lib"];

/// A file that links Embree.
#[derive(Clone, Debug)]
pub struct Link {
    /// The file.
    pub file: PathBuf,
    /// The name by which it asks for Embree, such as `libembree3.so.3`.
    pub name: String,
    /// The library that it gets now.
    pub found: Option<PathBuf>,
    /// True if a folder built into the file or its loaders, or a path in the name, goes before `LD_LIBRARY_PATH`.
    pub fixed: bool,
}

/// Resolves names of libraries as the dynamic loader does, and remembers what it has read.
pub struct Loader {
    /// `LD_LIBRARY_PATH`.
    path: Vec<PathBuf>,
    /// Names and files of the system's cache.
    cache: HashMap<String, Vec<PathBuf>>,
    read: HashMap<PathBuf, Option<Rc<Binary>>>,
    followed: HashSet<PathBuf>,
}

impl Loader {
    /// As this process's environment and the system have it.
    pub fn new() -> Self {
        let path = std::env::var_os("LD_LIBRARY_PATH").unwrap_or_default();
        let path = std::env::split_paths(&path).filter(|folder| !folder.as_os_str().is_empty()).collect();
        Self { path, cache: system_cache(), read: HashMap::new(), followed: HashSet::new() }
    }

    /// The files among `root` and all libraries that it loads, and they in turn, that link Embree; those that an earlier call has
    /// followed are left out. `above` are the RPATHs of what loads `root`.
    pub fn links(&mut self, root: &Path, above: &[PathBuf]) -> Vec<Link> {
        let mut links = Vec::new();
        let mut open = VecDeque::from([(root.to_path_buf(), above.to_vec())]);
        while let Some((path, above)) = open.pop_front() {
            let real = path.canonicalize().unwrap_or_else(|_| path.clone());
            if !self.followed.insert(real) {
                continue;
            }
            let Some(binary) = self.read(&path) else { continue };
            // One RUNPATH puts all RPATHs out of force.
            let before: Vec<PathBuf> = match &binary.runpath {
                Some(_) => Vec::new(),
                None => binary.rpath.iter().chain(&above).cloned().collect(),
            };
            for name in &binary.needed {
                let (found, fixed) = self.resolve(name, &binary, &before);
                if is_embree(name) {
                    let file = path.clone();
                    links.push(Link { file, name: name.clone(), found: found.clone(), fixed });
                }
                open.extend(found.map(|found| (found, before.clone())));
            }
        }
        links
    }

    /// All files that [`Loader::links`] has met.
    pub fn followed(&self) -> impl Iterator<Item = &PathBuf> {
        self.followed.iter()
    }

    /// The file that stands for `name`, and whether `LD_LIBRARY_PATH` cannot change that.
    fn resolve(&mut self, name: &str, of: &Binary, before: &[PathBuf]) -> (Option<PathBuf>, bool) {
        if name.contains('/') {
            return (Some(PathBuf::from(name)).filter(|path| path.exists()), true);
        }
        if let Some(found) = before.iter().find_map(|folder| self.fits(folder.join(name), of)) {
            return (Some(found), true);
        }
        let runpath = of.runpath.iter().flatten();
        let cached = self.cache.get(name).into_iter().flatten().cloned();
        let usual = USUAL.iter().map(Path::new);
        let places: Vec<PathBuf> = self.path.iter().chain(runpath).map(|folder| folder.join(name)).collect();
        let places = places.into_iter().chain(cached).chain(usual.map(|folder| folder.join(name)));
        (places.collect::<Vec<_>>().into_iter().find_map(|path| self.fits(path, of)), false)
    }

    /// `path` if it is for the same processor as `of`.
    fn fits(&mut self, path: PathBuf, of: &Binary) -> Option<PathBuf> {
        let machine = self.read(&path)?.machine;
        (machine == of.machine).then_some(path)
    }

    /// What is no library of 64 bits is to the loader as if it were not there.
    fn read(&mut self, path: &Path) -> Option<Rc<Binary>> {
        if let Some(known) = self.read.get(path) {
            return known.clone();
        }
        let read: Result<Binary> = elf::read(path);
        let read = read.ok().map(Rc::new);
        self.read.insert(path.to_path_buf(), read.clone());
        read
    }
}

/// True for names such as `libembree3.so.3`, `libembree4.so` and `libembree4-4aef3270.so.4`.
fn is_embree(name: &str) -> bool {
    let file = name.rsplit('/').next().unwrap_or(name);
    file.starts_with("libembree") && file.contains(".so")
}

/// What `ldconfig -p` prints; nothing on systems without it.
fn system_cache() -> HashMap<String, Vec<PathBuf>> {
    let mut cache: HashMap<String, Vec<PathBuf>> = HashMap::new();
    let run = |program: &str| Command::new(program).arg("-p").stderr(Stdio::null()).output().ok();
    let output = ["/sbin/ldconfig", "/usr/sbin/ldconfig", "ldconfig"].into_iter().find_map(run);
    let text = output.map_or(String::new(), |output| String::from_utf8_lossy(&output.stdout).into_owned());
    for line in text.lines() {
        if let Some((name, path)) = line.trim().split_once(" => ") {
            let name = name.split_whitespace().next().unwrap_or_default();
            cache.entry(name.to_string()).or_default().push(PathBuf::from(path));
        }
    }
    cache
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embree_is_told_by_its_name() {
        for name in ["libembree3.so.3", "libembree3.so", "libembree4-4aef3270.so.4", "/opt/lib/libembree4.so.4"] {
            assert!(is_embree(name), "{name}");
        }
        for name in ["libc.so.6", "libskipgrid_embree3.so", "libembree.a", "libembreeish/lib.so"] {
            assert!(!is_embree(name), "{name}");
        }
    }

    #[test]
    fn this_test_links_the_c_library_and_no_embree() {
        let this = std::env::current_exe().expect("a test is a file");
        let mut loader = Loader::new();
        assert!(loader.links(&this, &[]).is_empty());
        assert!(loader.followed().any(|path| path.to_string_lossy().contains("libc.so")));
    }
}
