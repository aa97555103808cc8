#include "schemas/screened/screened.h"

#include <algorithm>
#include <iterator>

#include "schemas/common/enum_text.h"
#include "schemas/common/members.h"

namespace runcert {

YamlNode screened_field_table_node();

// The members of the map `screening`, as `schemas/screened/v1.yaml` names them.

template <>
inline constexpr auto members<ScreeningModel> =
    std::tuple{Member{"axes", &ScreeningModel::axes},
               Member{"noise", &ScreeningModel::noise},
               Member{"jerk_density", &ScreeningModel::jerk_density},
               Member{"measurement_scale", &ScreeningModel::measurement_scale},
               Member{"white_scale", &ScreeningModel::white_scale},
               Member{"error_sigma_m", &ScreeningModel::error_sigma_m},
               Member{"error_tau_s", &ScreeningModel::error_tau_s}};

template <>
inline constexpr auto members<FixKindEvidence> =
    std::tuple{Member{"fix", &FixKindEvidence::fix}, Member{"axes", &FixKindEvidence::axes},
               Member{"epochs", &FixKindEvidence::epochs},
               Member{"variance_factor", &FixKindEvidence::variance_factor},
               Member{"judgement", &FixKindEvidence::judgement}};

template <>
inline constexpr auto members<VelocityEvidence> = std::tuple{
    Member{"compared", &VelocityEvidence::compared}, Member{"delay_s", &VelocityEvidence::delay_s},
    Member{"sigma_delay_s", &VelocityEvidence::sigma_delay_s},
    Member{"scale_mps", &VelocityEvidence::scale_mps},
    Member{"rejected", &VelocityEvidence::rejected}};

template <>
inline constexpr auto members<TimeFault> =
    std::tuple{Member{"epoch", &TimeFault::epoch}, Member{"kind", &TimeFault::kind},
               Member{"size_s", &TimeFault::size_s}};

template <>
inline constexpr auto members<TimeEvidence> =
    std::tuple{Member{"sessions", &TimeEvidence::sessions},
               Member{"gaps", &TimeEvidence::gaps},
               Member{"longest_gap_s", &TimeEvidence::longest_gap_s},
               Member{"duplicates", &TimeEvidence::duplicates},
               Member{"backward", &TimeEvidence::backward},
               Member{"rate_deviation", &TimeEvidence::rate_deviation},
               Member{"jitter_s", &TimeEvidence::jitter_s},
               Member{"faults", &TimeEvidence::faults}};

template <>
inline constexpr auto members<LimitEvidence> =
    std::tuple{Member{"acceleration_max_mps2", &LimitEvidence::acceleration_max_mps2},
               Member{"jerk_max_mps3", &LimitEvidence::jerk_max_mps3},
               Member{"vertical_rate_max_mps", &LimitEvidence::vertical_rate_max_mps},
               Member{"acceleration_mps2", &LimitEvidence::acceleration_mps2},
               Member{"jerk_mps3", &LimitEvidence::jerk_mps3},
               Member{"vertical_rate_mps", &LimitEvidence::vertical_rate_mps},
               Member{"rejected", &LimitEvidence::rejected}};

template <>
inline constexpr auto members<BaselineEvidence> = std::tuple{
    Member{"receiver", &BaselineEvidence::receiver},
    Member{"compared", &BaselineEvidence::compared},
    Member{"length_m", &BaselineEvidence::length_m}, Member{"sd_m", &BaselineEvidence::sd_m},
    Member{"rejected", &BaselineEvidence::rejected}};

template <>
inline constexpr auto members<DeviceEvidence> =
    std::tuple{Member{"moving", &DeviceEvidence::moving}, Member{"held", &DeviceEvidence::held},
               Member{"interpolated", &DeviceEvidence::interpolated},
               Member{"by_chance", &DeviceEvidence::by_chance}};

template <>
inline constexpr auto members<ScreeningEvidence> =
    std::tuple{Member{"family_false_alarm_rate", &ScreeningEvidence::family_false_alarm_rate},
               Member{"tests", &ScreeningEvidence::tests},
               Member{"test_size", &ScreeningEvidence::test_size},
               Member{"power", &ScreeningEvidence::power},
               Member{"burst_epochs_max", &ScreeningEvidence::burst_epochs_max},
               Member{"passes", &ScreeningEvidence::passes},
               Member{"models", &ScreeningEvidence::models},
               Member{"fix_kinds", &ScreeningEvidence::fix_kinds},
               Member{"velocity", &ScreeningEvidence::velocity},
               Member{"device", &ScreeningEvidence::device},
               Member{"time", &ScreeningEvidence::time},
               Member{"limits", &ScreeningEvidence::limits},
               Member{"baseline", &ScreeningEvidence::baseline}};

namespace {

constexpr EnumWords<Reason, 20> reason_words{{{Reason::none, "none"},
                                              {Reason::no_position, "no_position"},
                                              {Reason::no_fix, "no_fix"},
                                              {Reason::float_ambiguities, "float"},
                                              {Reason::other_fix, "other_fix"},
                                              {Reason::duplicate_time, "duplicate_time"},
                                              {Reason::backward_time, "backward_time"},
                                              {Reason::accuracy_missing, "accuracy_missing"},
                                              {Reason::accuracy_absurd, "accuracy_absurd"},
                                              {Reason::innovation, "innovation"},
                                              {Reason::short_arc, "short_arc"},
                                              {Reason::outlier, "outlier"},
                                              {Reason::burst, "burst"},
                                              {Reason::model, "model"},
                                              {Reason::velocity, "velocity"},
                                              {Reason::physical_limit, "physical_limit"},
                                              {Reason::baseline, "baseline"},
                                              {Reason::few_satellites, "few_satellites"},
                                              {Reason::low_ratio, "low_ratio"},
                                              {Reason::old_corrections, "old_corrections"}}};

constexpr EnumWords<ArcBreak, 7> break_words{{{ArcBreak::start, "start"},
                                              {ArcBreak::gap, "gap"},
                                              {ArcBreak::innovation, "innovation"},
                                              {ArcBreak::step, "step"},
                                              {ArcBreak::ramp, "ramp"},
                                              {ArcBreak::time_shift, "time_shift"},
                                              {ArcBreak::bridged, "bridged"}}};

constexpr EnumWords<Hypothesis, 11> hypothesis_words{{{Hypothesis::outlier, "outlier"},
                                                      {Hypothesis::burst, "burst"},
                                                      {Hypothesis::step, "step"},
                                                      {Hypothesis::ramp, "ramp"},
                                                      {Hypothesis::time_shift, "time_shift"},
                                                      {Hypothesis::model, "model"},
                                                      {Hypothesis::velocity, "velocity"},
                                                      {Hypothesis::acceleration, "acceleration"},
                                                      {Hypothesis::jerk, "jerk"},
                                                      {Hypothesis::vertical_rate, "vertical_rate"},
                                                      {Hypothesis::baseline, "baseline"}}};

constexpr EnumWords<TestedAxes, 2> axes_words{
    {{TestedAxes::horizontal, "horizontal"}, {TestedAxes::vertical, "vertical"}}};

/// The columns that revision 1.2 added.
std::vector<ColumnBinding<ScreenedEpoch>> test_columns() {
    using Row = ScreenedEpoch;
    using Error = EstimatedError;
    using Smallest = DetectableError;
    return {column<Row, &Row::hypothesis>("hypothesis"),
            column<Row, &Row::tested_axes>("tested_axes"),
            column<Row, &Row::estimated, &Error::east_m>("estimated_east"),
            column<Row, &Row::estimated, &Error::north_m>("estimated_north"),
            column<Row, &Row::estimated, &Error::up_m>("estimated_up"),
            column<Row, &Row::estimated, &Error::sigma_east_m>("sigma_estimated_east"),
            column<Row, &Row::estimated, &Error::sigma_north_m>("sigma_estimated_north"),
            column<Row, &Row::estimated, &Error::sigma_up_m>("sigma_estimated_up"),
            column<Row, &Row::estimated, &Error::correlation_east_north>("correlation_estimated"),
            column<Row, &Row::estimated, &Error::rate_east_mps>("estimated_rate_east"),
            column<Row, &Row::estimated, &Error::rate_north_mps>("estimated_rate_north"),
            column<Row, &Row::estimated, &Error::rate_up_mps>("estimated_rate_up"),
            column<Row, &Row::estimated, &Error::time_s>("estimated_time"),
            column<Row, &Row::detectable, &Smallest::outlier_m>("detectable_outlier"),
            column<Row, &Row::detectable, &Smallest::step_m>("detectable_step"),
            column<Row, &Row::detectable, &Smallest::ramp_mps>("detectable_ramp"),
            column<Row, &Row::detectable, &Smallest::time_s>("detectable_time"),
            column<Row, &Row::detectable, &Smallest::outlier_up_m>("detectable_outlier_up"),
            column<Row, &Row::detectable, &Smallest::step_up_m>("detectable_step_up"),
            column<Row, &Row::local_variance_factor>("local_variance_factor"),
            column<Row, &Row::manoeuvre_mps2>("manoeuvre"),
            column<Row, &Row::manoeuvre_up_mps2>("manoeuvre_up")};
}

const TableFormat<ScreenedEpoch>& format() {
    static const TableFormat<ScreenedEpoch> instance = [] {
        using Row = ScreenedEpoch;
        auto columns = enu_columns<Row>();
        columns.push_back(column<Row, &Row::usable>("usable"));
        columns.push_back(column<Row, &Row::reason>("reason"));
        columns.push_back(column<Row, &Row::statistic>("statistic"));
        columns.push_back(column<Row, &Row::threshold>("threshold"));
        columns.push_back(column<Row, &Row::arc>("arc"));
        columns.push_back(column<Row, &Row::break_before>("break_before"));
        std::ranges::copy(test_columns(), std::back_inserter(columns));
        return TableFormat<Row>(screened_field_table_node(), "schemas/screened/v1.yaml",
                                std::move(columns));
    }();
    return instance;
}

/// Whether a test of the positions decided so, and no condition on a row alone.
bool rejected_by_test(Reason reason) {
    switch (reason) {
        case Reason::outlier:
        case Reason::burst:
        case Reason::model:
        case Reason::velocity:
        case Reason::physical_limit:
        case Reason::baseline:
            return true;
        default:
            return false;
    }
}

std::optional<Hypothesis> decided_for(std::optional<ArcBreak> arc_break) {
    if (arc_break == ArcBreak::step || arc_break == ArcBreak::bridged) return Hypothesis::step;
    if (arc_break == ArcBreak::ramp) return Hypothesis::ramp;
    if (arc_break == ArcBreak::time_shift) return Hypothesis::time_shift;
    return std::nullopt;
}

/// Counts by the words of what is counted.
template <class Enum>
nlohmann::ordered_json counts_json(const std::map<Enum, std::int64_t>& counts) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [value, count] : counts)
        json[std::string(to_text(value))] = count;
    return json;
}

}  // namespace

std::string_view to_text(Reason reason) {
    return word_of(reason_words, reason);
}
bool from_text(std::string_view text, Reason& reason) {
    return value_of(reason_words, text, reason);
}
std::string_view words_of(Reason reason) {
    switch (reason) {
        case Reason::none:
            return "no reason is given";
        case Reason::no_position:
            return "no position";
        case Reason::no_fix:
            return "no solution";
        case Reason::float_ambiguities:
            return "ambiguities not fixed";
        case Reason::other_fix:
            return "kind of solution not allowed";
        case Reason::duplicate_time:
            return "time repeated";
        case Reason::backward_time:
            return "time out of order";
        case Reason::accuracy_missing:
            return "accuracy not stated";
        case Reason::accuracy_absurd:
            return "stated accuracy not believable";
        case Reason::few_satellites:
            return "too few satellites: nothing checks the position";
        case Reason::low_ratio:
            return "ambiguities hardly better than others (ratio)";
        case Reason::old_corrections:
            return "corrections too old";
        case Reason::innovation:
            return "position does not follow from those before it";
        case Reason::short_arc:
            return "stretch too short";
        case Reason::outlier:
            return "wrong position";
        case Reason::burst:
            return "several wrong positions in a row";
        case Reason::model:
            return "stretch that does not fit";
        case Reason::velocity:
            return "contradicted by the recorded velocity";
        case Reason::physical_limit:
            return "motion that the craft cannot make";
        case Reason::baseline:
            return "contradicted by the other receiver";
    }
    return "";
}

std::string_view to_text(ArcBreak arc_break) {
    return word_of(break_words, arc_break);
}
bool from_text(std::string_view text, ArcBreak& arc_break) {
    return value_of(break_words, text, arc_break);
}
std::string_view to_text(Hypothesis hypothesis) {
    return word_of(hypothesis_words, hypothesis);
}
bool from_text(std::string_view text, Hypothesis& hypothesis) {
    return value_of(hypothesis_words, text, hypothesis);
}
std::string_view to_text(TestedAxes axes) {
    return word_of(axes_words, axes);
}
bool from_text(std::string_view text, TestedAxes& axes) {
    return value_of(axes_words, text, axes);
}

void ScreeningSummary::add(const ScreenedEpoch& row) {
    usable += row.usable ? 1 : 0;
    if (row.arc) arcs = std::max(arcs, *row.arc);
    ++reasons[row.reason];
    if (row.hypothesis && rejected_by_test(row.reason)) ++decisions[*row.hypothesis];
    if (const auto hypothesis = decided_for(row.break_before)) ++decisions[*hypothesis];
}

ScreeningSummary summarise(const std::vector<ScreenedEpoch>& rows) {
    ScreeningSummary summary;
    for (const ScreenedEpoch& row : rows)
        summary.add(row);
    return summary;
}

std::string write_screened(const ScreenedTable& table) {
    nlohmann::ordered_json meta = frame_meta_json(table.header, table.facts, table.origin);
    const ScreeningSummary summary = summarise(table.rows);
    meta["summary"] = {{"epochs", table.rows.size()},
                       {"usable", summary.usable},
                       {"arcs", summary.arcs},
                       {"reasons", counts_json(summary.reasons)},
                       {"variance_factor", table.variance_factor}};
    if (table.evidence) {
        meta["screening"] = members_json(*table.evidence);
        meta["screening"]["decisions"] = counts_json(summary.decisions);
    }
    return format().write(std::move(meta), table.rows);
}

namespace {

ScreenedTable head_of(const YamlValue& meta) {
    const YamlValue screening = meta["screening"];
    return {.header = read_header(meta),
            .facts = read_recording_facts(meta),
            .origin = read_origin(meta),
            .variance_factor = meta["summary"]["variance_factor"].real(),
            .evidence = screening.exists()
                            ? std::optional(read_members<ScreeningEvidence>(screening))
                            : std::nullopt,
            .rows = {}};
}

}  // namespace

ScreenedTable read_screened(std::string_view text, const std::string& where) {
    auto contents = format().read(text, where);
    ScreenedTable table = head_of(contents.meta);
    table.rows = std::move(contents.rows);
    return table;
}

OpenTable<ScreenedTable> open_screened(std::string_view text, const std::string& where) {
    RowReader<ScreenedEpoch> rows(format(), text, where);
    return {head_of(rows.meta()), std::move(rows)};
}

}  // namespace runcert
