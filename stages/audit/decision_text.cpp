#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/text.h"
#include "stages/audit/parts.h"
#include "stages/audit/words.h"

namespace runcert {
namespace {

std::string one_or_range(const std::string& low, const std::string& high) {
    return low == high ? low : low + " to " + high;
}

/// Where rows stand in the recording: "(lines 1548 to 1557)"; empty where it has no lines.
std::string place_of(const ScreenedEpoch& first, const ScreenedEpoch& last) {
    const bool lines = first.source_line && last.source_line;
    const auto& from = lines ? first.source_line : first.source_byte;
    const auto& to = lines ? last.source_line : last.source_byte;
    if (!from || !to) return {};
    return fmt::format(" ({}{} {})", lines ? "line" : "byte", *from == *to ? "" : "s",
                       one_or_range(fmt::format("{}", *from), fmt::format("{}", *to)));
}

std::string time_of(const ScreenedEpoch& row) {
    return format_fixed(row.time.seconds(), 3) + " s";
}

/// "epochs 1531 to 1540 (lines 1548 to 1557), 415.000 s to 416.800 s"
std::string where_of(const ScreenedEpoch& first, const ScreenedEpoch& last) {
    return fmt::format(
        "epoch{} {}{}, {}", first.epoch == last.epoch ? "" : "s",
        one_or_range(fmt::format("{}", first.epoch), fmt::format("{}", last.epoch)),
        place_of(first, last),
        first.epoch == last.epoch ? time_of(first) : time_of(first) + " to " + time_of(last));
}

/// The figures of rows that share a decision, "0.183 m to 0.350 m". Empty where one is missing.
template <class Figure>
std::string range_text(const std::vector<ScreenedEpoch>& rows, const AuditEntry& entry,
                       int decimals, std::string_view unit, Figure figure) {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t row = entry.first; row <= entry.last; ++row) {
        const std::optional<double> value = figure(rows[row]);
        if (!value) return {};
        low = std::min(low, *value);
        high = std::max(high, *value);
    }
    const auto text = [&](double value) {
        return format_fixed(value, decimals) + std::string(unit);
    };
    return one_or_range(text(low), text(high));
}

std::string statistic_range(const std::vector<ScreenedEpoch>& rows, const AuditEntry& entry,
                            int decimals, std::string_view unit) {
    return range_text(rows, entry, decimals, unit,
                      [](const ScreenedEpoch& row) { return row.statistic; });
}

/// Puts the decisions of one table into words.
class DecisionWords {
  public:
    explicit DecisionWords(const ScreenedTable& table) : table_(table), rows_(table.rows) {
        double size = 0.0;
        const auto first_size = table.header.parameters.find("false_alarm_rate");
        if (table.evidence)
            size = table.evidence->test_size;
        else if (!holds_evidence(table) && first_size != table.header.parameters.end() &&
                 first_size->is_number())
            size = first_size->get<double>();
        if (size > 0.0) chance_ = fmt::format("is exceeded by chance {}", once_in(size));
    }

    std::string left_out(const AuditEntry& entry) const {
        return "left out: " + why(entry) + tests(entry);
    }

    std::string arc_break(std::size_t at) const {
        const ScreenedEpoch& row = rows_[at];
        std::string text = before(at);
        if (explains(row)) text += statistic({AuditEntry::Kind::arc_break, at, at});
        return text;
    }

    std::string used(const ScreenedEpoch& row) const {
        std::string text = "used";
        if (explains(row)) return text + "; its statistic is that of the entry before it";
        if (row.statistic && row.threshold)
            text += fmt::format("; {}{} {} of {}",
                                row.hypothesis ? words_of(*row.hypothesis) : "innovation",
                                row.tested_axes == TestedAxes::vertical ? " (vertical)" : "",
                                format_fixed(*row.statistic, 1), format_fixed(*row.threshold, 1));
        return text + detectable(row.detectable);
    }

  private:
    /// Whether the evidence of a row is that of the break before it.
    static bool explains(const ScreenedEpoch& row) {
        if (!row.usable || !row.break_before || !row.hypothesis) return false;
        switch (*row.break_before) {
            case ArcBreak::step:
            case ArcBreak::bridged:
                return *row.hypothesis == Hypothesis::step && size_of(row.estimated);
            case ArcBreak::ramp:
                return *row.hypothesis == Hypothesis::ramp && rate_of(row.estimated);
            case ArcBreak::time_shift:
                return *row.hypothesis == Hypothesis::time_shift && row.estimated.time_s;
            default:
                return false;
        }
    }

    std::string statistic(const AuditEntry& entry) const {
        const std::string range = statistic_range(rows_, entry, 1, "");
        const auto& threshold = rows_[entry.first].threshold;
        if (range.empty() || !threshold) return {};
        return fmt::format("; statistic {} where {} {}", range, format_fixed(*threshold, 1),
                           chance_.empty() ? "is the threshold" : chance_);
    }

    /// The statistic, where the reason is one that a test found.
    std::string tests(const AuditEntry& entry) const {
        switch (rows_[entry.first].reason) {
            case Reason::innovation:
            case Reason::outlier:
            case Reason::burst:
            case Reason::model:
            case Reason::velocity:
            case Reason::baseline:
                return statistic(entry);
            default:
                return {};
        }
    }

    std::string why(const AuditEntry& entry) const {
        const ScreenedEpoch& row = rows_[entry.first];
        const bool one = entry.first == entry.last;
        switch (row.reason) {
            case Reason::other_fix:
                return fmt::format("the kind of solution is one that the attempt does not allow: {}",
                                   words_of(row.fix));
            case Reason::duplicate_time:
                return one ? "its time is that of an epoch before it"
                           : "their times are those of epochs before them";
            case Reason::backward_time:
                return backward(entry);
            case Reason::accuracy_absurd:
                return accuracy(entry);
            case Reason::short_arc:
                return short_arc(row);
            case Reason::innovation:
                return one ? "its position does not follow from those before it"
                           : "their positions do not follow from those before them";
            case Reason::outlier:
            case Reason::burst:
                return wrong_positions(entry);
            case Reason::model:
                return stretch(row);
            case Reason::velocity:
                return one ? "the recorded velocity contradicts its position"
                           : "the recorded velocities contradict their positions";
            case Reason::physical_limit:
                return limit(entry);
            case Reason::baseline:
                return fmt::format("contradicted by the other receiver{}",
                                   table_.evidence && table_.evidence->baseline
                                       ? ", " + table_.evidence->baseline->receiver
                                       : "");
            default:
                return std::string(words_of(row.reason));
        }
    }

    std::string backward(const AuditEntry& entry) const {
        const std::string by =
            range_text(rows_, entry, 3, " s", [](const ScreenedEpoch& row) {
                return row.statistic ? std::optional(-*row.statistic) : std::nullopt;
            });
        return fmt::format("time runs backwards: {}earlier than the latest epoch before",
                           by.empty() ? "" : by + " ");
    }

    std::string accuracy(const AuditEntry& entry) const {
        const ScreenedEpoch& row = rows_[entry.first];
        if (!row.statistic || !row.threshold) return std::string(words_of(row.reason));
        constexpr double least_m = 1e-6;  // below it is the determinant of a correlation matrix
        if (*row.threshold < least_m)
            return "the stated accuracies and correlations are not those of any error";
        const std::string stated = statistic_range(rows_, entry, 4, " m");
        return fmt::format("the stated accuracy of {} is not believable: {} than {} m", stated,
                           *row.statistic > *row.threshold ? "larger" : "smaller",
                           format_fixed(*row.threshold, 4));
    }

    static std::string short_arc(const ScreenedEpoch& row) {
        if (!row.statistic || !row.threshold) return std::string(words_of(row.reason));
        return fmt::format("in a stretch without a break of only {} usable epochs, where {} are "
                           "needed",
                           format_fixed(*row.statistic, 0), format_fixed(*row.threshold, 0));
    }

    std::string wrong_positions(const AuditEntry& entry) const {
        const ScreenedEpoch& row = rows_[entry.first];
        const bool one = entry.first == entry.last;
        const bool vertical = row.tested_axes == TestedAxes::vertical;
        std::string text = row.reason == Reason::burst ? "several wrong epochs in a row: " : "";
        text += one ? "its " : "their ";
        text += vertical ? "height" : "position";
        text += one ? " is " : "s are ";
        const std::string size =
            range_text(rows_, entry, 3, " m",
                       [](const ScreenedEpoch& each) { return size_of(each.estimated); });
        if (size.empty()) return text + "not where the other epochs put " + (one ? "it" : "them");
        text += fmt::format("{} from where the epochs before and after {}", size,
                            one ? "it put it" : "them put them");
        return one ? text + " (" + components(row.estimated) + ")" : text;
    }

    static std::string stretch(const ScreenedEpoch& row) {
        if (row.hypothesis != Hypothesis::ramp)
            return "the positions of this stretch together do not fit, and no single error "
                   "explains why";
        const auto rate = rate_of(row.estimated);
        const std::string drift =
            rate ? fmt::format("{} m/s ({}) ", format_fixed(*rate, 3), rate_components(row.estimated))
                 : std::string();
        return fmt::format("the positions drift by {}against those across the next break: nobody "
                           "can tell which of the two drift, so both stretches are left out",
                           drift);
    }

    std::string limit(const AuditEntry& entry) const {
        const ScreenedEpoch& row = rows_[entry.first];
        const auto text = [&](std::string_view name, std::string_view unit,
                              double LimitEvidence::*allowed) {
            std::string words = fmt::format("{} of {}, which the craft cannot make", name,
                                            statistic_range(rows_, entry, 1, unit));
            if (table_.evidence)
                words += fmt::format(": its class can make {}{}",
                                     format_fixed(table_.evidence->limits.*allowed, 1), unit);
            const std::string threshold =
                range_text(rows_, entry, 1, unit,
                           [](const ScreenedEpoch& each) { return each.threshold; });
            if (!threshold.empty())
                words += fmt::format(" ({} with the uncertainty of the motion)", threshold);
            return words;
        };
        if (row.hypothesis == Hypothesis::acceleration)
            return text("an acceleration", " m/s^2", &LimitEvidence::acceleration_max_mps2);
        if (row.hypothesis == Hypothesis::jerk)
            return text("a jerk", " m/s^3", &LimitEvidence::jerk_max_mps3);
        if (row.hypothesis == Hypothesis::vertical_rate)
            return text("a vertical rate", " m/s", &LimitEvidence::vertical_rate_max_mps);
        return std::string(words_of(row.reason));
    }

    std::optional<std::size_t> used_before(std::size_t at) const {
        while (at-- > 0)
            if (rows_[at].usable && rows_[at].arc) return at;
        return std::nullopt;
    }

    /// What a break between two used epochs means for the arcs.
    std::string arcs(std::size_t at, std::optional<std::size_t> previous) const {
        const auto number = [](const ScreenedEpoch& row) {
            return row.arc ? fmt::format(" {}", *row.arc) : std::string();
        };
        if (!previous) return fmt::format("arc{} begins", number(rows_[at]));
        return fmt::format("arc{} ends and arc{} begins", number(rows_[*previous]),
                           number(rows_[at]));
    }

    std::string gap(std::size_t at, std::size_t previous) const {
        const ScreenedEpoch& row = rows_[at];
        const ScreenedEpoch& last = rows_[previous];
        const auto between = static_cast<std::int64_t>(at - previous - 1);
        const double gap_s = static_cast<double>(row.time.nanoseconds - last.time.nanoseconds) * 1e-9;
        return fmt::format("a gap: the last epoch used before is {}, {} s earlier, {} between",
                           last.epoch, format_fixed(gap_s, 3),
                           between == 0 ? "with none recorded"
                                        : fmt::format("with {} left out",
                                                      counted(between, "epoch")));
    }

    std::string before(std::size_t at) const {
        const ScreenedEpoch& row = rows_[at];
        const auto previous = used_before(at);
        const std::string then = arcs(at, previous);
        const std::string between =
            previous ? fmt::format(" between epochs {} and {}", rows_[*previous].epoch, row.epoch)
                     : fmt::format(" before epoch {}", row.epoch);
        switch (*row.break_before) {
            case ArcBreak::start:
                return then;
            case ArcBreak::gap:
                return (previous ? gap(at, *previous) : "a gap") + "; " + then;
            case ArcBreak::innovation:
                return "the positions from here on do not follow from those before" + between +
                       "; " + then;
            case ArcBreak::step:
                return step(row) + between +
                       ": the positions before and after it do not belong together; " + then;
            case ArcBreak::bridged:
                return step(row) + between +
                       ": the positions before and after it do not belong together; it is bridged, "
                       "with its offset as an unknown of the estimate";
            case ArcBreak::ramp:
                return drift(row) + between +
                       ": nobody can tell whether the positions before or after it drift; " + then;
            case ArcBreak::time_shift:
                return shift(row) + between +
                       ", or the positions by as much along the track: at constant speed nobody "
                       "can tell which; " +
                       then;
        }
        return then;
    }

    static std::string step(const ScreenedEpoch& row) {
        if (!explains(row)) return "a step";
        return fmt::format("a step {}of {} m ({})", row.estimated.up_m ? "in height " : "",
                           format_fixed(*size_of(row.estimated), 3), components(row.estimated));
    }

    static std::string drift(const ScreenedEpoch& row) {
        if (!explains(row)) return "a drift of the positions begins or ends";
        return fmt::format("a drift of {} m/s ({}) begins or ends",
                           format_fixed(*rate_of(row.estimated), 3),
                           rate_components(row.estimated));
    }

    static std::string shift(const ScreenedEpoch& row) {
        if (!explains(row)) return "the time stamps jump";
        return fmt::format("the time stamps jump by {} s",
                           format_fixed(*row.estimated.time_s, 4));
    }

    static std::string detectable(const DetectableError& error) {
        std::vector<std::string> sizes;
        const auto add = [&](std::string_view name, std::optional<double> size, int decimals,
                             std::string_view unit) {
            if (size)
                sizes.push_back(fmt::format("{} {} {}", name, format_fixed(*size, decimals), unit));
        };
        add("position", error.outlier_m, 3, "m");
        add("step", error.step_m, 3, "m");
        add("drift", error.ramp_mps, 3, "m/s");
        add("time", error.time_s, 4, "s");
        add("height", error.outlier_up_m, 3, "m");
        add("height step", error.step_up_m, 3, "m");
        if (sizes.empty()) return {};
        return "; finds " + fmt::format("{}", fmt::join(sizes, ", "));
    }

    const ScreenedTable& table_;
    const std::vector<ScreenedEpoch>& rows_;
    std::string chance_;
};

}  // namespace

std::string decisions_text(const ScreenedTable& table, const AuditSubject& subject, bool all) {
    using Kind = AuditEntry::Kind;
    const DecisionWords words(table);
    std::string text = wrapped(
        fmt::format("Decisions, in the order of {}, whose lines or bytes are in brackets; seconds "
                    "count from its first epoch; +- is one standard uncertainty",
                    subject.recording),
        0);
    std::int64_t used = 0;
    for (const AuditEntry& entry : audit_entries(table.rows)) {
        const std::string where = where_of(table.rows[entry.first], table.rows[entry.last]);
        if (entry.kind == Kind::arc_break)
            text += wrapped("before " + where + ": " + words.arc_break(entry.first));
        else if (entry.kind == Kind::left_out)
            text += wrapped(where + ": " + words.left_out(entry));
        else if (++used; all)
            text += wrapped(where + ": " + words.used(table.rows[entry.first]));
    }
    text += counted(used, "epoch") + " used";
    if (!all) return text + " (with --all: one line for each).\n";
    return text + wrapped("; after each the hypothesis that it supports best, with its statistic "
                          "and the threshold it stays below, and the smallest errors found there.");
}

}  // namespace runcert
