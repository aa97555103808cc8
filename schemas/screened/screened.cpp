#include "schemas/screened/screened.h"

#include <algorithm>

#include "schemas/common/enum_text.h"

namespace runcert {

std::string_view screened_schema_text(std::string_view name);

namespace {

constexpr EnumWords<Reason, 11> reason_words{{{Reason::none, "none"},
                                              {Reason::no_position, "no_position"},
                                              {Reason::no_fix, "no_fix"},
                                              {Reason::float_ambiguities, "float"},
                                              {Reason::other_fix, "other_fix"},
                                              {Reason::duplicate_time, "duplicate_time"},
                                              {Reason::backward_time, "backward_time"},
                                              {Reason::accuracy_missing, "accuracy_missing"},
                                              {Reason::accuracy_absurd, "accuracy_absurd"},
                                              {Reason::innovation, "innovation"},
                                              {Reason::short_arc, "short_arc"}}};

constexpr EnumWords<ArcBreak, 3> break_words{
    {{ArcBreak::start, "start"}, {ArcBreak::gap, "gap"}, {ArcBreak::innovation, "innovation"}}};

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
        return TableFormat<Row>(screened_schema_text("v1.yaml"), "schemas/screened/v1.yaml",
                                std::move(columns));
    }();
    return instance;
}

}  // namespace

std::string_view to_text(Reason reason) {
    return word_of(reason_words, reason);
}
bool from_text(std::string_view text, Reason& reason) {
    return value_of(reason_words, text, reason);
}
std::string_view to_text(ArcBreak arc_break) {
    return word_of(break_words, arc_break);
}
bool from_text(std::string_view text, ArcBreak& arc_break) {
    return value_of(break_words, text, arc_break);
}

ScreeningSummary summarise(const std::vector<ScreenedEpoch>& rows) {
    ScreeningSummary summary;
    for (const ScreenedEpoch& row : rows) {
        summary.usable += row.usable ? 1 : 0;
        if (row.arc) summary.arcs = std::max(summary.arcs, *row.arc);
        ++summary.reasons[row.reason];
    }
    return summary;
}

std::string write_screened(const ScreenedTable& table) {
    nlohmann::ordered_json meta = frame_meta_json(table.header, table.facts, table.origin);
    const ScreeningSummary summary = summarise(table.rows);
    nlohmann::ordered_json reasons = nlohmann::ordered_json::object();
    for (const auto& [reason, count] : summary.reasons)
        reasons[std::string(to_text(reason))] = count;
    meta["summary"] = {{"epochs", table.rows.size()},
                       {"usable", summary.usable},
                       {"arcs", summary.arcs},
                       {"reasons", reasons},
                       {"variance_factor", table.variance_factor}};
    return format().write(std::move(meta), table.rows);
}

ScreenedTable read_screened(std::string_view text, const std::string& where) {
    auto contents = format().read(text, where);
    return {.header = read_header(contents.meta),
            .facts = read_recording_facts(contents.meta),
            .origin = read_origin(contents.meta),
            .variance_factor = contents.meta["summary"]["variance_factor"].real(),
            .rows = std::move(contents.rows)};
}

}  // namespace runcert
