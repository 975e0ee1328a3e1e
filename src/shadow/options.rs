//! Options of techniques, as `key=value` text.

/// An option: its key, and the values that it takes, for error messages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    /// What is written behind `=`, such as `1 to 16384`, or `nearest or bilinear`.
    pub(crate) takes: &'static str,
}

/// The options of one technique.
pub(crate) trait Options: Copy + Default {
    /// All keys, in the order of reports.
    const KEYS: &'static [Key];

    /// The value of a key of [`Options::KEYS`], as text that [`Options::set`] reads back.
    fn get(&self, key: &str) -> String;

    /// Sets the value of a key of [`Options::KEYS`]; false if the key does not take this value.
    fn set(&mut self, key: &str, value: &str) -> bool;
}

/// Why an option is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Refusal {
    Key,
    /// The key does not take this value. Holds the text of the values that it takes.
    Value(&'static str),
}

/// All keys with their values.
pub(crate) fn listed(options: &impl Options) -> Vec<(&'static str, String)> {
    keys(options).iter().map(|key| (key.name, options.get(key.name))).collect()
}

/// The keys of these options.
pub(crate) fn keys<O: Options>(_: &O) -> &'static [Key] {
    O::KEYS
}

/// The options with one value changed.
pub(crate) fn changed<O: Options>(mut options: O, key: &str, value: &str) -> Result<O, Refusal> {
    let known = O::KEYS.iter().find(|known| known.name == key).ok_or(Refusal::Key)?;
    if options.set(key, value) { Ok(options) } else { Err(Refusal::Value(known.takes)) }
}

/// Sets a number if the text is one within the range; whether it is.
pub(crate) fn set_number(number: &mut u32, value: &str, range: std::ops::RangeInclusive<u32>) -> bool {
    let parsed = value.parse().ok().filter(|parsed| range.contains(parsed));
    parsed.map(|parsed| *number = parsed).is_some()
}
