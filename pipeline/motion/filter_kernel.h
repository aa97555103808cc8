#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "motion/motion_model.h"

// Arithmetic of the one filter behind likelihoods, innovation tests, smoothers and displacements.
// It exploits the structure of the model. The transition mixes whole blocks of rows (position,
// velocity, acceleration, Gauss-Markov error) by five numbers that are the same for all axes. The
// measurement is the sum of two of the blocks. General matrix products of the state's size would
// cost several times as much. Use it through kalman.h and motion_smoother.h; their tests hold the
// plain form of each step.
//
// `Number` is a double, or a vector (a GCC and clang extension) with one double for each of several
// models. Each lane results from the same operations in the same order, whatever the other lanes
// hold. A covariance is the lower triangle of a square, by rows. What is above the diagonal is
// neither read nor written, unless `mirror` fills it in.
namespace runcert::kernel {

/// A fixed number of values.
template <class Number, int Count>
struct Numbers {
    Number values[static_cast<std::size_t>(Count)];

    Number& operator[](int i) { return values[i]; }
    const Number& operator[](int i) const { return values[i]; }
    Number* data() { return values; }
    const Number* data() const { return values; }
};

/// Index of an entry of a symmetric matrix in its lower triangle, packed by rows.
constexpr int in_triangle(int row, int column) {
    return row * (row + 1) / 2 + column;
}
template <class Number, int Size>
using Triangle = Numbers<Number, Size*(Size + 1) / 2>;

/// The lower triangle of a symmetric matrix.
template <int Size>
Triangle<double, Size> triangle_of(const Eigen::Matrix<double, Size, Size>& matrix) {
    Triangle<double, Size> packed;
    for (int row = 0; row < Size; ++row)
        for (int column = 0; column <= row; ++column)
            packed[in_triangle(row, column)] = matrix(row, column);
    return packed;
}

/// One time step: the parts of AxisStep that differ between steps.
template <class Number>
struct StepNumbers {
    Number position_of_velocity{};
    Number position_of_acceleration{};
    Number velocity_of_acceleration{};
    Number acceleration{};
    Number error{};
    Triangle<Number, 3> noise{};  ///< of position, velocity, acceleration
    Number error_noise{};
};

/// Fills in a step. `put(number, value)` sets a number, or one lane of it.
template <class Number, class Put>
void set_numbers(StepNumbers<Number>& to, const AxisStep& step, const Put& put) {
    put(to.position_of_velocity, step.transition(0, 1));
    put(to.position_of_acceleration, step.transition(0, 2));
    put(to.velocity_of_acceleration, step.transition(1, 2));
    put(to.acceleration, step.transition(2, 2));
    put(to.error, step.error_transition);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column <= row; ++column)
            put(to.noise[in_triangle(row, column)], step.process_noise(row, column));
    put(to.error_noise, step.error_noise);
}
/// The numbers of a step.
inline StepNumbers<double> numbers_of(const AxisStep& step) {
    StepNumbers<double> one;
    set_numbers(one, step, [](double& number, double value) { number = value; });
    return one;
}

/// F x in place. The coordinates may have another type than the numbers of the step, such as arrays
/// of them.
template <int Axes, class Number, class Coordinate>
void carry(const StepNumbers<Number>& f, Coordinate* x) {
    for (int axis = 0; axis < Axes; ++axis) {
        Coordinate* const p = x + axis;
        p[0] += f.position_of_velocity * p[Axes] + f.position_of_acceleration * p[2 * Axes];
        p[Axes] += f.velocity_of_acceleration * p[2 * Axes];
        p[2 * Axes] *= f.acceleration;
        p[3 * Axes] *= f.error;
    }
}

/// F' x in place.
template <int Axes, class Number, class Coordinate>
void carry_back(const StepNumbers<Number>& f, Coordinate* x) {
    for (int axis = 0; axis < Axes; ++axis) {
        Coordinate* const p = x + axis;
        p[2 * Axes] = f.position_of_acceleration * p[0] + f.velocity_of_acceleration * p[Axes] +
                      f.acceleration * p[2 * Axes];
        p[Axes] += f.position_of_velocity * p[0];
        p[3 * Axes] *= f.error;
    }
}

/// Copies the lower triangle to the upper.
template <int Size>
void mirror(double* matrix) {
    for (int row = 0; row < Size; ++row)
        for (int column = 0; column < row; ++column)
            matrix[column * Size + row] = matrix[row * Size + column];
}

/// F X F' plus the process noise, in place, for the covariance X between position, velocity and
/// acceleration of axis `a` (rows) and those of axis `b` <= `a`.
template <int Axes, class Number>
void carry_motion_covariance(const StepNumbers<Number>& f, int a, int b, Number* p) {
    constexpr int size = state_size<Axes>;
    const auto at = [p](int row, int column) -> Number& { return p[row * size + column]; };
    // Above the diagonal the blocks hold the transpose of what is below.
    const Number x01 = at(Axes + b, a);
    const Number x02 = at(2 * Axes + b, a);
    const Number x12 = at(2 * Axes + b, Axes + a);
    Number& x00 = at(a, b);
    Number& x10 = at(Axes + a, b);
    Number& x11 = at(Axes + a, Axes + b);
    Number& x20 = at(2 * Axes + a, b);
    Number& x21 = at(2 * Axes + a, Axes + b);
    Number& x22 = at(2 * Axes + a, 2 * Axes + b);
    const Number g00 = x00 + f.position_of_velocity * x10 + f.position_of_acceleration * x20;
    const Number g01 = x01 + f.position_of_velocity * x11 + f.position_of_acceleration * x21;
    const Number g02 = x02 + f.position_of_velocity * x12 + f.position_of_acceleration * x22;
    const Number g10 = x10 + f.velocity_of_acceleration * x20;
    const Number g11 = x11 + f.velocity_of_acceleration * x21;
    const Number g12 = x12 + f.velocity_of_acceleration * x22;
    const Number g20 = f.acceleration * x20;
    const Number g21 = f.acceleration * x21;
    const Number g22 = f.acceleration * x22;
    x00 = g00 + f.position_of_velocity * g01 + f.position_of_acceleration * g02;
    x10 = g10 + f.position_of_velocity * g11 + f.position_of_acceleration * g12;
    x20 = g20 + f.position_of_velocity * g21 + f.position_of_acceleration * g22;
    x11 = g11 + f.velocity_of_acceleration * g12;
    x21 = g21 + f.velocity_of_acceleration * g22;
    x22 = g22 * f.acceleration;
    if (a == b) {
        x00 += f.noise[0];
        x10 += f.noise[1];
        x11 += f.noise[2];
        x20 += f.noise[3];
        x21 += f.noise[4];
        x22 += f.noise[5];
        return;
    }
    at(Axes + b, a) = g01 + f.velocity_of_acceleration * g02;
    at(2 * Axes + b, a) = g02 * f.acceleration;
    at(2 * Axes + b, Axes + a) = g12 * f.acceleration;
}

/// F P F' + Q in place: the covariance one step later.
template <int Axes, class Number>
void carry_covariance(const StepNumbers<Number>& f, Number* p) {
    constexpr int size = state_size<Axes>;
    for (int a = 0; a < Axes; ++a) {
        for (int b = 0; b <= a; ++b)
            carry_motion_covariance<Axes>(f, a, b, p);
        // Covariance of this axis's error with the motion along each axis, and with the errors.
        Number* const error = p + (3 * Axes + a) * size;
        for (int b = 0; b < Axes; ++b) {
            Number& position = error[b];
            Number& velocity = error[Axes + b];
            Number& acceleration = error[2 * Axes + b];
            position = f.error * (position + f.position_of_velocity * velocity +
                                  f.position_of_acceleration * acceleration);
            velocity = f.error * (velocity + f.velocity_of_acceleration * acceleration);
            acceleration *= f.error * f.acceleration;
        }
        for (int b = 0; b <= a; ++b)
            error[3 * Axes + b] *= f.error * f.error;
        error[3 * Axes + a] += f.error_noise;
    }
}

/// F' M F in place, for a symmetric M stored in full.
template <int Axes>
void carry_information_back(const StepNumbers<double>& f, double* m) {
    constexpr int size = state_size<Axes>;
    for (int axis = 0; axis < Axes; ++axis) {
        double* const position = m + axis * size;
        double* const velocity = m + (Axes + axis) * size;
        double* const acceleration = m + (2 * Axes + axis) * size;
        double* const error = m + (3 * Axes + axis) * size;
        for (int i = 0; i < size; ++i) {
            acceleration[i] = f.position_of_acceleration * position[i] +
                              f.velocity_of_acceleration * velocity[i] +
                              f.acceleration * acceleration[i];
            velocity[i] += f.position_of_velocity * position[i];
            error[i] *= f.error;
        }
    }
    for (int i = 0; i < size; ++i)
        carry_back<Axes>(f, m + i * size);
    mirror<size>(m);
}

/// Whether all pivots of a packed symmetric matrix are positive.
template <int Size>
bool is_positive_definite(Triangle<double, Size> s) {
    for (int j = 0; j < Size; ++j) {
        const double pivot = s[in_triangle(j, j)];
        if (!(pivot > 0.0 && pivot < std::numeric_limits<double>::infinity())) return false;
        for (int i = Size - 1; i > j; --i)
            for (int k = j + 1; k <= i; ++k)
                s[in_triangle(i, k)] -= s[in_triangle(i, j)] * (s[in_triangle(k, j)] / pivot);
    }
    return true;
}

/// One column of the state's height for each axis. Entry (row, axis) is at axis * size + row.
template <int Axes, class Number>
using Columns = Numbers<Number, Axes * state_size<Axes>>;

/// A measured position compared with its prediction. S = H P H' + R = U D U', with U lower
/// triangular and ones on its diagonal. The residual times inverse(U), and P H' times inverse(U'),
/// are independent from axis to axis.
template <int Axes, class Number>
struct FactoredInnovation {
    Columns<Axes, Number> cross;             ///< P H'
    Triangle<Number, Axes> factor;           ///< U, below its diagonal
    Numbers<Number, Axes> inverse_variance;  ///< of D
    Numbers<Number, Axes> independent;       ///< inverse(U) (measured minus predicted)
    Number determinant{};                    ///< of S
    Number statistic{};                      ///< residual' inverse(S) residual
    /// Whether P - P H' inverse(S) H P would lose more than a digit. It does where the measurement
    /// is far better than the prediction: at the beginning of an arc.
    decltype(Number{} > Number{}) digits_lost{};
};

/// Largest ratio of predicted variance to measurement variance for which P - P H' inverse(S) H P is
/// as accurate as Joseph's form.
inline constexpr double short_form_ratio = 30.0;

/// P H': the measurement observes the sum of position and error.
template <int Axes, class Number>
Columns<Axes, Number> cross_covariance(const Number* p) {
    constexpr int size = state_size<Axes>;
    const auto at = [p](int row, int column) -> const Number& { return p[row * size + column]; };
    Columns<Axes, Number> cross;
    for (int a = 0; a < Axes; ++a) {
        Number* const column = cross.data() + a * size;
        const int error = 3 * Axes + a;
        for (int row = 0; row < a; ++row)
            column[row] = at(a, row) + at(error, row);
        for (int row = a; row < 3 * Axes; ++row)
            column[row] = at(row, a) + at(error, row);
        for (int row = 3 * Axes; row < size; ++row)
            column[row] = at(row, a) + (row >= error ? at(row, error) : at(error, row));
    }
    return cross;
}

/// Compares a measured position with its prediction. `covariance` is that of the measurement under
/// the model.
template <int Axes, class Number>
FactoredInnovation<Axes, Number> innovation_of(const Number* mean, const Number* p,
                                               const double* measured,
                                               const Triangle<Number, Axes>& covariance) {
    constexpr int size = state_size<Axes>;
    FactoredInnovation<Axes, Number> seen;
    seen.cross = cross_covariance<Axes>(p);
    auto& lower = seen.factor;
    for (int row = 0; row < Axes; ++row)
        for (int column = 0; column <= row; ++column) {
            const Number predicted =
                seen.cross[column * size + row] + seen.cross[column * size + 3 * Axes + row];
            const Number& stated = covariance[in_triangle(row, column)];
            lower[in_triangle(row, column)] = predicted + stated;
            if (row == column)
                seen.digits_lost = seen.digits_lost | (predicted > short_form_ratio * stated);
        }
    seen.determinant += 1.0;
    for (int j = 0; j < Axes; ++j) {
        const Number variance = lower[in_triangle(j, j)];
        const Number inverse = 1.0 / variance;
        seen.inverse_variance[j] = inverse;
        seen.determinant *= variance;
        for (int i = Axes - 1; i > j; --i) {
            const Number factor = lower[in_triangle(i, j)] * inverse;
            for (int k = j + 1; k <= i; ++k)
                lower[in_triangle(i, k)] -= factor * lower[in_triangle(k, j)];
            lower[in_triangle(i, j)] = factor;
        }
        seen.independent[j] = measured[j] - mean[j] - mean[3 * Axes + j];
        for (int k = 0; k < j; ++k)
            seen.independent[j] -= lower[in_triangle(j, k)] * seen.independent[k];
        seen.statistic += seen.independent[j] * seen.independent[j] * inverse;
    }
    return seen;
}

/// P H' inverse(U'): times the inverse variances, it maps the independent residuals to the change
/// of the state.
template <int Axes, class Number>
Columns<Axes, Number> independent_cross(const FactoredInnovation<Axes, Number>& seen) {
    constexpr int size = state_size<Axes>;
    Columns<Axes, Number> columns = seen.cross;
    for (int j = 1; j < Axes; ++j)
        for (int k = 0; k < j; ++k)
            for (int row = 0; row < size; ++row)
                columns[j * size + row] -= seen.factor[in_triangle(j, k)] * columns[k * size + row];
    return columns;
}

/// (I - K H) P (I - K H)' + K R K', one side after the other, from K U = `scaled`.
template <int Axes, class Number>
Numbers<Number, state_size<Axes> * state_size<Axes>> joseph_form(
    const FactoredInnovation<Axes, Number>& seen, const Columns<Axes, Number>& scaled,
    const Triangle<Number, Axes>& covariance, const Number* p) {
    constexpr int size = state_size<Axes>;
    Columns<Axes, Number> gain = scaled;
    for (int j = Axes - 2; j >= 0; --j)
        for (int i = j + 1; i < Axes; ++i)
            for (int row = 0; row < size; ++row)
                gain[j * size + row] -= gain[i * size + row] * seen.factor[in_triangle(i, j)];
    // `one_side` is P - K (P H')', as rounded. `rest` is K R minus what the measurement observes of
    // it.
    Numbers<Number, size * size> one_side;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            Number value = row >= column ? p[row * size + column] : p[column * size + row];
            for (int a = 0; a < Axes; ++a)
                value -= gain[a * size + row] * seen.cross[a * size + column];
            one_side[row * size + column] = value;
        }
    Columns<Axes, Number> rest;
    for (int a = 0; a < Axes; ++a)
        for (int row = 0; row < size; ++row) {
            Number sum{};
            for (int b = 0; b < Axes; ++b)
                sum +=
                    gain[b * size + row] * covariance[in_triangle(std::max(a, b), std::min(a, b))];
            rest[a * size + row] =
                sum - (one_side[row * size + a] + one_side[row * size + 3 * Axes + a]);
        }
    for (int row = 0; row < size; ++row)
        for (int column = 0; column <= row; ++column)
            for (int a = 0; a < Axes; ++a)
                one_side[row * size + column] += rest[a * size + row] * gain[a * size + column];
    return one_side;
}

inline bool any_of(bool holds) {
    return holds;
}
/// Whether a comparison holds in any lane.
template <class Comparison>
bool any_of(const Comparison& holds) {
    for (std::size_t i = 0; i < sizeof holds / sizeof holds[0]; ++i)
        if (holds[i]) return true;
    return false;
}

/// Updates the estimate with the measurement: by the short form of the covariance, or by Joseph's
/// where the short form would lose digits.
template <int Axes, class Number>
void take_in(const FactoredInnovation<Axes, Number>& seen, const Triangle<Number, Axes>& covariance,
             Number* mean, Number* p) {
    constexpr int size = state_size<Axes>;
    const Columns<Axes, Number> columns = independent_cross(seen);
    Columns<Axes, Number> scaled = columns;
    for (int j = 0; j < Axes; ++j)
        for (int row = 0; row < size; ++row) {
            scaled[j * size + row] *= seen.inverse_variance[j];
            mean[row] += scaled[j * size + row] * seen.independent[j];
        }
    const auto subtract = [&] {
        for (int a = 0; a < Axes; ++a)
            for (int row = 0; row < size; ++row)
                for (int column = 0; column <= row; ++column)
                    p[row * size + column] -= scaled[a * size + row] * columns[a * size + column];
    };
    if (!any_of(seen.digits_lost)) return subtract();
    const auto joseph = joseph_form(seen, scaled, covariance, p);
    subtract();
    for (int i = 0; i < size * size; ++i)
        p[i] = seen.digits_lost ? joseph[i] : p[i];
}

}  // namespace runcert::kernel
