//! A strategy of any generator: its choices are recorded, and shrinking makes them smaller.
//!
//! After David MacIver and Alastair Donaldson, "Test-case reduction via test-case generation: insights from
//! the Hypothesis reducer", ECOOP 2020: reduce what a generator draws from, not what it makes.

use std::borrow::Cow;
use std::fmt::{self, Debug};

use proptest::prelude::*;
use proptest::strategy::{NewTree, ValueTree};
use proptest::test_runner::TestRunner;

use crate::random::SplitMix64;
use crate::testing::generate::Draw;

/// What `generate` makes of random choices. Shrinks choice by choice towards 0.
pub(super) fn drawn<T: Debug>(
    generate: impl Fn(&mut dyn Draw) -> T + Clone,
) -> impl Strategy<Value = T> + Clone {
    Drawn(generate)
}

/// Choices that are made before anybody knows what is drawn from them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Choices<const N: usize>([u32; N]);

impl<const N: usize> Choices<N> {
    /// Any choices.
    pub(super) fn any() -> impl Strategy<Value = Self> + Clone {
        // A unit with 32 bits is a word.
        drawn(|draw| Self([(); N].map(|()| (draw.unit() * WORDS) as u32)))
    }

    /// What `generate` makes of these choices; 0 for any more of them.
    pub(super) fn give<T>(&self, generate: impl FnOnce(&mut dyn Draw) -> T) -> T {
        generate(&mut Words::replay(&self.0))
    }
}

/// How many words there are.
const WORDS: f64 = 4_294_967_296.0;

/// Recorded words, then new ones: random and recorded, or zeros.
struct Words<'a> {
    recorded: Cow<'a, [u32]>,
    used: usize,
    random: Option<SplitMix64>,
}

impl<'a> Words<'a> {
    fn replay(words: &'a [u32]) -> Self {
        Self { recorded: Cow::Borrowed(words), used: 0, random: None }
    }

    fn word(&mut self) -> u32 {
        if let Some(random) = &mut self.random {
            self.recorded.to_mut().push(random.next() as u32);
        }
        self.used += 1;
        self.recorded.get(self.used - 1).copied().unwrap_or(0)
    }
}

impl Draw for Words<'_> {
    /// Larger for a larger word.
    fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.word()) * u64::from(n)) >> 32) as u32 // below `n`
    }

    fn unit(&mut self) -> f64 {
        f64::from(self.word()) / WORDS
    }
}

#[derive(Clone)]
struct Drawn<F>(F);

impl<F> Debug for Drawn<F> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("Drawn")
    }
}

impl<T: Debug, F: Fn(&mut dyn Draw) -> T + Clone> Strategy for Drawn<F> {
    type Tree = Shrinking<F>;
    type Value = T;

    fn new_tree(&self, runner: &mut TestRunner) -> NewTree<Self> {
        let random = Some(SplitMix64(runner.rng().next_u64()));
        let mut record = Words { random, ..Words::replay(&[]) };
        self.0(&mut record);
        let words = record.recorded.into_owned();
        Ok(Shrinking { generate: self.0.clone(), words, at: 0, low: 0, kept: None })
    }
}

/// Recorded words, each of them made smaller in turn: 0 first, then by bisection over its highest byte.
struct Shrinking<F> {
    generate: F,
    words: Vec<u32>,
    /// The index of the word that is made smaller.
    at: usize,
    /// Words below this one are known to lose the failure there; a multiple of [`STEP`].
    low: u32,
    /// What the word was when the test last failed, while a smaller one is tried.
    kept: Option<u32>,
}

const STEP: u32 = 1 << 24;

impl<T: Debug, F: Fn(&mut dyn Draw) -> T> Shrinking<F> {
    /// Tries the next smaller word; false if there is none.
    fn advance(&mut self) -> bool {
        let mut replay = Words::replay(&self.words);
        (self.generate)(&mut replay);
        let used = replay.used;
        self.words.truncate(used);
        while let Some(&word) = self.words.get(self.at) {
            if self.low < word {
                let smaller = if self.low == 0 { 0 } else { self.low + (word - self.low) / 2 };
                self.words[self.at] = smaller / STEP * STEP;
                self.kept = Some(word);
                return true;
            }
            (self.at, self.low) = (self.at + 1, 0);
        }
        false
    }
}

impl<T: Debug, F: Fn(&mut dyn Draw) -> T> ValueTree for Shrinking<F> {
    type Value = T;

    fn current(&self) -> T {
        (self.generate)(&mut Words::replay(&self.words))
    }

    /// The test failed, so the smaller word stays.
    fn simplify(&mut self) -> bool {
        self.kept = None;
        self.advance()
    }

    /// The test passed, so the word comes back. The next smaller one is tried at once, if there is one.
    fn complicate(&mut self) -> bool {
        let Some(word) = self.kept.take() else { return false };
        self.low = self.words[self.at].saturating_add(STEP);
        self.words[self.at] = word;
        self.advance();
        true
    }
}
