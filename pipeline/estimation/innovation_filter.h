#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "estimation/filter_kernel.h"
#include "estimation/motion_model.h"

namespace runcert {

/// Numbers side by side, one for each of several models (a vector of GCC's and clang's).
inline constexpr std::size_t models_side_by_side = 2;
using SideBySide = double __attribute__((vector_size(models_side_by_side * sizeof(double))));

/// Whether a comparison holds for any of the models.
template <class Comparison>
bool any_of(const Comparison& holds) {
    for (std::size_t i = 0; i < models_side_by_side; ++i)
        if (holds[i]) return true;
    return false;
}

/// The forward filter of some models side by side as far as the likelihood needs it: two take less
/// time than one takes in scalar numbers. Each number comes of the same operations in the same
/// order, whatever stands beside it.
///
/// Only the lower triangle of the covariance is there. The transition is applied to one pair of
/// axes after the other: it is the same 3 x 3 matrix for all of them. KalmanFilter is the same
/// filter in plain form.
template <int Axes>
class InnovationFilter {
  public:
    using T = SideBySide;
    static constexpr int size = state_size<Axes>;
    template <int Count>
    using Array = std::array<T, static_cast<std::size_t>(Count)>;

    /// One step of time: what of AxisStep is not the same for all steps.
    struct Step {
        T position_of_velocity{};
        T position_of_acceleration{};
        T velocity_of_acceleration{};
        T acceleration{};
        T error{};
        Array<6> noise{};  ///< of position, velocity, acceleration: lower triangle, by rows
        T error_noise{};
    };

    /// A measured position and its covariance as the models have it: lower triangle, by rows.
    struct Measured {
        std::array<double, static_cast<std::size_t>(Axes)> position{};
        Array<Axes*(Axes + 1) / 2> covariance{};
    };

    /// What a measurement says against the prediction: the statistic of the innovation and the
    /// determinant of its covariance.
    struct Seen {
        T statistic{};
        T determinant{};
    };

    /// A prior of independent coordinates.
    InnovationFilter(const Array<size>& mean, const Array<size>& variance) : mean_(mean) {
        p_.fill(T{});
        for (int i = 0; i < size; ++i)
            at(i, i) = variance[static_cast<std::size_t>(i)];
    }

    /// The state one step later.
    void carry(const Step& f) {
        for (int a = 0; a < Axes; ++a) {
            carry_mean(f, a);
            for (int b = 0; b <= a; ++b)
                carry_motion(f, a, b);
            for (int b = 0; b < Axes; ++b)
                carry_cross(f, a, b);
            for (int b = 0; b <= a; ++b)
                at(3 * Axes + a, 3 * Axes + b) *= f.error * f.error;
            at(3 * Axes + a, 3 * Axes + a) += f.error_noise;
        }
    }

    /// Positions are offset from here on by an unknown of this variance for each axis.
    void add_offset(double variance) {
        for (int a = 0; a < Axes; ++a)
            at(a, a) += variance;
    }

    /// Takes a measurement in: by the short form of the covariance, or by Joseph's where that would
    /// lose more than a digit, as at an arc's beginning.
    Seen take_in(const Measured& measured);

  private:
    using Columns = Array<Axes * size>;     // of a matrix of the state's height
    using Covariance = Array<size * size>;  // by rows; what is above the diagonal is not used
    struct Factors;                         // of the innovation's covariance

    T& at(int row, int column) { return p_[static_cast<std::size_t>(row * size + column)]; }
    T& mean(int i) { return mean_[static_cast<std::size_t>(i)]; }
    static constexpr std::size_t in_triangle(int row, int column) {
        return static_cast<std::size_t>(row * (row + 1) / 2 + column);
    }
    static constexpr std::size_t in_columns(int row, int column) {
        return static_cast<std::size_t>(column * size + row);
    }

    void carry_mean(const Step& f, int a);
    void carry_motion(const Step& f, int a, int b);
    void carry_cross(const Step& f, int a, int b);
    Columns cross_covariance();
    void subtract(const Columns& left, const Columns& right);
    Covariance joseph_form(const Columns& cross, const Columns& scaled, const Factors& factors,
                           const Measured& measured);

    Array<size> mean_;
    Covariance p_;
};

template <int Axes>
void InnovationFilter<Axes>::carry_mean(const Step& f, int a) {
    T& position = mean(a);
    T& velocity = mean(Axes + a);
    T& acceleration = mean(2 * Axes + a);
    position += f.position_of_velocity * velocity + f.position_of_acceleration * acceleration;
    velocity += f.velocity_of_acceleration * acceleration;
    acceleration *= f.acceleration;
    mean(3 * Axes + a) *= f.error;
}

/// F X F' of the covariance X between position, velocity and acceleration of axis a (rows) and of
/// axis b <= a, and the process noise.
template <int Axes>
void InnovationFilter<Axes>::carry_motion(const Step& f, int a, int b) {
    // Above the diagonal of the blocks stands the transpose of what is below.
    const T x01 = at(Axes + b, a);
    const T x02 = at(2 * Axes + b, a);
    const T x12 = at(2 * Axes + b, Axes + a);
    T& x00 = at(a, b);
    T& x10 = at(Axes + a, b);
    T& x11 = at(Axes + a, Axes + b);
    T& x20 = at(2 * Axes + a, b);
    T& x21 = at(2 * Axes + a, Axes + b);
    T& x22 = at(2 * Axes + a, 2 * Axes + b);
    const T g00 = x00 + f.position_of_velocity * x10 + f.position_of_acceleration * x20;
    const T g01 = x01 + f.position_of_velocity * x11 + f.position_of_acceleration * x21;
    const T g02 = x02 + f.position_of_velocity * x12 + f.position_of_acceleration * x22;
    const T g10 = x10 + f.velocity_of_acceleration * x20;
    const T g11 = x11 + f.velocity_of_acceleration * x21;
    const T g12 = x12 + f.velocity_of_acceleration * x22;
    const T g20 = f.acceleration * x20;
    const T g21 = f.acceleration * x21;
    const T g22 = f.acceleration * x22;
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

/// The covariance between the error of axis a and position, velocity and acceleration of axis b.
template <int Axes>
void InnovationFilter<Axes>::carry_cross(const Step& f, int a, int b) {
    T& position = at(3 * Axes + a, b);
    T& velocity = at(3 * Axes + a, Axes + b);
    T& acceleration = at(3 * Axes + a, 2 * Axes + b);
    position = f.error * (position + f.position_of_velocity * velocity +
                          f.position_of_acceleration * acceleration);
    velocity = f.error * (velocity + f.velocity_of_acceleration * acceleration);
    acceleration *= f.error * f.acceleration;
}

/// P H': the measurement sees position and error.
template <int Axes>
typename InnovationFilter<Axes>::Columns InnovationFilter<Axes>::cross_covariance() {
    Columns cross;
    for (int a = 0; a < Axes; ++a) {
        const int error = 3 * Axes + a;
        for (int row = 0; row < a; ++row)
            cross[in_columns(row, a)] = at(a, row) + at(error, row);
        for (int row = a; row < 3 * Axes; ++row)
            cross[in_columns(row, a)] = at(row, a) + at(error, row);
        for (int row = 3 * Axes; row < size; ++row)
            cross[in_columns(row, a)] =
                at(row, a) + (row >= error ? at(row, error) : at(error, row));
    }
    return cross;
}

/// Takes the outer product of two matrices off the covariance.
template <int Axes>
void InnovationFilter<Axes>::subtract(const Columns& left, const Columns& right) {
    for (int a = 0; a < Axes; ++a)
        for (int row = 0; row < size; ++row)
            for (int column = 0; column <= row; ++column)
                at(row, column) -= left[in_columns(row, a)] * right[in_columns(column, a)];
}

/// S = H P H' + R = U D U', U lower with a diagonal of ones.
template <int Axes>
struct InnovationFilter<Axes>::Factors {
    Array<Axes> inverse_variances;     // of D
    Array<Axes*(Axes + 1) / 2> lower;  // U below its diagonal
    T determinant = T{} + 1.0;
    decltype(T{} > T{}) digits_lost = T{} > T{};

    Factors(const Columns& cross, const Measured& measured) {
        constexpr double far_better = kernel::short_form_ratio;
        for (int row = 0; row < Axes; ++row)
            for (int column = 0; column <= row; ++column) {
                const T predicted =
                    cross[in_columns(row, column)] + cross[in_columns(3 * Axes + row, column)];
                const T& stated = measured.covariance[in_triangle(row, column)];
                lower[in_triangle(row, column)] = predicted + stated;
                if (row == column) digits_lost = digits_lost | (predicted > far_better * stated);
            }
        for (int j = 0; j < Axes; ++j) {
            const T variance = lower[in_triangle(j, j)];
            const T inverse = 1.0 / variance;
            inverse_variances[static_cast<std::size_t>(j)] = inverse;
            determinant *= variance;
            for (int i = Axes - 1; i > j; --i) {
                const T factor = lower[in_triangle(i, j)] * inverse;
                for (int k = j + 1; k <= i; ++k)
                    lower[in_triangle(i, k)] -= factor * lower[in_triangle(k, j)];
                lower[in_triangle(i, j)] = factor;
            }
        }
    }
};

/// (I - K H) P (I - K H)' + K R K', one side after the other, from K U = `scaled`.
template <int Axes>
typename InnovationFilter<Axes>::Covariance InnovationFilter<Axes>::joseph_form(
    const Columns& cross, const Columns& scaled, const Factors& factors, const Measured& measured) {
    Columns gain = scaled;
    for (int j = Axes - 2; j >= 0; --j)
        for (int i = j + 1; i < Axes; ++i)
            for (int row = 0; row < size; ++row)
                gain[in_columns(row, j)] -=
                    gain[in_columns(row, i)] * factors.lower[in_triangle(i, j)];
    // `one_side` is P - K (P H')', as rounded; `rest` is K R less what the measurement sees of it.
    Covariance one_side;
    const auto in_square = [](int row, int column) {
        return static_cast<std::size_t>(row * size + column);
    };
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column) {
            T value = row >= column ? at(row, column) : at(column, row);
            for (int a = 0; a < Axes; ++a)
                value -= gain[in_columns(row, a)] * cross[in_columns(column, a)];
            one_side[in_square(row, column)] = value;
        }
    Columns rest;
    for (int a = 0; a < Axes; ++a)
        for (int row = 0; row < size; ++row) {
            T sum = T{};
            for (int b = 0; b < Axes; ++b)
                sum += gain[in_columns(row, b)] *
                       measured.covariance[in_triangle(std::max(a, b), std::min(a, b))];
            rest[in_columns(row, a)] =
                sum - (one_side[in_square(row, a)] + one_side[in_square(row, 3 * Axes + a)]);
        }
    // Below the diagonal, where the position's columns are seen.
    Covariance updated = one_side;
    for (int row = 0; row < size; ++row)
        for (int column = 0; column <= row; ++column)
            for (int a = 0; a < Axes; ++a)
                updated[in_square(row, column)] +=
                    rest[in_columns(row, a)] * gain[in_columns(column, a)];
    return updated;
}

template <int Axes>
typename InnovationFilter<Axes>::Seen InnovationFilter<Axes>::take_in(const Measured& measured) {
    const Columns cross = cross_covariance();
    const Factors factors(cross, measured);
    const auto factor = [&](int i, int j) -> const T& { return factors.lower[in_triangle(i, j)]; };
    // With the residual and P H' both times inverse(U'), the axes are independent.
    Seen seen{.statistic = T{}, .determinant = factors.determinant};
    Columns columns = cross;
    Array<Axes> residual;
    for (int j = 0; j < Axes; ++j) {
        const auto axis = static_cast<std::size_t>(j);
        residual[axis] = measured.position[axis] - mean(j) - mean(3 * Axes + j);
        for (int k = 0; k < j; ++k) {
            residual[axis] -= factor(j, k) * residual[static_cast<std::size_t>(k)];
            for (int row = 0; row < size; ++row)
                columns[in_columns(row, j)] -= factor(j, k) * columns[in_columns(row, k)];
        }
        seen.statistic += residual[axis] * residual[axis] * factors.inverse_variances[axis];
    }
    Columns scaled = columns;
    for (int j = 0; j < Axes; ++j)
        for (int row = 0; row < size; ++row) {
            scaled[in_columns(row, j)] *= factors.inverse_variances[static_cast<std::size_t>(j)];
            mean(row) += scaled[in_columns(row, j)] * residual[static_cast<std::size_t>(j)];
        }
    if (!any_of(factors.digits_lost)) {
        subtract(scaled, columns);
        return seen;
    }
    const Covariance joseph = joseph_form(cross, scaled, factors, measured);
    subtract(scaled, columns);
    for (std::size_t i = 0; i < p_.size(); ++i)
        p_[i] = factors.digits_lost ? joseph[i] : p_[i];
    return seen;
}

}  // namespace runcert
