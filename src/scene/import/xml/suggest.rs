//! "Did you mean": the closest of the names that would have been right.

/// Returns ` (did you mean "x"?)` for the candidate closest to `found`, or nothing when none is
/// close. Letter case is ignored; an edit may also swap two neighbours.
pub fn did_you_mean<'c>(found: &str, candidates: impl IntoIterator<Item = &'c str>) -> String {
    let wanted = found.to_lowercase();
    let allowed = (wanted.chars().count() / 3).max(1);
    let distance = |name: &str| strsim::damerau_levenshtein(&wanted, &name.to_lowercase());
    candidates
        .into_iter()
        .map(|name| (distance(name), name))
        .filter(|(distance, name)| *distance <= allowed && *name != found)
        .min_by_key(|(distance, _)| *distance)
        .map_or_else(String::new, |(_, name)| {
            format!(" (did you mean \"{name}\"?)")
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_close_names_are_suggested() {
        let names = ["diffuse", "dielectric", "conductor"];
        assert_eq!(
            did_you_mean("difuse", names),
            " (did you mean \"diffuse\"?)"
        );
        assert_eq!(
            did_you_mean("Dielectric", names),
            " (did you mean \"dielectric\"?)"
        );
        assert_eq!(did_you_mean("velvet", names), "");
        assert_eq!(did_you_mean("x", ["y"]), " (did you mean \"y\"?)");
        assert_eq!(did_you_mean("x", []), "");
    }
}
