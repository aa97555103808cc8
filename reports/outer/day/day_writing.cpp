#include "reports/day/day_writing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "reports/day/shared_recordings.h"
#include "reports/day/summary.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/process.h"
#include "store/program.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/run_standing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* results_step = "results";
constexpr std::array day_files{"day.yaml", "day.csv", "day.html"};

/// Reads a file of a run and notes it as an input of the day's results. Failure where it is not as
/// its run wrote it.
FileView read_noted(const DayOutcome& of, const fs::path& out, const std::string& name,
                    const std::string& role, Header& header) {
    const std::string file = of.attempt.id + "/" + name;
    FileView view(out / file);
    const FileDigest found = digest_of(view);
    if (const auto known = of.outcome.files.find(name);
        known != of.outcome.files.end() && known->second != found.sha256)
        throw Failure((out / file).string(),
                      fmt::format("the file is not the one that its run wrote: its SHA-256 is {}, "
                                  "expected {}",
                                  found.sha256, known->second),
                      "Run the batch again, which certifies the attempt again");
    header.inputs.push_back({.role = role,
                             .file = file,
                             .sha256 = found.sha256,
                             .bytes = static_cast<std::int64_t>(found.bytes),
                             .original = {}});
    return view;
}

/// Who answered what of a run, and where each rule stands by it. Nobody vouches for the keys here.
void add_answers(const fs::path& run_dir, AttemptResult& result) {
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
AttemptResult read_done(const DayOutcome& of, const fs::path& out, DayResults& results,
                        WindowCurves& curves) {
    const fs::path run_dir = out / of.attempt.id;
    const auto text_of = [&](const std::string& name, const std::string& role) {
        return std::string(read_noted(of, out, name, role, results.header).bytes());
    };
    const std::string verdict_name(products::verdict_file);
    const Verdict verdict =
        read_verdict(text_of(verdict_name, "verdict"), (run_dir / verdict_name).string());
    const std::string verdict_sha256 = results.header.inputs.back().sha256;
    ReportIdentity report =
        read_report_identity(text_of("report.json", "report"), (run_dir / "report.json").string());
    std::set<std::string> answers = attestation_names(run_dir);
    std::erase_if(answers,
                  [&](const std::string& name) { return !fs::is_regular_file(run_dir / name); });
    for (const std::string& name : answers)
        (void)text_of(name, "attestation");
    add_rules(results.profiles, verdict);
    AttemptResult result = summary_of(of, verdict, verdict_sha256, report);
    for (const char* const page : page_names)
        if (of.outcome.files.contains(page))
            result.pages.push_back(fmt::format("{}/{}", of.attempt.id, page));
    curves[of.attempt.id] = std::move(report.curves);
    if (!answers.empty()) add_answers(run_dir, result);
    return result;
}

/// The recordings of an attempt, as its run's tables have them.
void add_recordings(const DayOutcome& of, const fs::path& out, std::size_t attempt,
                    DayResults& results, SharedRecordings& shared) {
    for (const auto& [name, hash] : of.outcome.files)
        if (name.starts_with(products::observations.stem)) {
            const FileView table = read_noted(of, out, name, "observations", results.header);
            shared.add(static_cast<std::uint32_t>(attempt),
                       open_observations(table.bytes(), (out / of.attempt.id / name).string()));
        }
}

/// Folders of results that hold a run of no attempt of the day.
std::vector<std::string> runs_without_attempt(const Day& day, const fs::path& out) {
    std::set<std::string> ids;
    for (const GivenAttempt& attempt : day.attempts)
        ids.insert(attempt.id);
    std::vector<std::string> names;
    const Folder results(out);
    for (const std::string& name : results.names())
        if (!ids.contains(name) && !name.starts_with('.') &&
            results.kind_of(name) == EntryKind::folder && fs::exists(out / name / "report.json"))
            names.push_back(name);
    return names;
}

/// What the results depend on beside the program: a text that is the same where they are.
std::string made_from(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                      const std::vector<std::string>& notes, const fs::path& out) {
    Json text{{"day", day.name}, {"notes", notes}};
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const AttemptOutcome& outcome = outcomes[i];
        const GivenAttempt& attempt = day.attempts[i];
        Json one{attempt.id, attempt.source, outcome.state, outcome.reason, outcome.files};
        if (outcome.failure)
            one.push_back({outcome.failure->step, outcome.failure->problem, outcome.failure->where,
                           outcome.failure->remedy});
        if (outcome.state == "done")
            for (const std::string& name : attestation_names(out / attempt.id))
                if (fs::is_regular_file(out / attempt.id / name))
                    one.push_back(digest_file(out / attempt.id / name).sha256);
        text["attempts"].push_back(std::move(one));
    }
    return text.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Moves an entry that this user's calls did not write to the first free name among what was
/// superseded.
void set_aside(const Folder& folder, const std::string& name) {
    const Folder kept = folder.make(batch_folder).make("superseded");
    std::string free = name;
    for (int number = 2; kept.kind_of(free) != EntryKind::none; ++number)
        free = fmt::format("{}.{}", name, number);
    folder.rename(name, kept, free);
}

std::string hash_of(const fs::path& file) {
    return fs::is_regular_file(fs::symlink_status(file)) ? digest_file(file).sha256 : "";
}

}  // namespace

DayResults results_of_day(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                          const std::vector<std::string>& notes, const fs::path& out,
                          WindowCurves& curves) {
    DayResults results{.header = {}, .day = day.name};
    results.header.stage = "day";
    results.header.program_version = program_version();
    results.header.source_revision = source_revision();
    results.notes = notes;
    SharedRecordings shared;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const DayOutcome of{day.attempts[i], outcomes[i]};
        const bool done = of.outcome.state == "done";
        if (done) add_recordings(of, out, i, results, shared);
        results.attempts.push_back(done ? read_done(of, out, results, curves) : summary_of(of));
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

void write_day(const Day& day, const std::vector<AttemptOutcome>& outcomes, const fs::path& out) {
    std::vector<std::string> notes = day.notes;
    for (const std::string& id : runs_without_attempt(day, out))
        notes.push_back(
            fmt::format("The folder {} holds a run that no attempt of this day makes", id));
    StepRecord now;
    now.programs = {{"runcert", digest_file("/proc/self/exe").sha256}};
    now.inputs = {{"runs", sha256_hex(made_from(day, outcomes, notes, out))}};
    const std::string earlier = hash_of(out / day_files.front());
    const StepRecord before = recalled_record(earlier)[results_step];
    const auto is_as_written = [&](const char* name) {
        const auto known = before.outputs.find(name);
        return known != before.outputs.end() && hash_of(out / name) == known->second;
    };
    if (what_changed(before, now).empty() && std::ranges::all_of(day_files, is_as_written)) return;
    WindowCurves curves;
    const DayResults results = results_of_day(day, outcomes, notes, out, curves);
    for (const char* name : day_files)
        if (fs::exists(fs::symlink_status(out / name)) && !is_as_written(name))
            set_aside(Folder(out), name);
    write_file_atomically(out / "day.yaml", write_day_results(results));
    write_file_atomically(out / "day.csv", day_csv(results));
    write_file_atomically(out / "day.html", day_page(results, curves));
    for (const char* name : day_files)
        now.outputs[name] = hash_of(out / name);
    remember_record(now.outputs[day_files.front()], {{results_step, now}}, earlier);
}

}  // namespace runcert
