#include "batch/slurm_args.h"

#include <fmt/format.h>
#include <wordexp.h>

#include <array>
#include <span>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

[[noreturn]] void refuse(std::string what, std::string remedy) {
    throw Failure("--slurm-args", std::move(what), std::move(remedy));
}

/// The words that wordexp found, freed at the end of the object's life.
struct Expansion {
    Expansion() = default;
    ~Expansion() { wordfree(&found); }
    Expansion(const Expansion&) = delete;
    Expansion& operator=(const Expansion&) = delete;

    wordexp_t found{};
};

void check_expansion(int error, std::string_view text) {
    const std::string shown = escape_for_message(text, 200);
    switch (error) {
        case 0:
            return;
        case WRDE_CMDSUB:
            refuse(fmt::format("a command to be run is not accepted: {}", shown),
                   "Run it yourself, and give what it says");
        case WRDE_BADVAL:
            refuse(fmt::format("a variable is not set: {}", shown),
                   "Set it and export it, or put its $ in single quotes");
        case WRDE_BADCHAR:
            refuse(
                fmt::format("one of | & ; < > ( ) {{ }} or a line end is not in quotes: {}", shown),
                "Put the word that holds it in quotes");
        case WRDE_SYNTAX:
            refuse(fmt::format("quotes or braces do not end: {}", shown), "Close them");
        default:
            refuse(fmt::format("there is no memory to read {}", shown), "Close other programs");
    }
}

struct ReservedOption {
    std::string_view name;    ///< long form
    std::string_view letter;  ///< short form; empty where there is none
    std::string_view remedy;
};

constexpr std::array<ReservedOption, 4> reserved_options{{
    {"--array", "-a",
     "Leave it out: the runs are distributed over the tasks by runcert. --jobs limits how many run "
     "at a time"},
    {"--wrap", "", "Leave it out: what the tasks run is said by runcert"},
    {"--wait", "-W", "Leave it out: the results are made by a job of their own"},
    {"--test-only", "", "Leave it out, and try it with: sbatch --test-only --wrap=true"},
}};

bool gives(std::string_view word, const ReservedOption& option) {
    if (word == option.name || word.starts_with(fmt::format("{}=", option.name))) return true;
    return !option.letter.empty() && word.starts_with(option.letter);
}

}  // namespace

std::vector<std::string> split_slurm_args(std::string_view text) {
    if (text.find('\0') != std::string_view::npos) refuse("a byte is 0", "Take it out");
    Expansion expansion;
    const std::string whole(text);
    check_expansion(wordexp(whole.c_str(), &expansion.found, WRDE_NOCMD | WRDE_UNDEF), text);
    const std::span<char*> words(expansion.found.we_wordv, expansion.found.we_wordc);
    return {words.begin(), words.end()};
}

void check_slurm_args(const std::vector<std::string>& words) {
    for (const std::string& word : words)
        for (const ReservedOption& option : reserved_options)
            if (gives(word, option))
                refuse(fmt::format("{} is not accepted", escape_for_message(word, 80)),
                       std::string(option.remedy));
}

}  // namespace runcert
