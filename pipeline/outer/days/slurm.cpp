#include "days/slurm.h"

#include <fmt/format.h>
#include <wordexp.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
#include <optional>
#include <regex>
#include <span>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert {
namespace {

constexpr std::string_view run_here = "run the day on this machine with --engine local";

/// What a program of Slurm's said, in one line, for a message.
std::string words_of(const ProcessResult& result) {
    std::string words;
    for (const std::string& line : lines_of(result.errors + result.output))
        if (!trim(line).empty())
            words += (words.empty() ? "" : "; ") + plain_text(std::string(trim(line)));
    while (words.ends_with('.'))
        words.pop_back();
    return words.empty() ? fmt::format("exit status {}, no words", result.exit_status) : words;
}

ProcessResult run_slurm(const std::vector<std::string>& arguments) {
    try {
        return run_process(arguments);
    } catch (const Failure& failure) {
        throw Failure(
            "Slurm", fmt::format("{}: {}", failure.where(), failure.problem()),
            fmt::format("Install slurm-client (Debian) and set it up for your cluster, or {}",
                        run_here));
    }
}

/// What a program of Slurm's says that asks the controller.
std::string asked_slurm(const std::vector<std::string>& arguments) {
    ProcessResult result = run_slurm(arguments);
    if (result.exit_status != 0)
        throw Failure(
            "Slurm", words_of(result),
            fmt::format("Try again when the cluster's controller answers (scontrol ping), or {}",
                        run_here));
    return std::move(result.output);
}

/// The number in a line "NAME      = 12" of `scontrol show config`, or in "..., NAME=12, ..."
/// there.
std::optional<std::int64_t> configured(const std::string& configuration, const std::string& name) {
    std::smatch found;
    if (!std::regex_search(configuration, found, std::regex("\\b" + name + "\\s*=\\s*([0-9]+)")))
        return std::nullopt;
    return parse_integer(found[1].str());
}

/// A path as sbatch's --output takes it: % begins what it replaces. It has no way to write a
/// backslash beside something to replace.
std::string output_pattern(const std::filesystem::path& folder) {
    std::string pattern = folder.string();
    replace_all(pattern, "%", "%%");
    if (pattern.find('\\') != std::string::npos)
        throw Failure(plain_text(folder.string()),
                      "Slurm cannot write into a folder with a backslash in its path",
                      "Name another folder (--out)");
    return pattern + "/%A_%a.txt";
}

[[noreturn]] void refuse(std::string what, std::string_view remedy) {
    throw Failure("--slurm-args", std::move(what), std::string(remedy));
}

/// Why wordexp takes a text for no words.
struct ExpansionError {
    int number;
    std::string_view problem;
    std::string_view remedy;
};

constexpr std::array<ExpansionError, 5> expansion_errors{{
    {WRDE_CMDSUB, "a command to be run is not accepted", "Run it yourself, and give what it says"},
    {WRDE_BADVAL, "a variable is not set", "Set it and export it, or put its $ in single quotes"},
    {WRDE_BADCHAR, "one of | & ; < > ( ) { } or a line end is not in quotes",
     "Put the word that holds it in quotes"},
    {WRDE_SYNTAX, "quotes or braces do not end", "Close them"},
    {WRDE_NOSPACE, "there is no memory to read this", "Close other programs"},
}};

/// What runcert must say itself.
struct ReservedOption {
    std::string_view name;    ///< long form
    std::string_view letter;  ///< short form; empty if there is none
    std::string_view remedy;
};

constexpr std::array<ReservedOption, 6> reserved_options{{
    {"--array", "-a", "Leave it out: the runs are distributed over the tasks by runcert"},
    {"--job-name", "-J", "Leave it out: by its name runcert finds the job again"},
    {"--clusters", "-M", "Set SLURM_CLUSTERS in its place, which squeue and scontrol read too"},
    {"--wrap", "", "Leave it out: what the tasks run is said by runcert"},
    {"--wait", "-W", "Leave it out: runcert waits for the tasks"},
    {"--test-only", "", "Leave it out, and try it with: sbatch --test-only --wrap=true"},
}};

bool gives(std::string_view word, const ReservedOption& option) {
    if (word == option.name || word.starts_with(fmt::format("{}=", option.name))) return true;
    return !option.letter.empty() && word.starts_with(option.letter);
}

}  // namespace

std::size_t most_tasks(const std::string& configuration) {
    const auto stated = [&](const char* name) {
        if (const auto number = configured(configuration, name)) return *number;
        throw Failure("Slurm", fmt::format("`scontrol show config` states no {}", name),
                      fmt::format("Check that scontrol is Slurm's, or {}", run_here));
    };
    const std::int64_t size = stated("MaxArraySize");
    const std::int64_t most =
        std::min({size, stated("MaxJobCount") / 2,
                  configured(configuration, "max_array_tasks").value_or(size)});
    if (most < 1)
        throw Failure("Slurm", "the cluster accepts no job arrays (MaxArraySize, MaxJobCount)",
                      fmt::format("Ask whoever runs it to allow them, or {}", run_here));
    return static_cast<std::size_t>(most);
}

std::size_t most_tasks() {
    for (const char* program : {"sbatch", "squeue", "scontrol"})
        run_slurm({program, "--version"});
    return most_tasks(asked_slurm({"scontrol", "show", "config"}));
}

std::size_t tasks_for(std::size_t runs, std::size_t most) {
    // A task begins by reading the whole day, of ten thousand attempts in seconds, and a run takes
    // seconds: fifty of them take minutes.
    constexpr std::size_t few = 200, longest = 50;
    return std::min({runs, std::max(few, (runs + longest - 1) / longest), most});
}

std::string job_at_work(const std::string& name) {
    const std::string ids =
        asked_slurm({"squeue", "--me", "--noheader", "--format=%F", "--name=" + name});
    for (const std::string& line : lines_of(ids))
        if (parse_integer(trim(line))) return std::string(trim(line));
    return {};
}

void run_array(const ArrayJob& job) {
    assert(job.tasks > 0);
    make_directory(job.folder);
    std::vector<std::string> words{"sbatch",
                                   "--parsable",
                                   "--job-name=" + job.name,
                                   "--chdir=" + job.folder.string(),
                                   "--output=" + output_pattern(job.folder),
                                   "--open-mode=append",
                                   "--requeue",
                                   "--cpus-per-task=1"};
    words.insert(words.end(), job.slurm_args.begin(), job.slurm_args.end());
    words.insert(words.end(), {"--wait", fmt::format("--array=0-{}", job.tasks - 1)});
    std::string command = "--wrap=exec";
    for (const std::string& word : job.command)
        command += " " + shell_word(word);
    // Slurm sets the index where the task runs: the shell there replaces it alone.
    words.push_back(fmt::format("{} --share \"$SLURM_ARRAY_TASK_ID\"/{}", command, job.tasks));
    const ProcessResult result = run_slurm(words);
    // Of an array that was accepted the status is that of its tasks.
    const std::string_view id = trim(result.output).substr(0, trim(result.output).find(';'));
    if (parse_integer(id).value_or(0) < 1)
        throw Failure("Slurm", fmt::format("the job was not accepted: {}", words_of(result)),
                      fmt::format("Correct it, e.g. by --slurm-args, or {}", run_here));
}

std::vector<std::string> split_slurm_args(std::string_view text) {
    if (text.find('\0') != std::string_view::npos) refuse("a byte is 0", "Take it out");
    wordexp_t found{};
    const std::unique_ptr<wordexp_t, decltype(&wordfree)> freed(&found, &wordfree);
    const std::string whole(text);
    const int error = wordexp(whole.c_str(), &found, WRDE_NOCMD | WRDE_UNDEF);
    for (const ExpansionError& known : expansion_errors)
        if (error == known.number)
            refuse(fmt::format("{}: {}", known.problem, escape_for_message(text, 200)),
                   known.remedy);
    const std::span<char*> expanded(found.we_wordv, found.we_wordc);
    std::vector<std::string> words(expanded.begin(), expanded.end());
    for (const std::string& word : words)
        for (const ReservedOption& option : reserved_options)
            if (gives(word, option))
                refuse(fmt::format("{} is not accepted", escape_for_message(word, 80)),
                       option.remedy);
    return words;
}

}  // namespace runcert
