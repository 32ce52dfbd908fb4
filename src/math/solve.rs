//! Small dense systems of equations.

/// x of A x = b for symmetric positive A of N rows (Cholesky), a little regularised; rows one after the other.
pub fn positive(matrix: &[f64], b: &[f64]) -> Vec<f64> {
    let n = b.len();
    let mut l = matrix.to_vec();
    for i in 0..n {
        l[i * n + i] *= 1.0 + 1e-12;
    }
    for j in 0..n {
        for k in 0..j {
            let factor = l[j * n + k];
            for i in j..n {
                l[i * n + j] -= l[i * n + k] * factor;
            }
        }
        let pivot = l[j * n + j].max(1e-300).sqrt();
        for i in j..n {
            l[i * n + j] /= pivot;
        }
    }
    let mut x = b.to_vec();
    for i in 0..n {
        for k in 0..i {
            x[i] -= l[i * n + k] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            x[i] -= l[k * n + i] * x[k];
        }
        x[i] /= l[i * n + i];
    }
    x
}

/// Factors of N terms that come nearest to values, each row (terms, value) of the same weight.
pub fn least_squares<const N: usize>(rows: &[([f64; N], f64)]) -> [f64; N] {
    let mut matrix = vec![0.0; N * N];
    let mut b = [0.0; N];
    for (terms, value) in rows {
        for i in 0..N {
            for j in 0..N {
                matrix[i * N + j] += terms[i] * terms[j];
            }
            b[i] += terms[i] * value;
        }
    }
    let x = positive(&matrix, &b);
    std::array::from_fn(|i| x[i])
}
