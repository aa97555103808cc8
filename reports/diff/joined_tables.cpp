#include "reports/diff/joined_tables.h"

#include <fmt/format.h>

#include <map>

#include "core/failure.h"
#include "core/gps_time.h"
#include "schemas/common/header.h"

namespace runcert {

std::optional<std::size_t> find_column(const EcsvReader& table, std::string_view name) {
    for (std::size_t i = 0; i < table.columns().size(); ++i)
        if (table.columns()[i].name == name) return i;
    return std::nullopt;
}

std::size_t column_of(const EcsvReader& table, std::string_view name) {
    if (const auto found = find_column(table, name)) return *found;
    throw Failure(table.where(), fmt::format("the table has no column \"{}\"", name),
                  "The file is not as the program writes it; take the original");
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

JoinedTables::Side::Side(std::string_view text, const std::string& where) : table(text, where) {
    const YamlValue first = YamlValue(table.meta(), where)["first_epoch_gps"];
    if (first.exists()) first_epoch_ns = read_gps_time(first).value().nanoseconds();
    EcsvReader rows(text, where);
    const std::size_t time = column_of(rows, "time");
    while (rows.next_row())
        times_ns.push_back(rows.seconds(time));
}

void JoinedTables::Side::step_to(std::optional<std::size_t> row) {
    for (const std::size_t last = row.value_or(next); next <= last; ++next)
        if (table.next_row() && !passed_line && row != next) passed_line = line();
}

JoinedTables::JoinedTables(std::string_view a, std::string_view b, const std::string& where_a,
                           const std::string& where_b)
    : a_(a, where_a), b_(b, where_b) {
    if (a_.first_epoch_ns && b_.first_epoch_ns)
        for (Side* side : {&a_, &b_})
            for (std::int64_t& time_ns : side->times_ns)
                time_ns += *side->first_epoch_ns;
    pairs_ = join_by_time(a_.times_ns, b_.times_ns);
}

bool JoinedTables::next() {
    const bool found = next_pair_ < pairs_.size();
    const RowPair pair = found ? pairs_[next_pair_++] : RowPair{};
    a_.step_to(found ? std::optional(pair.a) : std::nullopt);
    b_.step_to(found ? std::optional(pair.b) : std::nullopt);
    return found;
}

JoinedRow JoinedTables::row() const {
    const auto epoch = [](const EcsvReader& table) {
        const auto column = find_column(table, "epoch");
        return column && !table.is_missing(*column) ? table.integer(*column) : 0;
    };
    return {.epoch_a = epoch(a()),
            .epoch_b = epoch(b()),
            .time_s = a().real(column_of(a(), "time")),
            .line_a = a_.line(),
            .line_b = b_.line()};
}

}  // namespace runcert
