#include <fmt/format.h>

#include <filesystem>

#include "core/failure.h"
#include "core/prose.h"
#include "reports/day/day.h"
#include "reports/day/day_list.h"
#include "reports/day/shared_recordings.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "store/sha256.h"
#include "trust/run_standing.h"

using namespace runcert;

namespace {

struct Options {
    std::filesystem::path out;
    std::filesystem::path list;
};

/// Notes a file of the day as an input. Failure where it is not the one listed.
void note_listed(const Options& options, const ListedFile& listed, const FileDigest& found,
                 const std::string& role, Header& header) {
    const std::filesystem::path path = options.out / listed.file;
    if (found.sha256 != listed.sha256 || static_cast<std::int64_t>(found.bytes) != listed.bytes)
        throw Failure(path.string(),
                      fmt::format("the file is not the one that its run wrote: its SHA-256 is {}, "
                                  "expected {}",
                                  found.sha256, listed.sha256),
                      "Run the batch again, which certifies the attempt again");
    header.inputs.push_back({.role = role,
                             .file = listed.file,
                             .sha256 = found.sha256,
                             .bytes = found.bytes,
                             .original = {}});
}

std::string read_listed(const Options& options, const ListedFile& listed, const std::string& role,
                        Header& header) {
    std::string text = read_file(options.out / listed.file);
    note_listed(options, listed, digest_of(text), role, header);
    return text;
}

/// The recordings of an attempt, as its run's tables have them.
void add_recordings(const Options& options, const ListedAttempt& listed, std::size_t attempt,
                    DayResults& results, SharedRecordings& shared) {
    for (const ListedFile& file : listed.observations) {
        const FileView table(options.out / file.file);
        note_listed(options, file, digest_of(table), "observations", results.header);
        shared.add(static_cast<std::uint32_t>(attempt),
                   open_observations(table.bytes(), (options.out / file.file).string()));
    }
}

/// Who answered what of a run, and where each rule stands by it. Nobody vouches for the keys here.
void add_answers(const std::filesystem::path& run_dir, AttemptResult& result) {
    const RunStanding standing = stated_standing(run_dir, read_report_facts(run_dir), std::nullopt);
    for (const RuleStanding& rule : standing.rules)
        for (DayResult& one : result.results) {
            if (one.profile != rule.profile) continue;
            one.standing = rule.state.standing;
            for (const ClauseStanding& clause : rule.clauses)
                for (const GivenAnswer& answer : clause.answers)
                    one.answers.push_back(
                        fmt::format("{}: {}", clause.due.clause, answer_words(answer)));
        }
}

/// An attempt that is done: its verdict and its report are read, and let go of.
AttemptResult read_done(const Options& options, const ListedAttempt& listed, DayResults& results,
                        WindowCurves& curves) {
    const auto where = [&](const ListedFile& file) { return (options.out / file.file).string(); };
    const Verdict verdict = read_verdict(
        read_listed(options, *listed.verdict, "verdict", results.header), where(*listed.verdict));
    ReportIdentity report = read_report_identity(
        read_listed(options, *listed.report, "report", results.header), where(*listed.report));
    for (const ListedFile& file : listed.attestations)
        (void)read_listed(options, file, "attestation", results.header);
    add_rules(results.profiles, verdict);
    AttemptResult result = summary_of(listed, verdict, report);
    curves[listed.id] = std::move(report.curves);
    if (!listed.attestations.empty()) add_answers(options.out / listed.id, result);
    return result;
}

DayResults results_of_day(const Options& options, WindowCurves& curves) {
    const DayList list = read_day_list(read_file(options.list), options.list.string());
    DayResults results{.header = {}, .day = list.day};
    results.header.stage = "day";
    results.header.program_version = program_version();
    results.header.source_revision = source_revision();
    results.notes = list.notes;
    SharedRecordings shared;
    for (const ListedAttempt& listed : list.attempts) {
        add_recordings(options, listed, results.attempts.size(), results, shared);
        results.attempts.push_back(listed.state == "done"
                                       ? read_done(options, listed, results, curves)
                                       : summary_of(listed));
    }
    shared.note(results.attempts);
    results.counts = counts_of(results.attempts);
    for (DayProfile& profile : results.profiles) {
        profile.ranking = ranking_by(profile.profile, results.attempts);
        profile.counts = outcomes_by(profile.profile, results.attempts);
        profile.best = best_by(profile.profile, results.attempts, profile.ranking);
    }
    return results;
}

int write_day(const Options& options) {
    WindowCurves curves;
    const DayResults results = results_of_day(options, curves);
    write_file_atomically(options.out / "day.yaml", write_day_results(results));
    write_file_atomically(options.out / "day.csv", day_csv(results));
    write_file_atomically(options.out / "day.html", day_page(results, curves));
    fmt::print("day       {}, {} done, {} failed\n", counted(results.counts.attempts, "attempt"),
               counted(results.counts.done), counted(results.counts.failed));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    std::string out;
    std::string list;
    return reader_main(
        argc, argv, "The results of a day's runs: day.yaml, day.csv, day.html",
        [&](CommandLine& line) {
            line.text("--out", out, "folder of the day, which holds the run folders",
                      CommandLine::Need::required);
            line.text("--list", list,
                      "what became of each attempt: JSON, as `runcert batch` writes it",
                      CommandLine::Need::required);
        },
        [&]() -> int { return write_day({.out = out, .list = list}); });
}
