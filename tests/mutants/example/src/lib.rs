//! Functions whose mutants are known: which are caught, and which are not.

/// Counts from which a jar is full.
const FULL: u32 = 10;

/// Tested on both sides of the limit.
pub fn is_full(count: u32) -> bool {
    count >= FULL
}

/// Tested far from the limit only.
pub fn is_heavy(weight: i32) -> bool {
    weight > 100
}

/// Ends, unless a mutant never does.
pub fn halvings(mut number: u32) -> u32 {
    let mut count = 0;
    while number != 0 {
        number /= 2;
        count += 1;
    }
    count
}

/// Nothing comes by.
pub fn is_forgotten(a: bool, b: bool) -> bool {
    a && b
}

/// Text cannot be subtracted: no mutant builds.
pub fn joined(left: String, right: &str) -> String {
    left + right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_from_ten() {
        assert_eq!((is_full(9), is_full(10)), (false, true));
    }

    #[test]
    fn heavy_or_not() {
        assert_eq!((is_heavy(1), is_heavy(1000)), (false, true));
    }

    #[test]
    fn eleven_is_halved_four_times() {
        assert_eq!((halvings(0), halvings(11)), (0, 4));
    }

    #[test]
    fn text_is_joined() {
        assert_eq!(joined("a".into(), "b"), "ab");
    }
}
