#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "reports/audit/screening.h"

namespace runcert {
namespace {

using RowSpan = std::span<const ScreenedEpoch>;

std::optional<double> statistic_of(const ScreenedEpoch& row) {
    return row.statistic;
}

/// Reasons that are a figure against its limit.
struct CheckedFigure {
    Reason reason;
    int decimals;
    std::string_view unit;   ///< begins with its blank
    std::string_view limit;  ///< what the limit is; empty where it goes without saying
};

constexpr CheckedFigure checked_figures[] = {
    {Reason::backward_time, 3, " s", ""},          {Reason::accuracy_absurd, 4, " m", "limit"},
    {Reason::few_satellites, 0, "", "required"},   {Reason::low_ratio, 2, "", "required"},
    {Reason::old_corrections, 2, " s", "at most"}, {Reason::short_arc, 0, " epochs", "required"}};

/// "corrections too old: 35.00 s, at most 30.00 s".
std::string checked_text(const CheckedFigure& figure, RowSpan rows) {
    const ScreenedEpoch& row = rows.front();
    std::string text(words_of(row.reason));
    constexpr double least = 1e-6;  // a limit below it is of the determinant of correlations
    if (row.reason == Reason::accuracy_absurd && row.threshold && *row.threshold < least)
        return text + ", or the correlations are those of no error";
    const std::string found =
        range_text(rows, figure.decimals, figure.unit, [](const ScreenedEpoch& each) {
            return each.statistic ? std::optional(std::abs(*each.statistic)) : std::nullopt;
        });
    if (found.empty()) return text;
    text += ": " + found;
    if (!figure.limit.empty() && row.threshold)
        text += fmt::format(", {} {}{}", figure.limit,
                            format_fixed(*row.threshold, figure.decimals), figure.unit);
    return text;
}

/// By how much, and where to, positions and a witness part.
std::string contradicted(std::string_view witness, RowSpan rows) {
    const EstimatedError& apart = rows.front().estimated;
    std::string text = fmt::format("the {} contradict {}", witness,
                                   rows.size() == 1 ? "its position" : "their positions");
    if (apart.east_m && apart.north_m) text += ": by " + components(apart);
    return text;
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

std::string off_the_surface(RowSpan rows) {
    const std::string size = range_text(
        rows, 2, " m", [](const ScreenedEpoch& each) { return size_of(each.estimated); });
    const bool below = rows.front().estimated.up_m.value_or(0.0) < 0.0;
    return fmt::format("{} {}{} where the surface has {}",
                       rows.size() == 1 ? "its height is" : "their heights are",
                       size.empty() ? "not" : size,
                       size.empty() ? ""
                       : below      ? " below"
                                    : " above",
                       rows.size() == 1 ? "it" : "them");
}

}  // namespace

std::string left_out_text(const ScreenedTable& table, const AuditEntry& entry) {
    const RowSpan rows = RowSpan(table.rows).subspan(entry.first, entry.last - entry.first + 1);
    const ScreenedEpoch& row = rows.front();
    const bool one = rows.size() == 1;
    const auto* const checked =
        std::ranges::find(checked_figures, row.reason, &CheckedFigure::reason);
    if (checked != std::end(checked_figures)) return checked_text(*checked, rows);
    switch (row.reason) {
        case Reason::other_fix:
            return fmt::format("{}: {}", words_of(row.reason), words_of(row.fix));
        case Reason::repeated:
            return one ? "it repeats another epoch" : "they repeat other epochs";
        case Reason::duplicate_time:
            return one ? "its time is that of another epoch at another place"
                       : "their times are those of other epochs at other places";
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
        case Reason::surface:
            return off_the_surface(rows);
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
