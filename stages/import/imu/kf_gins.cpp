#include <array>
#include <cmath>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/csv/head.h"
#include "stages/import/imu/raw.h"
#include "stages/import/row_collector.h"

namespace runcert::imu {
namespace {

constexpr std::size_t kf_gins_fields = 7;
constexpr double week_s = 604'800.0;
constexpr double longest_interval_s = 0.2;
/// Velocity increments over their interval, in a recording that may begin in motion (m/s^2).
constexpr double least_force_m_s2 = 2.0, most_force_m_s2 = 60.0;
constexpr double largest_angle_rad = 1.0;

/// Seven numbers parted by blanks; nothing for another line.
std::optional<std::array<double, kf_gins_fields>> numbers_of(std::string_view text) {
    const RecordingBytes nameless{.name = {}, .bytes = text};
    const SourceLine line{.text = text, .number = 1};
    const std::vector<Cell> cells = split_words(line, text, nameless);
    if (cells.size() != kf_gins_fields) return std::nullopt;
    std::array<double, kf_gins_fields> numbers{};
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto number = parse_double(cells[i].text);
        if (!number) return std::nullopt;
        numbers[i] = *number;
    }
    return numbers;
}

/// Whether numbers are a row behind another: a later second of the week, and increments over the
/// time between that gravity explains.
bool follows(const std::array<double, kf_gins_fields>& row,
             const std::array<double, kf_gins_fields>& before) {
    const double interval_s = row[0] - before[0];
    const double force = std::hypot(row[4], row[5], row[6]) / interval_s;
    return row[0] <= week_s && before[0] >= 0.0 && interval_s > 0.0 &&
           interval_s < longest_interval_s && force > least_force_m_s2 && force < most_force_m_s2 &&
           std::hypot(row[1], row[2], row[3]) < largest_angle_rad;
}

}  // namespace

bool is_kf_gins(std::string_view bytes) {
    constexpr int rows_looked_at = 10;
    LineReader lines(bytes);
    std::optional<std::array<double, kf_gins_fields>> before;
    int rows = 0;
    for (auto line = lines.next(); line && rows < rows_looked_at; line = lines.next()) {
        if (csv::is_skipped(*line)) continue;
        if (!line->ended && rows > 0) break;  // the look goes no further
        const auto row = numbers_of(line->text);
        if (!row || (before && !follows(*row, *before))) return false;
        before = row;
        ++rows;
    }
    return rows > 1;
}

RawFile read_kf_gins(const Receiver& /*receiver*/, const RecordingBytes& file) {
    require_text(file);
    RawFile raw;
    raw.format = "kf-gins";
    raw.stamps = Stamps::week;
    raw.increments = true;
    read_lines(
        file,
        [&](const SourceLine& line, bool cut_off) -> std::optional<RawSample> {
            if (csv::is_skipped(line)) return std::nullopt;
            const std::vector<Cell> cells = split_words(line, line.text, file);
            require_count(cells.size(), kf_gins_fields, line, file, cut_off, "KF-GINS text has",
                          "Hand in the file as the program wrote it");
            RawSample sample{.time_ns = read_nanoseconds(cells[0], "time of the week")};
            for (Eigen::Index i = 0; i < 3; ++i) {
                const auto at = static_cast<std::size_t>(i);
                sample.gyro[i] = read_real(cells[1 + at], "angle increment");
                sample.accelerometer[i] = read_real(cells[4 + at], "velocity increment");
            }
            require_possible(sample, cells.front());
            return sample;
        },
        raw);
    return raw;
}

}  // namespace runcert::imu
