//! What a texel of a map holds, and how a face is drawn into it.

use std::fmt::Debug;

/// A texel. Drawing faces in any order gives the same texel, but for equal depths, where the face that was
/// drawn first stays.
pub trait Texel: Copy + Debug + Default + PartialEq + Send + Sync {
    /// Draws a face at a depth.
    fn draw(&mut self, depth: f32, face: u32);

    /// The greatest depth drawn, 0 if there is none.
    fn depth(&self) -> f32;
}

/// The greatest depth.
impl Texel for f32 {
    fn draw(&mut self, depth: f32, _: u32) {
        *self = self.max(depth);
    }

    fn depth(&self) -> f32 {
        *self
    }
}

/// The greatest depth, and the face that it is of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Named {
    depth: f32,
    /// The face plus 1; 0 for none.
    face: u32,
}

impl Named {
    /// The face nearest to the light, numbered as in
    /// [`CasterGroup::oracle`](crate::caster::CasterGroup::oracle).
    #[must_use]
    pub fn face(&self) -> Option<u32> {
        self.face.checked_sub(1)
    }
}

impl Texel for Named {
    fn draw(&mut self, depth: f32, face: u32) {
        if depth > self.depth {
            *self = Self { depth, face: face + 1 };
        }
    }

    fn depth(&self) -> f32 {
        self.depth
    }
}

/// The greatest depth, and the greatest of those below it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layered {
    depth: f32,
    second: f32,
}

impl Layered {
    /// The greatest depth below the first; 0 if there is none.
    #[must_use]
    pub fn second(&self) -> f32 {
        self.second
    }
}

impl Texel for Layered {
    fn draw(&mut self, depth: f32, _: u32) {
        if depth > self.depth {
            *self = Self { depth, second: self.depth };
        } else if depth < self.depth {
            self.second = self.second.max(depth);
        }
    }

    fn depth(&self) -> f32 {
        self.depth
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texel_does_not_depend_on_the_order_of_drawing() {
        let depths = [0.5, 0.75, 0.25, 0.75, 0.625];
        let mut order = [0, 1, 2, 3, 4];
        for turn in 0..120 {
            order.swap(turn % 5, (turn * 7 + 1) % 5);
            let (mut depth, mut layered) = (0.0_f32, Layered::default());
            for face in order {
                depth.draw(depths[face], 0);
                layered.draw(depths[face], 0);
            }
            assert_eq!((depth, layered.depth(), layered.second()), (0.75, 0.75, 0.625));
        }
        let mut named = Named::default();
        assert_eq!(named.face(), None);
        for (face, depth) in (0..).zip(depths) {
            named.draw(depth, face);
        }
        assert_eq!((named.depth(), named.face()), (0.75, Some(1)));
    }
}
