//! Which channels of an EXR file are its colours.
//!
//! Channels of a layer are called `LAYER.NAME` (OpenEXR, "Technical Introduction", section "Layers"); the layer may have
//! points in its own name.

/// The names of the channels to be taken as red, green and blue.
pub(super) type Colours = [String; 3];

/// Of the channels `names`, those of `layer`; without it those without a layer, else those of the only layer that has any.
///
/// The error is the cause alone.
pub(super) fn colours(names: &[String], layer: Option<&str>) -> Result<Colours, String> {
    if let Some(layer) = layer {
        return in_layer(names, layer).unwrap_or_else(|| Err(lacking(names, &full(layer, "R"))));
    }
    if let Some(found) = in_layer(names, "") {
        return found;
    }
    let mut layers: Vec<&str> = names.iter().filter_map(|name| Some(name.rsplit_once('.')?.0)).collect();
    layers.sort_unstable();
    layers.dedup();
    layers.retain(|layer| in_layer(names, layer).is_some());
    match layers[..] {
        [] => Err(lacking(names, "R")),
        [only] => in_layer(names, only).unwrap_or_else(|| Err(lacking(names, "R"))),
        _ => Err(format!("has the layers {}: one of them has to be chosen", quoted(layers.iter()))),
    }
}

/// The colours of one layer; `None` if it has none at all.
fn in_layer(names: &[String], layer: &str) -> Option<Result<Colours, String>> {
    let has = |name: &str| names.contains(&full(layer, name));
    let colours = ["R", "G", "B"];
    if colours.iter().any(|name| has(name)) {
        let missing = colours.iter().find(|name| !has(name));
        return Some(match missing {
            Some(name) => Err(lacking(names, &full(layer, name))),
            None => Ok(colours.map(|name| full(layer, name))),
        });
    }
    if has("RY") || has("BY") {
        return Some(Err(format!("has luminance and chroma, {}: wanted are R, G and B", quoted(names.iter()))));
    }
    has("Y").then(|| Ok([(); 3].map(|()| full(layer, "Y"))))
}

fn full(layer: &str, name: &str) -> String {
    if layer.is_empty() { name.to_string() } else { format!("{layer}.{name}") }
}

fn lacking(names: &[String], wanted: &str) -> String {
    format!("has no channel `{wanted}`, only {}", quoted(names.iter()))
}

fn quoted(names: impl Iterator<Item = impl AsRef<str>>) -> String {
    names.map(|name| format!("`{}`", name.as_ref())).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(names: &[&str], layer: Option<&str>) -> Result<String, String> {
        let names: Vec<String> = names.iter().map(|n| n.to_string()).collect();
        colours(&names, layer).map(|colours| colours.join(" "))
    }

    #[test]
    fn colours_are_found_or_the_layers_named() {
        for (names, layer, expected) in [
            (&["A", "B", "G", "R"][..], None, "R G B"),
            (&["Y"], None, "Y Y Y"),
            (&["A", "Y"], None, "Y Y Y"),
            (&["B", "G", "R", "Y", "diffuse.B", "diffuse.G", "diffuse.R"], None, "R G B"),
            (&["B", "G", "R", "d.B", "d.G", "d.R"], Some("d"), "d.R d.G d.B"),
            (&["view.all.B", "view.all.G", "view.all.R", "view.depth.Z"], None, "view.all.R view.all.G view.all.B"),
            (&["a.Y", "b.Z"], None, "a.Y a.Y a.Y"),
        ] {
            assert_eq!(found(names, layer).as_deref(), Ok(expected), "{names:?}");
        }
        for (names, layer, words) in [
            (&["a.B", "a.G", "a.R", "b.Y"][..], None, "the layers `a`, `b`"),
            (&["B", "R"], None, "no channel `G`, only `B`, `R`"),
            (&["Z"], None, "no channel `R`, only `Z`"),
            (&["BY", "RY", "Y"], None, "luminance and chroma"),
            (&["B", "G", "R"], Some("diffuse"), "no channel `diffuse.R`"),
        ] {
            let message = found(names, layer).expect_err(words);
            assert!(message.contains(words), "{message}");
        }
    }
}
