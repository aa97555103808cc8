#pragma once

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "core/text.h"
#include "stages/smooth/dhd22.h"

namespace runcert::published {

/// The numbers of a comma-separated file of the source tree, without its first line.
inline std::vector<std::vector<double>> read_numbers(const std::string& name) {
    std::ifstream file(std::string(RUNCERT_SOURCE_DIR) + "/" + name);
    std::vector<std::vector<double>> rows;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::istringstream cells(line);
        std::string cell;
        rows.emplace_back();
        while (std::getline(cells, cell, ','))
            rows.back().push_back(parse_double(trim(cell)).value());
    }
    return rows;
}

/// Appendix A of [DHD22]: 451 epochs at 10 Hz, 10 mm white noise on each coordinate.
inline std::vector<PlanePosition> appendix_a() {
    std::vector<PlanePosition> positions;
    for (const auto& row : read_numbers("examples/land_yacht/appendix_a_simulated_ppk.csv"))
        positions.push_back({.time_s = row[1], .position = {row[2], row[3]}, .sigma_m = 0.010});
    return positions;
}

/// True speed of the simulated run, [DHD22]: logistic with A = 60 m/s, v0 = 0.01 m/s, t0 = 15 s.
inline double true_speed_m_s(double time_s) {
    const double rate = std::log(60.0 / 0.01 - 1.0) / 15.0;
    return 60.0 / (1.0 + std::exp(-rate * (time_s - 15.0)));
}

struct Statistics {
    double mean = 0.0, variance = 0.0, root_mean_square = 0.0;
};

inline Statistics statistics_of(const std::vector<double>& values) {
    Statistics result;
    const auto n = static_cast<double>(values.size());
    for (const double value : values) {
        result.mean += value / n;
        result.root_mean_square += value * value / n;
    }
    for (const double value : values)
        result.variance += (value - result.mean) * (value - result.mean) / (n - 1.0);
    result.root_mean_square = std::sqrt(result.root_mean_square);
    return result;
}

}  // namespace runcert::published
