#include <fmt/format.h>

#include <cmath>
#include <span>

#include "reports/audit/screening.h"

namespace runcert {
namespace {

using RowSpan = std::span<const ScreenedEpoch>;

std::optional<double> statistic_of(const ScreenedEpoch& row) {
    return row.statistic;
}

std::optional<double> size_of_statistic(const ScreenedEpoch& row) {
    return row.statistic ? std::optional(std::abs(*row.statistic)) : std::nullopt;
}

std::string out_of_order(RowSpan rows) {
    const std::string by = range_text(rows, 3, " s", size_of_statistic);
    return fmt::format("{}{}", words_of(rows.front().reason), by.empty() ? "" : ": by " + by);
}

/// By how much, and where to, positions and a witness part.
std::string contradicted(std::string_view witness, RowSpan rows) {
    const EstimatedError& apart = rows.front().estimated;
    std::string text = fmt::format("the {} contradict {}", witness,
                                   rows.size() == 1 ? "its position" : "their positions");
    if (apart.east_m && apart.north_m) text += ": by " + components(apart);
    return text;
}

/// What the solution says of itself, against what is needed.
std::string witness(RowSpan rows) {
    const ScreenedEpoch& row = rows.front();
    if (!row.statistic || !row.threshold) return std::string(words_of(row.reason));
    if (row.reason == Reason::few_satellites)
        return fmt::format(
            "only {} satellites, where {} are required so that they check one another",
            range_text(rows, 0, "", statistic_of), format_fixed(*row.threshold, 0));
    if (row.reason == Reason::low_ratio)
        return fmt::format(
            "a ratio of {}, where {} is needed: another set of ambiguities fits almost as well",
            range_text(rows, 2, "", statistic_of), format_fixed(*row.threshold, 2));
    return fmt::format("corrections {} old, where at most {} s are allowed",
                       range_text(rows, 2, " s", size_of_statistic),
                       format_fixed(*row.threshold, 2));
}

std::string accuracy(RowSpan rows) {
    const ScreenedEpoch& row = rows.front();
    if (!row.statistic || !row.threshold) return std::string(words_of(row.reason));
    constexpr double least_m = 1e-6;  // what is below it bounds the determinant of correlations
    if (*row.threshold < least_m)
        return "the stated standard deviations and correlations are not those of any error";
    return fmt::format("the stated standard deviation of {} is not believable: {} than {} m",
                       range_text(rows, 4, " m", statistic_of),
                       *row.statistic > *row.threshold ? "larger" : "smaller",
                       format_fixed(*row.threshold, 4));
}

std::string short_arc(const ScreenedEpoch& row) {
    if (!row.statistic || !row.threshold) return std::string(words_of(row.reason));
    return fmt::format("in an arc of only {}, where {} are required",
                       counted(std::llround(*row.statistic), "usable epoch"),
                       counted(std::llround(*row.threshold)));
}

std::string wrong_positions(RowSpan rows) {
    const ScreenedEpoch& row = rows.front();
    const bool one = rows.size() == 1;
    std::string text = row.reason == Reason::burst ? "several outliers in a row: " : "";
    text += one ? "its " : "their ";
    text += row.tested_axes == TestedAxes::vertical ? "height" : "position";
    text += one ? " is " : "s are ";
    const std::string size = range_text(
        rows, 3, " m", [](const ScreenedEpoch& each) { return size_of(each.estimated); });
    if (size.empty()) return text + "not where the other epochs put " + (one ? "it" : "them");
    text += fmt::format("{} from where the epochs before and after {}", size,
                        one ? "it put it" : "them put them");
    return one ? text + " (" + components(row.estimated) + ")" : text;
}

std::string stretch(const ScreenedEpoch& row) {
    if (row.hypothesis != Hypothesis::ramp)
        return "the positions of this stretch together do not fit, and no single error explains "
               "why";
    const auto rate = rate_of(row.estimated);
    const std::string drift =
        rate ? fmt::format(", by {} m/s ({}) where that begins", format_fixed(*rate, 3),
                           rate_components(row.estimated))
             : std::string();
    return fmt::format(
        "the positions drift{}; where it cannot be decided which ones drift, those on both sides "
        "are left out",
        drift);
}

struct Limit {
    std::string_view name;
    std::string_view unit;
    double LimitComparison::*allowed;
};

std::optional<Limit> limit_of(std::optional<Hypothesis> hypothesis) {
    if (hypothesis == Hypothesis::acceleration)
        return Limit{"an acceleration", " m/s^2", &LimitComparison::acceleration_max_m_s2};
    if (hypothesis == Hypothesis::jerk)
        return Limit{"a jerk", " m/s^3", &LimitComparison::jerk_max_m_s3};
    if (hypothesis == Hypothesis::vertical_rate)
        return Limit{"a vertical rate", " m/s", &LimitComparison::vertical_rate_max_m_s};
    return std::nullopt;
}

std::string physical_limit(const ScreenedTable& table, RowSpan rows) {
    const std::string motion(words_of(Reason::physical_limit));
    const auto limit = limit_of(rows.front().hypothesis);
    const std::string figure = limit ? range_text(rows, 1, limit->unit, statistic_of) : "";
    if (figure.empty()) return motion;
    std::string text = fmt::format("{}: {} of {}", motion, limit->name, figure);
    text += fmt::format(", where its class can make {}{}",
                        format_fixed(table.basis.limits.*limit->allowed, 1), limit->unit);
    const std::string threshold =
        range_text(rows, 1, limit->unit, [](const ScreenedEpoch& each) { return each.threshold; });
    if (!threshold.empty())
        text += fmt::format(" (compared with {}, for the uncertainty of the motion)", threshold);
    return text;
}

}  // namespace

std::string left_out_text(const ScreenedTable& table, const AuditEntry& entry) {
    const RowSpan rows = RowSpan(table.rows).subspan(entry.first, entry.last - entry.first + 1);
    const ScreenedEpoch& row = rows.front();
    const bool one = rows.size() == 1;
    switch (row.reason) {
        case Reason::other_fix:
            return fmt::format("{}: {}", words_of(row.reason), words_of(row.fix));
        case Reason::repeated:
            return one ? "it repeats another epoch" : "they repeat other epochs";
        case Reason::duplicate_time:
            return one ? "its time is that of another epoch at another place"
                       : "their times are those of other epochs at other places";
        case Reason::backward_time:
            return out_of_order(rows);
        case Reason::accuracy_absurd:
            return accuracy(rows);
        case Reason::few_satellites:
        case Reason::low_ratio:
        case Reason::old_corrections:
            return witness(rows);
        case Reason::short_arc:
            return short_arc(row);
        case Reason::innovation:
            return one ? "its position does not follow from those before it"
                       : "their positions do not follow from those before them";
        case Reason::outlier:
        case Reason::burst:
            return wrong_positions(rows);
        case Reason::model:
            return stretch(row);
        case Reason::velocity:
            return one ? "the recorded velocity contradicts its position"
                       : "the recorded velocities contradict their positions";
        case Reason::physical_limit:
            return physical_limit(table, rows);
        case Reason::baseline:
            return fmt::format("{}{}", words_of(row.reason),
                               table.basis.baseline ? ", " + table.basis.baseline->receiver : "");
        default:
            if (const auto witness = witness_of(row.reason); !witness.empty())
                return contradicted(witness.front(), rows);
            return std::string(words_of(row.reason));
    }
}

}  // namespace runcert
