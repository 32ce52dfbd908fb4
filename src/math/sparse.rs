//! Sparse symmetric systems, solved directly (faer's Cholesky, one thread).

use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use faer::{MatMut, Side};

/// A factorised symmetric positive definite matrix.
pub struct Cholesky {
    factor: Llt<usize, f64>,
    size: usize,
}

impl Cholesky {
    /// Factorises the matrix whose lower triangle is the sum of the (row, column, value) entries, row ≥ column.
    ///
    /// `None` where the matrix is not positive definite, or holds an index out of range.
    pub fn new(size: usize, lower: &[(usize, usize, f64)]) -> Option<Self> {
        let triplets: Vec<_> = lower.iter().map(|&(row, col, val)| Triplet { row, col, val }).collect();
        let matrix = SparseColMat::<usize, f64>::try_new_from_triplets(size, size, &triplets).ok()?;
        let factor = matrix.sp_cholesky(Side::Lower).ok()?;
        Some(Self { factor, size })
    }

    /// Replaces each of the right-hand sides, stored one after the other, by its solution.
    ///
    /// # Panics
    /// Where `sides` is not a multiple of the matrix' size.
    pub fn solve(&self, sides: &mut [f64]) {
        if self.size > 0 {
            assert!(sides.len().is_multiple_of(self.size), "whole right-hand sides");
            let columns = sides.len() / self.size;
            self.factor.solve_in_place(MatMut::from_column_major_slice_mut(sides, self.size, columns));
        }
    }
}
