#include "reports/explain/explain.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <iterator>

#include "core/failure.h"
#include "core/text.h"
#include "reports/explain/parts.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

/// A clause of this program's own, and who answers for it.
std::string with_role(const Clause& own) {
    return fmt::format("{} ({})", own.id, own.answered_by.role);
}

/// The clause of this program's own that the computation decides, or what a rule's is about.
std::string clause_by(const std::string& computation) {
    for (const Clause& own : own_clauses())
        if (to_text(own.decided_by) == computation) return with_role(own);
    return fmt::format("the rule's by `{}`", computation);
}

std::string answered_in(const FieldOrigin& origin) {
    std::vector<std::string> clauses;
    for (const std::string& computation : origin.decides)
        clauses.push_back(clause_by(computation));
    for (const Clause& own : own_clauses())
        if (own.id == origin.clause)
            clauses.push_back((clauses.empty() ? "" : "else ") + with_role(own));
    return fmt::format("{}", fmt::join(clauses, ", "));
}

/// What a rule averages over.
std::string measures_words(const Profile& profile) {
    if (profile.evidence) return "Evidence, asked under every other rule of the attempt.";
    return fmt::format("Speed over {}{}.", window_words(profile),
                       profile.windows == 1 ? "" : fmt::format(", mean of {}", profile.windows));
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

ClauseView clause_view(const RuleView& view, const ExplainOptions& options,
                       const Requirement& requirement) {
    const auto clause = std::ranges::find(view.profile.clauses, requirement.clause, &Clause::id);
    return {view, options, requirement, clause == view.profile.clauses.end() ? nullptr : &*clause};
}

std::string full_name(const RuleView& view, std::string_view clause) {
    return fmt::format("{}/{}", view.verdict.profile, clause);
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

bool is_decision(const RuleView& view, const std::string& name) {
    return std::ranges::any_of(
        std::array<std::string_view, 2>{"outcome", "decision"},
        [&](std::string_view word) { return name == word || name == full_name(view, word); });
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
    for (std::size_t i = 0; i < clauses.rows.size(); ++i)
        std::ranges::move(clause_view(view, options, verdict.requirements[i]).answers(),
                          std::back_inserter(clauses.rows[i].further));
    add(section, std::move(clauses));
    return section;
}

std::vector<Section> one_clause(const std::vector<RuleView>& views, const ExplainOptions& options) {
    const std::string& name = options.clause;
    std::vector<Section> sections;
    for (const RuleView& view : views) {
        if (is_decision(view, name)) sections.push_back(decision_section(view, options, false));
        for (const Requirement& requirement : view.verdict.requirements)
            if (requirement.clause == name || full_name(view, requirement.clause) == name)
                sections.push_back(clause_section(clause_view(view, options, requirement)));
    }
    if (sections.empty()) refuse_clause(views, name);
    return sections;
}

/// How to read on.
Section further_section(const RuleView& first) {
    const auto& requirements = first.verdict.requirements;
    return {.anchor = "further",
            .title = "In full",
            .blocks = {
                facts({{"One clause", fmt::format("runcert explain RUN_DIR {}",
                                                  requirements.empty()
                                                      ? "CLAUSE"
                                                      : shell_word(plain_text(full_name(
                                                            first, requirements.front().clause))))},
                       {"The decision", "runcert explain RUN_DIR decision"}})}};
}

}  // namespace

std::string inputs_table_text() {
    std::string text =
        "| input | origin | can change | answered for in (by) |\n|---|---|---|---|\n";
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (!rule.origin || rule.origin->changes.empty()) continue;
        std::string origin = rule.origin->origin;
        std::ranges::replace(origin, '_', ' ');
        text += fmt::format("| `{}` | {} | {} | {} |\n", rule.path, origin,
                            fmt::join(rule.origin->changes, ", "), answered_in(*rule.origin));
    }
    return text;
}

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
    if (Block told = origin_facts(verdict.origins); !told.facts.empty())
        document.sections.push_back(
            {.anchor = "origins", .title = "Who says what", .blocks = {std::move(told)}});
    document.sections.push_back(further_section(views.front()));
    return document;
}

Document profiles_document(const std::vector<Profile>& profiles) {
    Block rules = table({"", ""});
    for (const Profile& profile : profiles) {
        TableRow& row = add_row(rules, {profile.id, sentence(profile.title)});
        row.further = {sentence(profile.body), measures_words(profile)};
        const auto add_line = [&](std::string_view what, const std::string& value) {
            if (!value.empty()) row.further.push_back(fmt::format("{} {}.", what, value));
        };
        add_line("Texts looked at until", profile.looked_at);
        add_line("For runs from", profile.valid_from);
        add_line("Superseded by", profile.superseded_by);
    }
    return {.title = "Rules that come with the program",
            .sections = {{.anchor = "rules", .blocks = {std::move(rules)}}}};
}

std::string citations_text(const std::vector<Profile>& profiles) {
    std::string text =
        "| rule | clause | source | edition | where | certainty | decided by |\n"
        "|---|---|---|---|---|---|---|\n";
    const auto add = [&](std::string_view rule, const Clause& clause) {
        text += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", rule, clause.id,
                            clause.source, clause.edition, clause.where, to_text(clause.certainty),
                            to_text(clause.decided_by));
    };
    for (const Profile& profile : profiles) {
        for (const Clause& clause : profile.clauses)
            add(profile.id, clause);
        for (const RuleQuestion& question : profile.questions)
            text += fmt::format("| {} | {} | {} | | | not known | question for the body |\n",
                                profile.id, question.id, question.source);
    }
    for (const Clause& own : own_clauses())
        add("every rule", own);
    return text;
}

}  // namespace runcert
