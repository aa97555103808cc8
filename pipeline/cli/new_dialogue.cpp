#include "new_dialogue.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <set>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/document/document_text.h"

namespace runcert {
namespace {

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

}  // namespace

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

namespace {

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
