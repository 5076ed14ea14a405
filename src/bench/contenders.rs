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

/// Settings that run beside the default ones, of the accelerators that have them.
const VARIANTS: [(&str, &str, &str); 7] = [
    ("nested", "quality", "fast"),
    ("nested", "quality", "best"),
    ("obvhs-native-bvh2", "preset", "fastest"),
    ("obvhs-native-cwbvh", "preset", "fastest"),
    ("obvhs-native-cwbvh", "preset", "very_slow"),
    ("embree", "quality", "low"),
    ("embree", "quality", "high"),
];

/// Specifications of what runs by default: the registry's accelerators that are present here, the newest first, and some of
/// their settings.
pub fn usual() -> Vec<String> {
    let mut specs = Vec::new();
    let present = ENTRIES.iter().filter(|e| e.missing().is_none() && !RESTS.iter().any(|(name, _)| *name == e.name));
    for entry in present {
        specs.push(entry.name.to_string());
        let own = VARIANTS.iter().filter(|(name, ..)| *name == entry.name);
        for (name, key, value) in own.filter(|(_, key, value)| has(entry.options, key, value)) {
            specs.push(format!("{name}:{key}={value}"));
        }
    }
    specs
}

/// Whether `options`, as an entry lists them, has `key` with `value` among the choices.
fn has(options: &str, key: &str, value: &str) -> bool {
    let choices = options.split(&format!("{key}=")).nth(1).unwrap_or("");
    choices.split([' ', ',']).next().unwrap_or("").split('|').any(|choice| choice == value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_found_in_the_words_of_entries() {
        let options = "preset=fastest|medium|very_slow (medium), quality=low|high (low), depth=N";
        assert!(has(options, "preset", "very_slow") && has(options, "quality", "low"));
        assert!(!has(options, "preset", "slow") && !has(options, "quality", "fastest") && !has("", "quality", "low"));
    }

    #[test]
    fn every_exception_names_an_accelerator_or_one_that_may_come() {
        for (name, _) in RESTS {
            assert!(ENTRIES.iter().any(|e| e.name == name), "{name}");
        }
        let usual = usual();
        assert!(usual.iter().any(|spec| spec == "grid") && !usual.iter().any(|spec| spec == "brute"));
        #[cfg(feature = "obvhs")]
        assert!(usual.iter().any(|spec| spec == "obvhs-native-cwbvh:preset=very_slow"));
    }
}
