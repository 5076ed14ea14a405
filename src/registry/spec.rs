//! Specifications of the form `name:key=value,key=value`.

use super::Entry;
use super::nearest::did_you_mean;
use crate::error::{Error, Result};

/// A parsed specification; options are taken one by one, and what is left over is an error.
#[derive(Clone, Debug)]
pub(crate) struct Spec {
    text: String,
    name: String,
    options: Vec<(String, String)>,
    /// Keys that were looked for: those that the accelerator has.
    known: Vec<&'static str>,
}

impl Spec {
    /// Splits `text` at `:`, `,` and `=`.
    ///
    /// # Errors
    /// There is no name, an option has no value, or a key comes twice.
    pub fn parse(text: &str) -> Result<Self> {
        let fail = |cause: String| Error::Spec { spec: text.into(), cause };
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        if name.is_empty() {
            return Err(fail("a name is missing; a specification is name:key=value,key=value".into()));
        }
        let mut options: Vec<(String, String)> = Vec::new();
        for option in rest.split(',').filter(|o| !o.is_empty()) {
            let Some((key, value)) = option.split_once('=') else {
                return Err(fail(format!("option `{option}` has no value; write {option}=VALUE")));
            };
            if options.iter().any(|(k, _)| k == key) {
                return Err(fail(format!("option `{key}` is given twice")));
            }
            options.push((key.into(), value.into()));
        }
        Ok(Self { text: text.into(), name: name.into(), options, known: Vec::new() })
    }

    /// The part before the colon.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Takes the option `key` and parses its value; `None` if it is not given.
    ///
    /// # Errors
    /// `parse` returns `None`.
    pub fn take<T>(&mut self, key: &'static str, parse: impl FnOnce(&str) -> Option<T>) -> Result<Option<T>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match parse(&value) {
            Some(value) => Ok(Some(value)),
            None => Err(self.error(format!("option `{key}` cannot be `{value}`"))),
        }
    }

    /// Takes the option `key`, whose value is one of the names in `choices`.
    ///
    /// # Errors
    /// It is none of them.
    pub fn take_choice<T: Copy>(&mut self, key: &'static str, choices: &[(&str, T)]) -> Result<Option<T>> {
        let Some(value) = self.value(key) else { return Ok(None) };
        match choices.iter().find(|(name, _)| *name == value) {
            Some((_, choice)) => Ok(Some(*choice)),
            None => {
                let names: Vec<&str> = choices.iter().map(|(name, _)| *name).collect();
                Err(self.error(format!("option `{key}` cannot be `{value}`; it is {}", names.join("|"))))
            }
        }
    }

    /// Takes the option `key` as it was given.
    fn value(&mut self, key: &'static str) -> Option<String> {
        self.known.push(key);
        let i = self.options.iter().position(|(k, _)| k == key)?;
        Some(self.options.remove(i).1)
    }

    /// To be called once all options of the accelerator have been looked for.
    ///
    /// # Errors
    /// An option was not taken.
    pub fn finish(&self) -> Result<()> {
        match self.options.first() {
            None => Ok(()),
            Some((key, _)) if self.known.is_empty() => {
                Err(self.error(format!("unknown option `{key}`; `{}` has none", self.name)))
            }
            Some((key, _)) => {
                let hint = did_you_mean(&self.known, key, 3.min(key.len().saturating_sub(1)));
                Err(self.error(format!("unknown option `{key}`{hint}; there are {}", self.known.join(", "))))
            }
        }
    }

    /// An error about this specification.
    pub fn error(&self, cause: impl Into<String>) -> Error {
        Error::Spec { spec: self.text.clone(), cause: cause.into() }
    }

    /// The error for a name that is in no entry: how to get it, or the nearest one.
    pub(super) fn unknown_name(&self, entries: &[Entry]) -> Error {
        if let Some((_, feature)) = super::LEFT_OUT.iter().find(|(name, _)| *name == self.name) {
            return self.error(format!("left out of this program; `cargo build --features {feature}` brings it in"));
        }
        let names: Vec<&str> = entries.iter().map(|e| e.name).collect();
        let hint = did_you_mean(&names, &self.name, 3);
        self.error(format!("unknown accelerator{hint}; there are {}", names.join(", ")))
    }
}

/// `spec` with the option `key=value`, where its accelerator, one of `entries`, has that option and `spec` does not set it.
pub(super) fn with_default(entries: &[Entry], spec: &str, key: &str, value: &str) -> String {
    let (name, options) = spec.split_once(':').unwrap_or((spec, ""));
    let key = format!("{key}=");
    let options_of = |name: &str| entries.iter().find(|entry| entry.name == name).map_or("", |entry| entry.options);
    let own = options_of(name);
    // The options of `grid` are written out once only.
    let takes = own.contains(&key) || (own.contains("those of grid") && options_of("grid").contains(&key));
    let set = options.split(',').any(|option| option.starts_with(&key));
    match (takes && !set, options.is_empty()) {
        (false, _) => spec.to_string(),
        (true, true) => format!("{name}:{key}{value}"),
        (true, false) => format!("{spec},{key}{value}"),
    }
}

/// Bytes as a number, with `K`, `M`, `G` or `T` for powers of 1024.
pub(crate) fn parse_bytes(text: &str) -> Option<u64> {
    let (digits, shift) = match text.char_indices().last()? {
        (i, 'K') => (&text[..i], 10),
        (i, 'M') => (&text[..i], 20),
        (i, 'G') => (&text[..i], 30),
        (i, 'T') => (&text[..i], 40),
        _ => (text, 0),
    };
    digits.parse::<u64>().ok()?.checked_mul(1 << shift)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        assert_eq!(parse_bytes("512"), Some(512));
        assert_eq!(parse_bytes("4G"), Some(4 << 30));
        assert_eq!(parse_bytes("99999999999T"), None);
        assert_eq!(parse_bytes("-1"), None);
    }
}
