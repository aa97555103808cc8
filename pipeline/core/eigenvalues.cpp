#include "core/eigenvalues.h"

#include <Eigen/Eigenvalues>

namespace runcert {

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
        .eigenvalues();
}

}  // namespace runcert
