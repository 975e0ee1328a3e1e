//! Numbers that mostly rise by equal steps, in runs.

/// A list of numbers: 16 bytes for each run of equal steps, of two numbers or more where the numbers ascend.
#[derive(Clone, Debug, Default)]
pub(super) struct Steps {
    runs: Vec<Run>,
    len: u32,
}

#[derive(Clone, Copy, Debug)]
struct Run {
    /// The index of the first number.
    start: u32,
    step: u32,
    first: u64,
}

impl Steps {
    #[inline]
    pub(super) fn push(&mut self, number: u64) {
        self.extend(number, 0, 1);
    }

    /// `count` numbers from `first` on, each `step` above the one before.
    #[inline]
    pub(super) fn extend(&mut self, first: u64, step: u32, count: u32) {
        if count == 0 {
            return;
        }
        let start = self.len;
        self.len = self.len.wrapping_add(count); // too many are refused by `Mesh::new`
        if let Some(run) = self.runs.last_mut() {
            let before = start.wrapping_sub(run.start);
            if before == 1
                && let Some(rise) = first.checked_sub(run.first).and_then(|rise| u32::try_from(rise).ok())
                && (count == 1 || rise == step)
            {
                run.step = rise;
                return;
            }
            if before > 1
                && run.first + u64::from(run.step) * u64::from(before) == first
                && (count == 1 || run.step == step)
            {
                return;
            }
        }
        self.runs.push(Run { start, step, first });
    }

    pub(super) fn len(&self) -> u32 {
        self.len
    }

    /// The number at `index`, if the list is that long.
    pub(super) fn get(&self, index: u32) -> Option<u64> {
        let run = self.runs[..self.runs.partition_point(|run| run.start <= index)].last()?;
        (index < self.len).then(|| run.first + u64::from(run.step) * u64::from(index - run.start))
    }

    /// The index of the last number that is at most `number`, in an ascending list; 0 if there is none.
    pub(super) fn index_of(&self, number: u64) -> u32 {
        let after = self.runs.partition_point(|run| run.first <= number);
        let Some(run) = self.runs[..after].last() else { return 0 };
        let end = self.runs.get(after).map_or(self.len, |next| next.start);
        let steps = (number - run.first).checked_div(run.step.into()).unwrap_or(u64::MAX);
        u64::from(end - 1 - run.start).min(steps) as u32 + run.start
    }

    /// Whether the numbers are 0, 1, 2, …
    pub(super) fn count_up(&self) -> bool {
        matches!(self.runs[..], [] | [Run { first: 0, step: 1, .. }])
            || self.len == 1 && self.get(0) == Some(0)
    }

    /// The runs: the first number, the step, how many.
    #[cfg(any(test, feature = "files"))]
    pub(super) fn runs(&self) -> impl Iterator<Item = (u64, u32, u32)> + '_ {
        let ends = self.runs[1.min(self.runs.len())..].iter().map(|run| run.start).chain([self.len]);
        self.runs.iter().zip(ends).map(|(run, end)| (run.first, run.step, end - run.start))
    }
}
