//! What is left out, and why that is allowed.

/// What stays the same when something is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Equality {
    /// The number of casting faces between each sample and the lamp.
    Count,
    /// Whether this number is 0.
    Verdict,
    /// The light that reaches each sample: no shadow is worked out where no light arrives.
    Picture,
    /// All but what the budget allows.
    Budget,
}

impl Equality {
    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Count => "count",
            Self::Verdict => "verdict",
            Self::Picture => "picture",
            Self::Budget => "budget",
        }
    }
}

/// The tests of relevance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum RelevanceTest {
    /// The lamp gives no light.
    Zero,
    /// No sample faces the lamp, or none lies within its range and cone.
    NoReceiver,
    /// The lamp's strongest contribution is below the budget.
    Faint,
    /// A watertight shell winds around the lamp and around no sample.
    Enclosed,
    /// No caster is left.
    Unblocked,
    /// A plane parts the shadow volume of the piece's box from the receivers.
    Parted,
    /// A plane parts it from each tile of receivers.
    Tiles,
    /// The piece lies beyond the lamp's range, or out of its cone.
    OutOfReach,
    /// The piece lies inside a watertight shell that holds neither the lamp nor a sample.
    Nested,
    /// The piece lies in the shadow of another one.
    Shadowed,
    /// No sample lies behind the piece, or all of them are dark without it.
    NothingBehind,
    /// The piece is a copy of another one.
    Copy,
    /// The receiver turns away from the lamp, or lies beyond its range or out of its cone.
    TurnedAway,
    /// The sample sees no surface.
    Sky,
    /// The light grid proves the sample lit or dark.
    Known,
}

impl RelevanceTest {
    /// All tests.
    pub const ALL: [Self; 15] = [
        Self::Zero,
        Self::NoReceiver,
        Self::Faint,
        Self::Enclosed,
        Self::Unblocked,
        Self::Parted,
        Self::Tiles,
        Self::OutOfReach,
        Self::Nested,
        Self::Shadowed,
        Self::NothingBehind,
        Self::Copy,
        Self::TurnedAway,
        Self::Sky,
        Self::Known,
    ];

    /// Name in reports.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Zero => "zero",
            Self::NoReceiver => "no-receiver",
            Self::Faint => "faint",
            Self::Enclosed => "enclosed",
            Self::Unblocked => "unblocked",
            Self::Parted => "parted",
            Self::Tiles => "tiles",
            Self::OutOfReach => "out-of-reach",
            Self::Nested => "nested",
            Self::Shadowed => "shadowed",
            Self::NothingBehind => "nothing-behind",
            Self::Copy => "copy",
            Self::TurnedAway => "turned-away",
            Self::Sky => "sky",
            Self::Known => "known",
        }
    }

    /// What stays the same when this test drops something.
    #[must_use]
    pub fn equality(self) -> Equality {
        match self {
            Self::Parted | Self::Tiles | Self::OutOfReach => Equality::Count,
            Self::Nested | Self::Shadowed | Self::NothingBehind | Self::Copy | Self::Known => {
                Equality::Verdict
            }
            Self::Zero
            | Self::NoReceiver
            | Self::Enclosed
            | Self::Unblocked
            | Self::TurnedAway
            | Self::Sky => Equality::Picture,
            Self::Faint => Equality::Budget,
        }
    }
}

/// Which part of a lamp's shadows is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Triple {
    /// The lamp, with all its shadows.
    Lamp,
    /// One casting piece: its number.
    Piece(u32),
    /// This many samples.
    Samples(usize),
}

/// Something that is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Dropped {
    /// Number of the lamp.
    pub lamp: usize,
    /// What is left out of its shadows.
    pub what: Triple,
    /// The test that allows it.
    pub test: RelevanceTest,
    /// Upper bound of the fraction of samples that change; 0 unless the equality is that of the budget.
    pub bound: f64,
}
