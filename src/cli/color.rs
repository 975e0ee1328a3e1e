//! Colors of verdicts on a terminal.

use std::io::{self, IsTerminal};

use umbrage::check::Verdict;

/// When verdicts are colored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum ColorChoice {
    /// On a terminal, unless NO_COLOR is set
    #[default]
    Auto,
    /// Everywhere
    Always,
    /// Nowhere
    Never,
}

/// Colors words, or leaves them as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Painter {
    is_on: bool,
}

impl ColorChoice {
    /// A painter for standard output. `NO_COLOR` counts if it is not empty (no-color.org); a terminal that
    /// calls itself dumb has no colors.
    pub(crate) fn painter(self) -> Painter {
        let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
        let is_dumb = std::env::var_os("TERM").is_some_and(|term| term == "dumb");
        let is_on = match self {
            Self::Always => true,
            Self::Never => false,
            Self::Auto => io::stdout().is_terminal() && !is_set("NO_COLOR") && !is_dumb,
        };
        Painter { is_on }
    }
}

impl Painter {
    /// That of a process whose output another one prints.
    pub(crate) fn of_worker(is_on: bool) -> Self {
        Self { is_on }
    }

    pub(crate) fn is_on(self) -> bool {
        self.is_on
    }

    /// A word in the color of a verdict: green for sound, red for cracked, yellow for what is not known.
    pub(crate) fn verdict(self, verdict: Verdict, word: &str) -> String {
        match verdict {
            Verdict::Sound => self.paint("32", word),
            Verdict::Cracked => self.bad(word),
            _ => self.paint("33", word),
        }
    }

    /// A word in red.
    pub(crate) fn bad(self, word: &str) -> String {
        self.paint("31", word)
    }

    fn paint(self, code: &str, word: &str) -> String {
        if self.is_on { format!("\x1b[{code}m{word}\x1b[0m") } else { word.to_owned() }
    }
}
