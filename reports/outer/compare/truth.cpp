#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"
#include "reports/compare/compare.h"

namespace runcert {
namespace {

constexpr std::int64_t time_tolerance_ns = 500'000;
constexpr std::array<std::string_view, 4> wanted{"time_s", "east_m", "north_m", "speed_m_s"};

std::vector<std::string_view> cells_of(std::string_view line) {
    std::vector<std::string_view> cells;
    while (true) {
        const std::size_t comma = line.find(',');
        cells.push_back(trim(line.substr(0, comma)));
        if (comma == std::string_view::npos) return cells;
        line.remove_prefix(comma + 1);
    }
}

}  // namespace

std::vector<TruthEpoch> read_truth(std::string_view text, const std::string& where) {
    std::vector<TruthEpoch> truth;
    std::array<std::size_t, wanted.size()> columns{};
    std::size_t width = 0, line = 0;
    const auto fail = [&](const std::string& what) {
        throw Failure(fmt::format("{}:{}", where, line), what,
                      "Give a truth file as `runcert simulate` writes it: time_s, east_m, north_m "
                      "and speed_m_s, separated by commas");
    };
    for (const std::string& content : lines_of(std::string(text))) {
        ++line;
        if (width == 0 && content.starts_with('#')) continue;
        const std::vector<std::string_view> cells = cells_of(content);
        if (width == 0) {
            for (std::size_t i = 0; i < wanted.size(); ++i) {
                const auto found = std::ranges::find(cells, wanted[i]);
                if (found == cells.end()) fail(fmt::format("there is no column {}", wanted[i]));
                columns[i] = static_cast<std::size_t>(found - cells.begin());
            }
            width = cells.size();
            continue;
        }
        if (cells.size() != width) fail(fmt::format("{} cells, {} expected", cells.size(), width));
        const auto number = [&](std::size_t i, auto parse) {
            const std::string_view cell = cells[columns[i]];
            const auto value = parse(cell);
            if (!value)
                fail(fmt::format("\"{}\" is not a number (column {})", escape_for_message(cell),
                                 wanted[i]));
            return *value;
        };
        const TruthEpoch row{.time = {number(0, parse_decimal_nanoseconds)},
                             .position = {number(1, parse_double), number(2, parse_double)},
                             .speed_m_s = number(3, parse_double)};
        if (!truth.empty() && row.time <= truth.back().time) fail("the time does not increase");
        truth.push_back(row);
    }
    line = 1;
    if (truth.empty()) fail("the file holds no epoch");
    return truth;
}

std::vector<MethodEpoch> truth_at_rows(const std::vector<TruthEpoch>& truth,
                                       const TrajectoryTable& trajectory) {
    std::vector<MethodEpoch> found;
    for (const TrajectoryEpoch& row : trajectory.rows) {
        const ElapsedTime earliest{row.time.nanoseconds - time_tolerance_ns};
        const auto at = std::ranges::lower_bound(truth, earliest, {}, &TruthEpoch::time);
        MethodEpoch& epoch = found.emplace_back();
        if (at != truth.end() && at->time.nanoseconds - row.time.nanoseconds <= time_tolerance_ns)
            epoch = {.position_m = at->position, .speed_m_s = at->speed_m_s};
    }
    return found;
}

}  // namespace runcert
