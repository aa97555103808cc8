#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "make/run_files.h"
#include "make/run_update.h"
#include "run/chain.h"

namespace runcert {

/// Thrown where a stop was requested; the run is as it was left.
struct Interrupted {};

/// Thrown where what a step brought in is not what was hashed before.
struct StepError {
    RunFailure failure;
};

/// A run that is inspected or made, step by step.
class RunMaking {
  public:
    RunMaking(const DayAttempt& given, const BatchContext& context, const StepWatch& watch,
              const std::stop_token& stop);

    /// Does what `update_run` says, for who holds the lock of the run.
    RunState update();
    /// Does what `inspect_run` says, and writes nothing.
    RunState inspect();

  private:
    // run_update.cpp: which steps, and why.
    StepRecord expected(const std::string& step) const;
    std::string why(const std::string& step, const StepRecord& now);
    bool keeps(const std::string& step, const StepRecord& now);
    bool is_published();
    RunState ended(const RunFailure& failure);

    // run_making.cpp: doing them.
    void prepare();
    std::multimap<std::string, std::string> known_files() const;
    void make();
    void begin(const std::string& step);
    void end(const StageDone& done, StepRecord record);
    void require_as_hashed(const std::string& step, const StepRecord& record);

    std::string sign();

    // The way from and into the run folder.
    FileHashes standing_signatures() const;
    FileHashes standing_attestations() const;
    void bring_signatures();
    void publish();
    RecordPlace record_place() const;
    void write_record() const;

    const DayAttempt& given_;
    const BatchContext& context_;
    const StepWatch& watch_;
    const std::stop_token& stop_;
    BatchFolders folders_;
    mutable RunFiles files_;
    RunRecord record_;
    Claim claim_;
    FileHashes current_;  ///< every file that the steps so far made or kept
    RunState state_;
    std::time_t started_ = 0;
    std::string step_;       ///< that is inspected or done
    bool looking_ = false;   ///< the run is only inspected
    bool prepared_ = false;  ///< the work folder is open
};

}  // namespace runcert
