//! Patterns for names: `*` stands for any characters, `?` for one.

use std::fmt;

/// A pattern for the names of nodes, meshes and materials; case-sensitive.
///
/// ```
/// use umbrage::scene::Pattern;
/// assert!(Pattern::new("tree*").matches("tree 12"));
/// assert!(!Pattern::new("tree").matches("tree 12"));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern(String);

impl Pattern {
    /// Any text is a pattern.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Self(text.into())
    }

    /// Whether all of `name` is as the pattern says. Time: at most the product of both lengths.
    #[must_use]
    pub fn matches(&self, name: &str) -> bool {
        let (mut pattern, mut rest) = (self.0.chars(), name.chars());
        // Behind the last star, and what of the name was left there: the only position to go back to, since
        // whatever an earlier star could still take, the last one can take too.
        let mut retry = None;
        loop {
            let before = (pattern.clone(), rest.clone());
            match (pattern.next(), rest.next()) {
                (Some('*'), _) => {
                    rest = before.1;
                    retry = Some((pattern.clone(), rest.clone()));
                    continue;
                }
                (Some('?'), Some(_)) => continue,
                (Some(wanted), Some(found)) if wanted == found => continue,
                (None, None) => return true,
                _ => {}
            }
            // The star takes one character more.
            let Some((after, left)) = &mut retry else { return false };
            if left.next().is_none() {
                return false;
            }
            (pattern, rest) = (after.clone(), left.clone());
        }
    }
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl From<&str> for Pattern {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The definition.
    fn naive(pattern: &[char], name: &[char]) -> bool {
        match (pattern, name) {
            ([], []) => true,
            (['*', rest @ ..], _) => (0..=name.len()).any(|taken| naive(rest, &name[taken..])),
            (['?', pattern @ ..], [_, name @ ..]) => naive(pattern, name),
            ([wanted, pattern @ ..], [found, name @ ..]) => wanted == found && naive(pattern, name),
            _ => false,
        }
    }

    #[test]
    fn pattern_matches_whole_names_by_case() {
        for (pattern, name, wanted) in [
            ("", "", true),
            ("", "a", false),
            ("*", "", true),
            ("Wheel", "Wheel", true),
            ("Wheel", "wheel", false),
            ("Wheel", "Wheel 2", false),
            ("*el*", "Wheel 2", true),
            ("?heel", "Wheel", true),
            ("?", "ä", true),
            ("[a]", "a", false),
            ("*ab*abc", "ababab abc", true),
        ] {
            assert_eq!(Pattern::new(pattern).matches(name), wanted, "{pattern} {name}");
        }
        // No time beyond the product of the lengths.
        assert!(!Pattern::new("a*".repeat(2000) + "b").matches(&"a".repeat(4000)));
    }

    proptest! {
        #[test]
        fn pattern_is_what_the_definition_says(pattern in "[ab*?]{0,8}", name in "[ab]{0,8}") {
            let chars = |text: &str| text.chars().collect::<Vec<_>>();
            prop_assert_eq!(Pattern::new(&*pattern).matches(&name), naive(&chars(&pattern), &chars(&name)));
        }
    }
}
