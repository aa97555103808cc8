#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reports/audit/walk.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// One entry of an audit: rows of a table (indices, both included) and what was decided of them.
struct AuditEntry {
    enum class Kind {
        arc_break,  ///< before one row: an arc begins there, or a step inside it is bridged
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

/// The minimal detectable biases of one kind of error over the usable rows, in the unit of that kind
/// (m, m/s or s; schemas/screened).
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
};

/// What an audit is about, beside the table itself.
struct AuditSubject {
    std::string attempt;
    std::string recording;               ///< name of the file that was handed in
    std::vector<std::string> checked;    ///< files whose hash is the one that another file names
    std::vector<std::string> unchecked;  ///< files that are not there, or that none there names
    std::vector<AuditedWindow> windows = {};
};

/// The audit of one receiver's screening: what the tests rested on, every decision with its rows in
/// the recording, the minimal detectable biases. An entry begins with "epoch ..." or
/// "epochs ..." for rows and "before epoch ..." for a break. With `all` the rows used are entries
/// too. Tables of any revision.
Section screening_section(const ScreenedTable& table, const AuditSubject& subject, bool all);

}  // namespace runcert
