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
/// No increment of an interval is as large (rad, m/s).
constexpr double largest_increment = 10.0;

/// Seconds of the week and six increments; nothing for another line.
bool is_kf_gins_row(std::string_view text) {
    const RecordingBytes nameless{.name = {}, .bytes = text};
    const SourceLine line{.text = text, .number = 1};
    const std::vector<Cell> cells = split_words(line, text, nameless);
    if (cells.size() != kf_gins_fields) return false;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto number = parse_double(cells[i].text);
        if (!number) return false;
        if (i == 0 ? *number < 0.0 || *number > week_s
                   : *number < -largest_increment || *number > largest_increment)
            return false;
    }
    return true;
}

}  // namespace

bool is_kf_gins(std::string_view bytes) {
    LineReader lines(bytes);
    std::size_t rows = 0;
    for (auto line = lines.next(); line && rows < 10; line = lines.next()) {
        if (csv::is_skipped(*line)) continue;
        if (!line->ended && rows > 0) break;  // the look goes no further
        if (!is_kf_gins_row(line->text)) return false;
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
    RecordLog log;
    LineReader lines(file);
    for (auto line = lines.next(); line; line = lines.next()) {
        if (csv::is_skipped(*line)) continue;
        try {
            const std::vector<Cell> cells = split_words(*line, line->text, file);
            require_count(cells.size(), kf_gins_fields, *line, file, lines.at_end() && !line->ended,
                          "KF-GINS text has", "Hand in the file as the program wrote it");
            RawSample sample{.time_ns = read_nanoseconds(cells[0], "time of the week"),
                             .line = static_cast<std::int32_t>(line->number),
                             .byte = line->byte};
            for (Eigen::Index i = 0; i < 3; ++i) {
                const auto at = static_cast<std::size_t>(i);
                sample.gyro[i] = read_real(cells[1 + at], "angle increment");
                sample.accelerometer[i] = read_real(cells[4 + at], "velocity increment");
            }
            raw.samples.push_back(sample);
            log.count_good();
        } catch (const Failure& failure) {
            log.count_bad(*line, failure, std::ssize(raw.samples));
        }
    }
    raw.records = std::move(log).finish(raw.notes);
    return raw;
}

}  // namespace runcert::imu
