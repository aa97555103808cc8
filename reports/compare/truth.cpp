#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>

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

[[noreturn]] void fail(const std::string& where, std::size_t line, const std::string& what) {
    throw Failure(fmt::format("{}:{}", where, line), what,
                  "Give a truth file as `runcert simulate` writes it: time_s, east_m, north_m and "
                  "speed_m_s, separated by commas");
}

/// Where each column that is wanted stands.
std::array<std::size_t, 4> find_columns(std::string_view header, const std::string& where) {
    const std::vector<std::string_view> names = cells_of(header);
    std::array<std::size_t, 4> columns{};
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const auto found = std::find(names.begin(), names.end(), wanted[i]);
        if (found == names.end()) fail(where, 1, fmt::format("there is no column {}", wanted[i]));
        columns[i] = static_cast<std::size_t>(found - names.begin());
    }
    return columns;
}

TruthEpoch read_row(const std::vector<std::string_view>& cells,
                    const std::array<std::size_t, 4>& columns, const std::string& where,
                    std::size_t line) {
    const auto not_a_number = [&](std::size_t i) {
        fail(where, line,
             fmt::format("\"{}\" is not a number (column {})",
                         escape_for_message(cells[columns[i]]), wanted[i]));
    };
    const auto number = [&](std::size_t i) {
        const std::optional<double> value = parse_double(cells[columns[i]]);
        if (!value) not_a_number(i);
        return *value;
    };
    const auto time = parse_decimal_nanoseconds(cells[columns[0]]);
    if (!time) not_a_number(0);
    return {.time = {*time}, .position = {number(1), number(2)}, .speed_m_s = number(3)};
}

}  // namespace

std::vector<TruthEpoch> read_truth(std::string_view text, const std::string& where) {
    std::vector<TruthEpoch> truth;
    std::array<std::size_t, 4> columns{};
    std::size_t width = 0;
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view content = trim(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (width == 0) {
            if (content.starts_with('#')) continue;
            columns = find_columns(content, where);
            width = cells_of(content).size();
            continue;
        }
        const std::vector<std::string_view> cells = cells_of(content);
        if (cells.size() != width)
            fail(where, line, fmt::format("{} cells, {} expected", cells.size(), width));
        const TruthEpoch row = read_row(cells, columns, where, line);
        if (!truth.empty() && row.time <= truth.back().time)
            fail(where, line, "the time does not increase");
        truth.push_back(row);
    }
    if (truth.empty()) fail(where, 1, "the file holds no epoch");
    return truth;
}

std::vector<std::optional<TruthEpoch>> truth_at_rows(const std::vector<TruthEpoch>& truth,
                                                     const TrajectoryTable& trajectory) {
    std::vector<std::optional<TruthEpoch>> found;
    found.reserve(trajectory.rows.size());
    for (const TrajectoryEpoch& row : trajectory.rows) {
        const ElapsedTime earliest{row.time.nanoseconds - time_tolerance_ns};
        const auto at = std::lower_bound(
            truth.begin(), truth.end(), earliest,
            [](const TruthEpoch& epoch, ElapsedTime time) { return epoch.time < time; });
        const bool matches =
            at != truth.end() && at->time.nanoseconds - row.time.nanoseconds <= time_tolerance_ns;
        found.push_back(matches ? std::optional(*at) : std::nullopt);
    }
    return found;
}

}  // namespace runcert
