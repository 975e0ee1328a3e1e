//! The sign of a determinant that is exactly zero.

use num_bigint::{BigInt, Sign as BigSign};
use umbrage::geom::predicate::{Sign, orient3d};

use crate::measure::{Bench, Contender, Group, Scatter, timed};

/// The four points of a predicate.
type Points = [[f32; 3]; 4];

pub(crate) fn run(bench: &mut Bench<'_>) {
    if !bench.wants("exact ties") {
        return;
    }
    let (of, power) = (|random: &mut Scatter| random.next(), |k: i32| 2.0_f32.powi(k));
    let whole = |random: &mut Scatter, most: f32| (random.next() * most).round();
    // The second line of a vertical wall, through two positions (x, y).
    let wall = |random: &mut Scatter, number: &dyn Fn(&mut Scatter) -> f32| -> Points {
        let feet = [(); 2].map(|()| [number(random), number(random)]);
        [0, 1, 1, 0].map(|foot: usize| [feet[foot][0], feet[foot][1], number(random)])
    };
    let again = |random: &mut Scatter, spread: f32| -> Points {
        let mut point = || [(); 3].map(|()| random.next() * power((random.next() * 0.5 * spread) as i32));
        let a = point();
        [a, point(), a, point()]
    };
    row(bench, "no tie", |r| [(); 4].map(|()| r.point(1.0)));
    row(bench, "face along an axis", |r| {
        let z = r.next();
        [(); 4].map(|()| [of(r), of(r), z])
    });
    row(bench, "upright wall · tenths", |r| wall(r, &|r| whole(r, 1000.0) * 0.1));
    row(bench, "upright wall · thirds", |r| wall(r, &|r| whole(r, 1000.0) / 3.0));
    row(bench, "tilted grid", |r| {
        [(); 4].map(|()| {
            let [x, y] = [whole(r, 100.0), whole(r, 100.0)];
            [x, y, x + 2.0 * y]
        })
    });
    row(bench, "tilted plane · f32", |r| {
        [(); 4].map(|()| {
            let x = of(r);
            [x, of(r), x]
        })
    });
    row(bench, "repeated vertex", |r| again(r, 0.0));
    row(bench, "repeated vertex · spread 2^20", |r| again(r, 20.0));
    row(bench, "repeated vertex · spread 2^60", |r| again(r, 60.0));
    row(bench, "repeated vertex · spread 2^120", |r| again(r, 120.0));
    row(bench, "light 2^40 away in a wall's plane", |r| {
        let mut on = |x: f32| [x, 2.0 * x, r.next()];
        let (near, far) = (on(0.7), on(power(40) / 3.0));
        [near, on(-0.3), on(0.1), far]
    });
}

fn row(bench: &mut Bench<'_>, kind: &'static str, points: impl Fn(&mut Scatter) -> Points) {
    let mut random = Scatter(7);
    let units = if bench.quick { 1 << 8 } else { 1 << 14 };
    let all: Vec<Points> = (0..units).map(|_| points(&mut random)).collect();
    let expected: Vec<Sign> = all.iter().map(reference).collect();
    let on = expected.iter().filter(|sign| sign.is_zero()).count();
    let mut signs = vec![Sign::Zero; units];
    let mut others = signs.clone();
    let told = |signs: &[Sign]| {
        assert!(signs == expected, "{kind}: signs differ from those of whole numbers");
        format!("ties={on}")
    };
    let coordinates = |[x, y, z]: [f32; 3]| robust::Coord3D { x, y, z };
    let of_robust = |&[a, b, c, d]: &Points| {
        let det = robust::orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(d));
        [Sign::Zero, Sign::Positive, Sign::Negative][usize::from(det > 0.0) + 2 * usize::from(det < 0.0)]
    };
    let of_ours = |&[a, b, c, d]: &Points| orient3d(a, b, c, d);
    let contenders = vec![
        Contender::new("robust::orient3d", || {
            timed(|| fill(&mut others, &all, of_robust), |signs| told(signs))
        }),
        Contender::new("orient3d", || timed(|| fill(&mut signs, &all, of_ours), |signs| told(signs))),
    ];
    bench.run(Group { stage: "exact ties", mesh: kind.to_owned(), units, unit: "predicate", contenders });
}

fn fill<'a>(signs: &'a mut [Sign], all: &[Points], sign: impl Fn(&Points) -> Sign) -> &'a [Sign] {
    for (place, points) in signs.iter_mut().zip(all) {
        *place = sign(points);
    }
    signs
}

/// The sign by big integers, in multiples of 2⁻¹⁴⁹.
fn reference(points: &Points) -> Sign {
    let whole = |x: f32| {
        let (exponent, fraction) = ((x.to_bits() >> 23) & 0xff, x.to_bits() & 0x7f_ffff);
        let size = if exponent == 0 { fraction } else { fraction | 0x80_0000 };
        let size = BigInt::from(size) << (exponent.max(1) - 1);
        if x.is_sign_negative() { -size } else { size }
    };
    let [a, b, c] = [0, 1, 2].map(|i| [0, 1, 2].map(|j| whole(points[i][j]) - whole(points[3][j])));
    let minor = |i: usize, j: usize| &b[i] * &c[j] - &b[j] * &c[i];
    match (&a[0] * minor(1, 2) - &a[1] * minor(0, 2) + &a[2] * minor(0, 1)).sign() {
        BigSign::Minus => Sign::Negative,
        BigSign::NoSign => Sign::Zero,
        BigSign::Plus => Sign::Positive,
    }
}
