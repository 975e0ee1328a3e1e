//! Which sides of a face cast, and with which sign.

use super::{CASTS_BEHIND, CASTS_IN_FRONT, CasterFaces};
use crate::geom::Facing;

#[test]
fn signs_and_masks_say_the_same_of_every_side() {
    let sides = [Facing::Front, Facing::Back, Facing::EdgeOn];
    for (faces, signs) in
        [(CasterFaces::All, [1, -1, 0]), (CasterFaces::Front, [1, 0, 0]), (CasterFaces::Back, [0, -1, 0])]
    {
        assert_eq!(faces.signs(&sides), signs, "{faces:?}");
        assert_eq!(sides.map(|side| faces.sign(side)), signs, "{faces:?}");
        // A buffer that held something holds only these.
        let mut kept = vec![7; 5];
        faces.signs_into(&sides, &mut kept);
        assert_eq!(kept, signs, "{faces:?}");
        let casts = [faces.mask() & CASTS_IN_FRONT != 0, faces.mask() & CASTS_BEHIND != 0];
        assert_eq!(casts, [signs[0] != 0, signs[1] != 0], "{faces:?}");
        assert_eq!(faces.mask() & !(CASTS_IN_FRONT | CASTS_BEHIND), 0, "{faces:?}");
    }
    assert_eq!((CASTS_IN_FRONT, CASTS_BEHIND), (1, 2));
}
