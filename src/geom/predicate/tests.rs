//! Every step of the predicates against big integers.

use proptest::prelude::*;

use super::filter::{FILTER, certain_sign};
use super::*;
use crate::random::SplitMix64;

/// Reference: the sign of the same determinant in big integers, as multiples of 2⁻¹⁴⁹, by cofactors of the
/// first row.
fn reference(rows: [Row; 3]) -> i32 {
    use num_bigint::{BigInt, Sign as BigSign};
    let whole = |x: f32| {
        let bits = x.to_bits();
        let (exponent, fraction) = ((bits >> 23) & 0xff, bits & 0x7f_ffff);
        let mantissa = if exponent == 0 { fraction } else { fraction | 0x80_0000 };
        let magnitude = BigInt::from(mantissa) << (exponent.max(1) - 1);
        if x.is_sign_negative() { -magnitude } else { magnitude }
    };
    let m = rows.map(|Row(u, v)| [0, 1, 2].map(|i| whole(u[i]) - whole(v[i])));
    let det = &m[0][0] * (&m[1][1] * &m[2][2] - &m[1][2] * &m[2][1])
        - &m[0][1] * (&m[1][0] * &m[2][2] - &m[1][2] * &m[2][0])
        + &m[0][2] * (&m[1][0] * &m[2][1] - &m[1][1] * &m[2][0]);
    match det.sign() {
        BigSign::Minus => -1,
        BigSign::NoSign => 0,
        BigSign::Plus => 1,
    }
}

fn finite() -> impl Strategy<Value = f32> {
    prop_oneof![
        any::<f32>().prop_filter("finite", |x| x.is_finite()),
        (-8_i8..8).prop_map(f32::from),
        (-1000_i16..1000).prop_map(|x| f32::from(x) * 0.001),
        Just(f32::MAX),
        Just(f32::from_bits(1)),
    ]
}

fn vector() -> impl Strategy<Value = [f32; 3]> {
    [finite(), finite(), finite()]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4096))]

    #[test]
    fn predicate_every_step_equals_whole_numbers(
        u in [vector(), vector(), vector()],
        v in [vector(), vector(), vector()],
        tie in any::<bool>(),
    ) {
        let mut rows = [0, 1, 2].map(|i| Row(u[i], v[i]));
        if tie {
            rows[2] = Row(v[0], u[0]); // row 2 = −row 0: exactly singular
        }
        let expected = reference(rows);
        prop_assert_eq!(sign_of_det(rows).value(), expected);
        prop_assert_eq!(Accumulator::of_det(&rows).sign().value(), expected);
        if certain_sign(&rows, FILTER).is_none() {
            for sign in [integer::sign_of_det(rows), integer::sign_of_scaled_det(rows)].into_iter().flatten() {
                prop_assert_eq!(sign.value(), expected);
            }
        }
    }
}

/// Determinants that are zero, or as close to zero as their entries allow: the third row is a sum or
/// difference of the others, or one of them again. In half the cases one entry is changed by an ulp.
fn near_tie(random: &mut SplitMix64) -> [Row; 3] {
    let kind = random.below(6);
    let number = |random: &mut SplitMix64| {
        let few = random.below(1 << 8) as f32 - 128.0;
        let many = random.below(1 << 24) as f32 - 8_388_608.0;
        let power = |k: usize| 2.0_f64.powi(k as i32) as f32;
        match kind {
            0 => few,
            1 => many,
            2 => few * 0.1,
            3 => many * power(random.below(16)),
            5 => few * power(random.below(70)),
            _ => many * power(random.below(90)) * 1e-9,
        }
    };
    let mut rows = [(); 3].map(|()| Row([(); 3].map(|()| number(random)), [(); 3].map(|()| number(random))));
    let relation = random.below(5);
    for i in 0..3 {
        let [Row(a, x), Row(b, y), Row(c, z)] = &mut rows;
        (c[i], z[i]) = match relation {
            0 => (a[i], x[i]),
            1 => (y[i], b[i]),
            // Exact where numbers are small integers.
            2 => (a[i] + b[i], x[i] + y[i]),
            4 => (3.0 * a[i], 3.0 * x[i]),
            _ => (a[i] - y[i], x[i] - b[i]),
        };
    }
    if kind < 4 && random.below(3) == 0 {
        // Rows of different magnitudes: an exact multiple of one row keeps the tie.
        let scale = 2.0_f64.powi(random.below(70) as i32 - 35) as f32;
        let Row(u, v) = &mut rows[random.below(3)];
        u.iter_mut().chain(v).for_each(|x| *x *= scale);
    }
    if random.below(2) == 0 {
        let entry = &mut rows[random.below(3)].0[random.below(3)];
        *entry = entry.next_up();
    }
    rows
}

/// An integer matrix of determinant −1, 0 or 1 (rows added to rows and columns to columns, starting from a
/// diagonal), with rows and columns scaled by powers of two.
fn unimodular(random: &mut SplitMix64) -> [Row; 3] {
    let mut m = [[1_i64, 0, 0], [0, 1, 0], [0, 0, random.below(3) as i64 - 1]];
    let most = 1 << (8 + random.below(17));
    for _ in 0..200 {
        let (from, to) = (random.below(3), random.below(3));
        let times = random.below(7) as i64 - 3;
        let mut next = m;
        for i in 0..3 {
            match (from == to, random.0 & 1) {
                (true, _) => {}
                (_, 0) => next[to][i] += times * m[from][i],
                _ => next[i][to] += times * m[i][from],
            }
        }
        if next.iter().flatten().all(|x| x.abs() < most) {
            m = next;
        }
    }
    let far = random.below(4) == 0;
    let mut power = || if far { 2.0_f64.powi(random.below(50) as i32 - 25) } else { 1.0 };
    let (rows, columns) = ([(); 3].map(|()| power()), [(); 3].map(|()| power()));
    [0, 1, 2].map(|i| Row([0, 1, 2].map(|j| (m[i][j] as f64 * rows[i] * columns[j]) as f32), [0.0; 3]))
}

fn near_zero(random: &mut SplitMix64) -> [Row; 3] {
    if random.below(2) == 0 { near_tie(random) } else { unimodular(random) }
}

/// The step that decides, and its sign.
fn answered(rows: [Row; 3]) -> (usize, Sign) {
    if let Some(sign) = certain_sign(&rows, FILTER) {
        (0, sign)
    } else if let Some(sign) = integer::sign_of_det(rows) {
        (if integer::is_small(rows) { 1 } else { 2 }, sign)
    } else if let Some(sign) = integer::sign_of_scaled_det(rows) {
        (3, sign)
    } else {
        (4, Accumulator::of_det(&rows).sign())
    }
}

#[test]
fn predicate_every_step_is_reached_and_right_near_ties() {
    let mut random = SplitMix64(1);
    // For each step: the number of ties, and of nonzero signs.
    let mut reached = [[0; 2]; 5];
    for _ in 0..60_000 {
        let rows = near_zero(&mut random);
        let expected = reference(rows);
        let (step, sign) = answered(rows);
        assert_eq!(sign.value(), expected, "step {step}: {rows:?}");
        assert_eq!(sign_of_det(rows), sign);
        reached[step][usize::from(expected != 0)] += 1;
    }
    assert!(reached[0][1] > 1000 && reached[1..].iter().flatten().all(|&n| n > 100), "{reached:?}");
}

#[test]
fn predicate_steps_that_forget_something_are_caught() {
    let mut random = SplitMix64(1);
    let mut wrong = [0; 6];
    for _ in 0..60_000 {
        let rows = near_zero(&mut random);
        let expected = reference(rows);
        // Fault injected: a filter with a tenth of its bound.
        wrong[0] +=
            usize::from(certain_sign(&rows, 0.1 * FILTER).is_some_and(|sign| sign.value() != expected));
        if certain_sign(&rows, FILTER).is_none() {
            // Faults injected: integers of 51 bits in `i64`; differences that were rounded.
            let unchecked =
                |spare| integer::sign_without_checks(rows, spare).is_some_and(|s| s.value() != expected);
            wrong[1] += usize::from(integer::sign_of_det(rows).is_some() && unchecked(0));
            wrong[2] += usize::from(unchecked(integer::SPARE));
            if integer::sign_of_det(rows).is_none() && integer::sign_of_scaled_det(rows).is_some() {
                let scaled = |apply: fn([usize; 3], f64, &mut [f64; 9])| {
                    integer::sign_of_scaled_badly(rows, apply).is_some_and(|s| s.value() != expected)
                };
                // Faults injected: one entry of each row and column left unscaled; the entry in the middle
                // scaled by 1.25 times too much.
                wrong[4] += usize::from(scaled(|[_, i, j], scale, entries| {
                    entries[i] *= scale;
                    entries[j] *= scale;
                }));
                wrong[5] += usize::from(scaled(|line, scale, entries| {
                    line.iter().for_each(|&i| entries[i] *= if i == 4 { 1.25 * scale } else { scale });
                }));
            }
        }
        // Fault injected: an accumulator that misses the second factor of an entry.
        let half = Accumulator::of_det_of(&rows, |u, v| {
            let [first, _] = accumulator::parts(u, v);
            [first, accumulator::Part::default()]
        });
        wrong[3] += usize::from(half.sign().value() != expected);
    }
    assert!(wrong.iter().all(|&n| n > 10), "{wrong:?}");
}

#[test]
fn predicate_agrees_with_the_robust_crate_one_ulp_off_a_plane() {
    let coord = |p: [f32; 3]| robust::Coord3D { x: p[0], y: p[1], z: p[2] };
    let [a, b, c] = [[0.1, 0.2, 0.3], [1.7, 0.3, 0.9], [0.4, 1.9, 1.1]];
    // Around the height of the plane over (0.55, 0.7).
    let wide = |p: [f32; 3]| glam::DVec3::from(p.map(f64::from));
    let normal = (wide(b) - wide(a)).cross(wide(c) - wide(a));
    let (x, y) = (0.55_f32, 0.7_f32);
    let step = normal.x * (f64::from(x) - wide(a).x) + normal.y * (f64::from(y) - wide(a).y);
    let on_plane = (wide(a).z - step / normal.z) as f32;
    let mut seen = [0; 3];
    for ulps in -40_i32..=40 {
        let d = [x, y, f32::from_bits(on_plane.to_bits().wrapping_add_signed(ulps))];
        let ours = orient3d(a, b, c, d);
        assert_eq!(ours, Sign::of(robust::orient3d(coord(a), coord(b), coord(c), coord(d))));
        seen[(ours.value() + 1) as usize] += 1;
    }
    assert!(seen[0] > 30 && seen[2] > 30, "{seen:?}");
}

#[test]
fn height_of_a_sliver_is_right_where_f64_is_wrong() {
    // A plane that misses the origin by seven units in 10^19. `f64` alone gets the offset wrong by as much as
    // its size.
    let triangle = [
        [-3_067_175.0, 580_525.0, 2_914_486.0],
        [2_535_584.0, 2_212_702.0, -3_664_925.0],
        [-1_451_934.0, 29_291.0, 1_494_139.0],
    ];
    let of_origin = height(triangle, Homogeneous::point([0.0; 3]));
    assert_eq!(of_origin.abs(), 7.0);
    assert_eq!(Sign::of(of_origin), side_of_point(triangle, [0.0; 3]));
}

#[test]
fn predicate_front_is_front_for_both_kinds_of_light() {
    let face = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert_eq!(side_of_light(face, &Light::point([0.0, 0.0, 1.0]).unwrap()), Sign::Positive);
    assert_eq!(side_of_light(face, &Light::directional([0.0, 0.0, -1.0]).unwrap()), Sign::Positive);
    assert_eq!(side_of_light(face, &Light::point([5.0, 5.0, 0.0]).unwrap()), Sign::Zero);
    assert_eq!(side_of_light(face, &Light::directional([0.0, 0.0, 1.0]).unwrap()), Sign::Negative);
    let [a, b, c] = face;
    let above = [0.0, 0.0, 1.0];
    assert_eq!(orient3d(a, b, c, above), -side_of_light(face, &Light::point(above).unwrap()));
}

#[test]
fn predicate_homogeneous_cofactors_agree_wherever_the_pivot_stands() {
    let light = Light::point([3.0, 5.0, 7.0]).unwrap();
    let [a, b, c, d] = [[0.0, 0.1, 0.2], [1.0, 0.3, 0.1], [0.2, 1.0, 0.4], [0.5, 0.6, 2.0]];
    let points = [a, b, c, d].map(Homogeneous::point);
    assert_eq!(orient3d_homogeneous(points), orient3d(a, b, c, d));
    // An even permutation of the rows keeps the sign and an odd one negates it, with the point at infinity in
    // every row.
    let far = Homogeneous::extruded(d, &light);
    let [a, b, c, _] = points;
    let sign = orient3d_homogeneous([a, b, c, far]);
    assert_ne!(sign, Sign::Zero);
    assert_eq!(orient3d_homogeneous([b, c, a, far]), sign);
    assert_eq!(orient3d_homogeneous([far, a, b, c]), -sign);
    assert_eq!(orient3d_homogeneous([a, far, b, c]), sign);
    assert_eq!(orient3d_homogeneous([a, b, far, c]), -sign);
    assert_eq!(orient3d_homogeneous([far; 4]), Sign::Zero);
}

#[test]
fn predicate_homogeneous_is_the_sign_of_the_unit_rows_in_every_order() {
    // A light in the direction of an axis shines against it.
    let axis = |xyz: [f32; 3]| Homogeneous::light(&Light::directional(xyz.map(|x| -x)).unwrap());
    let [x, y, z] = [axis([1.0, 0.0, 0.0]), axis([0.0, 1.0, 0.0]), axis([0.0, 0.0, 1.0])];
    // Of the identity, with the one finite row in each place.
    let w = Homogeneous::point([0.0; 3]);
    assert_eq!(orient3d_homogeneous([x, y, z, w]), Sign::Positive);
    assert_eq!(orient3d_homogeneous([x, y, w, z]), Sign::Negative);
    assert_eq!(orient3d_homogeneous([x, w, y, z]), Sign::Positive);
    assert_eq!(orient3d_homogeneous([w, x, y, z]), Sign::Negative);
    assert_eq!(orient3d_homogeneous([w, x, z, y]), Sign::Positive);
}

#[test]
fn predicate_collinear_points_are_on_one_line_to_the_last_place() {
    let [a, b] = [[1.0_f32, 2.0, 3.0], [2.0, 4.0, 6.0]];
    assert!(collinear(a, b, [3.0, 6.0, 9.0]) && collinear(a, b, a) && collinear(a, a, a));
    for axis in 0..3 {
        let mut off = [3.0, 6.0, 9.0_f32];
        off[axis] = off[axis].next_up();
        assert!(!collinear(a, b, off), "axis {axis}");
    }
}

/// Three points exactly on one line, so far apart that their differences are rounded.
fn on_one_line(random: &mut SplitMix64) -> [[f32; 3]; 3] {
    let direction = [(); 3].map(|()| random.below(255) as f32 - 127.0);
    [(); 3].map(|()| {
        let at = (random.below(1 << 16) as f32 - 32_768.0) * 2.0_f64.powi(random.below(60) as i32) as f32;
        direction.map(|x| x * at)
    })
}

#[test]
fn predicate_bounds_hold_and_smaller_ones_are_caught() {
    let mut random = SplitMix64(2);
    let factors = [1.0, 0.5, 0.25, 0.1];
    let (mut det, mut minor) = ([0; 4], [0; 4]);
    for _ in 0..200_000 {
        let rows = near_zero(&mut random);
        let expected = sign_of_det(rows);
        let [a, b, c] = on_one_line(&mut random);
        assert!(collinear(a, b, c));
        for (i, factor) in factors.into_iter().enumerate() {
            let sign = certain_sign(&rows, factor * FILTER);
            det[i] += usize::from(sign.is_some_and(|sign| sign != expected));
            minor[i] += usize::from(surely_not_collinear(a, b, c, factor * MINOR_FILTER));
        }
    }
    assert_eq!((det[0], minor[0]), (0, 0));
    assert!(det[2] > 0 && minor[1] > 0, "{det:?} {minor:?}");
}

#[test]
fn height_is_as_near_as_it_says_and_a_larger_share_of_f64_is_caught() {
    let mut random = SplitMix64(4);
    let mut worst = [0.0_f64; 2];
    for _ in 0..200_000 {
        let mut vector = || [(); 3].map(|()| (2.0 * random.unit() - 1.0) as f32);
        let (a, b, c) = (vector(), vector(), vector());
        // Close to the plane, by a random power of two.
        let (s, t) = (f64::from(vector()[0]), f64::from(vector()[1]));
        let off = 0.5_f64.powi((vector()[0].abs() * 24.0) as i32);
        let p = [0, 1, 2].map(|i| {
            let [a, b, c] = [a, b, c].map(|p| f64::from(p[i]));
            (a + s * (b - a) + t * (c - a) + off * f64::from(vector()[2])) as f32
        });
        // Differences that are rounded.
        let far = vector().map(|x| x * 2.0_f64.powi(-40) as f32);
        let rows = [Row(b, far), Row(c, far), Row(p, far)];
        let exact = Accumulator::of_det(&rows).value();
        for (share, worst) in [SHARE, SHARE / 64.0].into_iter().zip(&mut worst) {
            let value = value_of_det(rows, share);
            if exact != 0.0 {
                *worst = worst.max((value - exact).abs() / exact.abs());
            }
        }
    }
    let bits = worst.map(|x| x.log2());
    assert!(bits[0] < -39.0 && bits[1] > -39.0, "{bits:?}");
}

#[test]
fn parting_is_sure_only_where_whole_numbers_say_so() {
    let mut random = SplitMix64(11);
    let mut wrong = [0; 2];
    let mut sure = 0;
    for _ in 0..400_000 {
        // Differences of integers that need more than 53 bits, and a vector nearly perpendicular to them.
        let mut whole = |bits: u32, shift: usize| {
            let number = (random.next() >> (64 - bits)) as i128 - (1 << (bits - 1));
            number << random.below(shift)
        };
        let [p, q] = [(); 2].map(|()| [(); 3].map(|()| whole(24, 40)));
        let d = [0, 1, 2].map(|i| p[i] - q[i]);
        let [n0, n1] = [(); 2].map(|()| whole(50, 1));
        if d[2] == 0 {
            continue;
        }
        let n2 = -(n0 * d[0] + n1 * d[1]) / d[2];
        if n2.abs() >= 1 << 53 {
            continue;
        }
        let normal = [n0, n1, n2];
        let truth = (0..3).map(|i| normal[i] * d[i]).sum::<i128>() > 0;
        let row = Row(p.map(|x| x as f32), q.map(|x| x as f32)).rounded();
        let found = |filter| surely_along(row, normal.map(|x| x as f64), filter);
        sure += usize::from(found(ALONG_FILTER));
        for (wrong, part) in wrong.iter_mut().zip([1.0, 8.0]) {
            *wrong += usize::from(found(ALONG_FILTER / part) && !truth);
        }
    }
    assert!(wrong[0] == 0 && wrong[1] > 0, "{wrong:?} of {sure} sure");
}

#[test]
fn parting_tells_wedges_apart_and_no_others() {
    let o = [0.0; 3];
    let east = [[1.0, 0.5, 0.0], [1.0, -0.5, 0.2]];
    let west = [[-1.0, 0.5, 0.1], [-2.0, -0.5, 0.0]];
    assert!(surely_parted(o, east, west) && surely_parted(o, west, east));
    assert!(!surely_parted(o, east, [east[1], west[0]]), "a common edge");
    assert!(!surely_parted(o, east, [[1.0, 0.0, 1.0], [1.0, 0.0, -1.0]]), "through each other");
    assert!(!surely_parted(o, east, east) && !surely_parted(o, [o; 2], [o; 2]));
}

/// Quads whose corners lie on a line through the origin, at distances whose difference is rounded, and
/// others.
fn quads() -> impl Iterator<Item = [[f32; 3]; 4]> {
    let mut random = SplitMix64(7);
    (0..20_000).map(move |i| {
        let mut below = |n: u64| (random.next() % n) as f32;
        if i % 2 == 0 {
            let direction = [0; 3].map(|_| 1.0 + below(1 << 24));
            [0; 4].map(|_| below(50)).map(|k| direction.map(|x| x * (-k).exp2()))
        } else {
            let far = if i % 4 == 1 { 0.1 * below(1000) } else { 0.0 };
            [0; 4].map(|_| [0; 3].map(|_| far + 0.1 * below(10)))
        }
    })
}

#[test]
fn surely_convex_is_what_four_turns_say() {
    let (mut known, mut open, mut wrong) = (0, 0, 0);
    for quad @ [a, b, c, d] in quads() {
        for axis in 0..3 {
            let turns = [[d, a, b], [a, b, c], [b, c, d], [c, d, a]].map(|[p, q, r]| turn(p, q, r, axis));
            let convex = turns[0] != Sign::Zero && turns.iter().all(|&sign| sign == turns[0]);
            match surely_convex(quad, axis) {
                true => assert!(convex, "{quad:?} along {axis}"),
                false => open += u32::from(convex),
            }
            known += u32::from(convex);
            // Fault injected: no filter, so that rounding decides.
            let rounded = match axis {
                0 => surely_convex_in::<1, 2>(quad, 0.0),
                1 => surely_convex_in::<2, 0>(quad, 0.0),
                _ => surely_convex_in::<0, 1>(quad, 0.0),
            };
            wrong += u32::from(rounded && !convex);
        }
    }
    assert!(known > 1000 && open < known / 100, "{open} of {known} left open");
    assert!(wrong > 0, "rounding alone decides every quad");
}
