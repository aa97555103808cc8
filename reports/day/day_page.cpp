#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/day/day.h"
#include "reports/day/page_parts.h"
#include "store/base64.h"
#include "store/sha256.h"

namespace runcert {

std::string_view day_page_text(std::string_view name);

namespace {

/// Failures that are seen at once; the others are folded away.
constexpr std::size_t failures_shown = 12;

TemplateData failure_data(const AttemptResult& attempt) {
    const DayFailure failure = attempt.failure.value_or(DayFailure{});
    TemplateData data = template_map();
    set_text(data, "id", attempt.id);
    set_text(data, "source", attempt.source);
    set_text(data, "step", failure.step);
    set_text(data, "problem", failure.problem);
    set_text(data, "where", failure.where);
    set_text(data, "remedy", failure.remedy);
    data.set("notes", texts_of(attempt.notes));
    return data;
}

void set_failures(TemplateData& data, const DayResults& results) {
    TemplateData first = template_list();
    TemplateData more = template_list();
    std::size_t count = 0;
    for (const AttemptResult& attempt : results.attempts)
        if (attempt.state == "failed")
            (count++ < failures_shown ? first : more).push_back(failure_data(attempt));
    set_list(data, "failures", first, count > 0);
    set_list(data, "more_failures", more, count > failures_shown);
    set_text(
        data, "more_count",
        counted(static_cast<std::int64_t>(count > failures_shown ? count - failures_shown : 0)));
}

void set_counts(TemplateData& data, const DayCounts& counts) {
    const auto set = [&](const std::string& name, std::int64_t count) {
        set_text(data, name, counted(count));
        data.set("any_" + name, TemplateData(count > 0));
    };
    set("attempts", counts.attempts);
    set("done", counts.done);
    set("failed", counts.failed);
    set("left_out", counts.not_processed);
    set("beaten", counts.beaten);
}

void set_left_out(TemplateData& data, const DayResults& results) {
    TemplateData rows = template_list();
    for (const AttemptResult& attempt : results.attempts) {
        if (attempt.state != "not_processed") continue;
        TemplateData row = template_map();
        set_text(row, "id", attempt.id);
        set_text(row, "source", attempt.source);
        set_text(row, "reason", attempt.reason);
        rows.push_back(row);
    }
    data.set("left_out_rows", rows);
}

/// Notes of the day, and of the attempts that are done.
void set_notes(TemplateData& data, const DayResults& results) {
    TemplateData notes = texts_of(results.notes);
    bool any = !results.notes.empty();
    for (const AttemptResult& attempt : results.attempts) {
        if (attempt.state == "failed") continue;
        for (const std::string& text : attempt.notes) {
            TemplateData item = template_map();
            set_text(item, "id", attempt.id);
            set_text(item, "text", text);
            notes.push_back(item);
            any = true;
        }
    }
    set_list(data, "notes", notes, any);
}

void set_files(TemplateData& data, const Header& header) {
    TemplateData files = template_list();
    for (const InputFile& input : header.inputs) {
        TemplateData file = template_map();
        set_text(file, "role", input.role);
        set_text(file, "file", input.file);
        file.set("link", link_to(input.file));
        set_text(file, "sha256", input.sha256);
        set_text(file, "bytes", counted(static_cast<std::int64_t>(input.bytes)));
        files.push_back(file);
    }
    set_list(data, "files", files, !header.inputs.empty());
    set_text(data, "program",
             fmt::format("runcert-{} {}, source {}", header.stage, header.program_version,
                         header.source_revision));
    set_text(data, "version", header.program_version);
}

void set_scripts(TemplateData& data) {
    std::string script;
    for (const char* name : {"elements.js", "tables.js", "template/day.js"})
        script += std::string(day_page_text(name)) + "\n";
    data.set("style", std::string(day_page_text("report.css")) +
                          std::string(day_page_text("page.css")) +
                          std::string(day_page_text("template/day.css")));
    data.set("script_hash", base64_of_hex(sha256_hex(script)));
    data.set("script", script);
}

}  // namespace

std::string day_page(const DayResults& results) {
    TemplateData data = template_map();
    set_text(data, "day", results.day);
    set_counts(data, results.counts);
    set_failures(data, results);
    const AttemptsById attempts = attempts_by_id(results);
    TemplateData profiles = template_list();
    std::size_t number = 0;
    for (const DayProfile& profile : results.profiles)
        profiles.push_back(profile_data(profile, attempts, ++number));
    set_list(data, "profiles", profiles, number > 0);
    data.set("several_rules", TemplateData(number > 1));
    set_left_out(data, results);
    set_notes(data, results);
    set_files(data, results.header);
    set_scripts(data);
    kainjow::mustache::partial failure(
        [] { return std::string(day_page_text("template/failure.html")); });
    data.set("failure", TemplateData(failure));
    kainjow::mustache::mustache page{std::string(day_page_text("template/day.html"))};
    std::string html = page.render(data);
    if (!page.is_valid())
        throw Failure("template/day.html", page.error_message(),
                      "This is a fault of the program; please report it");
    return html;
}

}  // namespace runcert
