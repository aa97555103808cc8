#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "run/stage_run.h"

namespace CLI {
class App;
}

namespace runcert {

/// What a program's command line, or that of one of its commands, may hold: a facade of CLI11,
/// whose header takes longer to compile than most of the programs. Names are as CLI11 has them:
/// "--out", or "RUN_DIR" for a positional.
class CommandLine {
  public:
    enum class Need { optional, required };
    static constexpr Need required = Need::required;

    explicit CommandLine(CLI::App& app) : app_(app) {}

    void text(const std::string& name, std::string& value, const std::string& about,
              Need need = Need::optional);
    /// None where the option is not given: an empty text is one.
    void text(const std::string& name, std::optional<std::string>& value, const std::string& about);
    /// A text that is one of these words, which `about` names.
    void word(const std::string& name, std::string& value, const std::string& about,
              const std::vector<std::string>& words, Need need = Need::optional);
    /// An option that may be repeated, with one value each time; or all positionals.
    void texts(const std::string& name, std::vector<std::string>& values, const std::string& about,
               Need need = Need::optional);
    /// A whole number from `least` to `most`, which `about` names where they matter.
    void integer(const std::string& name, std::int64_t& value, const std::string& about,
                 std::int64_t least, std::int64_t most);
    void number(const std::string& name, double& value, const std::string& about, double least,
                double most);
    void flag(const std::string& name, bool& value, const std::string& about);
    /// `--time-limit`, of a command that makes or checks a run.
    void time_limit();
    /// One cannot be given with the others, which were added before.
    void exclude(const std::string& one, const std::vector<std::string>& others);
    /// One cannot be given without the other, which was added before.
    void need(const std::string& one, const std::string& other);
    /// Help says what the option is where it is not given.
    void show_default(const std::string& name);
    /// What help says after the options.
    void footer(const std::string& text);

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

/// A program beside `runcert`, and what help says of it.
struct Companion {
    std::string_view name;
    const char* summary;
};
/// Those that are commands: `runcert audit` is `runcert-audit`, which alone knows its options.
inline constexpr Companion audit_program{
    "audit", "A walk through a run: every input, decision and result, with its evidence"};
inline constexpr Companion explain_program{
    "explain", "What decides a verdict, clause by clause, in plain words"};
inline constexpr Companion compare_program{
    "compare", "All estimators' best windows side by side, and against truth where it is known"};
inline constexpr Companion export_program{"export", "A run for maps (KML) and spreadsheets (CSV)"};
inline constexpr std::array companions{audit_program, explain_program, compare_program,
                                       export_program};

/// Main of a program that looks at what the stages wrote: `options` adds to its command line, `run`
/// gives its exit status.
int reader_main(int argc, char** argv, const std::string& summary,
                const std::function<void(CommandLine&)>& options, const std::function<int()>& run);

}  // namespace runcert
