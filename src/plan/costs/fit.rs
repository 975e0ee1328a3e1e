//! Least squares without negative coefficients.

/// Fits `time ≈ Σ coefficient·count` to rows of counts, by the sum of the squares of relative errors. No
/// coefficient is negative: time does not fall with work. (An unconstrained fit gives some negative ones,
/// since counts grow together.) The most negative one is set to 0, and the others are fitted again.
///
/// Rows of times that are not above 0 are left out.
pub(super) fn fit(rows: &[(Vec<f64>, f64)], count: usize) -> Vec<f64> {
    let mut used: Vec<usize> = (0..count).collect();
    loop {
        let found = least_squares(rows, &used);
        let least = found.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        match least {
            Some((index, coefficient)) if *coefficient < 0.0 => {
                used.remove(index);
            }
            _ => {
                let mut coefficients = vec![0.0; count];
                for (&index, coefficient) in used.iter().zip(found) {
                    coefficients[index] = coefficient;
                }
                return coefficients;
            }
        }
    }
}

/// The coefficients of the used counts, by the normal equations. A count that follows from the ones before
/// gets 0.
fn least_squares(rows: &[(Vec<f64>, f64)], used: &[usize]) -> Vec<f64> {
    let n = used.len();
    let timed = || rows.iter().filter(|(_, time)| *time > 0.0);
    // Counts are scaled by their largest, since they differ by many powers of ten.
    let scale: Vec<f64> = used
        .iter()
        .map(|&i| timed().map(|(counts, time)| counts[i] / time).fold(0.0, f64::max))
        .map(|most| if most > 0.0 { most } else { 1.0 })
        .collect();
    let mut matrix = vec![vec![0.0; n + 1]; n];
    for (counts, time) in timed() {
        let row: Vec<f64> = (0..n).map(|i| counts[used[i]] / time / scale[i]).collect();
        for i in 0..n {
            for j in 0..n {
                matrix[i][j] += row[i] * row[j];
            }
            matrix[i][n] += row[i];
        }
    }
    let mut is_pivot = vec![false; n];
    for i in 0..n {
        let pivot = matrix[i][i];
        // Of a symmetric matrix with entries of about 1: what is left of a row that follows from others is
        // rounding.
        if pivot <= f64::EPSILON * 64.0 * rows.len() as f64 {
            continue;
        }
        is_pivot[i] = true;
        for j in 0..n {
            if j != i {
                let factor = matrix[j][i] / pivot;
                for k in i..=n {
                    matrix[j][k] -= factor * matrix[i][k];
                }
            }
        }
    }
    (0..n).map(|i| if is_pivot[i] { matrix[i][n] / matrix[i][i] / scale[i] } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fit_finds_the_coefficients_that_the_times_were_made_of() {
        let truth = [3.0, 0.5, 0.0, 20.0];
        let rows: Vec<(Vec<f64>, f64)> = (0..12_u32)
            .map(|k| {
                let x = f64::from(k);
                let counts = vec![1.0, 1e6 * (1.0 + x), (x * x) % 7.0, 1e3 * ((5.0 * x) % 11.0)];
                let time = counts.iter().zip(truth).map(|(count, c)| count * c).sum();
                (counts, time)
            })
            .collect();
        let found = fit(&rows, 4);
        for (found, truth) in found.iter().zip(truth) {
            assert!((found - truth).abs() <= 1e-6 * (1.0 + truth), "{found} for {truth}");
        }
    }

    #[test]
    fn fit_gives_nothing_negative_and_survives_rows_that_say_nothing() {
        // The second count is twice the first; the third would get a negative coefficient.
        let rows: Vec<(Vec<f64>, f64)> =
            (1..9_u32).map(f64::from).map(|x| (vec![x, 2.0 * x, x * x], 5.0 * x - 0.3 * x * x)).collect();
        let found = fit(&rows, 3);
        assert!(found.iter().all(|coefficient| *coefficient >= 0.0 && coefficient.is_finite()), "{found:?}");
        assert!(found[0] + 2.0 * found[1] > 2.0);
        assert_eq!(fit(&[], 2), [0.0, 0.0]);
        assert_eq!(fit(&[(vec![0.0, 1.0], 0.0)], 2), [0.0, 0.0]);
    }
}
