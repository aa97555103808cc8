#include "new_shown.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/prose.h"
#include "core/text.h"
#include "reports/document/document_text.h"
#include "reports/inspection/described.h"

namespace runcert {
namespace {

std::string fixes_text(const Recognition& is) {
    std::vector<std::string> fixes;
    for (const FixCount& one : is.fixes)
        if (fixes.size() < 3) fixes.push_back(fmt::format("{} {}", one.fix, one.epochs));
    return listed(fixes);
}

}  // namespace

std::string file_text(const Recognition& is) {
    if (is.kind == RecordingKind::signals) return "raw signals (RINEX observations)";
    if (is.kind == RecordingKind::orbits) return "orbits of the satellites (RINEX navigation)";
    if (is.kind == RecordingKind::series)
        return fmt::format("a series for the key {}", fmt::join(is.series, " or "));
    if (is.kind == RecordingKind::table) return "a table whose columns are not known";
    if (is.kind == RecordingKind::surface && is.triangles > 0)
        return fmt::format("the surface of a course ({}); {} vertices, {}", is.format,
                           counted(is.vertices), counted(is.triangles, "triangle"));
    if (is.kind == RecordingKind::surface)
        return fmt::format("the vertices of a surface; {} of them", counted(is.vertices));
    if (is.kind == RecordingKind::triangles)
        return fmt::format("the triangles of a surface; {}", counted(is.triangles, "triangle"));
    if (is.kind == RecordingKind::imu)
        return fmt::format("samples of an IMU ({}); {}, {} s apart", is.format,
                           counted(is.epochs, "sample"), format_fixed(is.interval_s, 4));
    std::string text = fmt::format("{}; {}", is.format, counted(is.epochs, "epoch"));
    if (is.interval_s > 0.0) text += fmt::format(", {} s apart", format_fixed(is.interval_s, 2));
    if (is.first && is.last)
        text += fmt::format("; {} to {}", to_utc_iso(*is.first, 0), to_utc_iso(*is.last, 0));
    else
        text += fmt::format("; {} s from an unknown start", format_fixed(is.span_s, 1));
    text += "; solutions: " + fixes_text(is);
    if (!is.device.empty()) text += "; made by " + is.device;
    if (is.simulated) text += "; it says that it was simulated";
    return text;
}

void show_recordings(const Draft& draft) {
    Section section{.anchor = "recordings", .title = "Recordings"};
    Block all = facts({});
    for (const HandedIn& file : draft.files())
        add_fact(all, file.path, file_text(file.is));
    add(section, std::move(all));
    if (!draft.arrangement().said.empty()) add(section, list_of(draft.arrangement().said));
    fmt::print("{}\n", section_text(section, terminal_columns()));
    for (const HandedIn& file : draft.files())
        if (!file.is.proposed.empty()) show_description(file);
}

void show_description(const HandedIn& file) {
    Section section = description_section(file.is, file.path);
    section.title = file.path;
    fmt::print("{}\n", section_text(section, terminal_columns()));
}

void show_gaps(const Draft& draft, const std::string& title, bool with_keys) {
    const std::vector<Gap> gaps = draft.gaps();
    std::vector<std::string> items;
    for (const Gap& gap : gaps) {
        std::string item = gap.question + (gap.required ? " (required)" : "");
        if (!gap.at_prompt) item += " (to be written in the file)";
        if (!gap.values.empty()) item += fmt::format(": {}", fmt::join(gap.values, ", "));
        if (with_keys) item = fmt::format("{}: {}. {}", gap.key, item, gap.why);
        items.push_back(std::move(item));
    }
    show_list(title, std::move(items));
}

namespace {

/// A value in a line: "name Greenbird, class land-yacht".
std::string in_a_line(const nlohmann::ordered_json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_structured()) return value.dump();
    std::vector<std::string> parts;
    for (const auto& [key, one] : value.items())
        parts.push_back((value.is_object() ? key + " " : "") + in_a_line(one));
    return fmt::format("{}", fmt::join(parts, value.is_object() ? ", " : "; "));
}

}  // namespace

void show_answers(const Draft& draft) {
    Section section{.anchor = "answers", .title = "What is written"};
    Block all = facts({});
    for (const auto& [key, value] : draft.keys().items())
        add_fact(all, key, plain_text(in_a_line(value)));
    add(section, std::move(all));
    fmt::print("{}\n", section_text(section, terminal_columns()));
    std::fflush(stdout);
}

void show_list(const std::string& title, std::vector<std::string> items) {
    if (items.empty()) return;
    Section section{.anchor = "list", .title = title};
    add(section, list_of(std::move(items)));
    fmt::print("{}\n", section_text(section, terminal_columns()));
    std::fflush(stdout);
}

}  // namespace runcert
