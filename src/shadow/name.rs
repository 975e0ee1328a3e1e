//! Techniques as text: `name`, or `name:key=value,…`.

use std::fmt;
use std::str::FromStr;

use super::Technique;
use super::options::Refusal;

/// Error of a text that names no [`Technique`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TechniqueError {
    /// The technique of this name is planned, but not built yet.
    #[error("not built yet: {0}")]
    NotBuilt(String),
    /// No technique has this name.
    #[error("`{0}` is not a technique; write one of {names}", names = names())]
    Unknown(String),
    /// The technique has no such option.
    #[error("`{technique}` has no option `{key}`; it has {keys}")]
    UnknownKey {
        /// The technique's name.
        technique: &'static str,
        /// The unknown key.
        key: String,
        /// The keys that there are, or `none`.
        keys: String,
    },
    /// The option does not take this value.
    #[error("{technique}:{key}={value}: `{value}` is not {takes}")]
    Value {
        /// The technique's name.
        technique: &'static str,
        /// The key.
        key: String,
        /// The value that was given.
        value: String,
        /// What the option takes.
        takes: &'static str,
    },
    /// The option is given more than once.
    #[error("{technique}: `{key}` is given twice")]
    Twice {
        /// The technique's name.
        technique: &'static str,
        /// The key.
        key: String,
    },
}

/// Names of planned techniques.
const PLANNED: [&str; 1] = ["auto"];

fn names() -> String {
    Technique::ALL.map(Technique::name).join(", ")
}

/// The name, and behind a colon the options that are not the default.
impl fmt::Display for Technique {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())?;
        let default = self.with_default_options().parameters();
        let changed = self.parameters().into_iter().zip(default).filter(|(own, default)| own != default);
        for (index, ((key, value), _)) in changed.enumerate() {
            write!(f, "{}{key}={value}", if index == 0 { ':' } else { ',' })?;
        }
        Ok(())
    }
}

impl FromStr for Technique {
    type Err = TechniqueError;

    fn from_str(text: &str) -> Result<Self, TechniqueError> {
        let (name, options) = text.split_once(':').unwrap_or((text, ""));
        let found = Self::ALL.into_iter().find(|technique| technique.name() == name);
        let mut technique = found.ok_or_else(|| match PLANNED.contains(&name) {
            true => TechniqueError::NotBuilt(name.to_owned()),
            false => TechniqueError::Unknown(name.to_owned()),
        })?;
        let mut given = Vec::new();
        for option in options.split(',').filter(|option| !option.is_empty()) {
            let (key, value) = option.split_once('=').unwrap_or((option, ""));
            if given.contains(&key) {
                return Err(TechniqueError::Twice { technique: technique.name(), key: key.to_owned() });
            }
            given.push(key);
            technique =
                technique.with(key, value).map_err(|refusal| technique.refuse(refusal, key, value))?;
        }
        Ok(technique)
    }
}

impl Technique {
    fn refuse(self, refusal: Refusal, key: &str, value: &str) -> TechniqueError {
        let (technique, key) = (self.name(), key.to_owned());
        match refusal {
            Refusal::Value(takes) => TechniqueError::Value { technique, key, value: value.to_owned(), takes },
            Refusal::Key => {
                let keys: Vec<&str> = self.parameters().into_iter().map(|(key, _)| key).collect();
                let keys = if keys.is_empty() { "none".to_owned() } else { keys.join(", ") };
                TechniqueError::UnknownKey { technique, key, keys }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn technique_names_parse_back_and_others_are_told_apart() {
        for technique in Technique::ALL {
            assert_eq!(technique.to_string(), technique.name(), "defaults are not written");
            assert_eq!(technique.to_string().parse(), Ok(technique));
            assert!(!PLANNED.contains(&technique.name()));
        }
        let error = |text: &str| text.parse::<Technique>().unwrap_err().to_string();
        assert_eq!(error("auto:x=1"), "not built yet: auto");
        assert_eq!(error("ray"), format!("`ray` is not a technique; write one of {}", names()));
        assert_eq!(error("zfail:size=3,x"), "`zfail` has no option `size`; it has none");
    }

    #[test]
    fn technique_options_parse_back_and_wrong_ones_are_refused() {
        let few: Technique = "samples:n=4".parse().unwrap();
        assert_eq!(few.to_string(), "samples:n=4");
        assert_eq!(few.parameters(), [("n", "4".to_owned())]);
        assert_ne!(Ok(few), "samples".parse());
        assert_eq!("samples:n=64".parse(), "samples".parse::<Technique>());
        let error = |text: &str| text.parse::<Technique>().unwrap_err().to_string();
        assert_eq!(error("samples:m=4"), "`samples` has no option `m`; it has n");
        assert_eq!(error("samples:n=0"), "samples:n=0: `0` is not a number from 1 to 65536");
        assert_eq!(error("samples:n"), "samples:n=: `` is not a number from 1 to 65536");
        assert_eq!(error("samples:n=2,n=3"), "samples: `n` is given twice");
        // Every value that a technique reports is one that it takes.
        for technique in Technique::ALL {
            for (key, value) in technique.parameters() {
                assert_eq!(technique.with(key, &value), Ok(technique), "{technique} {key}");
                assert!(technique.with(key, "surely not").is_err(), "{technique} {key}");
            }
        }
    }
}
