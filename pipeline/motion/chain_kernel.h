#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

#include "motion/motion_model.h"

// Arithmetic of the chain (chain.h) and of its likelihood. It exploits the structure of the model.
// The transition mixes whole blocks of rows (position, velocity, acceleration, Gauss-Markov error)
// by five numbers that are the same for all axes. A measured position observes the sum of two of
// the blocks, and is taken in one coordinate after the other. General matrix products of the
// state's size would cost several times as much. The tests hold the plain form of each step.
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

/// One time step: the parts of AxisStep that differ between steps.
template <class Number>
struct StepNumbers {
    Number position_of_velocity{};
    Number position_of_acceleration{};
    Number velocity_of_acceleration{};
    Number acceleration{};
    Number error{};
    Numbers<Number, 6> noise{};  ///< of position, velocity, acceleration; lower triangle
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

/// A covariance of measured positions as L D L', with ones on the diagonal of the lower triangular
/// L. The errors of the coordinates of inverse(L) times a position are independent, of variances D,
/// so that each can be taken in on its own [DK12] (6.4).
template <int Axes>
struct Whitening {
    double row[static_cast<std::size_t>(Axes)][static_cast<std::size_t>(Axes)];  ///< of inverse(L)
    double variance[static_cast<std::size_t>(Axes)];                             ///< of D, m^2

    bool is_positive_definite() const {
        return std::ranges::all_of(variance, [](double one) {
            return one > 0.0 && one < std::numeric_limits<double>::infinity();
        });
    }
};

template <int Axes>
Whitening<Axes> whitening_of(const PositionMatrix<Axes>& covariance) {
    Whitening<Axes> white{};
    for (int j = 0; j < Axes; ++j) {
        white.row[j][j] = 1.0;
        white.variance[j] = covariance(j, j);
        // Row j of L D by those before it, and inverse(L) row by row.
        double of_l_d[static_cast<std::size_t>(Axes)];
        for (int k = 0; k < j; ++k) {
            of_l_d[k] = 0.0;
            for (int i = 0; i <= k; ++i)
                of_l_d[k] += white.row[k][i] * covariance(j, i);
        }
        for (int k = 0; k < j; ++k) {
            const double l = of_l_d[k] / white.variance[k];
            white.variance[j] -= l * of_l_d[k];
            for (int i = 0; i <= k; ++i)
                white.row[j][i] -= l * white.row[k][i];
        }
    }
    return white;
}

/// Coordinate `j` of a position (`of(axis)`) in terms of independent errors.
template <int Axes, class Of>
auto whitened(const Whitening<Axes>& white, int j, const Of& of) {
    auto sum = of(j);
    if constexpr (Axes > 1)
        for (int k = 0; k < j; ++k)
            if (white.row[j][k] != 0.0) sum += white.row[j][k] * of(k);
    return sum;
}

/// What coordinate `j` observes of a state: the sum of position and error.
template <int Axes, class Number>
Number observed(const Whitening<Axes>& white, int j, const Number* x) {
    return whitened<Axes>(white, j, [x](int axis) { return x[axis] + x[3 * Axes + axis]; });
}
/// Adds `amount` times the row of coordinate `j` of the measurement matrix.
template <int Axes, class Number>
void add_observed(const Whitening<Axes>& white, int j, const Number& amount, Number* x) {
    x[j] += amount;
    x[3 * Axes + j] += amount;
    if constexpr (Axes > 1)
        for (int k = 0; k < j; ++k)
            if (white.row[j][k] != 0.0) {
                x[k] += white.row[j][k] * amount;
                x[3 * Axes + k] += white.row[j][k] * amount;
            }
}

/// One coordinate of a measured position, compared with its prediction.
template <int Axes, class Number>
struct Compared {
    Numbers<Number, state_size<Axes>> cross;  ///< covariance of the state with the prediction, P z'
    Number variance{};                        ///< of the innovation: z P z' and the measurement's
    Number innovation{};                      ///< measured minus predicted
    Number own_variance{};                    ///< of the measurement
};

/// Largest ratio of predicted variance to measurement variance for which P - P z' z P / f is as
/// accurate as Joseph's form. It is exceeded where a measurement is far better than its prediction:
/// at the beginning of an arc.
inline constexpr double short_form_ratio = 30.0;

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

/// The covariance after coordinate `j` was taken in, in place.
template <int Axes, class Number>
void reduce_covariance(const Whitening<Axes>& white, int j, const Compared<Axes, Number>& seen,
                       Number* p) {
    constexpr int size = state_size<Axes>;
    const Number inverse = 1.0 / seen.variance;
    Numbers<Number, size> gain;
    for (int row = 0; row < size; ++row)
        gain[row] = seen.cross[row] * inverse;
    const auto vague = seen.variance > (1.0 + short_form_ratio) * seen.own_variance;
    if (!any_of(vague)) {
        for (int row = 0; row < size; ++row)
            for (int column = 0; column <= row; ++column)
                p[row * size + column] -= gain[row] * seen.cross[column];
        return;
    }
    // Joseph's form, one side after the other: (I - K z) P as rounded, and what z observes of it.
    Numbers<Number, size * size> one_side;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
            one_side[row * size + column] =
                (row >= column ? p[row * size + column] : p[column * size + row]) -
                gain[row] * seen.cross[column];
    for (int row = 0; row < size; ++row) {
        const Number rest =
            gain[row] * seen.own_variance - observed<Axes>(white, j, one_side.data() + row * size);
        for (int column = 0; column <= row; ++column) {
            Number& entry = p[row * size + column];
            const Number joseph = one_side[row * size + column] + rest * gain[column];
            entry = vague ? joseph : entry - gain[row] * seen.cross[column];
        }
    }
}

/// How coordinate `j` of a measured position of that own variance compares, but for its innovation.
template <int Axes, class Number>
Compared<Axes, Number> compare(const Whitening<Axes>& white, int j, const Number& own_variance,
                               const Number* p) {
    const auto at = [p](int row, int column) -> const Number& {
        return row >= column ? p[row * state_size<Axes> + column]
                             : p[column * state_size<Axes> + row];
    };
    Compared<Axes, Number> seen;
    for (int row = 0; row < state_size<Axes>; ++row)
        seen.cross[row] = whitened<Axes>(
            white, j, [&](int axis) { return at(row, axis) + at(row, 3 * Axes + axis); });
    seen.own_variance = own_variance;
    seen.variance = observed<Axes>(white, j, seen.cross.data()) + own_variance;
    return seen;
}

/// Updates a mean with a measured value, and sets the innovation.
template <int Axes, class Number>
void update_mean(const Whitening<Axes>& white, int j, double measured, Compared<Axes, Number>& seen,
                 Number* mean) {
    seen.innovation = measured - observed<Axes>(white, j, mean);
    const Number weight = seen.innovation / seen.variance;
    for (int row = 0; row < state_size<Axes>; ++row)
        mean[row] += seen.cross[row] * weight;
}

/// Takes in coordinate `j` of a measured position, of that whitened value and own variance.
template <int Axes, class Number>
Compared<Axes, Number> update(const Whitening<Axes>& white, int j, double measured,
                              const Number& own_variance, Number* mean, Number* p) {
    Compared<Axes, Number> seen = compare<Axes>(white, j, own_variance, p);
    update_mean<Axes>(white, j, measured, seen, mean);
    reduce_covariance<Axes>(white, j, seen, p);
    return seen;
}

}  // namespace runcert::kernel
