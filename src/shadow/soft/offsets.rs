//! Texels around a texel, sorted by distance.

use std::sync::OnceLock;

/// The farthest that a search goes, in texels. A penumbra that is wider on one side ends there: the value
/// stays on its side of one half, and jumps by less than a half. (A map of 1024 texels has penumbrae this
/// wide under a lamp as large as a quarter of the scene.)
pub(super) const FARTHEST: f64 = 128.0;

/// A texel relative to another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Offset {
    /// Between the centers.
    pub(super) distance: f32,
    pub(super) i: i16,
    pub(super) j: i16,
}

/// All texels but the own one up to [`FARTHEST`] and two more, the nearest first; of equal distances by rows.
pub(super) fn offsets() -> &'static [Offset] {
    static OFFSETS: OnceLock<Vec<Offset>> = OnceLock::new();
    OFFSETS.get_or_init(|| {
        let reach = FARTHEST as i16 + 2;
        let mut offsets = Vec::new();
        for j in -reach..=reach {
            for i in -reach..=reach {
                let squared = i32::from(i).pow(2) + i32::from(j).pow(2);
                if squared > 0 && squared <= i32::from(reach).pow(2) {
                    offsets.push((squared, Offset { distance: (squared as f32).sqrt(), i, j }));
                }
            }
        }
        offsets.sort_by_key(|&(squared, Offset { i, j, .. })| (squared, j, i));
        offsets.into_iter().map(|(_, offset)| offset).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_sorted_and_complete() {
        let all = offsets();
        assert!(all.windows(2).all(|pair| pair[0].distance <= pair[1].distance));
        assert_eq!(all[0], Offset { distance: 1.0, i: 0, j: -1 });
        assert_eq!(all.iter().filter(|offset| offset.distance <= 2.0).count(), 12);
        // The area of a disk.
        let area = std::f64::consts::PI * (FARTHEST + 2.0).powi(2);
        assert!((all.len() as f64 / area - 1.0).abs() < 0.002);
    }
}
