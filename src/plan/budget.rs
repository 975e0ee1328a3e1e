//! The budget: how much may be wrong, and how long it may take.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// What a plan may cost in accuracy and in time. The default is exact, in the least time.
///
/// `Display` and `FromStr` use the form of the command line.
///
/// ```
/// use umbrage::plan::Budget;
/// let budget: Budget = "error=0.01,time=16ms".parse()?;
/// assert_eq!((budget.error, budget.time.map(|t| t.as_millis())), (0.01, Some(16)));
/// assert_eq!(budget.to_string(), "error=0.01,time=16ms");
/// assert_eq!("".parse::<Budget>()?, Budget::default());
/// # Ok::<(), umbrage::plan::BudgetError>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Budget {
    /// Largest fraction of samples that may be wrong, from 0 to 1.
    pub error: f64,
    /// A sample is wrong if the visible fraction of a lamp differs by more than this, from 0 to 1. `None`: 0
    /// for a lamp that casts hard shadows, 1/64 for one with an extent.
    pub light: Option<f64>,
    /// What is less than this many steps of an 8-bit picture does not count.
    pub level: f64,
    /// Time of one picture. A wish: the error is a wall.
    pub time: Option<Duration>,
    /// Whether the error is no wall, but to be as small as the time allows. A text that gives a time and
    /// no error asks for this.
    pub least_error: bool,
}

/// Error of a text that is no [`Budget`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BudgetError {
    /// No part of a budget has this name.
    #[error("a budget has no `{0}`; it has error, light, level and time, as in error=0.01,time=16ms")]
    Key(String),
    /// A part is given more than once.
    #[error("`{0}` is given twice")]
    Twice(&'static str),
    /// A value is not of the kind.
    #[error("{key}={value}: `{value}` is not {takes}")]
    Value {
        /// The part.
        key: &'static str,
        /// The value that was given.
        value: String,
        /// What the part takes.
        takes: &'static str,
    },
}

const FRACTION: &str = "a fraction from 0 to 1";

impl Budget {
    /// The largest difference of a lamp's visible fraction that is not wrong.
    #[must_use]
    pub fn light_of(&self, has_extent: bool) -> f64 {
        self.light.unwrap_or(if has_extent { 1.0 / 64.0 } else { 0.0 })
    }
}

fn number(key: &'static str, value: &str, most: f64, takes: &'static str) -> Result<f64, BudgetError> {
    let wrong = || BudgetError::Value { key, value: value.to_owned(), takes };
    let number: f64 = value.parse().map_err(|_| wrong())?;
    (0.0..=most).contains(&number).then_some(number).ok_or_else(wrong)
}

/// A time in ms, s or us.
fn time(value: &str) -> Result<Duration, BudgetError> {
    let takes = "a time such as 16ms, 500us or 2s";
    let wrong = || BudgetError::Value { key: "time", value: value.to_owned(), takes };
    let units = [("ms", 1e-3), ("us", 1e-6), ("s", 1.0)];
    let split = units.iter().find_map(|&(unit, scale)| Some((value.strip_suffix(unit)?, scale)));
    let (digits, scale) = split.ok_or_else(wrong)?;
    let seconds = digits.trim_end().parse::<f64>().map_err(|_| wrong())? * scale;
    // A duration holds no more than 2^64 seconds; a picture takes none of them.
    (seconds > 0.0).then_some(()).ok_or_else(wrong)?;
    Duration::try_from_secs_f64(seconds).map_err(|_| wrong())
}

impl FromStr for Budget {
    type Err = BudgetError;

    fn from_str(text: &str) -> Result<Self, BudgetError> {
        let mut budget = Self::default();
        let mut given = Vec::new();
        for part in text.split(',').filter(|part| !part.is_empty()) {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            let known = ["error", "light", "level", "time"].into_iter().find(|&known| known == key);
            let key = known.ok_or_else(|| BudgetError::Key(key.to_owned()))?;
            if given.contains(&key) {
                return Err(BudgetError::Twice(key));
            }
            given.push(key);
            match key {
                "error" => budget.error = number(key, value, 1.0, FRACTION)?,
                "light" => budget.light = Some(number(key, value, 1.0, FRACTION)?),
                "level" => budget.level = number(key, value, 255.0, "a number of 8-bit steps from 0 to 255")?,
                _ => budget.time = Some(time(value)?),
            }
        }
        budget.least_error = budget.time.is_some() && !given.contains(&"error");
        Ok(budget)
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let error = (!self.least_error).then(|| format!("error={}", self.error));
        let light = self.light.map(|light| format!("light={light}"));
        let level = (self.level > 0.0).then(|| format!("level={}", self.level));
        let time = self.time.map(|time| format!("time={}ms", time.as_secs_f64() * 1e3));
        let parts: Vec<String> = [error, light, level, time].into_iter().flatten().collect();
        f.write_str(&parts.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn budget_reads_back_what_it_writes() {
        for text in ["error=0", "error=0.001,light=0.5,level=2", "error=1,time=16.5ms", "level=1,time=16ms"] {
            let budget: Budget = text.parse().unwrap();
            assert_eq!(budget.to_string(), text);
            assert_eq!(budget.to_string().parse(), Ok(budget));
        }
        // A time alone: the error is no wall.
        assert!("time=2s".parse::<Budget>().unwrap().least_error);
        assert!(!"time=2s,error=0".parse::<Budget>().unwrap().least_error);
        assert_eq!("time=2s".parse::<Budget>().unwrap().time, Some(Duration::from_secs(2)));
        assert_eq!("time=500us".parse::<Budget>().unwrap().time, Some(Duration::from_micros(500)));
    }

    #[test]
    fn budget_that_cannot_be_is_refused_with_the_part() {
        let error = |text: &str| text.parse::<Budget>().unwrap_err().to_string();
        assert_eq!(error("error=2"), "error=2: `2` is not a fraction from 0 to 1");
        assert_eq!(error("error=nan"), "error=nan: `nan` is not a fraction from 0 to 1");
        assert_eq!(error("time=16"), "time=16: `16` is not a time such as 16ms, 500us or 2s");
        for never in ["time=0ms", "time=-1s", "time=1e300s", "time=nans", "time=ms"] {
            assert!(error(never).contains("is not a time"), "{never}");
        }
        assert_eq!(error("error=0,error=1"), "`error` is given twice");
        assert!(error("errors=1").starts_with("a budget has no `errors`"));
    }
}
