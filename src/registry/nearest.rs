//! "Did you mean": the known name nearest to one that is not.

/// "; did you mean `NAME`?" with the one of `names` nearest to `given`; empty if none is within `most` edits.
pub(crate) fn did_you_mean(names: &[&str], given: &str, most: usize) -> String {
    let nearest = names.iter().map(|name| (distance(name, given), name)).min_by_key(|(edits, _)| *edits);
    match nearest {
        Some((edits, name)) if edits <= most => format!("; did you mean `{name}`?"),
        _ => String::new(),
    }
}

/// Levenshtein's edit distance, for names of a few letters; long ones are infinitely far.
fn distance(a: &str, b: &str) -> usize {
    if b.len() > 64 {
        return usize::MAX;
    }
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(row[j + 1] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edit_distance_counts_edits() {
        assert_eq!(distance("grid", "gird"), 2);
        assert_eq!(distance("", "abc"), 3);
    }
}
