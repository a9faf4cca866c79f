#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

/// Systems of equations with a symmetric positive definite matrix, by Cholesky's method. Matrices are n x n by rows, of
/// which only the lower triangle is used.
namespace talus::stats {

/// Replaces the matrix by L with L L^T equal to it; false (contents then undefined) where it is not positive definite.
inline bool cholesky(std::vector<double>& matrix, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = matrix[i * n + j];
            for (std::size_t k = 0; k < j; ++k) sum -= matrix[i * n + k] * matrix[j * n + k];
            if (j < i) {
                matrix[i * n + j] = sum / matrix[j * n + j];
            } else {
                if (!(sum > 0)) return false;
                matrix[i * n + i] = std::sqrt(sum);
            }
        }
    }
    return true;
}

/// Replaces b by x with L x = b.
inline void solve_lower(const std::vector<double>& factor, std::vector<double>& b) {
    const std::size_t n = b.size();
    for (std::size_t i = 0; i < n; ++i) {
        double sum = b[i];
        for (std::size_t k = 0; k < i; ++k) sum -= factor[i * n + k] * b[k];
        b[i] = sum / factor[i * n + i];
    }
}

/// Replaces b by x with L^T x = b.
inline void solve_upper(const std::vector<double>& factor, std::vector<double>& b) {
    const std::size_t n = b.size();
    for (std::size_t i = n; i-- > 0;) {
        b[i] /= factor[i * n + i];
        for (std::size_t k = 0; k < i; ++k) b[k] -= factor[i * n + k] * b[i];
    }
}

}  // namespace talus::stats
