//! The value of `--fill`.

/// Which holes are closed: those within both limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FillLimit {
    pub(super) edges: Option<usize>,
    /// Around the hole, in mesh units.
    pub(super) length: Option<f64>,
}

impl FillLimit {
    /// `64`, `edges=64`, `length=0.5`, or `edges=64,length=0.5`. A number alone is one of edges and must be
    /// whole, so that a length is never taken for it.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut limit = Self::default();
        for entry in text.split(',') {
            let (key, value) = entry.split_once('=').unwrap_or(("edges", entry));
            let is_new = match key {
                "edges" => set(&mut limit.edges, value.parse().ok()),
                "length" => set(&mut limit.length, value.parse().ok().filter(|&most: &f64| most > 0.0)),
                _ => false,
            };
            if !is_new {
                return Err("write a number of edges, or edges=N, length=D above 0 in mesh units, or both \
                            with a comma; before a file name write --fill=LIMIT"
                    .to_owned());
            }
        }
        if limit.length.is_some_and(f64::is_infinite) {
            return Err("write a finite length, or leave it out".to_owned());
        }
        Ok(limit)
    }
}

/// Whether there is a value, and was none before.
fn set<T>(slot: &mut Option<T>, value: Option<T>) -> bool {
    slot.is_none() && {
        *slot = value;
        slot.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_of_holes_are_parsed_and_nonsense_refused() {
        let limit = |edges, length| Ok(FillLimit { edges, length });
        assert_eq!(FillLimit::parse("64"), limit(Some(64), None));
        assert_eq!(FillLimit::parse("edges=64"), limit(Some(64), None));
        assert_eq!(FillLimit::parse("length=0.5"), limit(None, Some(0.5)));
        assert_eq!(FillLimit::parse("length=2,edges=3"), limit(Some(3), Some(2.0)));
        assert_eq!(FillLimit::parse("3,length=1e-3"), limit(Some(3), Some(1e-3)));
        for text in [
            "",
            "0.5",
            "-1",
            "0.5mm",
            "length=0",
            "length=-1",
            "length=nan",
            "length=inf",
            "length=",
            "edges=1.5",
            "3,4",
            "3,edges=4",
            "length=1,length=2",
            "area=3",
            "scan.ply",
            "3,",
            "Length=1",
        ] {
            assert!(FillLimit::parse(text).is_err(), "{text}");
        }
    }
}
