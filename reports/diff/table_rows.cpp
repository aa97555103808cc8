#include <map>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/gps_time.h"
#include "reports/diff/table_comparison.h"
#include "schemas/common/header.h"
#include "store/ecsv.h"

namespace runcert {
namespace {

std::size_t time_column(const EcsvReader& table) {
    for (std::size_t i = 0; i < table.columns().size(); ++i)
        if (table.columns()[i].name == "time") return i;
    throw Failure(table.where(), "the table has no column \"time\"",
                  "The file is not as the program writes it; take the original");
}

YamlValue whole_of(std::string_view text, const std::string& name) {
    if (name.ends_with(".ecsv")) return YamlValue(EcsvReader(text, name).meta(), name);
    return YamlValue(parse_yaml(text, name), name);
}

constexpr const char* header_members[] = {"schema", "stage", "inputs", "parameters", "attempt"};

}  // namespace

nlohmann::ordered_json results_of(std::string_view text, const std::string& name) {
    auto results = json_from_yaml(whole_of(text, name));
    for (const char* member : header_members)
        results.erase(member);
    return results;
}

nlohmann::ordered_json header_of(std::string_view text, const std::string& name) {
    const YamlValue whole = whole_of(text, name);
    auto header = nlohmann::ordered_json::object();
    for (const char* member : header_members)
        if (whole[member].exists()) header[member] = json_from_yaml(whole[member]);
    return header;
}

bool says_first_epoch(std::string_view table, const std::string& where) {
    return YamlValue(EcsvReader(table, where).meta(), where)["first_epoch_gps"].exists();
}

std::vector<std::int64_t> row_times(std::string_view text, const std::string& where,
                                    bool absolute) {
    EcsvReader table(text, where);
    std::int64_t first_ns = 0;
    if (absolute)
        first_ns =
            read_gps_time(YamlValue(table.meta(), where)["first_epoch_gps"]).value().nanoseconds();
    const std::size_t column = time_column(table);
    std::vector<std::int64_t> times;
    while (table.next_row())
        times.push_back(first_ns + table.seconds(column));
    return times;
}

std::vector<RowPair> join_by_time(const std::vector<std::int64_t>& a,
                                  const std::vector<std::int64_t>& b) {
    std::multimap<std::int64_t, std::size_t> rows_of_b;
    for (std::size_t i = 0; i < b.size(); ++i)
        rows_of_b.emplace(b[i], i);
    std::vector<RowPair> pairs;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const auto found = rows_of_b.lower_bound(a[i]);
        if (found == rows_of_b.end() || found->first != a[i]) continue;
        const std::size_t row = found->second;
        rows_of_b.erase(found);
        // Rows are gone through once: one that would lead back is left to its own table.
        if (pairs.empty() || row > pairs.back().b) pairs.push_back({i, row});
    }
    return pairs;
}

}  // namespace runcert
