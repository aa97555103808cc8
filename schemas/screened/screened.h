#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/enu/enu.h"

namespace runcert {

/// Why an epoch is not usable.
enum class Reason {
    none,  ///< usable
    no_position,
    no_fix,
    float_ambiguities,
    other_fix,  ///< a kind of solution the attempt does not allow
    duplicate_time,
    backward_time,
    accuracy_missing,
    accuracy_absurd,
    innovation,
    short_arc
};
std::string_view to_text(Reason reason);
bool from_text(std::string_view text, Reason& reason);

/// Why a new arc begins at an epoch.
enum class ArcBreak { start, gap, innovation };
std::string_view to_text(ArcBreak arc_break);
bool from_text(std::string_view text, ArcBreak& arc_break);

struct ScreenedEpoch : EnuEpoch {
    bool usable = false;
    Reason reason = Reason::none;
    std::optional<double> statistic;
    std::optional<double> threshold;
    std::optional<std::int64_t> arc;  ///< counted from 1
    std::optional<ArcBreak> break_before;
};

/// 3-screened.ecsv, `schemas/screened/v1.yaml`.
struct ScreenedTable {
    Header header;
    RecordingFacts facts;
    std::optional<FrameOrigin> origin;
    double variance_factor = 1.0;
    std::vector<ScreenedEpoch> rows;
};

/// Rows by reason, arcs and usable rows, counted from the rows.
struct ScreeningSummary {
    std::int64_t usable = 0;
    std::int64_t arcs = 0;
    std::map<Reason, std::int64_t> reasons;
};
ScreeningSummary summarise(const std::vector<ScreenedEpoch>& rows);

std::string write_screened(const ScreenedTable& table);
ScreenedTable read_screened(std::string_view text, const std::string& where);

}  // namespace runcert
