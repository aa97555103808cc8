#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/day/day.h"
#include "reports/day/page_parts.h"
#include "reports/document/document_html.h"

namespace runcert {

std::string_view day_page_text(std::string_view name);

namespace {

/// Failures that stand above the rankings; the others stand below them.
constexpr std::size_t failures_above = 12;

Section counts_section(const DayResults& results) {
    const DayCounts& counts = results.counts;
    const auto marked = [](std::int64_t count, const char* sign) {
        return count > 0 ? fmt::format("{} {}", sign, counted(count)) : counted(count);
    };
    Block tally = facts({{.name = "Attempts", .value = counted(counts.attempts)},
                         {.name = "Processed", .value = counted(counts.done)},
                         {.name = "Failed", .value = marked(counts.failed, "⚠")}},
                        {}, "narrow");
    if (counts.not_processed > 0) add_fact(tally, "Left out", counted(counts.not_processed));
    add_fact(tally, "Above a record", marked(counts.beaten, "✓"));
    Section section{.anchor = "counts", .blocks = {std::move(tally)}};
    if (!results.profiles.empty())
        add(section, paragraph("Ranked by outcome (above the record, not proven, not beaten, not "
                               "certifiable), then by speed, then by uncertainty. Ranks marked ≈ "
                               "cannot be separated: their speeds differ by less than the expanded "
                               "uncertainty of the difference, √(U₁² + U₂²) (JCGM 100:2008, "
                               "5.1.2).",
                               "note"));
    return section;
}

void add_failure(Block& failures, const AttemptResult& attempt) {
    const DayFailure failure = attempt.failure.value_or(DayFailure{});
    TableRow& row = add_row(
        failures, {"⚠ " + attempt.id, attempt.source, failure.step, sentence(failure.problem)},
        "refused");
    if (!failure.where.empty()) row.further.push_back("Where: " + failure.where);
    if (!failure.remedy.empty()) row.further.push_back("What to do: " + sentence(failure.remedy));
    row.further.insert(row.further.end(), attempt.notes.begin(), attempt.notes.end());
}

/// What failed: above the rankings, and below where it is too much for a page's beginning.
struct Failures {
    Block above = table({"Attempt|22", "From|22", "Step|12", "What is wrong|44"});
    Block below = above;
};

Failures failures_of(const DayResults& results) {
    Failures failures;
    for (const AttemptResult& attempt : results.attempts)
        if (attempt.state == "failed")
            add_failure(
                failures.above.rows.size() < failures_above ? failures.above : failures.below,
                attempt);
    return failures;
}

/// Adds a section of one block, where that holds something.
void add_if_any(Document& page, const char* anchor, const char* title, Block block) {
    if (!block.rows.empty() || !block.items.empty())
        page.sections.push_back({.anchor = anchor, .title = title, .blocks = {std::move(block)}});
}

void add_failed(Document& page, const Failures& failures) {
    add_if_any(page, "failures", "What could not be processed", failures.above);
    if (const std::int64_t more = std::ssize(failures.below.rows); more > 0)
        add(page.sections.back(),
            paragraph(fmt::format("{} more stand below the rankings.", counted(more)), "strong"));
}

Block left_out_of(const DayResults& results) {
    Block left_out = table({"Attempt|22", "From|30", "Why|48"});
    for (const AttemptResult& attempt : results.attempts)
        if (attempt.state == "not_processed")
            add_row(left_out, {attempt.id, attempt.source, attempt.reason});
    return left_out;
}

/// Notes of the day, and of the attempts that are done.
Block notes_of(const DayResults& results) {
    Block notes = list_of({});
    for (const std::string& text : results.notes)
        notes.items.push_back(sentence(text));
    for (const AttemptResult& attempt : results.attempts)
        if (attempt.state != "failed")
            for (const std::string& text : attempt.notes)
                notes.items.push_back(fmt::format("{}: {}", attempt.id, sentence(text)));
    return notes;
}

Section made_from(const Header& header) {
    Block made = facts({}, {}, "narrow");
    add_fact(made, "Made by",
             fmt::format("runcert-{} {}, source {}", header.stage, header.program_version,
                         header.source_revision));
    add_fact(made, "Figures", "day.yaml", "day.yaml");
    add_fact(made, "For spreadsheets", "day.csv", "day.csv");
    Section section{.anchor = "made-from", .title = "What this was made from"};
    add(section, {std::move(made),
                  paragraph("This page is a list, not a certificate: what certifies an attempt is "
                            "its report, which `runcert verify` checks.",
                            "note")});
    Block files = table({"File|40", "SHA-256|60"}, "Files that were read", "small");
    for (const InputFile& input : header.inputs)
        add_row(files, {input.file, input.sha256}).link = input.file;
    if (!files.rows.empty()) add(section, std::move(files));
    return section;
}

}  // namespace

std::string day_page(const DayResults& results, const WindowCurves& curves) {
    Document page{.title = results.day, .subtitle = "Results of the day"};
    PageParts parts;
    page.sections.push_back(counts_section(results));
    const Failures failures = failures_of(results);
    add_failed(page, failures);
    const AttemptsById attempts = attempts_by_id(results);
    for (const DayProfile& profile : results.profiles) {
        RankingPart rule = ranking_part(profile, attempts, curves, parts.plots.size());
        page.sections.push_back(std::move(rule.section));
        std::ranges::move(rule.plots, std::back_inserter(parts.plots));
    }
    add_if_any(page, "more-failures", "What else could not be processed", failures.below);
    add_if_any(page, "left-out", "Left out", left_out_of(results));
    add_if_any(page, "notes", "Notes", notes_of(results));
    page.sections.push_back(made_from(results.header));
    parts.style =
        std::string(day_page_text("page.css")) + std::string(day_page_text("template/day.css"));
    for (const char* name : {"elements.js", "tables.js", "template/day.js"})
        parts.script += std::string(day_page_text(name)) + "\n";
    return document_page(page, parts);
}

}  // namespace runcert
