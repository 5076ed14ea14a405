//! Which of our libraries stands in for which Embree, and where it is looked for.

use super::elf;
use super::links::Link;
use crate::error::{Error, Result};
use std::collections::BTreeSet;
use std::fmt;
use std::path::{Path, PathBuf};

/// Builds the libraries.
const BUILD: &str = "cargo build --release -p skipgrid-embree3 -p skipgrid-embree4";

/// A version of Embree's interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// `rtcIntersect1` takes a context.
    Three,
    /// `rtcIntersect1` takes arguments.
    Four,
}

impl Version {
    /// What a file's name says.
    pub fn of(file: &str) -> Option<Self> {
        let file = file.rsplit('/').next().unwrap_or(file);
        [("embree3", Version::Three), ("embree4", Version::Four)]
            .into_iter()
            .find_map(|(name, version)| file.contains(name).then_some(version))
    }

    fn file(self) -> &'static str {
        match self {
            Version::Three => "libskipgrid_embree3.so",
            Version::Four => "libskipgrid_embree4.so",
        }
    }
}

impl fmt::Display for Version {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Version::Three => "Embree 3",
            Version::Four => "Embree 4",
        })
    }
}

/// Files that link Embree in the same way.
#[derive(Debug)]
pub struct Group {
    /// The files; at least one.
    files: Vec<PathBuf>,
    /// The name by which they ask for Embree.
    pub name: String,
    /// What they get without us.
    found: Option<PathBuf>,
    /// The interface that they speak.
    version: Version,
    /// True if the library must be preloaded, because its folder cannot go before theirs.
    pub preload: bool,
    /// Functions of Embree that they ask for.
    wanted: BTreeSet<String>,
}

/// A library of ours for some of the files.
#[derive(Debug)]
pub struct Swap {
    /// Those that get it.
    pub group: Group,
    /// The library.
    pub library: PathBuf,
}

/// Finds the library for each of `links`; and says which stay as they are, and why.
///
/// # Errors
/// Nothing can be swapped: none is Embree 3 or 4, or there is no library for any of them that has all their functions. Or two of
/// them could not be told apart once the library is preloaded.
pub fn choose(links: Vec<Link>, wish: Option<&Path>) -> Result<(Vec<Swap>, Vec<String>)> {
    let (groups, mut left) = group(links)?;
    let mut swaps = Vec::new();
    for group in groups {
        let library = library(group.version, wish)?;
        let unfit = library.as_ref().map(|library| unfit(library, &group)).transpose()?.flatten();
        match (library, unfit) {
            (Some(library), None) => swaps.push(Swap { group, library }),
            (_, Some(cause)) => left.push(cause),
            (None, None) => left.push(missing(&group, wish)),
        }
    }
    if swaps.is_empty() {
        return Err(Error::invalid(left.join("; ")));
    }
    check_names(&swaps)?;
    Ok((swaps, left))
}

/// Groups `links`, and says which are no version of Embree that we know.
fn group(links: Vec<Link>) -> Result<(Vec<Group>, Vec<String>)> {
    let (mut groups, mut left, mut unused) = (Vec::<Group>::new(), Vec::new(), None);
    for Link { file, name, found, fixed } in links {
        let Some(version) = Version::of(&name) else {
            left.push(format!("{} links {name}: neither Embree 3 nor 4", file.display()));
            continue;
        };
        let wanted = elf::functions(&file)?.wanted;
        if wanted.is_empty() {
            // Linked for nothing, as all of Mitsuba's plugins do: it is the same to them what they get.
            unused.get_or_insert(format!("{} links {name}, but calls nothing of it", file.display()));
            continue;
        }
        let wanted = wanted.into_iter();
        match groups.iter_mut().find(|g| (&g.name, &g.found, g.preload) == (&name, &found, fixed)) {
            Some(group) => {
                group.files.push(file);
                group.wanted.extend(wanted);
            }
            None => {
                groups.push(Group { files: vec![file], name, found, version, preload: fixed, wanted: wanted.collect() })
            }
        }
    }
    if groups.is_empty() && left.is_empty() {
        left.extend(unused);
    }
    Ok((groups, left))
}

/// Why `group` stays as it is.
fn missing(group: &Group, wish: Option<&Path>) -> String {
    let (who, version) = (group.files[0].display(), group.version);
    match wish {
        Some(wish) if !wish.is_dir() => format!("{who} links {version}, for which {} is not", wish.display()),
        _ => {
            let places: Vec<String> = places(wish).iter().map(|place| place.display().to_string()).collect();
            let places = places.join(" nor in ");
            format!("{who} links {version}, but {} is not in {places}: build it by `{BUILD}`", version.file())
        }
    }
}

/// Folders that may hold the libraries.
fn places(wish: Option<&Path>) -> Vec<PathBuf> {
    if let Some(wish) = wish {
        return vec![wish.to_path_buf()];
    }
    let this = std::env::current_exe().and_then(|path| path.canonicalize()).unwrap_or_default();
    let beside = this.parent().unwrap_or(Path::new("."));
    vec![beside.to_path_buf(), beside.parent().unwrap_or(beside).join("lib").join("skipgrid")]
}

/// The library for `version`: the file that the user wishes if it is of this version, else by name in the usual folders.
fn library(version: Version, wish: Option<&Path>) -> Result<Option<PathBuf>> {
    let whole = |path: &Path| path.canonicalize().map_err(|error| Error::io(path, error));
    if let Some(wish) = wish {
        let wish = whole(wish)?;
        if !wish.is_dir() {
            let said = Version::of(&wish.to_string_lossy());
            let said =
                said.ok_or_else(|| Error::malformed(&wish, "neither `embree3` nor `embree4` in the library's name"))?;
            return Ok((said == version).then_some(wish));
        }
    }
    places(wish)
        .iter()
        .map(|place| place.join(version.file()))
        .find(|path| path.is_file())
        .map(|path| whole(&path))
        .transpose()
}

/// Why `library` cannot be swapped in: it must be for the processor of those who want it, and have every function that they want.
fn unfit(library: &Path, group: &Group) -> Result<Option<String>> {
    let (ours, theirs) = (library.display(), group.files[0].display());
    if elf::read(library)?.machine != elf::read(&group.files[0])?.machine {
        return Ok(Some(format!("{ours} is for another processor than {theirs}")));
    }
    let given = elf::functions(library)?.given;
    let lacking: Vec<&String> = group.wanted.iter().filter(|name| !given.contains(name)).collect();
    let (count, all) = (lacking.len(), group.wanted.len());
    let text =
        |first: &&String| format!("{ours} lacks {count} of {all} functions that {theirs} asks for, such as {first}");
    Ok(lacking.first().map(text))
}

/// A library that is preloaded answers to its names for everybody in the process.
fn check_names(swaps: &[Swap]) -> Result<()> {
    let groups = || swaps.iter().map(|swap| &swap.group);
    for preloaded in groups().filter(|group| group.preload) {
        if let Some(other) = groups().find(|group| group.by_c_names() && group.version != preloaded.version) {
            return Err(Error::invalid(format!(
                "{} links {} and {} links {} by the same names, and one process may load both: name the one that is meant with \
                 --linked-by",
                preloaded.files[0].display(),
                preloaded.version,
                other.files[0].display(),
                other.version
            )));
        }
    }
    Ok(())
}

impl Group {
    /// True if they ask for C's names of functions, which Embree 3 and 4 share.
    fn by_c_names(&self) -> bool {
        self.wanted.iter().any(|name| !elf::in_mitsubas_namespace(name))
    }

    /// True if they ask for the names that Mitsuba's builds have.
    fn by_mitsubas_names(&self) -> bool {
        self.wanted.iter().any(|name| elf::in_mitsubas_namespace(name))
    }
}

impl fmt::Display for Swap {
    /// Who links what, and how it is swapped.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Group { files, name, found, version, preload, .. } = &self.group;
        write!(f, "{} links {version}", files[0].display())?;
        if self.group.by_mitsubas_names() {
            f.write_str(" by Mitsuba's names")?;
        }
        write!(f, " as {name}")?;
        match found {
            Some(found) => write!(f, " ({})", found.display())?,
            None => f.write_str(" (not found)")?,
        }
        if files.len() > 1 {
            write!(f, ", and so do {} more files", files.len() - 1)?;
        }
        let by = if *preload { "LD_PRELOAD" } else { "LD_LIBRARY_PATH" };
        write!(f, ": {} instead, by {by}", self.library.display())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_told_by_names() {
        for (name, version) in [
            ("libembree3.so.3", Some(Version::Three)),
            ("libembree4-4aef3270.so.4", Some(Version::Four)),
            ("/embree4/libskipgrid_embree3.so", Some(Version::Three)),
            ("libembree.so.2", None),
        ] {
            assert_eq!(Version::of(name), version, "{name}");
        }
    }
}
