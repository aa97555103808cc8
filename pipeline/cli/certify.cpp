#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "commands.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "make/maker.h"
#include "make/progress.h"
#include "recognised.h"
#include "reports/document/document_text.h"
#include "reports/words/answer.h"
#include "run/chain.h"
#include "run/steps.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/process.h"
#include "store/program.h"
#include "trust/signature_files.h"
#include "trust/signing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t stage_columns = 62;  ///< of what a stage says on its line
constexpr double kept = -1.0;              ///< the seconds of a stage that was not run

struct CertifyOptions {
    std::string attempt;
    std::string out;
    std::string key;
    bool no_render = false;
    bool no_pdf = false;
    bool brief = false;
    bool quiet = false;
    bool json = false;
};

Verdict verdict_in(const fs::path& run_dir) {
    const fs::path file = run_dir / products::verdict_file;
    return read_verdict(read_file(file), file.string());
}

/// Lines at a terminal's width; a file gets them whole.
std::size_t columns_of_output() {
    return isatty(STDOUT_FILENO) != 0 ? terminal_columns() : std::string::npos;
}

std::size_t lines_in(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count(text, '\n'));
}

std::string page_to_read(const CertifyOptions& options) {
    return options.no_render ? "report.json" : options.no_pdf ? "report.html" : "certificate.pdf";
}

/// What is said of a verdict, all of it on one screen.
struct Answer {
    std::string details = {}, result = {}, next = {};
};

Answer answer_of(const Verdict& verdict, const std::vector<StageDone>& done,
                 const fs::path& run_dir, const CertifyOptions& options) {
    constexpr std::size_t screen = 24, stages = 8, blank = 2;
    const std::size_t columns = columns_of_output();
    Answer answer;
    answer.result = answer_text({answer_result(verdict)}, columns);
    answer.next = answer_text(
        {answer_next(verdict, run_dir.string(), (run_dir / page_to_read(options)).string())},
        columns);
    std::vector<AnswerLine> details = answer_details(verdict);
    if (const std::string missing = missing_sandbox(); !missing.empty())
        details.push_back({"note", missing});
    // What a stage's line has no room for, such as a witness that says nothing, and why.
    // Of a rule the answer itself says which window it is, or that there is none.
    const auto is_answered = [&](const std::string& said) {
        return std::ranges::any_of(verdict.profiles, [&](const ProfileVerdict& rule) {
            return said == rule.profile + ": no certifiable window" ||
                   (rule.speed_m_s && said.starts_with(rule.profile + ": "));
        });
    };
    for (const StageDone& stage : done)
        for (std::size_t i = 0; i < stage.said.size() && stage.name != "check"; ++i)
            if ((i > 0 || characters_in(stage.said[i]) > stage_columns) &&
                !is_answered(stage.said[i]))
                details.push_back({"note", stage.said[i]});
    const std::size_t used = stages + blank + 2 * lines_in(answer.result) + lines_in(answer.next);
    answer.details =
        columns == std::string::npos
            ? answer_text(details, columns)
            : answer_text(details, columns, screen - std::min(screen - 3, used), run_dir.string());
    return answer;
}

/// The answer for programs.
void print_json(const Verdict& verdict, const fs::path& run_dir, bool is_signed, int status,
                const std::string& superseded) {
    nlohmann::ordered_json answer{
        {"run_folder", run_dir.string()}, {"signed", is_signed}, {"exit_status", status}};
    if (!superseded.empty()) answer["superseded"] = superseded;
    answer["georeferenced"] = verdict.georeferenced;
    for (const ProfileVerdict& profile : verdict.profiles)
        answer["profiles"].push_back(members_json(profile));
    fmt::print("{}\n", answer.dump(2, ' ', true));
}

std::string stage_line(const StageDone& stage) {
    const std::string said =
        stage.said.empty() ? "" : wrapped(stage.said.front(), 0, 0, stage_columns);
    return fmt::format(
        "{:<8}{:<{}} {}\n", stage.name, said.substr(0, said.find('\n')), stage_columns,
        stage.seconds == kept ? "    kept" : fmt::format("{:>6.2f} s", stage.seconds));
}

/// What is no attempt may be a recording: the likeliest first try.
Attempt attempt_in(const std::string& file) {
    try {
        return read_attempt(read_handwritten(file), file);
    } catch (const Failure&) {
        const std::string suffix = lower_case(fs::path(file).extension().string());
        if (suffix == ".yaml" || suffix == ".yml" || !fs::is_regular_file(file)) throw;
        const Recognised recognised = recognise(file);
        const Recognition& is = recognised.is;
        // Any text of a few words a line may be a table.
        if (recognised.said.exit_status != 0 || is.kind == RecordingKind::table) throw;
        throw Failure(file,
                      fmt::format("this is a recording ({}), and no attempt",
                                  is.format.empty() ? "a series" : is.format),
                      fmt::format("Write an attempt from it first: runcert new {}",
                                  shell_word(plain_text(file))));
    }
}

std::vector<std::string> pages_of(const CertifyOptions& options) {
    if (options.no_render) return {};
    if (options.no_pdf) return {"report.html"};
    if (options.brief) return {"report.html", "certificate.pdf"};
    return {page_names.begin(), page_names.end()};
}

/// What the user sees of a run while it is made.
class Shown {
  public:
    Shown(const CertifyOptions& options, fs::path run_dir)
        : options_(options),
          run_dir_(std::move(run_dir)),
          says_stages_(!options.json && !options.quiet),
          progress_(make_progress(
              {.style = says_stages_ ? progress_style_for(stdout) : ProgressStyle::plain,
               .took = seconds_of_steps(run_dir_ / run_times_name)})) {}

    MakerWatch watch() {
        return {.begins =
                    [this](const std::string& step) {
                        if (step != "render") progress_({.what = StepBegins{step}});
                        if (step == "report") report_began_ = Clock::now();
                    },
                .ends = [this](const StepReport& step, const StepRecord& record,
                               const fs::path& folder) { ends(step, record, folder); },
                .published = [this] { published(); }};
    }

    /// The run has its place. Its pages are named where they can be opened.
    void published() {
        if (std::exchange(is_published_, true)) return;
        if (report_began_ != Clock::time_point())
            report_.seconds = std::chrono::duration<double>(Clock::now() - report_began_).count();
        show(report_);
        progress_ = nullptr;  // what follows is printed without it
        if (!options_.json)
            fmt::print("        {}{}\n", (run_dir_ / page_to_read(options_)).string(),
                       is_signed() ? " (signed)" : " (UNSIGNED: give --key to sign it)");
        std::fflush(stdout);
    }

    void clear() { progress_ = nullptr; }
    bool is_signed() const { return !signature_files(run_dir_).empty(); }
    const Verdict& verdict() const { return verdict_; }
    const Answer& answer() const { return answer_; }

  private:
    using Clock = std::chrono::steady_clock;

    void ends(const StepReport& step, const StepRecord& record, const fs::path& folder) {
        StageDone done{.name = step.step, .said = record.said, .seconds = record.seconds};
        if (!step.ran) done.seconds = kept;
        if (step.step == "check") verdict_ = verdict_in(folder);
        // One line to the user, with its pages.
        if (step.step == "report")
            report_ = done;
        else if (step.step == "render")
            report_.said = done.said;
        else if (!step_named(step.step).program.empty())
            show(done);
    }

    void show(StageDone stage) {
        stages_.push_back(stage);
        if (stage.name == "check") stage.said = {"answer below"};
        if (says_stages_) progress_({.what = Note{stage_line(stage)}});
        // The answer is there before anything is drawn; where time may run out, at the end.
        if (stage.name != (time_is_limited() ? "report" : "check") || options_.json) return;
        answer_ = answer_of(verdict_, stages_, run_dir_, options_);
        const bool with_result = !options_.no_render && !time_is_limited();
        progress_({.what = Note{fmt::format("\n{}{}\n", answer_.details,
                                            with_result ? answer_.result : "")}});
    }

    const CertifyOptions& options_;
    fs::path run_dir_;
    bool says_stages_;
    Progress progress_;
    std::vector<StageDone> stages_;
    StageDone report_;
    Clock::time_point report_began_;
    Verdict verdict_;
    Answer answer_;
    bool is_published_ = false;
};

int certify(const CertifyOptions& options) {
    const Attempt attempt = attempt_in(options.attempt);
    if (!options.key.empty()) (void)signing_role(attempt);
    MakerOptions making = maker_options(pages_of(options), options.key);
    making.pages_ahead = true;
    const fs::path run_dir =
        options.out.empty() ? fs::path("out") / attempt.id : fs::path(options.out);
    const fs::path file = options.attempt;
    const GivenAttempt given{
        .id = attempt.id, .source = options.attempt, .file = file, .folder = file.parent_path()};
    Shown shown(options, run_dir);
    const RunState state = update_run({.attempt = given, .run_dir = run_dir, .is_named = true},
                                      making, shown.watch(), {});
    if (state.failure) {
        shown.clear();
        throw Failure(state.failure->where, state.failure->problem, state.failure->remedy);
    }
    shown.published();
    const Verdict& verdict = shown.verdict();
    const bool all_beaten = std::ranges::all_of(
        verdict.profiles, [](const auto& one) { return one.outcome == Outcome::beaten; });
    const int status = all_beaten ? 0 : 1;
    if (options.json) {
        print_json(verdict, run_dir, shown.is_signed(), status, state.superseded);
        return status;
    }
    if (!state.superseded.empty())
        fmt::print("        the earlier run is in {}\n", (run_dir / state.superseded).string());
    fmt::print("{}{}", shown.answer().result, shown.answer().next);
    return status;
}

}  // namespace

void add_certify(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<CertifyOptions>(
        app, chosen, "certify",
        "Measure an attempt: recordings in, a signed measurement report out", certify);
    line.text("ATTEMPT", options.attempt, "the attempt's file (YAML)", CommandLine::required);
    line.text("--out", options.out, "run folder to write (default: out/ID)");
    line.text("--key", options.key, "secret key to sign the report with");
    line.flag("--no-pdf", options.no_pdf, "report.json and HTML alone");
    line.flag("--brief", options.brief, "certificate.pdf, the first page, and no report.pdf");
    line.flag("--no-render", options.no_render, "stop after report.json: no HTML, no PDF");
    line.flag("--quiet", options.quiet, "print the verdict, and nothing of the stages");
    line.flag("--json", options.json, "print one JSON document instead");
    line.exclude("--json", {"--quiet"});
    line.time_limit();
    line.footer(fmt::format(
        "Exit status: 0 the outcome of every profile is beaten, 1 one is not, 2 no certificate\n"
        "could be made. It goes by the outcome alone: requirements that remain to be attested and\n"
        "missing signatures do not change it.\n"
        "RUNCERT_THREADS=N in the environment: no more than N threads (left out: one for each\n"
        "processor). The results are the same.\n\n"
        "An attempt (schema attempt/1.0; runcert new RECORDING writes one, and examples/ has some\n"
        "that run as they are):\n\n"
        "  schema: attempt/1.0\n"
        "  id: lake-run-1\n"
        "  craft: {{name: yacht, class: land-yacht}}\n"
        "  officials: [{{role: measurer}}]\n"
        "  receivers:\n"
        "    - {{id: primary, recording: rover.pos}}\n"
        "  record: {{speed: 202.9, unit: km/h, source: where it is published}}\n"
        "  profiles: [nalsa]\n\n"
        "Every key:\n{}",
        attempt_schema().field_table()));
}

}  // namespace runcert
