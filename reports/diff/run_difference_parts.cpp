#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "core/uncertainty.h"
#include "reports/diff/run_difference.h"
#include "store/ecsv.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

const Json* find(const Json& map, const std::string& key) {
    const auto found = map.find(key);
    return found == map.end() || found->is_null() ? nullptr : &*found;
}

std::string text_in(const Json& map, const std::string& key) {
    const Json* found = find(map, key);
    return found && found->is_string() ? found->get<std::string>() : "";
}

/// The entries of a list by the text that names them.
std::map<std::string, Json> by_name(const Json& document, const std::string& list,
                                    const std::string& name) {
    std::map<std::string, Json> entries;
    if (const Json* found = find(document, list))
        for (const Json& entry : *found)
            entries[text_in(entry, name)] = entry;
    return entries;
}

std::vector<std::string> names_of(const std::map<std::string, Json>& a,
                                  const std::map<std::string, Json>& b) {
    std::vector<std::string> names;
    for (const auto* entries : {&a, &b})
        for (const auto& [name, entry] : *entries)
            if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    return names;
}

/// Two windows, and what is said of them.
class WindowPair {
  public:
    WindowPair(std::string name, const Json* a, const Json* b)
        : name_(std::move(name)), a_(a), b_(b) {}

    std::vector<Change> changes() && {
        if (!a_ || !b_) {
            if (a_ || b_) changes_.push_back({name_, presence(a_), presence(b_)});
            return std::move(changes_);
        }
        number("start_time_s", "start", " s", 3);
        number("duration_s", "duration", " s", 3);
        number("speed_m_s", "speed", " m/s", 6);
        number("standard_uncertainty_m_s", "standard uncertainty", " m/s", 6);
        return std::move(changes_);
    }

  private:
    static std::string presence(const Json* window) {
        if (!window) return "none";
        return fmt::format("{} m/s from {} s on",
                           format_fixed(number_in(*window, "speed_m_s").value_or(0.0), 6),
                           format_fixed(number_in(*window, "start_time_s").value_or(0.0), 3));
    }

    void number(const char* key, const char* what, const char* unit, int decimals) {
        const auto from = number_in(*a_, key);
        const auto to = number_in(*b_, key);
        if (from == to || !from || !to) return;
        std::string note = fmt::format("{}{}", signed_text(*to - *from, decimals), unit);
        if (std::string_view(key) == "speed_m_s") note += in_uncertainties(*to - *from);
        changes_.push_back({fmt::format("{}, {}", name_, what),
                            format_fixed(*from, decimals) + unit,
                            format_fixed(*to, decimals) + unit, note});
    }

    static std::string signed_text(double value, int decimals) {
        return fmt::format("{}{}", value > 0.0 ? "+" : "", format_fixed(value, decimals));
    }

    std::string in_uncertainties(double difference_m_s) const {
        const auto u_a = number_in(*a_, "standard_uncertainty_m_s");
        const auto u_b = number_in(*b_, "standard_uncertainty_m_s");
        if (!u_a || !u_b) return {};
        const double expanded = usual_coverage_factor * std::hypot(*u_a, *u_b);
        if (!(expanded > 0.0)) return {};
        return fmt::format(", {} of the combined expanded uncertainty (k = 2)",
                           format_fixed(std::abs(difference_m_s) / expanded, 4));
    }

    std::string name_;
    const Json* a_;
    const Json* b_;
    std::vector<Change> changes_;
};

std::string refusals_of(const Json* indicated) {
    if (!indicated) return "none";
    const Json* refusals = find(*indicated, "refusals");
    std::string text;
    if (refusals)
        for (const Json& refusal : *refusals)
            text += (text.empty() ? "" : "; ") + refusal.get<std::string>();
    return text.empty() ? "not refused" : "refused: " + text;
}

/// The columns of a screened table that say what became of an epoch.
class Screening {
  public:
    Screening(std::string_view text, const std::string& where)
        : table_(text, where),
          epoch_(column("epoch")),
          time_(column("time")),
          usable_(column("usable")),
          reason_(column("reason")),
          break_(column("break_before")) {}

    void step_to(std::size_t row) {
        for (; next_ <= row; ++next_)
            (void)table_.next_row();
    }
    std::string state() const {
        std::string text = table_.boolean(usable_) ? "used" : "left out: " + table_.text(reason_);
        if (!table_.is_missing(break_)) text += fmt::format("; {} before it", table_.text(break_));
        return text;
    }
    std::int64_t epoch() const { return table_.integer(epoch_); }
    double time_s() const { return table_.real(time_); }
    std::size_t line() const { return table_.line(); }

  private:
    std::size_t column(const std::string& name) const {
        for (std::size_t i = 0; i < table_.columns().size(); ++i)
            if (table_.columns()[i].name == name) return i;
        throw Failure(table_.where(), fmt::format("the table has no column \"{}\"", name),
                      "The file is not as the program writes it; take the original");
    }

    EcsvReader table_;
    std::size_t epoch_, time_, usable_, reason_, break_;
    std::size_t next_ = 0;
};

void append(std::vector<Change>& all, std::vector<Change> some) {
    std::ranges::move(some, std::back_inserter(all));
}

}  // namespace

std::vector<Change> window_changes(const Json& a, const Json& b, const std::string& receiver) {
    const auto rules_a = by_name(a, "profiles", "profile");
    const auto rules_b = by_name(b, "profiles", "profile");
    std::vector<Change> changes;
    for (const std::string& rule : names_of(rules_a, rules_b)) {
        const std::string name = fmt::format("{}{}", rule, receiver);
        const auto in_a = rules_a.find(rule);
        const auto in_b = rules_b.find(rule);
        if (in_a == rules_a.end() || in_b == rules_b.end()) {
            changes.push_back({name, in_a == rules_a.end() ? "not claimed" : "claimed",
                               in_b == rules_b.end() ? "not claimed" : "claimed"});
            continue;
        }
        for (const char* window : {"best", "indicated"})
            append(changes, WindowPair(fmt::format("{}, {} window", name, window),
                                       find(in_a->second, window), find(in_b->second, window))
                                .changes());
        const std::string refused_a = refusals_of(find(in_a->second, "indicated"));
        const std::string refused_b = refusals_of(find(in_b->second, "indicated"));
        if (refused_a != refused_b)
            changes.push_back({name + ", indicated window", refused_a, refused_b});
    }
    return changes;
}

std::vector<Change> verdict_changes(const Json& a, const Json& b) {
    const auto rules_a = by_name(a, "profiles", "profile");
    const auto rules_b = by_name(b, "profiles", "profile");
    std::vector<Change> changes;
    const auto compare = [&](const std::string& what, const std::string& from,
                             const std::string& to) {
        if (from != to)
            changes.push_back({what, from.empty() ? "none" : from, to.empty() ? "none" : to});
    };
    for (const std::string& rule : names_of(rules_a, rules_b)) {
        const auto in_a = rules_a.find(rule);
        const auto in_b = rules_b.find(rule);
        const Json one = in_a == rules_a.end() ? Json::object() : in_a->second;
        const Json other = in_b == rules_b.end() ? Json::object() : in_b->second;
        compare(rule + ", outcome", text_in(one, "outcome"), text_in(other, "outcome"));
        const auto clauses_a = by_name(one, "requirements", "clause");
        const auto clauses_b = by_name(other, "requirements", "clause");
        const auto status = [](const std::map<std::string, Json>& clauses,
                               const std::string& clause) {
            const auto found = clauses.find(clause);
            return found == clauses.end() ? std::string() : text_in(found->second, "status");
        };
        for (const std::string& clause : names_of(clauses_a, clauses_b))
            compare(fmt::format("{}, {}", rule, clause), status(clauses_a, clause),
                    status(clauses_b, clause));
    }
    return changes;
}

EpochDifference epoch_difference(std::string_view a, std::string_view b, const std::string& where_a,
                                 const std::string& where_b) {
    const bool absolute = says_first_epoch(a, where_a) && says_first_epoch(b, where_b);
    const auto times_a = row_times(a, where_a, absolute);
    const auto times_b = row_times(b, where_b, absolute);
    const auto pairs = join_by_time(times_a, times_b);
    EpochDifference found{
        .rows_a = std::ssize(times_a), .rows_b = std::ssize(times_b), .joined = std::ssize(pairs)};
    Screening one(a, where_a);
    Screening other(b, where_b);
    for (const RowPair& pair : pairs) {
        one.step_to(pair.a);
        other.step_to(pair.b);
        if (one.state() != other.state())
            found.changes.push_back({.row = {.epoch_a = one.epoch(),
                                             .epoch_b = other.epoch(),
                                             .time_s = one.time_s(),
                                             .line_a = one.line(),
                                             .line_b = other.line()},
                                     .a = one.state(),
                                     .b = other.state()});
    }
    return found;
}

}  // namespace runcert
