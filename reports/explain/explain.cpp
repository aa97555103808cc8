#include "reports/explain/explain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "core/failure.h"
#include "core/text.h"
#include "reports/results/results.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

std::string full_name(const RuleView& rule, std::string_view clause) {
    return fmt::format("{}/{}", rule.verdict.profile, clause);
}

std::string window_complete_words(const Profile& profile) {
    return fmt::format(
        "Every stretch of {}, {}, is looked at. Those that hold a break of the recording or an "
        "epoch that screening left out are passed over. Met where {} the speed. No uncertainty "
        "enters.",
        window_words(profile),
        profile.window_kind == WindowKind::course ? "from one line to the other"
        : profile.ends == WindowEnds::any         ? "beginning and ending at any instant"
                                                  : "beginning and ending at measured epochs",
        profile.windows == 1 ? "one is left: the fastest gives"
                             : fmt::format("{} that do not overlap are left: the fastest give",
                                           counted(profile.windows, "stretch")));
}

/// How a computation makes its figure and compares it.
std::string how(const RuleView& rule, Computation computation) {
    const Profile& profile = rule.profile;
    if (computation == Computation::window_complete) return window_complete_words(profile);
    if (computation == Computation::accuracy)
        return fmt::format(
            "The expanded uncertainty of the speed is {:.3g} times the combined standard "
            "uncertainty of its budget. What choosing the fastest window may have left in the "
            "speed is added. The factor is the rule's k = {:.3g}, or more where the budget has few "
            "degrees of freedom. Met where it is at most the limit.",
            rule.verdict.coverage_factor, profile.coverage_factor);
    if (computation == Computation::margin)
        return fmt::format(
            "The required speed is {}; {}. From the speed and its standard uncertainty, the "
            "record's own taken in where it has one, follows the probability that the true speed "
            "reaches it. Met where that is at least {}: this is the decision itself, which "
            "`decision` explains.",
            margin_words(profile), rounding_words(profile),
            level_text(profile.decision_probability));
    std::string words(words_of(computation));
    const ClauseLimit limit = limit_of(computation);
    // Its own words say when it is met: below its limit nothing is refused.
    if (!limit.units.empty() && computation != Computation::least_speed)
        words += fmt::format(
            " Met where it is {0} the limit with all of its expanded uncertainty, not met where it "
            "is {1} the limit with all of it. In between the recording does not decide it, and an "
            "official must attest it.",
            limit.at_most ? "at most" : "at least", limit.at_most ? "above" : "below");
    if (computation == Computation::opposite_runs && profile.opposite_runs_within_s)
        words += fmt::format(" Met where both lie within {}.",
                             number_text(*profile.opposite_runs_within_s, "s"));
    return words;
}

std::string certainty_words(Certainty certainty, RuleOrigin origin) {
    if (certainty == Certainty::secondary)
        return "The rule text was unavailable; the wording is from a secondary source. Compare it "
               "with the body's text before relying on it.";
    if (certainty == Certainty::unconfirmed)
        return "It could not be confirmed that the rule has this clause, or that it says so: ask "
               "the body.";
    return origin == RuleOrigin::own
               ? "The attempt's own rule says so; nobody checked whether a body's does."
               : "These are the rule's own words, or this program's own rule.";
}

/// The figures of a profile, as an attempt names them, on which a clause hangs.
std::vector<std::string> figures_behind(const Requirement& requirement) {
    switch (requirement.decided_by) {
        case Computation::window_complete:
            return {"window.duration_s", "window.distance_m"};
        case Computation::accuracy:
            return {"accuracy.limit", "accuracy.coverage_factor"};
        case Computation::margin:
            return {"margin.value", "decision.probability"};
        case Computation::opposite_runs:
            return {"opposite_runs.within_s"};
        default:
            return {fmt::format("clauses.{}.limit", requirement.clause)};
    }
}

/// What the computation compared with, "1 m"; empty where it takes no limit.
std::string limit_words(const Profile& profile, const Requirement& requirement) {
    if (requirement.decided_by == Computation::accuracy && profile.accuracy_limit_m_s)
        return number_text(*profile.accuracy_limit_m_s / metres_per_second(profile.accuracy_unit),
                           profile.accuracy_unit);
    const auto clause = std::ranges::find(profile.clauses, requirement.clause, &Clause::id);
    return clause != profile.clauses.end() && clause->limit
               ? number_text(*clause->limit, clause->unit)
               : "";
}

/// Who answered for a clause, and what.
std::vector<std::string> explanations_of(const std::string& name, const ExplainOptions& options) {
    const auto found = options.answers.find(name);
    return found == options.answers.end() ? std::vector<std::string>() : found->second;
}

/// A clause in full: text, source, computation, figures, limit, outcome.
Section clause_section(const RuleView& rule, const Requirement& requirement,
                       const ExplainOptions& options) {
    const Computation computation = requirement.decided_by;
    const std::string name = full_name(rule, requirement.clause);
    const bool attest = requirement.status == RequirementStatus::attest;
    Block block = facts(
        {{"The rule", requirement.text},
         {"Its source", fmt::format("{} {}", sentence(source_text(requirement)),
                                    certainty_words(requirement.certainty, rule.profile.origin))},
         {"Decided by",
          computation == Computation::attest
              ? std::string(words_of(computation))
              : fmt::format("{}. {}", to_text(computation), how(rule, computation))}});
    for (const Figure& figure : requirement.figures)
        add_fact(block, "Figure", sentence(figure_text(figure)));
    add_fact(block, "Limit", limit_words(rule.profile, requirement));
    for (std::string& words : override_words(rule.verdict, figures_behind(requirement)))
        add_fact(block, "Replaced", std::move(words));
    add_fact(
        block, "Outcome",
        fmt::format("{}. {}", attest ? "To be attested" : capitalised(words_of(requirement.status)),
                    sentence(requirement.evidence)));
    if (attest) add_fact(block, "To do", std::string(phrase_of(computation)));
    if (requirement.answered_by)
        add_fact(block, "Answered by",
                 fmt::format("{} in the role {}", requirement.answered_by->count,
                             requirement.answered_by->role));
    for (std::string& answer : explanations_of(name, options))
        add_fact(block, "Answer", std::move(answer));
    return {.anchor = name,
            .title = fmt::format("{}: {}", name, upper_case(words_of(requirement.status))),
            .blocks = {std::move(block)}};
}

std::vector<RuleView> views_of(const Attempt& attempt, const Verdict& verdict,
                               const std::vector<Profile>& profiles,
                               const ExplainOptions& options) {
    const std::string& wanted = options.profile;
    std::vector<RuleView> views;
    std::vector<std::string_view> known;
    for (const ProfileVerdict& entry : verdict.profiles) {
        known.push_back(entry.profile);
        if (!wanted.empty() && entry.profile != wanted) continue;
        const auto profile = std::ranges::find(profiles, entry.profile, &Profile::id);
        if (profile == profiles.end())
            throw Failure(std::string(products::verdict_file),
                          fmt::format("the verdict is by the profile {}, which the attempt does "
                                      "not claim",
                                      escape_for_message(entry.profile)),
                          "Run the stages again, or `runcert certify`");
        views.push_back({attempt, entry, *profile, windows_of(options.windows, entry.profile)});
    }
    if (views.empty())
        throw Failure("--profile",
                      fmt::format("the verdict has no profile \"{}\"", escape_for_message(wanted)),
                      fmt::format("Use one of: {}", fmt::join(known, ", ")));
    return views;
}

[[noreturn]] void refuse_clause(const std::vector<RuleView>& views, const std::string& clause) {
    std::vector<std::string> known{"outcome", "decision"};
    for (const RuleView& view : views)
        for (const Requirement& requirement : view.verdict.requirements)
            known.push_back(full_name(view, requirement.clause));
    std::vector<std::string_view> candidates;
    for (const std::string& name : known) {
        candidates.push_back(name);
        candidates.push_back(std::string_view(name).substr(name.find('/') + 1));
    }
    throw Failure("CLAUSE",
                  fmt::format("the verdict has no clause \"{}\"", escape_for_message(clause)),
                  fmt::format("Did you mean {}? There are: {}", nearest(clause, candidates),
                              fmt::join(known, ", ")));
}

/// How a rule was decided: in short with each of its clauses, or in full.
Section decision_section(const RuleView& view, const ExplainOptions& options, bool in_short) {
    const ProfileVerdict& verdict = view.verdict;
    Section section{
        .anchor = verdict.profile,
        .title = fmt::format("{}: {}, {}", verdict.profile, verdict.title, verdict.body)};
    add(section, outcome_facts(verdict, options.vouched_by));
    add(section, verdict_blocks(view, Level::page, in_short ? Level::page : Level::record));
    add(section, refused_blocks(view));
    if (!in_short) return section;
    Block clauses = requirement_rows(verdict, Level::annex);
    for (TableRow& row : clauses.rows)
        std::ranges::move(explanations_of(full_name(view, row.clause), options),
                          std::back_inserter(row.further));
    add(section, std::move(clauses));
    return section;
}

std::vector<Section> one_clause(const std::vector<RuleView>& views, const ExplainOptions& options) {
    std::vector<Section> sections;
    for (const RuleView& view : views) {
        const auto is_asked = [&](const std::string& name) {
            return options.clause == name || options.clause == full_name(view, name);
        };
        if (is_asked("outcome") || is_asked("decision"))
            sections.push_back(decision_section(view, options, false));
        for (const Requirement& requirement : view.verdict.requirements)
            if (is_asked(requirement.clause))
                sections.push_back(clause_section(view, requirement, options));
    }
    if (sections.empty()) refuse_clause(views, options.clause);
    return sections;
}

}  // namespace

Document explained(const Attempt& attempt, const Verdict& verdict,
                   const std::vector<Profile>& profiles, const ExplainOptions& options) {
    Document document{.title = fmt::format("Verdict on the attempt {}", verdict.attempt)};
    const std::vector<RuleView> views = views_of(attempt, verdict, profiles, options);
    if (!options.clause.empty()) {
        document.sections = one_clause(views, options);
        return document;
    }
    for (const RuleView& view : views)
        document.sections.push_back(decision_section(view, options, true));
    if (Block block = origin_facts(verdict.origins); !block.facts.empty())
        document.sections.push_back(
            {.anchor = "origins", .title = "Who says what", .blocks = {std::move(block)}});
    const RuleView& first = views.front();
    const auto& requirements = first.verdict.requirements;
    const std::string clause =
        requirements.empty()
            ? "CLAUSE"
            : shell_word(plain_text(full_name(first, requirements.front().clause)));
    document.sections.push_back(
        {.anchor = "further",
         .title = "In full",
         .blocks = {facts({{"One clause", "runcert explain RUN_DIR " + clause},
                           {"The decision", "runcert explain RUN_DIR decision"}})}});
    return document;
}

}  // namespace runcert
