//! Relations of several casters: their crossings add up, and their shadows form a union.

use umbrage::mesh::{Mesh, Weld, weld};
use umbrage::oracle::{Crossings, Verdict};
use umbrage::testing::strategy::Case;

use super::Twist;
use super::answers::{Answers, Fault, Slip, Tally, equal, rebuilt};

type Judgement = Option<Result<Tally, String>>;

/// The message of each comparison of [`adding`] about a wrong answer.
pub(super) const ADDING: &[(Slip, &str)] = &[
    (Slip::Lighter, "point "),
    (Slip::Facing, "facing: "),
    (Slip::Darker, "verdict at point "),
    (Slip::Crossings, "crossings at point "),
    (Slip::Winding, "winding number at point "),
];

/// The message of each comparison of [`parting`] about a wrong answer.
pub(super) const PARTING: &[(Slip, &str)] = &[
    (Slip::Lighter, "verdict at point "),
    (Slip::Darker, "verdict at point "),
    (Slip::Crossings, "crossings at point "),
    (Slip::Winding, "winding number at point "),
];

/// Two casters, and both together.
struct Three {
    one: Answers,
    other: Answers,
    both: Answers,
}

impl Three {
    fn of(case: &Case, [one, other, both]: [Mesh; 3], fault: Fault) -> Result<Self, String> {
        let ask = |mesh| Answers::of(&Case { mesh, ..case.clone() });
        let mut three = Self { one: ask(one)?, other: ask(other)?, both: ask(both)? };
        fault.spoil(&mut three.both);
        Ok(three)
    }

    /// Checks that a point is in shadow if one caster shadows it, grazing if one is touched, and that the
    /// counts add up.
    fn add_up(&self) -> Result<(), String> {
        let parts = self.one.points.iter().zip(&self.other.points);
        for (point, (both, (one, other))) in self.both.points.iter().zip(parts).enumerate() {
            let either = |verdict| one.verdict == verdict || other.verdict == verdict;
            let expected = match () {
                () if either(Verdict::Shadowed) => Verdict::Shadowed,
                () if either(Verdict::Grazing) => Verdict::Grazing,
                () => Verdict::Lit,
            };
            equal(&format!("verdict at point {point}"), &both.verdict, &expected)?;
            let (a, b) = (one.crossings, other.crossings);
            let crossings = Crossings {
                front: a.front + b.front,
                back: a.back + b.back,
                touching: a.touching + b.touching,
            };
            equal(&format!("crossings at point {point}"), &both.crossings, &crossings)?;
            // Where sides of two volumes cancel, a point may lie on these volumes but not on the third.
            if let (Some(a), Some(b), Some(sum)) = (one.winding, other.winding, both.winding) {
                equal(&format!("winding number at point {point}"), &sum, &(a + b))?;
            }
        }
        Ok(())
    }
}

/// A second caster, with vertices of its own or joined to the mesh. Fault: it replaces half of the mesh.
pub(super) fn adding(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let mut whole = case.mesh.clone();
    if fault.in_image() {
        let (positions, triangles, ..) = whole.into_parts();
        let half = triangles.len() / 2;
        whole = rebuilt(positions, triangles[..half].to_vec());
    }
    let both = Mesh::concat(&[whole, twist.extra.clone()]).expect("few faces");
    let both = if twist.weld { weld(&both, Weld::Exact).mesh } else { both };
    let judge = || {
        let three = Three::of(case, [case.mesh.clone(), twist.extra.clone(), both], fault)?;
        for (point, (before, after)) in three.one.points.iter().zip(&three.both.points).enumerate() {
            let lighter = match before.verdict {
                Verdict::Lit => false,
                Verdict::Grazing => after.verdict == Verdict::Lit,
                Verdict::Shadowed => after.verdict != Verdict::Shadowed,
            };
            if lighter {
                return Err(format!("point {point} was {:?} and is {:?}", before.verdict, after.verdict));
            }
        }
        let facing = [three.one.facing.clone(), three.other.facing.clone()].concat();
        equal("facing", &three.both.facing, &facing)?;
        three.add_up()?;
        Ok(three.one.tally())
    };
    Some(judge())
}

/// The faces of the mesh divided among two casters. Fault: the second loses half of its faces.
pub(super) fn parting(case: &Case, twist: &Twist, fault: Fault) -> Judgement {
    let mut hands = [Vec::new(), Vec::new()];
    for (face, &corners) in case.mesh.triangles().iter().enumerate() {
        hands[(twist.scattered(face) & 1) as usize].push(corners);
    }
    if fault.in_image() {
        let half = hands[1].len() / 2;
        hands[1].truncate(half);
    }
    let [one, other] = hands.map(|faces| rebuilt(case.mesh.positions().to_vec(), faces));
    let judge = || {
        let three = Three::of(case, [one, other, case.mesh.clone()], fault)?;
        three.add_up()?;
        Ok(three.both.tally())
    };
    Some(judge())
}
