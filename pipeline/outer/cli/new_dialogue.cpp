#include "new_dialogue.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "outer_commands.h"
#include "reports/document/document_text.h"
#include "reports/inspection/described.h"

namespace runcert {
namespace {

void show(const Section& section) {
    fmt::print("{}\n", section_text(section, terminal_columns()));
    std::fflush(stdout);
}

std::string fixes_text(const Recognition& is) {
    std::vector<std::string> fixes;
    for (const FixCount& one : is.fixes)
        if (fixes.size() < 3) fixes.push_back(fmt::format("{} {}", one.fix, one.epochs));
    return listed(fixes);
}

/// A value in a line: "name Greenbird, class land-yacht".
std::string in_a_line(const nlohmann::ordered_json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_structured()) return value.dump();
    std::vector<std::string> parts;
    for (const auto& [key, one] : value.items())
        parts.push_back((value.is_object() ? key + " " : "") + in_a_line(one));
    return fmt::format("{}", fmt::join(parts, value.is_object() ? ", " : "; "));
}

void say(const std::string& text) {
    fmt::print(stderr, "{}", wrapped(text, 0, 0, terminal_columns()));
}

/// What may be answered, numbered: "1 fixed, 2 float".
std::string numbered(const std::vector<std::string>& values) {
    std::string text;
    for (std::size_t i = 0; i < values.size(); ++i)
        text += fmt::format("{}{} {}", i == 0 ? "" : ", ", i + 1, values[i]);
    return text;
}

/// Values by their numbers, else the answer as it is.
std::string by_number(const std::string& answer, const std::vector<std::string>& values) {
    const std::size_t comma = answer.find(',');
    if (comma != std::string::npos)
        return by_number(answer.substr(0, comma), values) + "," +
               by_number(answer.substr(comma + 1), values);
    const auto number = parse_integer(trim(answer));
    return number && *number >= 1 && *number <= std::ssize(values)
               ? values[static_cast<std::size_t>(*number - 1)]
               : answer;
}

/// One after the other, each by role and name.
void ask_officials(Draft& draft) {
    std::string officials;
    while (true) {
        const std::string role = ask_line(
            officials.empty()
                ? "Role of an official (measurer, observer, timekeeper, judge; Enter: none)"
                : "Role of another official (Enter: no more)");
        if (role.empty() || role == "-") return;
        const std::string name = ask_line(fmt::format("Name of the {}", role));
        const std::string more = officials + role + " " + name + ";";
        try {
            draft.set("officials", more);
            officials = more;
        } catch (const Failure& failure) {
            say(fmt::format("{} {}", sentence(failure.problem()), sentence(failure.remedy())));
        }
    }
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
    show(section);
    for (const HandedIn& file : draft.files())
        if (!file.is.proposed.empty()) show_description(file);
}

void show_description(const HandedIn& file) {
    Section section = description_section(file.is, file.path);
    section.title = file.path;
    show(section);
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

void show_answers(const Draft& draft) {
    Section section{.anchor = "answers", .title = "What is written"};
    Block all = facts({});
    for (const auto& [key, value] : draft.keys().items())
        add_fact(all, key, plain_text(in_a_line(value)));
    add(section, std::move(all));
    show(section);
}

void show_list(const std::string& title, std::vector<std::string> items) {
    if (items.empty()) return;
    Section section{.anchor = "list", .title = title};
    add(section, list_of(std::move(items)));
    show(section);
}

bool somebody_answers() {
    return isatty(STDIN_FILENO) != 0;
}

std::string ask_line(const std::string& question) {
    fmt::print(stderr, "{}: ", question);
    std::fflush(stderr);
    std::string line;
    if (!std::getline(std::cin, line)) {
        fmt::print(stderr, "\n");
        throw Failure("the dialogue", "it ended before the last question, and nothing was written",
                      "Run the same command again; or give --no-questions, and complete the file");
    }
    return std::string(trim(line));
}

void ask(Draft& draft, const Gap& gap) {
    fmt::print(stderr, "\n");
    say(gap.why);
    if (gap.key == "officials") return ask_officials(draft);
    if (!gap.values.empty()) say(numbered(gap.values));
    const std::string question =
        gap.question + (gap.proposal.empty() ? "" : fmt::format(" [{}]", gap.proposal));
    while (true) {
        std::string answer = ask_line(question);
        if (answer == "-") return;
        if (answer.empty() && gap.proposal.empty() && gap.required) {
            say("Nothing can be certified without it. Write it, or - to leave it open.");
            continue;
        }
        if (answer.empty() && gap.proposal.empty()) return;
        if (answer.empty()) answer = gap.proposal;
        try {
            draft.set(gap.key, gap.values.empty() ? answer : by_number(answer, gap.values));
            return;
        } catch (const Failure& failure) {
            say(fmt::format("{} {}", sentence(failure.problem()), sentence(failure.remedy())));
        }
    }
}

void ask_all(Draft& draft) {
    std::set<std::string> asked;
    while (true) {
        const std::vector<Gap> gaps = draft.gaps();
        const auto next = std::ranges::find_if(
            gaps, [&](const Gap& gap) { return gap.at_prompt && !asked.contains(gap.key); });
        if (next == gaps.end()) return;
        asked.insert(next->key);
        ask(draft, *next);
    }
}

}  // namespace runcert
