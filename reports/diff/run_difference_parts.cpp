#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/uncertainty.h"
#include "reports/diff/joined_tables.h"
#include "reports/diff/run_difference.h"
#include "reports/diff/value_comparison.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// A member of a map; null where it has none.
Json member_of(const Json& map, const char* name) {
    return map.is_object() ? map.value(name, Json()) : Json();
}

std::string text_in(const Json& map, const char* name) {
    const Json found = member_of(map, name);
    return found.is_string() ? found.get<std::string>() : "none";
}

/// Calls `visit(name, in_a, in_b)` for each entry of two maps' lists, by the text that names it;
/// null where one does not have it.
template <class Visit>
void each_in_either(const Json& a, const Json& b, const char* list, const char* name, Visit visit) {
    const Json all_a = member_of(a, list), all_b = member_of(b, list);
    const auto entry = [&](const Json& entries, const std::string& named) {
        const auto found = std::find_if(entries.begin(), entries.end(), [&](const Json& one) {
            return text_in(one, name) == named;
        });
        return found == entries.end() ? Json() : *found;
    };
    for (const Json& one : all_a)
        visit(text_in(one, name), one, entry(all_b, text_in(one, name)));
    for (const Json& other : all_b)
        if (entry(all_a, text_in(other, name)).is_null())
            visit(text_in(other, name), Json(), other);
}

void add_change(std::vector<Change>& changes, std::string what, std::string a, std::string b) {
    if (a != b) changes.push_back({std::move(what), std::move(a), std::move(b)});
}

/// A figure of a window, as it is written.
struct WindowFigure {
    const char* key;
    const char* name;
    const char* unit;
    int decimals;
};

constexpr WindowFigure window_figures[] = {
    {"start_time_s", "start", "s", 3},
    {"duration_s", "duration", "s", 3},
    {"speed_m_s", "speed", "m/s", 6},
    {"standard_uncertainty_m_s", "standard uncertainty", "m/s", 6}};

std::string presence(const Json& window) {
    if (window.is_null()) return "none";
    return fmt::format("{} m/s from {} s on",
                       format_fixed(number_in(window, "speed_m_s").value_or(0.0), 6),
                       format_fixed(number_in(window, "start_time_s").value_or(0.0), 3));
}

std::string in_uncertainties(const Json& a, const Json& b, double difference_m_s) {
    const auto u_a = number_in(a, "standard_uncertainty_m_s");
    const auto u_b = number_in(b, "standard_uncertainty_m_s");
    const double expanded =
        usual_coverage_factor * std::hypot(u_a.value_or(0.0), u_b.value_or(0.0));
    if (!u_a || !u_b || !(expanded > 0.0)) return {};
    return fmt::format(", {} of the combined expanded uncertainty (k = 2)",
                       format_fixed(std::abs(difference_m_s) / expanded, 4));
}

void add_window_changes(std::vector<Change>& changes, const std::string& name, const Json& a,
                        const Json& b) {
    if (a.is_null() || b.is_null()) return add_change(changes, name, presence(a), presence(b));
    for (const WindowFigure& figure : window_figures) {
        const auto from = number_in(a, figure.key), to = number_in(b, figure.key);
        if (!from || !to || from == to) continue;
        const auto text = [&](double value) {
            return fmt::format("{} {}", format_fixed(value, figure.decimals), figure.unit);
        };
        std::string note = (*to > *from ? "+" : "") + text(*to - *from);
        if (std::string_view(figure.name) == "speed") note += in_uncertainties(a, b, *to - *from);
        changes.push_back(
            {fmt::format("{}, {}", name, figure.name), text(*from), text(*to), std::move(note)});
    }
}

std::string refusals_of(const Json& indicated) {
    if (indicated.is_null()) return "none";
    const auto refusals = indicated.value("refusals", std::vector<std::string>());
    return refusals.empty() ? "not refused" : fmt::format("refused: {}", fmt::join(refusals, "; "));
}

/// What became of the epoch at hand.
class EpochState {
  public:
    explicit EpochState(const EcsvReader& table)
        : table_(table),
          usable_(column_of(table, "usable")),
          reason_(column_of(table, "reason")),
          break_(column_of(table, "break_before")) {}

    std::string text() const {
        return (table_.boolean(usable_) ? "used" : "left out: " + table_.text(reason_)) +
               (table_.is_missing(break_) ? ""
                                          : fmt::format("; {} before it", table_.text(break_)));
    }

  private:
    const EcsvReader& table_;
    std::size_t usable_, reason_, break_;
};

}  // namespace

std::vector<Change> window_changes(const Json& a, const Json& b, const std::string& receiver) {
    std::vector<Change> changes;
    each_in_either(a, b, "profiles", "profile",
                   [&](const std::string& rule, const Json& one, const Json& other) {
                       const std::string name = rule + receiver;
                       const auto claimed = [](const Json& in) {
                           return in.is_null() ? "not claimed" : "claimed";
                       };
                       if (one.is_null() || other.is_null())
                           return add_change(changes, name, claimed(one), claimed(other));
                       for (const char* window : {"best", "indicated"})
                           add_window_changes(changes, fmt::format("{}, {} window", name, window),
                                              member_of(one, window), member_of(other, window));
                       add_change(changes, name + ", indicated window",
                                  refusals_of(member_of(one, "indicated")),
                                  refusals_of(member_of(other, "indicated")));
                   });
    return changes;
}

std::vector<Change> verdict_changes(const Json& a, const Json& b) {
    std::vector<Change> changes;
    each_in_either(a, b, "profiles", "profile",
                   [&](const std::string& rule, const Json& one, const Json& other) {
                       add_change(changes, rule + ", outcome", text_in(one, "outcome"),
                                  text_in(other, "outcome"));
                       each_in_either(
                           one, other, "requirements", "clause",
                           [&](const std::string& clause, const Json& in_a, const Json& in_b) {
                               add_change(changes, fmt::format("{}, {}", rule, clause),
                                          text_in(in_a, "status"), text_in(in_b, "status"));
                           });
                   });
    return changes;
}

EpochDifference epoch_difference(std::string_view a, std::string_view b, const std::string& where_a,
                                 const std::string& where_b) {
    JoinedTables tables(a, b, where_a, where_b);
    EpochDifference found{
        .rows_a = tables.rows_a(), .rows_b = tables.rows_b(), .joined = tables.joined()};
    const EpochState a_state(tables.a()), b_state(tables.b());
    while (tables.next())
        if (std::string one = a_state.text(), other = b_state.text(); one != other)
            found.changes.push_back({tables.row(), std::move(one), std::move(other)});
    return found;
}

}  // namespace runcert
