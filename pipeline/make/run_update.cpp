#include "make/run_update.h"

#include <algorithm>
#include <ctime>
#include <exception>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "make/claim.h"
#include "make/run_making.h"
#include "make/run_record.h"
#include "store/folder.h"
#include "store/folder_lock.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// The name in failures of the last thing that is done, which is no step: putting the files into
/// the run folder.
constexpr const char* publishing = "publish";

RunFailure failure_of(const std::string& step, const Failure& failure) {
    return {.step = step,
            .problem = failure.problem(),
            .where = failure.where(),
            .remedy = failure.remedy()};
}

/// Does the work of a run. A failure that no step foresaw, such as a lock that cannot be taken or
/// want of memory, is one of this run too, and stops no other.
RunState guarded(const fs::path& run_dir, const std::function<RunState()>& work) {
    const std::string& step = steps().front().name;
    try {
        return work();
    } catch (const Failure& failure) {
        return {.failure = failure_of(step, failure)};
    } catch (const std::exception& fault) {
        return {.failure = RunFailure{.step = step,
                                      .problem = fault.what(),
                                      .where = run_dir.string(),
                                      .remedy = "Check that the folder can be read and written and "
                                                "that there is memory, and run again"}};
    }
}

}  // namespace

RunMaking::RunMaking(const DayAttempt& given, const BatchContext& context, const StepWatch& watch,
                     const std::stop_token& stop)
    : given_(given),
      context_(context),
      watch_(watch),
      stop_(stop),
      folders_(context.out),
      files_(folders_.out, given.id, BatchFolders("").work(given.id)),
      record_(read_run_record(record_place())),
      started_(std::time(nullptr)),
      step_(steps().front().name) {
    state_.foreign_record = record_.foreign;
}

RecordPlace RunMaking::record_place() const {
    return {
        .file = folders_.record(given_.id), .of = "run " + given_.id, .key = context_.record_key};
}

/// What a step would now be made from.
StepRecord RunMaking::expected(const std::string& step) const {
    StepRecord record{
        .programs = context_.programs.at(step),
        .settings = settings_of_step(step, claim_.attempt, claim_.profiles, context_.report),
        .inputs = {},
        .outputs = {},
        .said = {}};
    for (const std::string& name : inputs_of(step_named(step), claim_.attempt))
        record.inputs[name] = current_.at(name);
    if (step == "claim") record.inputs = claim_.files;
    if (step == "import") record.inputs = recording_hashes(claim_);
    if (step == "render") {
        record.inputs.merge(standing_signatures());
        record.inputs.merge(standing_attestations());
        for (const auto& [name, hash] : current_)
            if (is_signature_name(name)) record.inputs[name] = hash;
    }
    return record;
}

/// Why a step must be done again; empty if it need not.
std::string RunMaking::why(const std::string& step, const StepRecord& now) {
    if (!looking_ && context_.force) return "--force";
    if (!looking_ && !context_.from.empty() &&
        std::ranges::find(steps(), step, &Step::name) >=
            std::ranges::find(steps(), context_.from, &Step::name))
        return "--from " + context_.from;
    const auto known = record_.steps.find(step);
    if (known == record_.steps.end())
        return state_.foreign_record ? "its record is not this user's" : "not done yet";
    if (std::string reason = what_changed(known->second, now); !reason.empty()) return reason;
    for (const auto& [name, hash] : known->second.outputs)
        if (!files_.find(name, hash))
            return files_.exists(name) ? name + " is not as it was written" : name + " is missing";
    return {};
}

/// Whether a step's files can stay; if not, the state's last step says why.
bool RunMaking::keeps(const std::string& step, const StepRecord& now) {
    const std::string reason = why(step, now);
    state_.steps.push_back({.step = step,
                            .ran = !reason.empty(),
                            .reason = reason.empty() ? "nothing changed" : reason});
    if (!reason.empty()) return false;
    for (const auto& [name, hash] : record_.steps.at(step).outputs)
        current_[name] = hash;
    watch_.ends(state_.steps.back());
    return true;
}

RunState RunMaking::ended(const RunFailure& failure) {
    state_.failure = failure;
    const std::string composed = folders_.composed(given_.id).string();
    if (given_.file.empty() && failure.where.find(composed) != std::string::npos)
        state_.failure->where += " (made from " + given_.source + ")";
    record_.failure = state_.failure;
    try {
        write_record();
    } catch (const Failure&) {
        // On a full disk this fails for the same reason; the next call finds out again.
    }
    return state_;
}

RunState RunMaking::update() {
    try {
        files_.remove_left();
        claim_ = read_claim(given_, folders_.composed(given_.id));
        if (const fs::path& run = files_.run_dir(); fs::is_directory(run))
            require_a_run(Folder(run), inventory_of(claim_.attempt).files, record_.published);
        make();
        step_ = publishing;
        publish();
    } catch (const Interrupted&) {
        state_.interrupted = true;
        return state_;
    } catch (const StageFailed& failed) {
        if (failed.result.end != ProcessEnd::stopped)
            return ended(failure_of_program(failed.name, failed.result, context_.time_limit));
        state_.interrupted = true;
        return state_;
    } catch (const StepError& error) {
        return ended(error.failure);
    } catch (const Failure& failure) {
        return ended(failure_of(step_, failure));
    }
    state_.complete = true;
    state_.said = record_.steps.at("check").said;
    state_.files = current_;
    return state_;
}

bool RunMaking::is_published() {
    return std::ranges::all_of(
        current_, [&](const auto& file) { return files_.is_published(file.first, file.second); });
}

RunState RunMaking::inspect() {
    looking_ = true;
    try {
        claim_ = read_claim(given_, folders_.composed(given_.id));
        for (const Step& one : steps()) {
            step_ = one.name;
            if (is_step_of(one, context_.report) && !keeps(step_, expected(step_))) break;
        }
    } catch (const Failure& failure) {
        state_.failure = failure_of(step_, failure);
        return state_;
    }
    if (state_.steps.back().ran) {
        if (record_.failure && record_.failure->step == step_) state_.failure = record_.failure;
        return state_;
    }
    state_.complete = is_published();
    if (!state_.complete && record_.failure && record_.failure->step == publishing)
        state_.failure = record_.failure;
    state_.said = record_.steps.at("check").said;
    state_.files = current_;
    return state_;
}

RunState update_run(const DayAttempt& attempt, const BatchContext& context, const StepWatch& watch,
                    const std::stop_token& stop) {
    const fs::path run_dir = context.out / attempt.id;
    return guarded(run_dir, [&]() -> RunState {
        const fs::path lock = BatchFolders("").lock(attempt.id);
        const auto taken = FolderLock::try_lock(make_below(context.out, lock.parent_path()),
                                                lock.filename().string(), LockKind::exclusive);
        if (!taken.lock)
            return {.failure =
                        RunFailure{.step = steps().front().name,
                                   .problem = "another batch makes this run: " + taken.holder,
                                   .where = run_dir.string(),
                                   .remedy = "Wait until it has ended, and run this again"}};
        return RunMaking(attempt, context, watch, stop).update();
    });
}

RunState inspect_run(const DayAttempt& attempt, const BatchContext& context) {
    return guarded(context.out / attempt.id, [&] {
        const StepWatch nobody;
        return RunMaking(attempt, context, nobody, {}).inspect();
    });
}

}  // namespace runcert
