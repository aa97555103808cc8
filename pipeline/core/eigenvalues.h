#pragma once

#include <Eigen/Core>

namespace runcert {

/// The eigenvalues of a symmetric matrix of any size (n by n; its lower triangle counts), smallest
/// first: n values, in the unit of its elements, which must be finite. Neither symmetry nor
/// finiteness is checked, and it throws no Failure.
/// All callers share this one because Eigen's solver of each fixed size costs the compiler a
/// quarter of a minute.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

}  // namespace runcert
