//! A list of bounded length that is spread evenly over all that was added.

/// The first ones, which are kept as they are, and of what follows every second, every fourth, and on: as
/// many as there is room for.
#[derive(Default)]
pub(super) struct Thinned<T> {
    items: Vec<T>,
    /// How many of the items stay.
    fixed: usize,
    /// Of the others, one in 2 to this power is kept.
    halvings: u32,
    /// How many of the others there were.
    others: usize,
}

impl<T> Thinned<T> {
    /// Adds items that stay, as far as there is room. To be called before [`Thinned::spread`].
    pub(super) fn fix(&mut self, items: impl IntoIterator<Item = T>, most: usize) -> [usize; 2] {
        let first = self.items.len();
        self.items.extend(items.into_iter().take(most - first));
        self.fixed = self.items.len();
        [first, self.fixed - first]
    }

    /// Adds items that may give way to others.
    pub(super) fn spread(&mut self, items: impl IntoIterator<Item = T>, most: usize) {
        for item in items {
            let is_kept = self.others.trailing_zeros() >= self.halvings;
            self.others += 1;
            if !is_kept || self.fixed == most {
                continue;
            }
            self.items.push(item);
            if self.items.len() > most {
                let mut index = 0;
                let fixed = self.fixed;
                self.items.retain(|_| {
                    index += 1;
                    index <= fixed || (index - 1 - fixed).is_multiple_of(2)
                });
                self.halvings += 1;
            }
        }
    }

    pub(super) fn items(&self) -> &[T] {
        &self.items
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_list_is_what_a_stride_over_all_would_keep() {
        for most in [1_usize, 2, 5, 16] {
            for fixed in 0..=most {
                for others in [0_usize, 1, 7, 16, 17, 100, 1000] {
                    let mut list = Thinned::default();
                    assert_eq!(list.fix((0..fixed).map(|i| i as i64 - 1000), most), [0, fixed]);
                    list.spread(0..others as i64, most);
                    let room = most - fixed;
                    let rest: Vec<i64> =
                        match (0..60).map(|k| 1 << k).find(|&stride| others.div_ceil(stride) <= room) {
                            Some(stride) if room > 0 => (0..others as i64).step_by(stride).collect(),
                            _ => Vec::new(),
                        };
                    let first = (0..fixed).map(|i| i as i64 - 1000);
                    assert_eq!(
                        list.items(),
                        first.chain(rest).collect::<Vec<_>>(),
                        "{most} {fixed} {others}"
                    );
                }
            }
        }
    }
}
