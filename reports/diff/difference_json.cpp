#include <nlohmann/json.hpp>

#include "reports/diff/day_difference.h"
#include "reports/diff/run_difference.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

void set(Json& json, const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
}

Json json_of(const std::vector<Change>& changes, const char* a = "a", const char* b = "b") {
    Json list = Json::array();
    for (const Change& change : changes) {
        Json entry{{"what", change.what}, {a, change.a}, {b, change.b}};
        if (!change.note.empty()) entry["note"] = change.note;
        list.push_back(std::move(entry));
    }
    return list;
}

Json json_of(const JoinedRow& row) {
    return {{"epoch_a", row.epoch_a},
            {"epoch_b", row.epoch_b},
            {"time_s", row.time_s},
            {"line_a", row.line_a},
            {"line_b", row.line_b}};
}

Json json_of(const EpochDifference& epochs) {
    Json json{{"receiver", epochs.receiver},
              {"compared", epochs.joined},
              {"only_a", epochs.rows_a - epochs.joined},
              {"only_b", epochs.rows_b - epochs.joined},
              {"counts", Json::object()},
              {"changes", Json::array()}};
    for (const auto& [change, count] : epochs.counts())
        json["counts"][change] = count;
    for (const EpochChange& change : epochs.changes) {
        Json entry = json_of(change.row);
        entry["a"] = change.a;
        entry["b"] = change.b;
        json["changes"].push_back(std::move(entry));
    }
    return json;
}

Json json_of(const std::vector<ValueDifference>& values) {
    Json list = Json::array();
    for (const ValueDifference& value : values) {
        Json entry{{"path", value.path}, {"a", value.a}, {"b", value.b}};
        set(entry, "difference", value.difference);
        set(entry, "of_standard_uncertainty", value.ratio);
        list.push_back(std::move(entry));
    }
    return list;
}

Json json_of(const ColumnDifference& column) {
    Json json{{"column", column.column}, {"unit", column.unit}, {"cells", column.cells}};
    Json largest = json_of(column.largest.row);
    largest["a"] = column.largest.a;
    largest["b"] = column.largest.b;
    set(largest, "difference", column.largest.difference);
    set(largest, "of_standard_uncertainty", column.largest.ratio);
    json["largest"] = std::move(largest);
    return json;
}

Json json_of(const TableComparison& table) {
    Json json{{"rows_compared", table.joined},
              {"rows_only_a", table.rows_a - table.joined},
              {"rows_only_b", table.rows_b - table.joined},
              {"columns_only_a", table.columns_only_a},
              {"columns_only_b", table.columns_only_b},
              {"columns", Json::array()},
              {"header", json_of(table.header)}};
    for (const ColumnDifference& column : table.columns)
        json["columns"].push_back(json_of(column));
    return json;
}

Json json_of(const ProductDifference& product) {
    Json json{{"file", product.file}, {"equal", product.equal()}};
    if (product.only_a || product.only_b) json["missing_in"] = product.only_a ? "b" : "a";
    if (product.table)
        json["table"] = json_of(*product.table);
    else
        json["values"] = json_of(product.values);
    return json;
}

Json json_of(const std::optional<DayFailure>& failure) {
    if (!failure) return nullptr;
    return {{"step", failure->step},
            {"problem", failure->problem},
            {"where", failure->where},
            {"remedy", failure->remedy}};
}

Json json_of(const std::optional<DayResult>& result) {
    if (!result) return nullptr;
    Json json{{"outcome", to_text(result->outcome)}, {"reason", result->reason}};
    if (result->speed_m_s) json["speed_m_s"] = *result->speed_m_s;
    if (result->expanded_uncertainty_m_s)
        json["expanded_uncertainty_m_s"] = *result->expanded_uncertainty_m_s;
    json["coverage_factor"] = result->coverage_factor;
    return json;
}

Json json_of(const ResultChange& change) {
    Json json{{"id", change.id},
              {"profile", change.profile},
              {"outcome_changed", change.outcome_changed},
              {"speed_moved", change.speed_moved},
              {"uncertainty_moved", change.uncertainty_moved},
              {"old", json_of(change.old_result)},
              {"new", json_of(change.new_result)}};
    if (change.moved_by) json["of_standard_uncertainty"] = *change.moved_by;
    return json;
}

Json json_of(const ChangeCauses& causes) {
    Json json{{"id", causes.id},
              {"programs", json_of(causes.causes.programs, "old", "new")},
              {"inputs", json_of(causes.causes.inputs, "old", "new")},
              {"parameters", json_of(causes.causes.parameters, "old", "new")},
              {"attempt", json_of(causes.causes.attempt, "old", "new")}};
    if (!causes.unknown.empty()) json["unknown"] = causes.unknown;
    return json;
}

}  // namespace

Json difference_json(const RunDifference& difference) {
    Json json{{"schema", "run-difference/1.0"},
              {"equal", difference.equal()},
              {"programs", json_of(difference.programs)},
              {"inputs", json_of(difference.inputs)},
              {"parameters", json_of(difference.parameters)},
              {"attempt", json_of(difference.attempt)},
              {"epochs", Json::array()},
              {"windows", json_of(difference.windows)},
              {"verdicts", json_of(difference.verdicts)},
              {"products", Json::array()}};
    for (const EpochDifference& epochs : difference.epochs)
        json["epochs"].push_back(json_of(epochs));
    for (const ProductDifference& product : difference.products)
        json["products"].push_back(json_of(product));
    return json;
}

Json comparison_json(const DayComparison& comparison) {
    Json json{{"schema", "day-comparison/1.0"},  {"equal", comparison.equal()},
              {"in_both", comparison.in_both},   {"unchanged", comparison.unchanged},
              {"only_old", comparison.only_old}, {"only_new", comparison.only_new},
              {"states", Json::array()},         {"results", Json::array()},
              {"causes", Json::array()}};
    for (const StateChange& change : comparison.states)
        json["states"].push_back({{"id", change.id},
                                  {"old", change.old_state},
                                  {"new", change.new_state},
                                  {"old_failure", json_of(change.old_failure)},
                                  {"new_failure", json_of(change.new_failure)}});
    for (const ResultChange& change : comparison.results)
        json["results"].push_back(json_of(change));
    for (const ChangeCauses& causes : comparison.causes)
        json["causes"].push_back(json_of(causes));
    return json;
}

}  // namespace runcert
