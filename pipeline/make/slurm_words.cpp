#include <fmt/format.h>
#include <wordexp.h>

#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "make/slurm.h"
#include "store/atomic_file.h"

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
    std::string_view letter;  ///< short form; empty if there is none
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

constexpr std::string_view schema = "slurm-jobs/1.0";

[[noreturn]] void broken(const std::filesystem::path& file, const std::string& what) {
    throw Failure(escape_for_message(file.string(), 1000), what,
                  "Remove it; jobs that may still run are listed by: squeue --me");
}

/// A job's id as Slurm writes it, so that nothing else ever becomes an argument of its programs.
bool is_job_id(std::string_view text) {
    const std::optional<std::int64_t> number = parse_integer(text);
    return number && *number > 0 && std::to_string(*number) == text;
}

bool is_cluster_name(std::string_view text) {
    return is_printable_ascii(text) && !text.starts_with('-');
}

std::string job_count(std::size_t count, std::string_view noun) {
    return counted(static_cast<std::int64_t>(count), noun);
}

std::string indented(std::string_view text) {
    return "  " + wrapped(text, 4, 2);
}

std::string with_cluster(const SlurmJobs& jobs) {
    return jobs.cluster.empty() ? "" : " --clusters=" + shell_word(jobs.cluster);
}

/// "12 waiting (10 Resources, 2 BeginTime)"; with nothing in brackets where no reason is given.
std::string waiting_text(const JobState& state) {
    std::vector<std::string> reasons;
    for (const auto& [reason, count] : state.reasons)
        reasons.push_back(fmt::format("{} {}", count, escape_for_message(reason, 200)));
    std::string text = fmt::format("{} waiting", state.pending);
    if (!reasons.empty()) text += fmt::format(" ({})", fmt::join(reasons, ", "));
    return text;
}

std::string state_text(const JobState& state) {
    std::vector<std::string> parts;
    if (state.pending > 0) parts.push_back(waiting_text(state));
    if (state.running > 0) parts.push_back(fmt::format("{} running", state.running));
    if (state.over > 0) parts.push_back(fmt::format("{} ended", state.over));
    return listed(parts);
}

std::string troubles_text(const std::string& id, const JobState& state, const SlurmJobs& jobs) {
    std::string text;
    if (state.requeued > 0)
        text +=
            indented(fmt::format("{} of job {} put back and begun again by Slurm: a node failed, "
                                 "or was needed elsewhere",
                                 job_count(state.requeued, "task"), id));
    if (state.held > 0)
        text += indented(fmt::format("{} of job {} held until released: scontrol{} release {}",
                                     job_count(state.held, "task"), id, with_cluster(jobs), id));
    return text;
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

void write_slurm_jobs(const std::filesystem::path& file, const SlurmJobs& jobs) {
    const nlohmann::ordered_json json = {{"schema", schema},          {"array", jobs.array},
                                         {"gatherer", jobs.gatherer}, {"cluster", jobs.cluster},
                                         {"tasks", jobs.tasks},       {"runs", jobs.runs}};
    write_file_atomically(file, json.dump(2) + "\n");
}

std::optional<SlurmJobs> read_slurm_jobs(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::symlink_status(file, ignored).type() ==
        std::filesystem::file_type::not_found)
        return std::nullopt;
    const std::string text = read_handwritten(file);
    SlurmJobs jobs;
    try {
        const nlohmann::json json = nlohmann::json::parse(text);
        if (json.at("schema").get<std::string>() != schema)
            broken(file, "this is not a list of jobs that this version of runcert wrote");
        json.at("array").get_to(jobs.array);
        json.at("gatherer").get_to(jobs.gatherer);
        json.at("cluster").get_to(jobs.cluster);
        for (const char* count : {"tasks", "runs"})
            if (!json.at(count).is_number_unsigned() || json.at(count).get<std::uint64_t>() == 0)
                broken(file, fmt::format("{} is not a count", count));
        json.at("tasks").get_to(jobs.tasks);
        json.at("runs").get_to(jobs.runs);
    } catch (const nlohmann::json::exception& error) {
        broken(file, fmt::format("this is not a list of jobs ({})",
                                 escape_for_message(error.what(), 200)));
    }
    if (!is_job_id(jobs.array) || !is_job_id(jobs.gatherer))
        broken(file, "a job's id is no number");
    if (!is_cluster_name(jobs.cluster)) broken(file, "the cluster's name is not one");
    return jobs;
}

std::string submission_text(const SlurmJobs& jobs) {
    return wrapped(fmt::format("submitted job {}, {} for {}; results by job {}", jobs.array,
                               job_count(jobs.tasks, "task"), job_count(jobs.runs, "run"),
                               jobs.gatherer)) +
           indented(fmt::format(
               "`runcert batch ... --status` says how they stand; `scancel{} {} {}` ends them",
               with_cluster(jobs), jobs.array, jobs.gatherer));
}

std::string status_text(const SlurmJobs& jobs, const JobState& array, const JobState& gatherer) {
    std::string text =
        wrapped(fmt::format("job {}, {} for {}: {}", jobs.array, job_count(jobs.tasks, "task"),
                            job_count(jobs.runs, "run"), state_text(array)));
    text += troubles_text(jobs.array, array, jobs);
    text += wrapped(fmt::format("job {}, results: {}", jobs.gatherer,
                                gatherer.is_over()     ? "ended"
                                : gatherer.running > 0 ? "running"
                                : array.is_over()      ? waiting_text(gatherer)
                                                       : "waits for the runs"));
    text += troubles_text(jobs.gatherer, gatherer, jobs);
    return text;
}

}  // namespace runcert
