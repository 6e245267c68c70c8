//! Property names of all file versions in one spelling.

/// A property name: as the file writes it, and as the importer looks it up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Name {
    /// The name in the file, for messages.
    pub written: String,
    /// The name in snake case: `toWorld` and `to_world` are both `to_world`.
    pub normalised: String,
}

impl Name {
    /// Normalises a name of any file version.
    pub fn new(written: impl Into<String>) -> Self {
        let written = written.into();
        let normalised = to_snake_case(&written);
        Self {
            written,
            normalised,
        }
    }
}

/// `intIOR` → `int_ior`, `kNN` → `k_nn`, `rrDepth` → `rr_depth`.
fn to_snake_case(name: &str) -> String {
    let letters: Vec<char> = name.chars().collect();
    let mut snake = String::with_capacity(name.len() + 2);
    for (i, letter) in letters.iter().enumerate() {
        if letter.is_uppercase() {
            let previous = i.checked_sub(1).map(|before| letters[before]);
            let ends_acronym = letters.get(i + 1).is_some_and(|next| next.is_lowercase());
            let new_word = previous.is_some_and(|previous| {
                previous.is_lowercase()
                    || previous.is_numeric()
                    || (previous.is_uppercase() && ends_acronym)
            });
            if new_word {
                snake.push('_');
            }
        }
        snake.extend(letter.to_lowercase());
    }
    snake
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_generations_meet_in_snake_case() {
        for (written, normalised) in [
            ("toWorld", "to_world"),
            ("to_world", "to_world"),
            ("intIOR", "int_ior"),
            ("kNN", "k_nn"),
            ("IORFile", "ior_file"),
            ("sampleCount", "sample_count"),
            ("color0", "color0"),
            ("alphaU", "alpha_u"),
            ("", ""),
        ] {
            assert_eq!(Name::new(written).normalised, normalised);
        }
    }
}
