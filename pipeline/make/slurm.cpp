#include "make/slurm.h"

#include <fmt/format.h>
#include <wordexp.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
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
    for (const std::string& line :
         lines_of(trim(result.errors).empty() ? result.output : result.errors))
        if (!trim(line).empty())
            words += (words.empty() ? "" : "; ") + plain_text(std::string(trim(line)));
    if (words.empty()) words = fmt::format("exit status {}, no words", result.exit_status);
    while (words.ends_with('.'))
        words.pop_back();
    return words;
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

/// The value in a line "Name      = value" of `scontrol show config`.
std::optional<std::string> configured(std::string_view configuration, std::string_view name) {
    for (const std::string& line : lines_of(std::string(configuration))) {
        const std::size_t sign = line.find('=');
        if (sign != std::string::npos && trim(std::string_view(line).substr(0, sign)) == name)
            return std::string(trim(std::string_view(line).substr(sign + 1)));
    }
    return std::nullopt;
}

std::int64_t configured_number(std::string_view configuration, std::string_view name) {
    const auto text = configured(configuration, name);
    const auto number = text ? parse_integer(*text) : std::nullopt;
    if (!number || *number < 0)
        throw Failure("Slurm", fmt::format("`scontrol show config` states no {}", name),
                      fmt::format("Check that scontrol is Slurm's, or {}", run_here));
    return *number;
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

std::string shell_line(const std::vector<std::string>& words) {
    std::string line = "exec";
    for (const std::string& word : words)
        line.append(" ").append(shell_word(word));
    return line;
}

[[noreturn]] void refuse(std::string what, std::string remedy) {
    throw Failure("--slurm-args", std::move(what), std::move(remedy));
}

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
    std::string_view letter;  ///< short form; empty if there is none
    std::string_view remedy;
};

constexpr std::array<ReservedOption, 4> reserved_options{{
    {"--array", "-a", "Leave it out: the runs are distributed over the tasks by runcert"},
    {"--wrap", "", "Leave it out: what the tasks run is said by runcert"},
    {"--wait", "-W", "Leave it out: runcert waits for the tasks"},
    {"--test-only", "", "Leave it out, and try it with: sbatch --test-only --wrap=true"},
}};

bool gives(std::string_view word, const ReservedOption& option) {
    if (word == option.name || word.starts_with(fmt::format("{}=", option.name))) return true;
    return !option.letter.empty() && word.starts_with(option.letter);
}

}  // namespace

ArrayLimits read_array_limits(std::string_view configuration) {
    ArrayLimits limits{.max_array_size = configured_number(configuration, "MaxArraySize"),
                       .max_job_count = configured_number(configuration, "MaxJobCount")};
    constexpr std::string_view key = "max_array_tasks=";
    const std::string parameters = configured(configuration, "SchedulerParameters").value_or("");
    if (const std::size_t at = ("," + parameters).find(fmt::format(",{}", key));
        at != std::string::npos)
        limits.max_array_tasks =
            parse_integer(std::string_view(parameters)
                              .substr(at + key.size())
                              .substr(0, parameters.find(',', at) - at - key.size()));
    return limits;
}

ArrayLimits array_limits() {
    for (const char* program : {"sbatch", "squeue", "scontrol"})
        run_slurm({program, "--version"});
    (void)asked_slurm({"scontrol", "ping"});
    return read_array_limits(asked_slurm({"scontrol", "show", "config"}));
}

std::size_t tasks_for(std::size_t runs, const ArrayLimits& limits) {
    const std::int64_t most = std::min({limits.max_array_size, limits.max_job_count / 2,
                                        limits.max_array_tasks.value_or(limits.max_array_size)});
    if (most < 1)
        throw Failure("Slurm", "the cluster accepts no job arrays (MaxArraySize, MaxJobCount)",
                      fmt::format("Ask whoever runs it to allow them, or {}", run_here));
    // A run takes seconds: fifty of them take minutes.
    constexpr std::size_t few = 50, longest = 50;
    const std::size_t share = std::clamp<std::size_t>(runs / few, 1, longest);
    return std::min((runs + share - 1) / share, static_cast<std::size_t>(most));
}

std::string job_at_work(const ArrayJob& job) {
    std::vector<std::string> words{"squeue", "--me", "--noheader", "--format=%A",
                                   "--name=" + plain_text(job.name)};
    for (std::size_t i = 0; i < job.slurm_args.size(); ++i)  // the cluster that is chosen there
        if (const std::string& word = job.slurm_args[i];
            word.starts_with("--clusters=") || (word.starts_with("-M") && word.size() > 2))
            words.push_back(word);
        else if ((word == "-M" || word == "--clusters") && i + 1 < job.slurm_args.size())
            words.push_back("--clusters=" + job.slurm_args[i + 1]);
    for (const std::string& line : lines_of(asked_slurm(words)))
        if (parse_integer(trim(line))) return std::string(trim(line));
    return {};
}

void run_array(const ArrayJob& job) {
    assert(job.tasks > 0);
    make_directory(job.folder);
    std::vector<std::string> words{"sbatch",
                                   "--parsable",
                                   "--job-name=" + plain_text(job.name),
                                   "--chdir=" + job.folder.string(),
                                   "--output=" + output_pattern(job.folder),
                                   "--open-mode=append",
                                   "--requeue",
                                   "--cpus-per-task=1"};
    words.insert(words.end(), job.slurm_args.begin(), job.slurm_args.end());
    words.insert(words.end(), {"--wait", fmt::format("--array=0-{}", job.tasks - 1)});
    // Slurm sets the index where the task runs: the shell there replaces it alone.
    words.push_back(fmt::format("--wrap={} --share \"$SLURM_ARRAY_TASK_ID\"/{}",
                                shell_line(job.command), job.tasks));
    const ProcessResult result = run_slurm(words);
    // Of an array that was accepted the status is that of its tasks.
    const std::string_view id = trim(result.output).substr(0, trim(result.output).find(';'));
    if (!parse_integer(id))
        throw Failure("Slurm", fmt::format("the job was not accepted: {}", words_of(result)),
                      fmt::format("Correct it, e.g. by --slurm-args, or {}", run_here));
}

std::vector<std::string> split_slurm_args(std::string_view text) {
    if (text.find('\0') != std::string_view::npos) refuse("a byte is 0", "Take it out");
    wordexp_t found{};
    const std::unique_ptr<wordexp_t, decltype(&wordfree)> freed(&found, &wordfree);
    const std::string whole(text);
    check_expansion(wordexp(whole.c_str(), &found, WRDE_NOCMD | WRDE_UNDEF), text);
    const std::span<char*> expanded(found.we_wordv, found.we_wordc);
    std::vector<std::string> words(expanded.begin(), expanded.end());
    for (const std::string& word : words)
        for (const ReservedOption& option : reserved_options)
            if (gives(word, option))
                refuse(fmt::format("{} is not accepted", escape_for_message(word, 80)),
                       std::string(option.remedy));
    return words;
}

}  // namespace runcert
