#include "make/maker.h"

#include <algorithm>
#include <ctime>
#include <exception>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "make/claim.h"
#include "make/early_pages.h"
#include "run/chain.h"
#include "run/run_lock.h"
#include "run/staging_folder.h"
#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/sha256.h"
#include "store/user_state.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/signature_files.h"
#include "trust/signing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* report_file = "report.json";

/// The name in failures of the last thing that is done, which is no step: letting the run take its
/// place.
constexpr const char* publishing = "publish";

/// Thrown where a stop was requested; the run is as it was.
struct Interrupted {};

/// A run folder with other files in it does not verify, whoever signs its report.
void require_no_strangers(const fs::path& run_dir) {
    std::vector<std::string> strangers = unknown_files(run_dir);
    std::erase(strangers, superseded_folder);
    if (strangers.empty()) return;
    throw Failure((run_dir / strangers.front()).string(),
                  "this is no part of the run; nothing was signed",
                  "Move it out of the folder, and run this again");
}

/// The signature of this very report that the key made before in that role, if there is one: it and
/// its time stamp stay.
std::optional<std::string> own_signature(const fs::path& folder, const ReportFacts& report,
                                         const PublicKey& key, const std::string& role) {
    for (const SignatureFile& file : signature_files(folder)) {
        if (file.kind != SignatureKind::minisign) continue;
        try {
            const SignatureCheck check = check_signature(report.text, file.text, key, file.name);
            if (check.valid && parse_trusted_comment(check.trusted_comment).role == role)
                return file.name;
        } catch (const Failure&) {
            // No signature, whatever it is.
        }
    }
    return std::nullopt;
}

/// A run that is inspected or made, step by step.
class Maker {
  public:
    Maker(const RunOrder& order, const MakerOptions& options, const MakerWatch& watch,
          const std::stop_token& stop)
        : order_(order), options_(options), watch_(watch), stop_(stop) {}

    RunState update() {
        try {
            refuse_link();
            clear_left();
            look();
            if (all_stay())
                for (const StepReport& step : state_.steps)
                    watch_.ends(step, record_.at(step.step), order_.run_dir);
            else
                make();
            state_.complete = true;
            state_.said = record_.at("check").said;
            state_.files = current_;
        } catch (const Interrupted&) {
            state_.interrupted = true;
        } catch (const StageFailed& failed) {
            if (failed.result.end == ProcessEnd::stopped)
                state_.interrupted = true;
            else
                fail(failure_of_program(failed.name, failed.result,
                                        options_.time_limit.value_or(std::chrono::seconds(0))));
        } catch (const std::exception& fault) {
            fail(failure_of(fault));
        }
        return state_;
    }

    RunState inspect() {
        looking_ = true;
        try {
            refuse_link();
            look();
        } catch (const std::exception& fault) {
            state_.failure = failure_of(fault);
            return state_;
        }
        if (all_stay()) {
            state_.complete = true;
            state_.said = record_.at("check").said;
            state_.files = current_;
        } else {
            state_.failure = recalled_failure(order_.run_dir, claim_.files);
        }
        return state_;
    }

  private:
    /// The steps up to the first that cannot stay.
    void look() {
        record_ = recalled_record(in_run_folder(report_file));
        claim_ = read_claim(order_.attempt);
        for (const Step& one : steps()) {
            step_ = one.name;
            if (is_step_of(one, options_.report) && !keeps(step_, expected(step_))) break;
        }
    }

    /// What ended the present step. A fault that nothing foresaw, such as want of memory, is one of
    /// this run too, and stops no other.
    RunFailure failure_of(const std::exception& fault) const {
        if (const auto* failure = dynamic_cast<const Failure*>(&fault))
            return {.step = step_,
                    .problem = failure->problem(),
                    .where = failure->where(),
                    .remedy = failure->remedy()};
        return {.step = step_,
                .problem = fault.what(),
                .where = order_.run_dir.string(),
                .remedy =
                    "Check that the folder can be read and written and that there is memory, "
                    "and run again"};
    }

    bool all_stay() const { return !state_.steps.empty() && !state_.steps.back().ran; }

    void refuse_link() const {
        if (!order_.is_named && fs::is_symlink(fs::symlink_status(order_.run_dir)))
            (void)Folder(folder_of(order_.run_dir)).open(order_.run_dir.filename().string());
    }

    /// Removes what killed programs left, also where nothing is made.
    void clear_left() const {
        if (!fs::is_directory(order_.run_dir)) return;
        if (order_.is_named) clear_abandoned(Folder(folder_of(fs::canonical(order_.run_dir))));
        const Folder run(order_.run_dir);
        if (std::ranges::none_of(run.names(), is_own_name)) return;
        const RunLock lock(order_.run_dir);  // which removes files
        clear_abandoned(run);
    }

    /// The hash of a file of the run folder; empty where there is none.
    std::string in_run_folder(const std::string& name) {
        const auto known = in_run_folder_.find(name);
        if (known != in_run_folder_.end()) return known->second;
        const fs::path file = order_.run_dir / name;
        const bool regular = fs::is_regular_file(fs::symlink_status(file));
        return in_run_folder_[name] = regular ? digest_file(file).sha256 : "";
    }

    bool has_same_report() { return in_run_folder(report_file) == current_.at(report_file); }

    /// What a step would now be made from.
    StepRecord expected(const std::string& step) {
        StepRecord now;
        now.settings = settings_of_step(step, claim_.attempt, claim_.profiles, options_.report);
        for (const std::string& name : inputs_of(step_named(step), claim_.attempt))
            now.inputs[name] = current_.at(name);
        if (step == "claim") now.inputs = claim_.files;
        if (step == "import") {
            if (recordings_.empty()) recordings_ = recording_hashes(claim_);
            now.inputs = recordings_;
        }
        if (step == "render") {
            now.inputs.merge(standing_signatures());
            now.inputs.merge(standing_attestations());
            for (const auto& [name, hash] : current_)
                if (is_signature_name(name)) now.inputs[name] = hash;
        }
        return now;
    }

    /// Why a step must be done again; empty if it need not.
    std::string why(const std::string& step, StepRecord& now) {
        if (options_.force && !looking_) return "--force";
        if (!options_.from.empty() && !looking_ &&
            std::ranges::find(steps(), step, &Step::name) >=
                std::ranges::find(steps(), options_.from, &Step::name))
            return "--from " + options_.from;
        const auto known = record_.find(step);
        if (known == record_.end()) return "not done yet";
        now.programs = programs_.get().at(step);
        if (std::string reason = what_changed(known->second, now); !reason.empty()) return reason;
        for (const auto& [name, hash] : known->second.outputs)
            if (in_run_folder(name) != hash)
                return in_run_folder(name).empty() ? name + " is missing"
                                                   : name + " is not as it was written";
        return {};
    }

    /// Whether a step's files can stay; if not, the state's last step says why.
    bool keeps(const std::string& step, StepRecord now) {
        const std::string reason = why(step, now);
        state_.steps.push_back({.step = step,
                                .ran = !reason.empty(),
                                .reason = reason.empty() ? "nothing changed" : reason});
        now_ = std::move(now);
        if (!reason.empty()) return false;
        const StepRecord& record = record_.at(step);
        for (const auto& [name, hash] : record.outputs) {
            current_[name] = hash;
            if (staging_) staging_->earlier().place(name, staging_->folder());
        }
        if (staging_) watch_.ends(state_.steps.back(), record, order_.run_dir);
        return true;
    }

    /// Does the steps whose files cannot stay, in a folder beside the run's; the others' files are
    /// put there, too.
    void make() {
        if (order_.is_named)
            staging_.emplace(order_.run_dir);
        else
            staging_.emplace(Folder(folder_of(order_.run_dir)), order_.run_dir.filename().string());
        in_run_folder_.clear();  // whoever had the lock may have made the run
        require_own_run();
        state_.steps.clear();
        current_.clear();
        ProcessOptions process{.environment = {synced_by_caller()},
                               .time_limit = options_.time_limit,
                               .stop = stop_,
                               .most_output = most_output_of_step,
                               .own_group = options_.own_group};
        if (options_.threads > 0)
            process.environment.emplace_back("RUNCERT_THREADS", std::to_string(options_.threads));
        make_run(
            {.attempt = claim_.attempt,
             .text = claim_.text,
             .source = claim_.source,
             .folder = staging_->path(),
             .known_as = order_.run_dir,
             .report = options_.report,
             .programs = options_.program_folder,
             .process = process,
             .latest = options_.latest,
             .sign = [this] { return sign(); },
             .draw =
                 options_.pages_ahead ? [this] { return draw(); } : std::function<StageDone()>()},
            [this](const Step& step) {
                step_ = step.name;
                if (keeps(step.name, expected(step.name))) return true;
                begin(step.name);
                return false;
            },
            [this](const StageDone& done) { end(done); });
        step_ = publishing;
        publish();
    }

    /// Failure where the run folder holds files of a run's names that no run put there.
    void require_own_run() const {
        require_a_run(staging_->earlier(), inventory_of(claim_.attempt).files,
                      last_published(order_.run_dir).names);
    }

    void begin(const std::string& step) {
        if (stop_.stop_requested()) throw Interrupted{};
        watch_.begins(step);
        const bool has_pages = options_.pages_ahead && !options_.report.pages.empty();
        if (has_pages && !early_) early_.emplace(staging_->path(), options_.report.pages);
        if (has_pages && step == "report") early_->expect_whole();
        if (step == "render") bring_signatures();
    }

    StageDone draw() { return early_->draw(); }

    /// Keeps what a step said and wrote.
    void end(const StageDone& done) {
        now_.programs = programs_.get().at(done.name);
        now_.outputs = hashes_of(done.wrote);
        if (done.name == "claim" || done.name == "import") require_as_hashed();
        now_.said = done.said;
        now_.seconds = done.seconds;
        for (const auto& [name, hash] : now_.outputs)
            current_[name] = hash;
        state_.steps.back().seconds = done.seconds;
        record_[done.name] = now_;
        watch_.ends(state_.steps.back(), now_, staging_->path());
    }

    /// Of files that were just written.
    FileHashes hashes_of(const std::vector<std::string>& names) const {
        FileHashes hashes;
        for (const std::string& name : names) {
            const fs::path file = staging_->path() / name;
            if (!fs::is_regular_file(file))
                throw Failure(file.string(), "the program ended well without this file",
                              "This is a fault of the program; please report it with the attempt");
            hashes[name] = digest_file(file).sha256;
        }
        return hashes;
    }

    /// Refuses what a step brought in from outside if it is not what was hashed before. Else the
    /// record would name files that the run was not made from, and trust the run when they are put
    /// back.
    void require_as_hashed() const {
        FileHashes brought_in = claim_.files;  // which import brings in once more
        brought_in.insert(now_.inputs.begin(), now_.inputs.end());
        for (const auto& [name, hash] : brought_in) {
            const auto written = now_.outputs.find(name);
            if ((written != now_.outputs.end()
                     ? written->second
                     : digest_file(staging_->path() / name).sha256) != hash)
                throw Failure(
                    claim_.source.file.string(),
                    "what the run keeps as " + name + " changed while it was read",
                    "Leave the files of the attempt as they are while the run is made, and run "
                    "this again");
        }
    }

    /// The signatures in the run folder that are of this run's report, beside those made now.
    FileHashes standing_signatures() {
        FileHashes hashes;
        if (!has_same_report()) return hashes;
        for (const SignatureFile& file : signature_files(order_.run_dir))
            if (!current_.contains(file.name)) hashes[file.name] = sha256_hex(file.text);
        return hashes;
    }

    /// The attestations there of this run's report.
    FileHashes standing_attestations() {
        FileHashes hashes;
        if (!has_same_report()) return hashes;
        for (const std::string& name : attestation_names(order_.run_dir))
            if (const fs::path file = order_.run_dir / name; fs::is_regular_file(file))
                hashes[name] = digest_file(file).sha256;
        return hashes;
    }

    /// Puts the standing signatures and attestations beside the new report: pages show them, and a
    /// new signature stands beside them.
    void bring_signatures() {
        if (!has_same_report()) return;
        const Folder& earlier = staging_->earlier();
        for (const auto& [name, hash] : standing_signatures())
            earlier.place(name, staging_->folder());
        carry_attestations(earlier, staging_->folder(), true);
    }

    /// Signs the report that the steps so far made or kept, and returns the name of the signature.
    /// A file that was changed since it was hashed is not signed.
    std::string sign() {
        bring_signatures();
        const fs::path& folder = staging_->path();
        const ReportFacts report = read_report_facts(folder);
        if (sha256_hex(report.text) != current_.at(report_file))
            throw Failure((folder / report_file).string(),
                          "the report changed while the run was made; nothing was signed",
                          "Find out who writes into the folder, and run this again");
        require_signable(folder, report, "Make the run again with --force");
        // A user who names the folder may keep files of his own in it.
        if (!order_.is_named && has_same_report()) require_no_strangers(order_.run_dir);
        const std::string role = signing_role(claim_.attempt);
        if (auto standing = own_signature(folder, report, public_key_of(*options_.key), role))
            return *standing;
        state_.signs = what_is_signed(folder);
        return sign_report(folder, report, *options_.key, role);
    }

    /// The run is whole beside the earlier one before it takes that one's place.
    void publish() {
        if (!in_run_folder(report_file).empty() && !has_same_report())
            state_.superseded = superseded_name(staging_->earlier());
        carry_over(staging_->earlier(), staging_->folder());
        std::vector<StageDone> stages;
        for (const Step& step : steps())
            if (const auto done = record_.find(step.name);
                done != record_.end() && is_step_of(step, options_.report))
                stages.push_back({.name = step.name,
                                  .said = done->second.said,
                                  .seconds = done->second.seconds});
        staging_->folder().write(run_times_name, run_times_text(started_, stages));
        // Where time may run out, all is there before anything takes the earlier run's place.
        if (early_ && time_is_limited()) put_whole_into(staging_->path());
        require_time();
        const std::string before = last_published(order_.run_dir).report_sha256;
        staging_->publish();
        remember_record(current_.at(report_file), record_, before);
        remember_failure(order_.run_dir, claim_.files, {});
        watch_.published();
        if (early_) put_whole_into(order_.run_dir);
    }

    void put_whole_into(const fs::path& folder) {
        step_ = "render";
        if (!early_->put_whole_into(folder)) return;
        FileHashes& outputs = record_.at("render").outputs;
        outputs["report.pdf"] = current_["report.pdf"] = digest_file(folder / "report.pdf").sha256;
        if (folder == order_.run_dir) remember_record(current_.at(report_file), record_);
    }

    void fail(RunFailure failure) {
        for (std::string* text : {&failure.problem, &failure.where})
            if (staging_) replace_all(*text, staging_->path().string(), order_.run_dir.string());
        state_.failure = std::move(failure);
        remember_failure(order_.run_dir, claim_.files, state_.failure);
    }

    const RunOrder& order_;
    const MakerOptions& options_;
    const MakerWatch& watch_;
    const std::stop_token& stop_;
    std::shared_future<std::map<std::string, StepPrograms>> programs_ = options_.programs;
    RunRecord record_;
    Claim claim_;
    FileHashes recordings_;     ///< that import reads
    FileHashes in_run_folder_;  ///< files of the run folder
    FileHashes current_;        ///< every file that the steps so far made or kept
    StepRecord now_;            ///< of the step that is done
    RunState state_;
    bool looking_ = false;  ///< the run is only inspected
    std::string step_ = steps().front().name;
    std::optional<StagingFolder> staging_;
    std::optional<EarlyPages> early_;
    std::time_t started_ = std::time(nullptr);
};

}  // namespace

MakerOptions maker_options(std::vector<std::string> pages, const std::string& key_file) {
    MakerOptions options;
    options.programs =
        std::async(std::launch::async, [] { return programs_of_steps(program_folder()); }).share();
    options.report.pages = std::move(pages);
    options.latest = end_of_tomorrow(std::time(nullptr));
    if (key_file.empty()) return options;
    options.key = load_secret_key(key_file);
    options.report.signer = key_id_text({.key_id = options.key->key_id()});
    return options;
}

RunState update_run(const RunOrder& order, const MakerOptions& options, const MakerWatch& watch,
                    const std::stop_token& stop) {
    return Maker(order, options, watch, stop).update();
}

RunState inspect_run(const RunOrder& order, const MakerOptions& options) {
    const MakerWatch nobody;
    const std::stop_token never;
    return Maker(order, options, nobody, never).inspect();
}

}  // namespace runcert
