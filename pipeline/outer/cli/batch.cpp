#include "days/batch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/failure.h"
#include "core/text.h"
#include "days/slurm.h"
#include "make/maker.h"
#include "outer_commands.h"
#include "reports/day/day_writing.h"
#include "reports/day/page_parts.h"
#include "reports/diff/day_difference.h"
#include "reports/document/document_text.h"
#include "run/chain.h"
#include "schemas/common/product_files.h"
#include "schemas/day/day.h"
#include "store/process.h"
#include "trust/signing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct BatchOptions {
    std::vector<std::string> day;
    std::string out;
    std::int64_t jobs = 0;
    double time_limit_s = 600.0;
    bool force = false;
    std::string from;
    std::vector<std::string> only;
    bool explain = false;
    bool quiet = false;
    bool json = false;
    bool no_pdf = false;
    bool no_render = false;
    std::string key;
    std::string engine = "local";
    std::string slurm_args;
    bool wait = false;
    bool status = false;
    std::string compare;
    std::optional<std::string> share;  ///< an empty one is none, and not the whole day
};

/// Steps that a user may name: the stages, report and render.
std::vector<std::string> nameable_steps() {
    std::vector<std::string> names;
    for (const Step& step : steps())
        if (!step.program.empty()) names.push_back(step.name);
    return names;
}

/// out/NAME, NAME being that of the folder, of the day file, or of the folder it is in.
fs::path default_out(const std::string& first) {
    const fs::path given = fs::weakly_canonical(fs::absolute(first));
    const bool names_itself = fs::is_directory(given) || given.stem() != "day";
    const fs::path name = names_itself ? given.stem() : given.parent_path().filename();
    return fs::path("out") / (name.empty() ? "day" : name);
}

ProgressStyle style_of(const BatchOptions& options) {
    if (options.json) return ProgressStyle::json;
    return options.quiet ? ProgressStyle::quiet : progress_style_for(stdout);
}

BatchOrder order_of(const BatchOptions& options) {
    BatchOrder order;
    order.day.assign(options.day.begin(), options.day.end());
    order.out = options.out.empty() ? default_out(options.day.front()) : fs::path(options.out);
    std::vector<std::string> pages;
    if (options.no_pdf)
        pages = {"report.html"};
    else
        pages.assign(page_names.begin(), page_names.end());
    if (options.no_render) pages.clear();
    order.making = maker_options(pages, options.key);
    order.making.force = options.force;
    order.making.from = options.from;
    order.making.own_group = true;
    order.making.time_limit = std::chrono::milliseconds(std::llround(options.time_limit_s * 1e3));
    constexpr int columns_of_a_log = 160;  // a terminal says its own
    order.progress = {
        .style = style_of(options), .explain = options.explain, .columns = columns_of_a_log};
    order.jobs = options.jobs > 0 ? static_cast<std::size_t>(options.jobs)
                                  : std::max(1U, std::thread::hardware_concurrency());
    order.only = options.only;
    order.write_day = write_day;
    order.wait = options.wait;
    return order;
}

/// What the tasks on a cluster must be told as this call was.
std::vector<std::string> task_options(const BatchOptions& options) {
    std::vector<std::string> words{"--time-limit", fmt::format("{}", options.time_limit_s),
                                   "--jobs", "1"};
    if (options.no_pdf) words.emplace_back("--no-pdf");
    if (options.no_render) words.emplace_back("--no-render");
    return words;
}

Share share_of(const std::string& text) {
    const std::size_t slash = text.find('/');
    const auto part = parse_integer(text.substr(0, slash));
    const auto of =
        slash == std::string::npos ? std::nullopt : parse_integer(text.substr(slash + 1));
    if (!part || !of || *part < 0 || *of < 1 || *part >= *of)
        throw Failure("--share", fmt::format("\"{}\" is not a share", escape_for_message(text)),
                      "Write I/N, I counting from 0 to N - 1");
    return {.part = static_cast<std::size_t>(*part), .of = static_cast<std::size_t>(*of)};
}

void check(const BatchOptions& options) {
    if (!options.compare.empty() && !fs::exists(fs::path(options.compare) / "day.yaml"))
        throw Failure(options.compare, "the folder holds no day.yaml to compare with",
                      "Name the --out of an earlier batch");
    if (options.engine != "slurm") return;
    if (!options.key.empty())
        throw Failure("--key",
                      "a day on a cluster is not signed there: the key would leave this "
                      "computer",
                      "Sign the runs here when they are done: runcert sign RUN_DIR, or the same "
                      "batch with --key and without --engine");
    if (options.force || !options.from.empty())
        throw Failure("--engine slurm",
                      "--force and --from are for this computer alone: the tasks "
                      "of an array find out by themselves what is to be done",
                      "Give another --out, or remove the runs that are to be recomputed");
}

/// What the results have otherwise than those of the folder to compare with.
void say_difference(const BatchOptions& options, const fs::path& out) {
    const DayComparison found = compare_days(options.compare, out);
    if (options.json)
        fmt::print(
            "{}\n",
            nlohmann::ordered_json{{"event", "comparison"}, {"comparison", comparison_json(found)}}
                .dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace));
    else
        fmt::print("\n{}",
                   document_text(comparison_document(found, options.compare, out, options.explain),
                                 terminal_columns()));
}

int batch(const BatchOptions& options) {
    check(options);
    const BatchOrder order = order_of(options);
    if (options.status) return say_status(order);
    if (options.share) return run_share(order, share_of(*options.share));
    const int status =
        options.engine == "slurm"
            ? run_on_cluster(order, task_options(options), split_slurm_args(options.slurm_args))
            : run_batch(order);
    if (const fs::path day = order.out / "day.yaml";
        !options.json && !options.quiet && fs::exists(day))
        fmt::print("{}", ranking_text(read_day_results(read_file(day), day.string())));
    if (!options.compare.empty()) say_difference(options, order.out);
    return status;
}

void add_choices(CommandLine& line, BatchOptions& options) {
    line.text("--out", options.out,
              "folder of the results and run folders (default: out/NAME of the day)");
    line.integer("--jobs", options.jobs, "runs side by side (default: one for each core)", 1, 1024);
    line.number("--time-limit", options.time_limit_s,
                "seconds after which a step is ended and its run has failed (default: 600)", 0.1,
                1e7);
    line.flag("--force", options.force, "make every step again");
    const std::vector<std::string> names = nameable_steps();
    line.word("--from", options.from,
              fmt::format("make this step and those after it again: {}", fmt::join(names, ", ")),
              names);
    line.texts("--only", options.only,
               "only attempts with such an id (* and ? as in file names); may be repeated");
    line.flag("--no-pdf", options.no_pdf, "report.json and HTML alone");
    line.flag("--no-render", options.no_render, "stop after report.json: no HTML, no PDF");
    line.text("--key", options.key,
              "secret key to sign the reports with, once their files are verified");
}

void add_display(CommandLine& line, BatchOptions& options) {
    line.flag("--explain", options.explain, "explain why each step ran or was skipped");
    line.flag("--quiet", options.quiet, "print failures and summary only");
    line.flag("--json", options.json, "one event a line, for programs");
    line.text("--compare", options.compare,
              "at the end, what differs from the results in this folder, and why");
    line.flag("--status", options.status,
              "only say what is done and what is not (exit status 1 where not all is)");
    line.flag("--wait", options.wait, "wait for another batch on the same folder to end");
}

void add_cluster(CommandLine& line, BatchOptions& options) {
    line.word("--engine", options.engine, "local, or slurm for a cluster", {"local", "slurm"});
    line.text("--slurm-args", options.slurm_args,
              "more arguments for sbatch, as in a shell: \"--partition=lake --mem=2G\"");
    line.text("--share", options.share,
              "I/N: every N-th attempt from the I-th, counted from 0, and no results; a task of a "
              "cluster's array");
}

std::string footer() {
    return fmt::format(
        "Each attempt has a run folder OUT/ID, as certify writes it; day.html, day.csv and "
        "day.yaml\n"
        "in OUT have the ranking. A step runs again only if its program, its parameters or its "
        "inputs\n"
        "changed, by SHA-256, or if what it wrote is not there as it was written. What each run "
        "was\n"
        "made from is remembered in $XDG_STATE_HOME/runcert (else ~/.local/state/runcert), where\n"
        "only you can write: a run that is not known there is made again. So --key signs only\n"
        "what this call or an earlier one of yours computed. Ctrl-C once finishes what is "
        "running,\n"
        "twice stops it; the same command again goes on.\n"
        "Exit status: 0 all were processed, whatever their outcomes; 2 one could not be.\n\n"
        "A day file (examples/day has one that runs as it is):\n\n"
        "  schema: day/1.0\n"
        "  id: lake-day\n"
        "  defaults:\n"
        "    craft: {{name: yacht, class: land-yacht}}\n"
        "    officials: [{{role: measurer}}]\n"
        "    record: {{speed: 202.9, unit: km/h, source: where it is published}}\n"
        "    profiles: [nalsa]\n"
        "  attempts:\n"
        "    - {{id: first, recording: morning/first.pos}}\n"
        "    - {{id: final, recording: final.pos, craft: {{name: other, class: land-yacht}}}}\n"
        "    - {{attempt: heats/attempt.yaml}}  # as it is\n\n"
        "Every key (defaults and attempts beside have the keys of an attempt: runcert certify "
        "--help):\n{}",
        day_schema().field_table());
}

}  // namespace

void add_batch(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<BatchOptions>(
        app, chosen, "batch",
        "Certify a day's attempts: those that changed are made again, results ranked", batch);
    line.texts("DAY", options.day,
               "a folder of attempts, a day file (schema day/1.0), or attempt files",
               CommandLine::required);
    add_choices(line, options);
    add_display(line, options);
    add_cluster(line, options);
    line.footer(footer());
}

}  // namespace runcert
