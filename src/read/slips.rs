//! Slips around plain geometry: counted while a file is read, one note a kind.

/// What was read although it is not quite well formed.
#[derive(Default)]
pub(super) struct Slips(Vec<Slip>);

struct Slip {
    noun: &'static str,
    what: &'static str,
    count: u64,
    first: String,
}

impl Slips {
    /// One more of the kind that `noun` and `what` name together: "face", "of fewer than three corners left
    /// out". `first` says where, and is only asked for the first: "on line 7".
    #[cold]
    pub(super) fn add(&mut self, noun: &'static str, what: &'static str, first: impl FnOnce() -> String) {
        match self.0.iter_mut().find(|slip| (slip.noun, slip.what) == (noun, what)) {
            Some(slip) => slip.count += 1,
            None => self.0.push(Slip { noun, what, count: 1, first: first() }),
        }
    }

    /// The notes, in the order in which the kinds came first.
    pub(super) fn notes(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|slip| {
            let counted = super::text::counted(slip.count, slip.noun);
            let the_first = if slip.count == 1 { "" } else { "the first " };
            format!("{counted} {}, {the_first}{}", slip.what, slip.first)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_of_a_kind_are_one_note_that_names_the_first() {
        let mut slips = Slips::default();
        for line in [3, 7, 9] {
            slips.add("face", "left out", || format!("on line {line}"));
        }
        slips.add("vertex", "left out", || "on line 8".to_owned());
        let notes: Vec<_> = slips.notes().collect();
        assert_eq!(notes, ["3 faces left out, the first on line 3", "1 vertex left out, on line 8"]);
    }
}
