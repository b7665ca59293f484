//! The nearest known word to a misspelt one.

/// Largest share of typing errors per letter.
const MOST_ERRORS: f64 = 0.34;

/// The candidate nearest to a word with a typing error or two, if it is unique.
pub(crate) fn nearest(word: &str, candidates: impl IntoIterator<Item = impl Into<String>>) -> Option<String> {
    let lower = word.to_lowercase();
    let most = (MOST_ERRORS * lower.chars().count() as f64).floor() as usize;
    let mut best: Option<(usize, String)> = None;
    let mut alone = true;
    for candidate in candidates {
        let candidate = candidate.into();
        let errors = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
        match &best {
            Some((fewest, _)) if errors > *fewest => {}
            Some((fewest, _)) if errors == *fewest => alone = false,
            _ => (best, alone) = (Some((errors, candidate)), true),
        }
    }
    best.filter(|(errors, _)| alone && *errors <= most.max(1)).map(|(_, candidate)| candidate)
}

/// "did you mean ply? " or nothing.
pub(crate) fn did_you_mean(word: &str, candidates: impl IntoIterator<Item = impl Into<String>>) -> String {
    nearest(word, candidates).map_or(String::new(), |c| format!("did you mean {c}? "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_word_is_named_when_it_is_near_and_alone() {
        let sizes = || ["A3", "A4", "A4-landscape", "letter"];
        assert_eq!(nearest("A44", sizes()).as_deref(), Some("A4"));
        assert_eq!(nearest("a4-landscap", sizes()).as_deref(), Some("A4-landscape"));
        assert_eq!(nearest("A7", sizes()), None, "A3 and A4 are as near");
        assert_eq!(nearest("poster", sizes()), None);
        assert_eq!(nearest("", sizes()), None);
        assert_eq!(nearest("checkr.json", ["checker.json", "rig.json"]).as_deref(), Some("checker.json"));
        assert_eq!(nearest("Photo.JPG", ["photo.jpg"]).as_deref(), Some("photo.jpg"));
    }
}
