#include "reports/certificate/json_screening.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_facts.h"
#include "reports/certificate/json_screening_basis.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

double longest_arc_s(const std::vector<ScreenedEpoch>& rows) {
    std::map<std::int64_t, std::pair<ElapsedTime, ElapsedTime>> ends;
    for (const ScreenedEpoch& row : rows)
        if (row.arc) ends.try_emplace(*row.arc, row.time, row.time).first->second.second = row.time;
    double longest = 0.0;
    for (const auto& [arc, times] : ends)
        longest = std::max(longest, times.second.seconds() - times.first.seconds());
    return longest;
}

/// What was decided for, as a noun that can be counted.
struct Noun {
    std::string one;
    std::string several;
};

Noun decided_for(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::outlier:
            return {"single outlier", "single outliers"};
        case Hypothesis::burst:
            return {"position in a run of wrong ones", "positions in runs of wrong ones"};
        case Hypothesis::step:
            return {"step of the positions", "steps of the positions"};
        case Hypothesis::ramp:
            return {"drift of the positions", "drifts of the positions"};
        case Hypothesis::time_shift:
            return {"jump of the time stamps", "jumps of the time stamps"};
        case Hypothesis::model:
            return {"position in a stretch that no single error explains",
                    "positions in stretches that no single error explains"};
        case Hypothesis::velocity:
            return {"position that the recorded velocity contradicts",
                    "positions that the recorded velocities contradict"};
        case Hypothesis::acceleration:
            return {"acceleration that the craft cannot make",
                    "accelerations that the craft cannot make"};
        case Hypothesis::jerk:
            return {"jerk that the craft cannot make", "jerks that the craft cannot make"};
        case Hypothesis::vertical_rate:
            return {"vertical rate that the craft cannot make",
                    "vertical rates that the craft cannot make"};
        case Hypothesis::baseline:
            return {"position that the other receiver contradicts",
                    "positions that the other receiver contradicts"};
        default:
            break;
    }
    const auto witness = witness_of(hypothesis);
    return {fmt::format("position that the {} contradict", witness.at(0)),
            fmt::format("positions that the {} contradict", witness.at(0))};
}

std::string decisions_text(const ScreeningSummary& summary) {
    std::string text;
    for (const auto& [hypothesis, count] : summary.decisions) {
        const Noun noun = decided_for(hypothesis);
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count,
                            count == 1 ? noun.one : noun.several);
    }
    return text.empty() ? "nothing" : text;
}

std::string used_text(const ScreenedTable& table, const ScreeningSummary& summary) {
    std::string used = fmt::format("{} of {}", summary.usable, table.rows.size());
    if (summary.arcs == 0) return used;
    const std::string longest = format_fixed(longest_arc_s(table.rows), 3);
    if (summary.arcs == 1) return fmt::format("{}, in one arc, of {} s", used, longest);
    return fmt::format("{}, in {} arcs, the longest of {} s", used, summary.arcs, longest);
}

}  // namespace

Json screening_json(const ScreenedTable& table) {
    const ScreeningSummary summary = summarise(table.rows);
    Json json{{"epochs", table.rows.size()},
              {"usable", summary.usable},
              {"arcs", summary.arcs},
              {"longest_arc_s", rounded(longest_arc_s(table.rows), 9)},
              {"variance_factor", rounded(table.variance_factor, 4)},
              {"reasons", Json::array()}};
    for (const auto& [reason, count] : summary.reasons)
        json["reasons"].push_back({{"reason", to_text(reason)},
                                   {"words", reason == Reason::none ? "used" : words_of(reason)},
                                   {"count", count}});
    json["decisions"] = Json::array();
    for (const auto& [hypothesis, count] : summary.decisions)
        json["decisions"].push_back({{"hypothesis", to_text(hypothesis)},
                                     {"words", decided_for(hypothesis).one},
                                     {"count", count}});
    json["basis"] = screening_basis_json(table.basis);
    return json;
}

Json screening_facts(const ScreenedTable& table) {
    const ScreeningSummary summary = summarise(table.rows);
    Json facts = Json::array();
    facts.push_back(fact("Epochs used", used_text(table, summary)));
    facts.push_back(fact("Decided by the tests", decisions_text(summary)));
    for (Json& line : screening_basis_facts(table.basis))
        facts.push_back(std::move(line));
    return facts;
}

}  // namespace runcert
