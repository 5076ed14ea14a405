//! What the dynamic loader reads of one ELF file, and the names of Embree's functions in it.

use crate::error::{Error, Result};
use object::elf::{self, FileHeader64};
use object::read::elf::{Dyn, ElfFile, FileHeader, ProgramHeader};
use object::read::{ReadCache, StringTable};
use object::{Endianness, Object, ObjectSymbol};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

type Data<'a> = &'a ReadCache<File>;
type Elf = FileHeader64<Endianness>;

/// Stands in every build of Embree, whether it can be swapped or not.
const MARK: &[u8] = b"Embree Ray Tracing Kernels";

/// What the dynamic loader reads of a program or library.
#[derive(Debug)]
pub struct Binary {
    /// The processor that it is for: an `EM_` constant.
    pub machine: elf::Machine,
    /// `DT_NEEDED`: the libraries that it asks for.
    pub needed: Vec<String>,
    /// `DT_RPATH`: folders looked into before `LD_LIBRARY_PATH`, for what this file loads and what that loads.
    pub rpath: Vec<PathBuf>,
    /// `DT_RUNPATH`: folders looked into after `LD_LIBRARY_PATH`. If there is one, no `DT_RPATH` counts.
    pub runpath: Option<Vec<PathBuf>>,
}

/// Functions of Embree that a file takes from elsewhere, and those that it gives.
#[derive(Debug, Default)]
pub struct Functions {
    /// Undefined symbols.
    pub wanted: Vec<String>,
    /// Defined symbols.
    pub given: Vec<String>,
}

/// True if the file begins as every ELF file does.
pub fn is_elf(path: &Path) -> bool {
    let mut magic = [0; 4];
    File::open(path).and_then(|mut file| file.read_exact(&mut magic)).is_ok_and(|()| magic == elf::ELFMAG)
}

/// Reads the dynamic section.
///
/// # Errors
/// The file cannot be read, is no ELF file of 64 bits, or is damaged.
pub fn read(path: &Path) -> Result<Binary> {
    let data = open(path)?;
    let malformed = |cause: &dyn std::fmt::Display| Error::malformed(path, format!("as an ELF file: {cause}"));
    let header = Elf::parse(&data).map_err(|error| malformed(&error))?;
    let endian = header.endian().map_err(|error| malformed(&error))?;
    let segments = header.program_headers(endian, &data).map_err(|error| malformed(&error))?;

    let mut entries = Vec::new();
    for segment in segments {
        for entry in segment.dynamic(endian, &data).map_err(|error| malformed(&error))?.unwrap_or_default() {
            entries.push((entry.d_tag(endian), entry.d_val(endian)));
        }
    }
    let number = |tag| entries.iter().find(|(t, _)| *t == tag).map(|(_, value)| *value);
    let strings = match (number(elf::DT_STRTAB), number(elf::DT_STRSZ)) {
        (Some(address), Some(size)) => {
            let start = segments.iter().filter(|s| s.p_type(endian) == elf::PT_LOAD).find_map(|s| {
                let inside = address.checked_sub(s.p_vaddr(endian)).filter(|&inside| inside < s.p_filesz(endian))?;
                s.p_offset(endian).checked_add(inside)
            });
            let start = start.ok_or_else(|| malformed(&"its names lie in no segment"))?;
            StringTable::new(&data, start, start.saturating_add(size))
        }
        // Linked statically.
        _ => StringTable::default(),
    };
    let texts = |tag| -> Result<Vec<String>> {
        let values = entries.iter().filter(|(t, _)| *t == tag).map(|(_, value)| *value);
        let text = |value: u64| u32::try_from(value).ok().and_then(|v| strings.get(v).ok());
        values
            .map(|value| text(value).map(|bytes| String::from_utf8_lossy(bytes).into_owned()))
            .map(|text| text.ok_or_else(|| malformed(&"a name lies outside of the table of names")))
            .collect()
    };
    let folders = |list: Vec<String>| list.iter().flat_map(|list| search_path(list, path)).collect::<Vec<_>>();
    let runpath = texts(elf::DT_RUNPATH)?;
    Ok(Binary {
        machine: header.e_machine(endian),
        needed: texts(elf::DT_NEEDED)?,
        rpath: folders(texts(elf::DT_RPATH)?),
        runpath: if runpath.is_empty() { None } else { Some(folders(runpath)) },
    })
}

/// Reads which functions of Embree the file wants and gives: names as in C, and as Mitsuba has them in a C++ namespace.
///
/// # Errors
/// As [`read`].
pub fn functions(path: &Path) -> Result<Functions> {
    let data = open(path)?;
    let file = ElfFile::<Elf, Data>::parse(&data)
        .map_err(|error| Error::malformed(path, format!("as an ELF file: {error}")))?;
    let mut functions = Functions::default();
    for symbol in file.dynamic_symbols() {
        let Ok(name) = symbol.name() else { continue };
        if !(name.starts_with("rtc") || in_mitsubas_namespace(name)) {
            continue;
        }
        if symbol.is_definition() {
            functions.given.push(name.to_string());
        } else if !symbol.is_weak() {
            functions.wanted.push(name.to_string());
        }
    }
    Ok(functions)
}

/// True if `name` is a function of Embree as Mitsuba's builds have it: `_ZN7mitsuba12rtcNewDevice..`.
pub fn in_mitsubas_namespace(name: &str) -> bool {
    name.strip_prefix("_ZN7mitsuba")
        .is_some_and(|rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()).starts_with("rtc"))
}

/// True if a build of Embree is inside the file.
pub fn contains_embree(path: &Path) -> bool {
    let Ok(mut file) = File::open(path) else { return false };
    // The mark may lie across two pieces.
    let mut piece = vec![0; 1 << 20];
    let mut kept = 0;
    while let Ok(read @ 1..) = file.read(&mut piece[kept..]) {
        let filled = kept + read;
        if piece[..filled].windows(MARK.len()).any(|window| window == MARK) {
            return true;
        }
        kept = filled.min(MARK.len() - 1);
        piece.copy_within(filled - kept..filled, 0);
    }
    false
}

fn open(path: &Path) -> Result<ReadCache<File>> {
    File::open(path).map(ReadCache::new).map_err(|error| Error::io(path, error))
}

/// The folders of a list with colons, where `$ORIGIN` is the folder of `file`. Other variables are the loader's own affair:
/// folders with them are left out.
fn search_path(list: &str, file: &Path) -> Vec<PathBuf> {
    let origin = file.parent().unwrap_or(Path::new("/")).to_string_lossy();
    let expanded = list.split(':').map(|f| f.replace("${ORIGIN}", &origin).replace("$ORIGIN", &origin));
    expanded.filter(|folder| !folder.is_empty() && !folder.contains('$')).map(PathBuf::from).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_relative_to_the_file() {
        let folders = search_path("$ORIGIN/../lib:${ORIGIN}::/opt/lib:/opt/$LIB", Path::new("/a/b/c.so"));
        assert_eq!(folders, ["/a/b/../lib", "/a/b", "/opt/lib"].map(PathBuf::from));
    }

    #[test]
    fn mitsubas_names_are_told_from_others() {
        assert!(in_mitsubas_namespace("_ZN7mitsuba12rtcNewDeviceEPKc"));
        assert!(!in_mitsubas_namespace("_ZN7mitsuba5ShapeC2Ev"));
        assert!(!in_mitsubas_namespace("rtcNewDevice"));
    }

    #[test]
    fn embree_inside_is_found_across_pieces() {
        let path = std::env::temp_dir().join(format!("skipgrid-mark-{}", std::process::id()));
        for before in [0, 7, (1 << 20) - 30, (1 << 20) - 3, (1 << 21) + 5] {
            let bytes = [vec![b'E'; before], MARK.to_vec(), vec![0; 99]].concat();
            std::fs::write(&path, bytes).expect("the temporary folder is writable");
            assert!(contains_embree(&path), "{before}");
        }
        std::fs::write(&path, &MARK[1..]).expect("the temporary folder is writable");
        assert!(!contains_embree(&path));
        std::fs::remove_file(&path).expect("the file was written");
    }
}
