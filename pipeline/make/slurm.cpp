#include "make/slurm.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert {
namespace {

constexpr std::string_view run_here = "run the day on this machine with --engine local";

std::vector<std::string_view> line_views_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = trim(text.substr(0, end));
        if (!line.empty()) lines.push_back(line);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return lines;
}

/// What a program of Slurm's said, in one line, for a message.
std::string words_of(const ProcessResult& result) {
    const bool has_errors = !trim(result.errors).empty();
    std::string words;
    for (const std::string_view line : line_views_of(has_errors ? result.errors : result.output))
        words += (words.empty() ? "" : "; ") + plain_text(line);
    if (words.empty()) words = fmt::format("exit status {}, no words", result.exit_status);
    while (words.ends_with('.'))
        words.pop_back();
    return words;
}

[[noreturn]] void no_answer(const ProcessResult& result) {
    throw Failure(
        "Slurm", words_of(result),
        fmt::format("Try again when the cluster's controller answers (scontrol ping), or {}",
                    run_here));
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

/// The value in a line "Name      = value" of `scontrol show config`.
std::optional<std::string_view> configured(std::string_view configuration, std::string_view name) {
    for (const std::string_view line : line_views_of(configuration)) {
        const std::size_t sign = line.find('=');
        if (sign != std::string_view::npos && trim(line.substr(0, sign)) == name)
            return trim(line.substr(sign + 1));
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

std::vector<std::string> on_cluster(const std::string& cluster) {
    if (cluster.empty()) return {};
    return {"--clusters=" + cluster};
}

void append(std::vector<std::string>& words, const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
}

std::string shell_line(const std::vector<std::string>& words) {
    std::string line = "exec";
    for (const std::string& word : words)
        line.append(" ").append(shell_word(word));
    return line;
}

/// A path as sbatch's --output takes it: % begins what it replaces. It has no way to write a
/// backslash beside something to replace.
std::string output_pattern(const std::filesystem::path& folder, std::string_view file) {
    std::string pattern;
    for (const char c : folder.string())
        pattern += c == '%' ? std::string("%%") : std::string(1, c);
    if (pattern.find('\\') != std::string::npos)
        throw Failure(plain_text(folder.string()),
                      "Slurm cannot write into a folder with a backslash in its path",
                      "Name another folder (--out)");
    return fmt::format("{}/{}", pattern, file);
}

std::vector<std::string> sbatch_words(const ArrayJob& job, std::string_view output) {
    std::vector<std::string> words{"sbatch",
                                   "--parsable",
                                   "--job-name=" + plain_text(job.name),
                                   "--chdir=" + job.folder.string(),
                                   "--output=" + output_pattern(job.folder, output),
                                   "--open-mode=append",
                                   "--requeue",
                                   "--cpus-per-task=1"};
    if (!job.memory.empty()) words.push_back("--mem=" + job.memory);
    append(words, job.slurm_args);
    return words;
}

struct Submitted {
    std::string id;
    std::string cluster;
};

Submitted run_sbatch(const std::vector<std::string>& words) {
    const ProcessResult result = run_slurm(words);
    const auto refuse = [&] {
        throw Failure("Slurm", fmt::format("the job was not accepted: {}", words_of(result)),
                      fmt::format("Correct it, e.g. by --slurm-args, or {}", run_here));
    };
    if (result.exit_status != 0) refuse();
    const std::vector<std::string_view> lines = line_views_of(result.output);
    if (lines.empty()) refuse();
    const std::string_view answer = lines.back();
    const std::size_t end = std::min(answer.find(';'), answer.size());
    const std::string_view id = answer.substr(0, end);
    if (id.empty() || id.find_first_not_of("0123456789") != std::string_view::npos) refuse();
    return {.id = std::string(id),
            .cluster = std::string(answer.substr(std::min(end + 1, answer.size())))};
}

Submitted submit_array(const ArrayJob& job) {
    std::vector<std::string> words = sbatch_words(job, "%A_%a.txt");
    make_directory(job.folder);
    words.push_back(fmt::format("--array=0-{}{}", job.tasks - 1,
                                job.at_once > 0 ? fmt::format("%{}", job.at_once) : ""));
    // Slurm sets the index where the task runs: the shell there replaces it alone.
    words.push_back(fmt::format("--wrap={} --share \"$SLURM_ARRAY_TASK_ID\"/{}",
                                shell_line(job.command), job.tasks));
    return run_sbatch(words);
}

Submitted submit_gatherer(const ArrayJob& job, const Submitted& array) {
    std::vector<std::string> words = sbatch_words(job, "%j.txt");
    append(words, on_cluster(array.cluster));
    append(words, {"--dependency=afterany:" + array.id, "--kill-on-invalid-dep=yes",
                   "--wrap=" + shell_line(job.gatherer)});
    return run_sbatch(words);
}

/// Cancels a submitted job; says what became of it.
std::string cancelled(const Submitted& job) {
    std::vector<std::string> words{"scancel"};
    append(words, on_cluster(job.cluster));
    words.push_back(job.id);
    const ProcessResult result = run_slurm(words);
    if (result.exit_status == 0) return fmt::format("job {} of the runs was cancelled", job.id);
    return fmt::format("job {} of the runs is still submitted, and could not be cancelled: {}",
                       job.id, words_of(result));
}

bool is_over(std::string_view state) {
    constexpr std::array<std::string_view, 10> ends{
        "BOOT_FAIL", "CANCELLED", "COMPLETED",     "DEADLINE", "FAILED",
        "NODE_FAIL", "PREEMPTED", "OUT_OF_MEMORY", "TIMEOUT",  "REVOKED"};
    return std::ranges::find(ends, state) != ends.end();
}

bool is_begun(std::string_view state) {
    constexpr std::array<std::string_view, 8> begun{"RUNNING",   "COMPLETING", "CONFIGURING",
                                                    "SUSPENDED", "STAGE_OUT",  "STOPPED",
                                                    "SIGNALING", "RESIZING"};
    return std::ranges::find(begun, state) != begun.end();
}

/// Adds one task, a line "STATE RESTARTS REASON" of squeue.
void count_task(std::string_view line, JobState& state) {
    const auto take_word = [&line] {
        const std::string_view word = line.substr(0, line.find(' '));
        line = trim(line.substr(word.size()));
        return word;
    };
    const std::string_view task = take_word();
    if (is_over(task)) return;
    if (parse_integer(take_word()).value_or(0) > 0) ++state.requeued;
    const bool is_held = line.find("Held") != std::string_view::npos ||
                         line.find("held") != std::string_view::npos || task == "SPECIAL_EXIT";
    if (is_begun(task) && !is_held) {
        ++state.running;
        return;
    }
    ++state.pending;
    if (is_held) ++state.held;
    if (!line.empty() && line != "None") ++state.reasons[std::string(line)];
}

}  // namespace

void slurm_ready() {
    for (const char* program : {"sbatch", "squeue", "scontrol", "scancel"})
        run_slurm({program, "--version"});
    const ProcessResult ping = run_slurm({"scontrol", "ping"});
    if (ping.exit_status != 0) no_answer(ping);
}

ArrayLimits read_array_limits(std::string_view configuration) {
    ArrayLimits limits{.max_array_size = configured_number(configuration, "MaxArraySize"),
                       .max_job_count = configured_number(configuration, "MaxJobCount")};
    constexpr std::string_view key = "max_array_tasks=";
    std::string_view parameters = configured(configuration, "SchedulerParameters").value_or("");
    while (!parameters.empty()) {
        const std::string_view parameter = parameters.substr(0, parameters.find(','));
        parameters.remove_prefix(std::min(parameter.size() + 1, parameters.size()));
        if (parameter.starts_with(key))
            limits.max_array_tasks = parse_integer(parameter.substr(key.size()));
    }
    return limits;
}

ArrayLimits array_limits() {
    const ProcessResult result = run_slurm({"scontrol", "show", "config"});
    if (result.exit_status != 0) no_answer(result);
    return read_array_limits(result.output);
}

std::size_t tasks_for(std::size_t runs, const ArrayLimits& limits) {
    const std::int64_t most = std::min({limits.max_array_size, limits.max_job_count / 2,
                                        limits.max_array_tasks.value_or(limits.max_array_size)});
    if (most < 1)
        throw Failure("Slurm", "the cluster accepts no job arrays (MaxArraySize, MaxJobCount)",
                      fmt::format("Ask whoever runs it to allow them, or {}", run_here));
    return std::min(runs, static_cast<std::size_t>(most));
}

std::vector<std::string> batch_command(const std::vector<std::filesystem::path>& day,
                                       const std::filesystem::path& out) {
    std::vector<std::string> words{std::filesystem::read_symlink("/proc/self/exe").string(),
                                   "batch"};
    for (const std::filesystem::path& path : day)
        words.push_back(std::filesystem::absolute(path).string());
    append(words, {"--out", std::filesystem::absolute(out).string()});
    return words;
}

SlurmJobs submit(const ArrayJob& job) {
    assert(job.tasks > 0);
    check_slurm_args(job.slurm_args);
    const Submitted array = submit_array(job);
    try {
        const Submitted gatherer = submit_gatherer(job, array);
        return {.array = array.id,
                .gatherer = gatherer.id,
                .cluster = array.cluster,
                .tasks = job.tasks,
                .runs = job.runs};
    } catch (const Failure& failure) {
        throw Failure(failure.where(),
                      fmt::format("of the job that makes the results: {}; {}", failure.problem(),
                                  cancelled(array)),
                      failure.remedy());
    }
}

JobState job_state(const std::string& id, const std::string& cluster, std::size_t tasks) {
    std::vector<std::string> words{"squeue"};
    append(words, on_cluster(cluster));
    append(words, {"--noheader", "--array", "--me", "--states=all", "--jobs=" + id,
                   "--Format=State:32,RestartCnt:12,Reason:200"});
    const ProcessResult result = run_slurm(words);
    JobState state;
    if (result.exit_status != 0) {
        if (result.errors.find("Invalid job id") == std::string::npos) no_answer(result);
    } else {
        for (const std::string_view line : line_views_of(result.output))
            if (!line.starts_with("CLUSTER:")) count_task(line, state);
    }
    state.over = tasks - std::min(tasks, state.pending + state.running);
    return state;
}

}  // namespace runcert
