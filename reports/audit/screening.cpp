#include "reports/audit/screening.h"

#include "core/statistics.h"

namespace runcert {
namespace {

/// Whether two rows left out one after the other were left out by the same decision.
bool same_decision(const ScreenedEpoch& a, const ScreenedEpoch& b) {
    if (a.reason != b.reason || a.hypothesis != b.hypothesis || a.tested_axes != b.tested_axes)
        return false;
    switch (a.reason) {
        case Reason::outlier:
            return false;
        case Reason::other_fix:
            return a.fix == b.fix;
        case Reason::burst:
        case Reason::model:
        case Reason::short_arc:
            return a.statistic == b.statistic && a.threshold == b.threshold;
        case Reason::accuracy_absurd:
            return a.threshold == b.threshold &&
                   (a.statistic > a.threshold) == (b.statistic > b.threshold);
        default:
            return true;
    }
}

}  // namespace

std::vector<AuditEntry> audit_entries(const std::vector<ScreenedEpoch>& rows) {
    using Kind = AuditEntry::Kind;
    std::vector<AuditEntry> entries;
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (rows[row].break_before) entries.push_back({Kind::arc_break, row, row});
        if (rows[row].usable) {
            entries.push_back({Kind::used, row, row});
            continue;
        }
        const bool goes_on = !entries.empty() && entries.back().kind == Kind::left_out &&
                             same_decision(rows[row - 1], rows[row]);
        if (goes_on)
            entries.back().last = row;
        else
            entries.push_back({Kind::left_out, row, row});
    }
    return entries;
}

std::optional<DetectableSizes> detectable_sizes(
    const std::vector<ScreenedEpoch>& rows, std::optional<double> MinimalDetectableBias::*size) {
    DetectableSizes sizes;
    std::vector<double> found;
    for (const ScreenedEpoch& row : rows) {
        if (!row.usable) continue;
        const std::optional<double> here = row.detectable.*size;
        if (!here) {
            ++sizes.without;
            continue;
        }
        if (found.empty() || *here > sizes.worst) {
            sizes.worst = *here;
            sizes.worst_epoch = row.epoch;
        }
        found.push_back(*here);
    }
    if (found.empty()) return std::nullopt;
    sizes.epochs = std::ssize(found);
    sizes.median = median(std::move(found));
    return sizes;
}

}  // namespace runcert
