#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

/// Where the witness's own words end.
std::string witness_text(const WitnessedSpeed& one, const RuleView& rule) {
    const SpeedUnit& unit = rule.unit();
    const auto uncertainty = [&](double uncertainty_m_s) {
        return fmt::format("{} {}", uncertainty_text(uncertainty_m_s * unit.per_m_s), unit.name);
    };
    const SpeedsToShow other{
        .speed_m_s = one.speed_m_s,
        .expanded_uncertainty_m_s = rule.verdict.coverage_factor * one.standard_uncertainty_m_s};
    const ComparedSpeeds shown =
        compared_in(unit, other, one.speed_m_s + one.difference_m_s, rule.shown());
    return fmt::format(
        "{}{}, {} against the positions; the two {} (normalised error {:.2f}, at most 1){}",
        shown.other,
        one.compared_over_s ? fmt::format(" over {:.1f} s around the window", *one.compared_over_s)
                            : std::string(),
        shown.difference, contradicts(one) ? "contradict one another" : "agree",
        one.normalised_error,
        one.confirms ? fmt::format(". Beside it errors of the positions of any kind change the "
                                   "speed by {} at most (k = 2)",
                                   uncertainty(largest_error_beside(one)))
                     : std::string());
}

std::string began_words(RunEdge began) {
    const char* preposition = began == RunEdge::recording  ? "with"
                              : began == RunEdge::standing ? "from"
                                                           : "after";
    return fmt::format("{} {}", preposition, words_of(began));
}

std::string ended_words(RunEdge ended) {
    return fmt::format("{} {}", ended == RunEdge::recording ? "with" : "at", words_of(ended));
}

bool holds(const WindowSpan& run, const std::optional<WindowSpan>& window) {
    const auto end_ns = [](const WindowSpan& span) {
        return span.start.nanoseconds + span.duration.nanoseconds;
    };
    return window && run.start.nanoseconds <= window->start.nanoseconds &&
           end_ns(*window) <= end_ns(run);
}

/// The runs that several rules cut alike.
Block runs_table(const std::vector<RuleView>& rules, bool named) {
    const SpeedUnit& unit = rules.front().unit();
    std::vector<std::string> names;
    for (const RuleView& rule : rules)
        names.push_back(fmt::format("“{}”", rule.profile.id));
    Block block = table({">Run|7", ">Begins at|12", ">Time|12", ">Path|12", ">Largest speed|16",
                         ">Direction|12", "How it begins and ends|29"},
                        "Runs of the craft" + (named ? ": rule " + listed(names) : ""));
    std::int64_t number = 0;
    for (const RunSummary& run : rules.front().verdict.runs) {
        std::vector<std::string> windows;
        for (std::size_t i = 0; i < rules.size(); ++i)
            if (holds(run.span, rules[i].verdict.window)) windows.push_back(names[i]);
        const std::string held =
            windows.empty()
                ? ""
                : "; holds the window" + (rules.front().several ? " of " + listed(windows) : "");
        add_row(block,
                {counted(++number), seconds_text(run.span.start), seconds_text(run.span.duration),
                 format_fixed(run.length_m, 1) + " m",
                 fmt::format("{} {}", speed_text(run.top_speed_m_s, std::nullopt, unit), unit.name),
                 format_fixed(run.heading_deg, 1) + "°",
                 fmt::format("begins {}, ends {}{}", began_words(run.began), ended_words(run.ended),
                             held)},
                windows.empty() ? "" : "chosen");
    }
    return block;
}

}  // namespace

std::vector<Block> witness_blocks(const std::vector<RuleView>& rules) {
    Block list = facts({}, "What witnesses say of the speed");
    for (const RuleView& rule : rules) {
        if (rule.best() == nullptr) continue;
        for (const WitnessedSpeed& one : rule.best()->witnesses) {
            const std::string witness =
                one.receiver.empty() ? std::string(words_of(one.kind))
                                     : fmt::format("positions of receiver “{}”", one.receiver);
            add_fact(list,
                     rule.several ? fmt::format("“{}”: {}", rule.profile.id, witness)
                                  : capitalised(witness),
                     witness_text(one, rule));
        }
    }
    return list.facts.empty() ? std::vector<Block>() : std::vector<Block>{std::move(list)};
}

std::vector<Block> run_blocks(const std::vector<RuleView>& rules) {
    std::vector<Block> blocks;
    std::vector<std::vector<RuleView>> alike;
    for (const RuleView& rule : rules) {
        if (rule.verdict.runs.empty()) continue;
        const auto same = std::ranges::find_if(alike, [&](const std::vector<RuleView>& group) {
            return group.front().verdict.runs == rule.verdict.runs &&
                   group.front().unit().name == rule.unit().name;
        });
        if (same == alike.end())
            alike.push_back({rule});
        else
            same->push_back(rule);
    }
    for (const std::vector<RuleView>& group : alike)
        blocks.push_back(runs_table(group, alike.size() > 1));
    return blocks;
}

std::vector<Block> course_blocks(const std::vector<RuleView>& rules) {
    Block block = table(
        {"From the data|38", "Figure ± expanded uncertainty (k = 2)|26", "Where it comes from|36"},
        "Course and craft");
    // What several rules have alike is one row.
    std::vector<std::pair<const Figure*, std::vector<std::string>>> found;
    const auto behind = [&](const std::string& name) {
        const auto last = std::find_if(found.rbegin(), found.rend(),
                                       [&](const auto& one) { return one.first->name == name; });
        return last == found.rend() ? found.end() : last.base();
    };
    for (const RuleView& rule : rules)
        for (const Figure& figure : rule.verdict.course) {
            auto same = std::ranges::find_if(found, [&](const auto& one) {
                return one.first->name == figure.name && one.first->note == figure.note &&
                       figure_value_text(*one.first) == figure_value_text(figure);
            });
            if (same == found.end()) same = found.insert(behind(figure.name), {&figure, {}});
            same->second.push_back(fmt::format("“{}”", rule.profile.id));
        }
    for (const auto& [figure, of] : found)
        add_row(block, {of.size() == rules.size()
                            ? figure->name
                            : fmt::format("{}: {}", figure->name, fmt::join(of, ", ")),
                        figure_value_text(*figure), figure->note});
    return block.rows.empty() ? std::vector<Block>() : std::vector<Block>{std::move(block)};
}

}  // namespace runcert
