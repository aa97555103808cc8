#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/prose.h"
#include "core/text.h"
#include "schemas/document/document.h"
#include "schemas/screened/screened.h"
#include "schemas/verdict/figures.h"

// The audit of screening: its parts, which `screening_blocks` puts together, and their words.

namespace runcert {

/// One entry of an audit: rows of a table (indices, both included) and what was decided of them.
struct AuditEntry {
    enum class Kind {
        arc_break,  ///< before one row: an arc begins there
        left_out,   ///< rows that are not usable
        used        ///< one row that is usable
    };
    Kind kind = Kind::used;
    std::size_t first = 0;
    std::size_t last = 0;
};

/// All that was decided, in the order of the rows: every break, every row. Rows left out one after
/// the other by the same decision are one entry; outliers are decided for one by one, a burst or a
/// stretch without explanation together.
std::vector<AuditEntry> audit_entries(const std::vector<ScreenedEpoch>& rows);

/// The minimal detectable biases of one kind of error over the usable rows, in the unit of that
/// kind (m, m/s or s; schemas/screened).
struct DetectableSizes {
    std::int64_t epochs = 0;   ///< that have one
    std::int64_t without = 0;  ///< at which no size could be found
    double median = 0.0;
    double worst = 0.0;
    std::int64_t worst_epoch = 0;  ///< the first of them
};
/// Nothing where no usable row has one.
std::optional<DetectableSizes> detectable_sizes(const std::vector<ScreenedEpoch>& rows,
                                                std::optional<double> MinimalDetectableBias::*size);

/// The certified window of a rule.
struct AuditedWindow {
    std::string profile;
    double duration_s = 0.0;
    SpeedUnit unit = speed_unit("");  ///< the rule's
};

/// What an audit is about, beside the table itself.
struct AuditSubject {
    std::string recording;  ///< name of the file that was handed in
    std::vector<AuditedWindow> windows = {};
};

/// The audit of one receiver's screening: what the tests rested on, every decision with its rows in
/// the recording, the minimal detectable biases. Entries begin with "epoch ..." or "epochs ...",
/// those of breaks with "before epoch ...". With `all` used rows are entries.
std::vector<Block> screening_blocks(const ScreenedTable& table, const AuditSubject& subject,
                                    bool all);

/// Every decision with its rows in the recording.
std::vector<Block> decision_blocks(const ScreenedTable& table, const AuditSubject& subject,
                                   bool all);

/// Why the rows of an entry were left out, without the statistic.
std::string left_out_text(const ScreenedTable& table, const AuditEntry& entry);

/// How often something of that probability happens: "once in 590 million".
std::string once_in(double probability);

/// "3 to 5", or "3" where both are the same.
std::string one_or_range(const std::string& low, const std::string& high);

/// The figures of rows that share a decision, "0.183 m to 0.350 m"; `unit` begins with its blank.
/// `figure(row)` is an optional; empty where there is none or one is missing.
template <class Rows, class Figure>
std::string range_text(const Rows& rows, int decimals, std::string_view unit, Figure figure) {
    std::optional<double> low;
    std::optional<double> high;
    for (const ScreenedEpoch& row : rows) {
        const std::optional<double> value = figure(row);
        if (!value) return {};
        low = std::min(low.value_or(*value), *value);
        high = std::max(high.value_or(*value), *value);
    }
    if (!low) return {};
    return one_or_range(format_fixed(*low, decimals) + std::string(unit),
                        format_fixed(*high, decimals) + std::string(unit));
}

/// An error towards two directions, or upwards, with its standard uncertainties: "0.174 m east,
/// 0.057 m south, each ± 0.020 m". Empty where nothing was estimated.
std::string components(const EstimatedError& error);
/// Its length, m; nothing where it was not estimated. The same of a ramp, m/s.
std::optional<double> size_of(const EstimatedError& error);
std::optional<double> rate_of(const EstimatedError& error);
/// A ramp towards two directions, or upwards.
std::string rate_components(const EstimatedError& error);

}  // namespace runcert
