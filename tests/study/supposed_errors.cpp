#include "supposed_errors.h"

#include <algorithm>
#include <cmath>

namespace runcert {
namespace {

bool within(std::size_t k, std::size_t first, std::size_t last, std::size_t reach) {
    return k + reach >= first && k <= last + reach;
}

bool is_break(const ScreenedEpoch& row) {
    return row.break_before && *row.break_before != ArcBreak::start &&
           *row.break_before != ArcBreak::gap;
}

Eigen::Vector2d error_at(std::size_t k, double time_s, double first_s, const SupposedError& error) {
    if (k < error.first) return Eigen::Vector2d::Zero();
    switch (error.kind) {
        case Hypothesis::outlier:
        case Hypothesis::burst:
            return k <= error.last() ? error.size : Eigen::Vector2d::Zero();
        case Hypothesis::step:
            return error.size;
        case Hypothesis::ramp:
            return (time_s - first_s) * error.size;
        default:
            return Eigen::Vector2d::Zero();
    }
}

}  // namespace

Eigen::Vector2d true_position(const SimulatedRecording& recording, std::size_t k, double late_s) {
    // By the nearest epoch's motion.
    const double dt_s = recording.screened.facts.nominal_interval_s;
    const double steps = std::round(late_s / dt_s);
    const auto last = static_cast<double>(recording.truth.size() - 1);
    const auto near =
        static_cast<std::size_t>(std::clamp(static_cast<double>(k) - steps, 0.0, last));
    const double time_s = (static_cast<double>(k) - static_cast<double>(near)) * dt_s - late_s;
    return recording.truth[near] + time_s * recording.velocity[near] +
           0.5 * time_s * time_s * recording.acceleration[near];
}

ScreenedTable with_errors(const SimulatedRecording& recording,
                          std::span<const SupposedError> errors) {
    ScreenedTable table = recording.screened;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        ScreenedEpoch& row = table.rows[k];
        double late_s = 0.0;
        Eigen::Vector2d moved = Eigen::Vector2d::Zero();
        for (const SupposedError& error : errors) {
            moved += error_at(k, row.time.seconds(), table.rows[error.first].time.seconds(), error);
            if (k >= error.first) late_s += error.late_s;
        }
        if (late_s != 0.0) moved += true_position(recording, k, late_s) - recording.truth[k];
        *row.east_m += moved.x();
        *row.north_m += moved.y();
    }
    return table;
}

EnuTable to_be_screened(const ScreenedTable& table) {
    EnuTable enu;
    enu.facts = table.facts;
    enu.rows.assign(table.rows.begin(), table.rows.end());
    return enu;
}

Judgement judge(const ScreenedTable& screened, const SupposedError& error, double rate_hz) {
    const bool ramp = error.kind == Hypothesis::ramp;
    const std::size_t reach = ramp ? static_cast<std::size_t>(rate_hz) : 1;
    const bool epochs_alone = error.kind == Hypothesis::outlier || error.kind == Hypothesis::burst;
    Judgement judgement;
    bool all_left_out = true;
    for (std::size_t k = 0; k < screened.rows.size(); ++k) {
        const ScreenedEpoch& row = screened.rows[k];
        if (k >= error.first && k <= error.last()) all_left_out = all_left_out && !row.usable;
        if (!within(k, error.first, error.last(), reach)) continue;
        judgement.found = judgement.found || !row.usable || is_break(row);
        // Of a ramp nothing may be left that could begin with a break.
        if (ramp && !row.usable && row.hypothesis == Hypothesis::ramp) judgement.named = true;
        if (!is_break(row)) continue;
        if (within(k, error.first, error.first, reach)) judgement.dated = true;
        const ArcBreak told = *row.break_before;
        judgement.named =
            judgement.named || (ramp ? told == ArcBreak::ramp : told != ArcBreak::ramp);
    }
    if (epochs_alone) judgement.named = all_left_out;
    return judgement;
}

std::int64_t wrongly_left_out(const ScreenedTable& screened,
                              std::span<const SupposedError> errors) {
    std::int64_t count = 0;
    for (std::size_t k = 0; k < screened.rows.size(); ++k) {
        if (screened.rows[k].usable) continue;
        const bool wrong = std::any_of(errors.begin(), errors.end(), [k](const SupposedError& e) {
            const bool alone = e.kind == Hypothesis::outlier || e.kind == Hypothesis::burst;
            return alone && k >= e.first && k <= e.last();
        });
        if (!wrong) ++count;
    }
    return count;
}

const Attempt& study_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: study\ncraft: {name: study, class: land-yacht}\n"
        "receivers: [{id: primary, recording: none}]\nprofiles: [nalsa]\n",
        "study");
    return attempt;
}

ScreenConfig study_screen_config() {
    return screen_config(study_attempt());
}

}  // namespace runcert
