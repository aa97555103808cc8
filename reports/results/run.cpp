#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

std::string quoted(const RuleView& rule) {
    return fmt::format("“{}”", rule.profile.id);
}

/// Where the witness's own words end.
std::string witness_text(const WitnessedSpeed& one, const RuleView& rule) {
    const SpeedsToShow other{
        .speed_m_s = one.speed_m_s,
        .expanded_uncertainty_m_s = rule.verdict.coverage_factor * one.standard_uncertainty_m_s};
    const ComparedSpeeds shown =
        compared_in(rule.unit(), other, one.speed_m_s + one.difference_m_s, rule.shown());
    return fmt::format(
        "{}{}, {} against the positions; the two {} (normalised error {:.2f}, at most 1){}",
        shown.other,
        one.compared_over_s ? fmt::format(" over {:.1f} s around the window", *one.compared_over_s)
                            : "",
        shown.difference, contradicts(one) ? "contradict one another" : "agree",
        one.normalised_error,
        one.confirms ? fmt::format(". Beside it errors of the positions of any kind change the "
                                   "speed by {} at most (k = 2)",
                                   rule.uncertainty_text(largest_error_given(one)))
                     : "");
}

bool lies_in(const std::optional<WindowSpan>& window, const WindowSpan& run) {
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
        names.push_back(quoted(rule));
    Block block = table({">Run|7", ">Begins at|12", ">Time|12", ">Path|12", ">Largest speed|15",
                         ">Direction|14", "How it begins and ends|28"},
                        "Runs of the craft" + (named ? ": rule " + listed(names) : ""));
    for (const RunSummary& run : rules.front().verdict.runs) {
        std::vector<std::string> holds;
        for (std::size_t i = 0; i < rules.size(); ++i)
            if (lies_in(rules[i].verdict.window, run.span)) holds.push_back(names[i]);
        add_row(
            block,
            {counted(std::ssize(block.rows) + 1), seconds_text(run.span.start),
             seconds_text(run.span.duration), format_fixed(run.length_m, 1) + " m",
             fmt::format("{} {}", speed_text(run.top_speed_m_s, std::nullopt, unit), unit.name),
             format_fixed(run.heading_deg, 1) + "°",
             fmt::format("begins {} {}, ends {} {}{}{}",
                         run.began == RunEdge::recording  ? "with"
                         : run.began == RunEdge::standing ? "from"
                                                          : "after",
                         words_of(run.began), run.ended == RunEdge::recording ? "with" : "at",
                         words_of(run.ended), holds.empty() ? "" : "; holds the window",
                         rules.front().several && !holds.empty() ? " of " + listed(holds) : "")},
            holds.empty() ? "" : "chosen");
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
            add_fact(
                list,
                rule.several ? fmt::format("{}: {}", quoted(rule), witness) : capitalised(witness),
                witness_text(one, rule));
        }
    }
    return list.facts.empty() ? std::vector<Block>() : std::vector<Block>{std::move(list)};
}

std::vector<Block> run_blocks(const std::vector<RuleView>& rules) {
    std::vector<RuleView> cut;
    std::ranges::copy_if(rules, std::back_inserter(cut),
                         [](const RuleView& rule) { return !rule.verdict.runs.empty(); });
    const auto groups = grouped(cut, [](const RuleView& a, const RuleView& b) {
        return a.verdict.runs == b.verdict.runs && a.unit().name == b.unit().name;
    });
    std::vector<Block> blocks;
    for (const std::vector<RuleView>& group : groups)
        blocks.push_back(runs_table(group, groups.size() > 1));
    return blocks;
}

std::vector<Block> course_blocks(const std::vector<RuleView>& rules) {
    Block block = table(
        {"From the data|38", "Figure ± expanded uncertainty (k = 2)|26", "Where it comes from|36"},
        "Course and craft");
    // What several rules have alike is one row; rows of one name stand together.
    std::vector<std::pair<const Figure*, std::vector<std::string>>> found;
    for (const RuleView& rule : rules)
        for (const Figure& figure : rule.verdict.course) {
            auto same = std::ranges::find_if(found, [&](const auto& one) {
                return one.first->name == figure.name && one.first->note == figure.note &&
                       figure_value_text(*one.first) == figure_value_text(figure);
            });
            if (same == found.end()) same = found.insert(same, {&figure, {}});
            same->second.push_back(quoted(rule));
        }
    for (const auto& of_name :
         grouped(found, [](const auto&a, const auto&b) { return a.first->name == b.first->name; }))
        for (const auto& [figure, of] : of_name)
            add_row(block, {of.size() == rules.size()
                                ? figure->name
                                : fmt::format("{}: {}", figure->name, fmt::join(of, ", ")),
                            figure_value_text(*figure), figure->note});
    return block.rows.empty() ? std::vector<Block>() : std::vector<Block>{std::move(block)};
}

}  // namespace runcert
