#pragma once

#include <cstddef>
#include <limits>

#include "estimation/motion_model.h"

// The arithmetic of filter and smoother on plain numbers, written for the structure of the model:
// the transition mixes whole blocks of rows (position, velocity, acceleration, error), and the
// measurement adds up two of them. General products of matrices of the state's size would cost
// several times as much. kalman.h and motion_smoother.h are what to use; the plain form of each
// step is in their tests.
namespace runcert::kernel {

/// A state of `Blocks` kinds for `Axes` axes: position, velocity, acceleration and, where there are
/// four, the Gauss-Markov error. Matrices are column by column.
template <int Axes, int Blocks>
struct Layout {
    static_assert(Blocks == 3 || Blocks == 4);
    static constexpr int size = Axes * Blocks;
    static constexpr bool with_error = Blocks == 4;
    /// The block of the error where there is one, else the position's own.
    static constexpr int error_row = with_error ? 3 * Axes : 0;

    static constexpr int at(int row, int column) { return column * size + row; }
};

/// What a step of time does, without the structure that all steps share.
struct Transition {
    double position_of_velocity = 0.0;
    double position_of_acceleration = 0.0;
    double velocity_of_acceleration = 0.0;
    double acceleration = 0.0;
    double error = 0.0;

    Transition() = default;
    explicit Transition(const AxisStep& step)
        : position_of_velocity(step.transition(0, 1)),
          position_of_acceleration(step.transition(0, 2)),
          velocity_of_acceleration(step.transition(1, 2)),
          acceleration(step.transition(2, 2)),
          error(step.error_transition) {}
};

/// So many numbers, counted by int as all of Eigen's are.
template <int Count>
struct Numbers {
    double values[static_cast<std::size_t>(Count)];

    double& operator[](int i) { return values[i]; }
    double operator[](int i) const { return values[i]; }
    double* data() { return values; }
    const double* data() const { return values; }
};

/// F x in place.
template <int Axes, int Blocks>
inline void carry(const Transition& f, double* x) {
    for (int axis = 0; axis < Axes; ++axis) {
        double* const p = x + axis;
        p[0] += f.position_of_velocity * p[Axes] + f.position_of_acceleration * p[2 * Axes];
        p[Axes] += f.velocity_of_acceleration * p[2 * Axes];
        p[2 * Axes] *= f.acceleration;
        if constexpr (Blocks == 4) p[3 * Axes] *= f.error;
    }
}

/// F' x in place.
template <int Axes, int Blocks>
inline void carry_back(const Transition& f, double* x) {
    for (int axis = 0; axis < Axes; ++axis) {
        double* const p = x + axis;
        p[2 * Axes] = f.position_of_acceleration * p[0] + f.velocity_of_acceleration * p[Axes] +
                      f.acceleration * p[2 * Axes];
        p[Axes] += f.position_of_velocity * p[0];
        if constexpr (Blocks == 4) p[3 * Axes] *= f.error;
    }
}

/// The lower triangle's mirror image.
template <int Size>
inline void mirror(double* matrix) {
    for (int column = 0; column < Size; ++column)
        for (int row = column + 1; row < Size; ++row)
            matrix[row * Size + column] = matrix[column * Size + row];
}

/// F P F' of a symmetric P, in place.
template <int Axes, int Blocks>
inline void carry_covariance(const Transition& f, double* p) {
    using L = Layout<Axes, Blocks>;
    constexpr int n = L::size;
    // P F': whole columns.
    for (int axis = 0; axis < Axes; ++axis) {
        double* const position = p + L::at(0, axis);
        double* const velocity = p + L::at(0, Axes + axis);
        double* const acceleration = p + L::at(0, 2 * Axes + axis);
        for (int row = 0; row < n; ++row) {
            position[row] += f.position_of_velocity * velocity[row] +
                             f.position_of_acceleration * acceleration[row];
            velocity[row] += f.velocity_of_acceleration * acceleration[row];
            acceleration[row] *= f.acceleration;
        }
        if constexpr (Blocks == 4) {
            double* const error = p + L::at(0, 3 * Axes + axis);
            for (int row = 0; row < n; ++row)
                error[row] *= f.error;
        }
    }
    // F (P F'): of each column the lower triangle is enough.
    for (int column = 0; column < n; ++column)
        carry<Axes, Blocks>(f, p + L::at(0, column));
    mirror<n>(p);
}

/// F' M F of a symmetric M, in place.
template <int Axes, int Blocks>
inline void carry_information_back(const Transition& f, double* m) {
    using L = Layout<Axes, Blocks>;
    constexpr int n = L::size;
    for (int axis = 0; axis < Axes; ++axis) {
        double* const position = m + L::at(0, axis);
        double* const velocity = m + L::at(0, Axes + axis);
        double* const acceleration = m + L::at(0, 2 * Axes + axis);
        for (int row = 0; row < n; ++row) {
            acceleration[row] = f.position_of_acceleration * position[row] +
                                f.velocity_of_acceleration * velocity[row] +
                                f.acceleration * acceleration[row];
            velocity[row] += f.position_of_velocity * position[row];
        }
        if constexpr (Blocks == 4) {
            double* const error = m + L::at(0, 3 * Axes + axis);
            for (int row = 0; row < n; ++row)
                error[row] *= f.error;
        }
    }
    for (int column = 0; column < n; ++column)
        carry_back<Axes, Blocks>(f, m + L::at(0, column));
    mirror<n>(m);
}

/// Adds the process noise of a step.
template <int Axes, int Blocks>
inline void add_noise(const AxisStep& step, double* p) {
    using L = Layout<Axes, Blocks>;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            for (int axis = 0; axis < Axes; ++axis)
                p[L::at(i * Axes + axis, j * Axes + axis)] += step.process_noise(i, j);
    if constexpr (Blocks == 4)
        for (int axis = 0; axis < Axes; ++axis)
            p[L::at(3 * Axes + axis, 3 * Axes + axis)] += step.error_noise;
}

/// Whether all pivots of a symmetric matrix are positive; only its lower triangle is looked at.
template <int Axes>
inline bool is_positive_definite(const double* matrix) {
    double s[Axes * Axes];
    for (int i = 0; i < Axes * Axes; ++i)
        s[i] = matrix[i];
    for (int j = 0; j < Axes; ++j) {
        const double pivot = s[j * Axes + j];
        if (!(pivot > 0.0 && pivot < std::numeric_limits<double>::infinity())) return false;
        for (int i = j + 1; i < Axes; ++i)
            for (int k = j + 1; k <= i; ++k)
                s[k * Axes + i] -= s[j * Axes + i] * (s[j * Axes + k] / pivot);
    }
    return true;
}

/// A measured position against a prediction. With S = H P H' + R = U D U', U lower with a diagonal
/// of ones.
template <int Axes, int Blocks>
struct Seen {
    static constexpr int n = Layout<Axes, Blocks>::size;
    Numbers<n * Axes> cross;         ///< P H'
    Numbers<Axes * Axes> factor;     ///< below its diagonal: U
    Numbers<Axes> inverse_variance;  ///< of D
    Numbers<Axes> residual;          ///< measured less predicted
    Numbers<Axes> independent;       ///< inverse(U) residual: of variance D
    double determinant = 1.0;        ///< of S
    double statistic = 0.0;          ///< residual' inverse(S) residual
    bool digits_lost = false;  ///< whether P - P H' inverse(S) H P would lose more than a digit
};

/// P - P H' inverse(S) H P is as good as Joseph's form unless the measurement is far better than
/// the prediction, as at an arc's beginning.
inline constexpr double short_form_ratio = 30.0;

/// `covariance` is that of the measured position as the model has it (column by column).
template <int Axes, int Blocks>
inline Seen<Axes, Blocks> see(const double* mean, const double* p, const double* measured,
                              const double* covariance) {
    using L = Layout<Axes, Blocks>;
    constexpr int n = L::size;
    Seen<Axes, Blocks> seen;
    for (int axis = 0; axis < Axes; ++axis) {
        const double* const position = p + L::at(0, axis);
        double* const cross = seen.cross.data() + axis * n;
        if constexpr (Blocks == 4) {
            const double* const error = p + L::at(0, L::error_row + axis);
            for (int row = 0; row < n; ++row)
                cross[row] = position[row] + error[row];
            seen.residual[axis] = measured[axis] - mean[axis] - mean[L::error_row + axis];
        } else {
            for (int row = 0; row < n; ++row)
                cross[row] = position[row];
            seen.residual[axis] = measured[axis] - mean[axis];
        }
    }
    double s[Axes * Axes];
    for (int column = 0; column < Axes; ++column)
        for (int row = column; row < Axes; ++row) {
            const double* const cross = seen.cross.data() + column * n;
            const double predicted =
                Blocks == 4 ? cross[row] + cross[L::error_row + row] : cross[row];
            const double stated = covariance[column * Axes + row];
            s[column * Axes + row] = predicted + stated;
            if (row == column) seen.digits_lost |= predicted > short_form_ratio * stated;
        }
    // S = U D U', and inverse(U) residual beside it.
    for (int j = 0; j < Axes; ++j) {
        const double variance = s[j * Axes + j];
        const double inverse = 1.0 / variance;
        seen.inverse_variance[j] = inverse;
        seen.determinant *= variance;
        seen.independent[j] = seen.residual[j];
        for (int k = 0; k < j; ++k)
            seen.independent[j] -= seen.factor[k * Axes + j] * seen.independent[k];
        seen.statistic += seen.independent[j] * seen.independent[j] * inverse;
        for (int i = j + 1; i < Axes; ++i)
            seen.factor[j * Axes + i] = s[j * Axes + i] * inverse;
        for (int i = j + 1; i < Axes; ++i)
            for (int k = j + 1; k <= i; ++k)
                s[k * Axes + i] -= seen.factor[j * Axes + i] * s[j * Axes + k];
    }
    return seen;
}

/// P H' inverse(U'), a column for each axis: what the independent residuals move the state by,
/// times their variances.
template <int Axes, int Blocks>
inline Numbers<Layout<Axes, Blocks>::size * Axes> independent_cross(
    const Seen<Axes, Blocks>& seen) {
    constexpr int n = Layout<Axes, Blocks>::size;
    Numbers<n* Axes> columns = seen.cross;
    for (int j = 1; j < Axes; ++j)
        for (int k = 0; k < j; ++k) {
            const double factor = seen.factor[k * Axes + j];
            for (int row = 0; row < n; ++row)
                columns[j * n + row] -= factor * columns[k * n + row];
        }
    return columns;
}

/// Of U.
template <int Axes, int Blocks>
inline Eigen::Matrix<double, Axes, Axes> inverse_factor(const Seen<Axes, Blocks>& seen) {
    Eigen::Matrix<double, Axes, Axes> inverse = Eigen::Matrix<double, Axes, Axes>::Identity();
    for (int j = 1; j < Axes; ++j)
        for (int k = 0; k < j; ++k)
            inverse.row(j) -= seen.factor[k * Axes + j] * inverse.row(k);
    return inverse;
}

/// A square matrix times some columns, one whole column of the matrix after the other.
template <int Size, int Count>
inline Eigen::Matrix<double, Size, Count> times_columns(
    const Eigen::Matrix<double, Size, Size>& matrix,
    const Eigen::Matrix<double, Size, Count>& columns) {
    Eigen::Matrix<double, Size, Count> product;
    for (int column = 0; column < Count; ++column) {
        double sum[Size] = {};
        for (int i = 0; i < Size; ++i) {
            const double factor = columns(i, column);
            for (int row = 0; row < Size; ++row)
                sum[row] += matrix.data()[i * Size + row] * factor;
        }
        for (int row = 0; row < Size; ++row)
            product(row, column) = sum[row];
    }
    return product;
}

/// (I - K H) P (I - K H)' + K R K', one side after the other, in place.
template <int Axes, int Blocks>
inline void take_in_by_joseph(const Seen<Axes, Blocks>& seen, const double* noise,
                              const Numbers<Layout<Axes, Blocks>::size * Axes>& columns,
                              double* p) {
    using L = Layout<Axes, Blocks>;
    constexpr int n = L::size;
    using Columns = Eigen::Matrix<double, n, Axes>;
    using Small = Eigen::Matrix<double, Axes, Axes>;
    const Eigen::Map<const Columns> cross(seen.cross.data());
    const Eigen::Map<const Eigen::Matrix<double, Axes, 1>> weights(seen.inverse_variance.data());
    const Columns gain = Eigen::Map<const Columns>(columns.data()) * weights.asDiagonal() *
                         inverse_factor<Axes, Blocks>(seen);
    Eigen::Map<Eigen::Matrix<double, n, n>> covariance(p);
    const Eigen::Matrix<double, n, n> one_side = covariance - gain * cross.transpose();
    Columns rest = gain * Eigen::Map<const Small>(noise) - one_side.template leftCols<Axes>();
    if constexpr (Blocks == 4) rest -= one_side.template rightCols<Axes>();
    covariance = one_side + rest * gain.transpose();
    mirror<n>(p);
}

/// Takes the measurement in. `noise` is its covariance as the model has it. The updated covariance
/// is symmetric but for rounding.
template <int Axes, int Blocks>
inline void take_in(const Seen<Axes, Blocks>& seen, const double* noise, double* mean, double* p) {
    constexpr int n = Layout<Axes, Blocks>::size;
    const auto columns = independent_cross<Axes, Blocks>(seen);
    for (int axis = 0; axis < Axes; ++axis) {
        const double* const cross = columns.data() + axis * n;
        double scaled[n];
        for (int row = 0; row < n; ++row)
            scaled[row] = cross[row] * seen.inverse_variance[axis];
        for (int row = 0; row < n; ++row)
            mean[row] += scaled[row] * seen.independent[axis];
        if (seen.digits_lost) continue;
        for (int column = 0; column < n; ++column)
            for (int row = 0; row < n; ++row)
                p[column * n + row] -= scaled[row] * cross[column];
    }
    if (seen.digits_lost) take_in_by_joseph<Axes, Blocks>(seen, noise, columns, p);
}

}  // namespace runcert::kernel
