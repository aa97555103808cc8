#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "run/stage_run.h"

namespace CLI {
class App;
}

namespace runcert {

/// What a program's command line may hold: a facade of CLI11, whose header takes longer to compile
/// than most of the programs. Names are as CLI11 has them: "--out", or "RUN_DIR" for a positional.
class CommandLine {
  public:
    enum class Need { optional, required };

    explicit CommandLine(CLI::App& app) : app_(app) {}

    void text(const std::string& name, std::string& value, const std::string& about,
              Need need = Need::optional);
    /// A text that is one of these words.
    void word(const std::string& name, std::string& value, const std::string& about,
              const std::vector<std::string>& words, Need need = Need::optional);
    /// An option that may be repeated.
    void texts(const std::string& name, std::vector<std::string>& values, const std::string& about);
    /// A whole number from `least` to `most`.
    void integer(const std::string& name, std::int64_t& value, const std::string& about,
                 std::int64_t least, std::int64_t most);
    void flag(const std::string& name, bool& value, const std::string& about);
    /// One cannot be given with the other, which was added before.
    void exclude(const std::string& one, const std::string& other);

  private:
    CLI::App& app_;
};

/// Runs `body` as a program's main: a Failure is printed on standard error in three lines (what,
/// where, what to do) and gives exit status 2; so does memory that runs out. Where another program
/// of ours runs this one, it ends with that one.
int guarded_main(const std::function<int()>& body);

/// Main of a stage program: reads `--attempt ATTEMPT.yaml --run-dir DIR` (and what `options` adds),
/// runs the stage, prints what it says. `summary` is the first line of --help. `before` is called
/// before anything is read.
int stage_main(int argc, char** argv, const std::string& stage, const std::string& summary,
               const std::function<void(StageRun&)>& body,
               const std::function<void(CommandLine&)>& options = {},
               const std::function<void()>& before = {});

/// Main of a program that looks at what the stages wrote: `options` adds to its command line, `run`
/// gives its exit status.
int reader_main(int argc, char** argv, const std::string& name, const std::string& summary,
                const std::function<void(CommandLine&)>& options, const std::function<int()>& run);

}  // namespace runcert
