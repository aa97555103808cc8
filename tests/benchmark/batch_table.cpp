#include "batch_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

double mebibytes(std::uint64_t bytes) {
    return static_cast<double>(bytes) / (1 << 20);
}

std::string row(const std::string& what, const MeasuredCall& call) {
    return fmt::format("{:<44}{:>9.2f}{:>9.2f}{:>9.2f}{:>9.1f}{:>9.1f}\n", what, call.wall_s,
                       call.processor_s, static_cast<double>(call.done) / call.wall_s,
                       mebibytes(call.own_peak_bytes), mebibytes(call.largest_peak_bytes));
}

std::string steps_text(const MeasuredCall& call) {
    std::vector<std::string> steps;
    for (const auto& [step, count] : call.ran)
        steps.push_back(fmt::format("{} {}", step, count));
    return fmt::format("  steps done: {}; kept: {}\n",
                       steps.empty() ? "none" : fmt::format("{}", fmt::join(steps, ", ")),
                       call.kept);
}

std::string pages_text(const BatchFigures& figures) {
    const MeasuredCall& call = *figures.with_pages;
    const double scale = static_cast<double>(figures.attempts) / figures.rendered;
    return row(fmt::format("with pages and PDFs, {} attempts, 2 jobs", figures.rendered), call) +
           fmt::format("  scaled to {} attempts: {:.0f} s\n", figures.attempts,
                       scale * call.wall_s);
}

std::string many_text(const BatchFigures& figures) {
    const MeasuredCall& call = *figures.many_runs;
    std::string text =
        row(fmt::format("{} attempts of {} epochs, 2 jobs", figures.many, figures.many_epochs),
            call) +
        fmt::format("  first stage started after {:.2f} s\n", call.first_stage_s);
    if (figures.many_unchanged) text += row("  nothing changed, 2 jobs", *figures.many_unchanged);
    return text;
}

Json json_of_call(const MeasuredCall& call) {
    return {{"wall_s", call.wall_s},
            {"processor_s", call.processor_s},
            {"own_peak_bytes", call.own_peak_bytes},
            {"largest_peak_bytes", call.largest_peak_bytes},
            {"first_stage_s", call.first_stage_s},
            {"ran", call.ran},
            {"kept", call.kept},
            {"done", call.done}};
}

/// Steps beyond those that a changed figure of the decision asks for, and those missing of these.
double wrong_steps(const MeasuredCall& call, int attempts) {
    double wrong = 0.0;
    for (const auto& [step, count] : call.ran)
        if (step != "claim" && step != "check" && step != "report")
            wrong += static_cast<double>(count);
    for (const char* step : {"claim", "check", "report"}) {
        const auto found = call.ran.find(step);
        wrong += attempts - (found == call.ran.end() ? 0.0 : static_cast<double>(found->second));
    }
    return wrong;
}

}  // namespace

std::vector<Requirement> requirements_of(const BatchFigures& figures) {
    std::vector<Requirement> all{
        {.what = "1 job / 2 jobs, wall time",
         .found = figures.one_job.wall_s / figures.two_jobs.wall_s,
         .at_least = true,
         .limit = 1.8},
        {.what = "first call, 2 jobs: attempts a second",
         .found = figures.attempts / figures.two_jobs.wall_s,
         .at_least = true,
         .limit = 12.0},
        {.what = "nothing changed / first call, wall time, 2 jobs",
         .found = 100.0 * figures.nothing_changed.wall_s / figures.two_jobs.wall_s,
         .limit = 3.0,
         .unit = " %"},
        {.what = "nothing changed: steps done",
         .found = static_cast<double>(figures.nothing_changed.ran.size()),
         .limit = 0.0},
        {.what = "one figure changed: steps too many or missing",
         .found = wrong_steps(figures.figure_changed, figures.attempts),
         .limit = 0.0}};
    if (!figures.many_runs) return all;
    all.push_back({.what = fmt::format("{} attempts: first stage started after", figures.many),
                   .found = figures.many_runs->first_stage_s,
                   .limit = 2.0,
                   .unit = " s"});
    all.push_back({.what = fmt::format("{} attempts: memory of runcert itself", figures.many),
                   .found = mebibytes(figures.many_runs->own_peak_bytes),
                   .limit = 200.0,
                   .unit = " MiB"});
    return all;
}

std::string table_of(const BatchFigures& figures) {
    std::string text = fmt::format(
        "{} attempts of {} epochs at 10 Hz, --no-render; {} cores, load average {:.1f} to {:.1f}; "
        "medians of {}\n\n{:<44}{:>9}{:>9}{:>9}{:>9}{:>9}\n{:<44}{:>9}{:>9}{:>9}{:>9}{:>9}\n",
        figures.attempts, figures.epochs, std::thread::hardware_concurrency(), figures.load_before,
        figures.load_after, figures.calls, "", "wall", "CPU", "runs", "runcert", "largest", "", "s",
        "s", "/s", "MiB", "MiB");
    text += row("first call, 1 job, 1 thread", figures.one_job);
    text += row("first call, 2 jobs", figures.two_jobs);
    text += row("nothing changed, 2 jobs", figures.nothing_changed);
    text += row("one profile figure changed, 2 jobs", figures.figure_changed);
    text += steps_text(figures.figure_changed);
    if (figures.with_pages) text += pages_text(figures);
    if (figures.many_runs) text += many_text(figures);
    text += "\n";
    for (const Requirement& asked : requirements_of(figures))
        text += fmt::format("{:<52}{:>9.2f}{:<4}  at {} {}{:<4}  {}\n", asked.what, asked.found,
                            asked.unit, asked.at_least ? "least" : "most", asked.limit, asked.unit,
                            asked.is_met() ? "met" : "NOT MET");
    return text;
}

Json json_of(const BatchFigures& figures) {
    Json json{{"attempts", figures.attempts},
              {"epochs", figures.epochs},
              {"calls", figures.calls},
              {"cores", std::thread::hardware_concurrency()},
              {"load_average", {figures.load_before, figures.load_after}},
              {"one_job", json_of_call(figures.one_job)},
              {"two_jobs", json_of_call(figures.two_jobs)},
              {"nothing_changed", json_of_call(figures.nothing_changed)},
              {"figure_changed", json_of_call(figures.figure_changed)}};
    if (figures.with_pages)
        json["with_pages"] = {{"attempts", figures.rendered},
                              {"call", json_of_call(*figures.with_pages)}};
    if (figures.many_runs)
        json["many"] = {{"attempts", figures.many},
                        {"epochs", figures.many_epochs},
                        {"call", json_of_call(*figures.many_runs)}};
    if (figures.many_unchanged) json["many"]["unchanged"] = json_of_call(*figures.many_unchanged);
    for (const Requirement& asked : requirements_of(figures))
        json["requirements"].push_back(
            {{"what", asked.what}, {"found", asked.found}, {"met", asked.is_met()}});
    return json;
}

double load_average() {
    double load = 0.0;
    return getloadavg(&load, 1) == 1 ? load : 0.0;
}

}  // namespace runcert
