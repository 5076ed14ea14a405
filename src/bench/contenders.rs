//! Which accelerators run unless told otherwise: those of the registry, but for a few.

use crate::registry::ENTRIES;

/// Left out unless named, with reasons.
const RESTS: [(&str, &str); 6] = [
    ("brute", "tests every primitive"),
    ("bsp", "a study, `skipgrid papers arvo`"),
    ("grid-clouds", "a study, `skipgrid papers semwal-kvarnstrom`, like the next three"),
    ("grid-dual", "as above"),
    ("grid-dsz24", "as above"),
    ("grid-chessboard", "as above"),
];

/// Settings that run beside the default ones.
const VARIANTS: [(&str, &str); 7] = [
    ("nested", "quality=fast"),
    ("nested", "quality=best"),
    ("obvhs-native-bvh2", "preset=fastest"),
    ("obvhs-native-cwbvh", "preset=fastest"),
    ("obvhs-native-cwbvh", "preset=very_slow"),
    ("embree", "quality=low"),
    ("embree", "quality=high"),
];

/// Specifications of what runs by default: the registry's accelerators that are present here, in its order, and some of
/// their settings.
pub fn usual() -> Vec<String> {
    let mut specs = Vec::new();
    let present = ENTRIES.iter().filter(|e| e.missing().is_none() && !RESTS.iter().any(|(name, _)| *name == e.name));
    for entry in present {
        specs.push(entry.name.to_string());
        let own = VARIANTS.iter().filter(|(name, _)| *name == entry.name);
        specs.extend(own.map(|(name, option)| format!("{name}:{option}")));
    }
    specs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_exception_names_an_accelerator() {
        for (name, _) in RESTS {
            assert!(ENTRIES.iter().any(|e| e.name == name), "{name}");
        }
        let usual = usual();
        assert!(crate::stress::contenders(&usual).is_ok(), "an option is not known");
        assert!(usual.iter().any(|spec| spec == "nested:quality=fast"));
        assert!(usual.iter().any(|spec| spec == "grid") && !usual.iter().any(|spec| spec == "brute"));
        #[cfg(feature = "obvhs")]
        assert!(usual.iter().any(|spec| spec == "obvhs-native-cwbvh:preset=very_slow"));
    }
}
