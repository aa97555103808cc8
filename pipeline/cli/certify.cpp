#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "make/progress.h"
#include "recognised.h"
#include "reports/document/document_text.h"
#include "reports/words/answer.h"
#include "run/attempt_files.h"
#include "run/chain.h"
#include "run/staging_folder.h"
#include "run/steps.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/folder.h"
#include "store/process.h"
#include "store/program.h"
#include "trust/signature_files.h"
#include "trust/signing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* run_times_name = "run.yaml";
constexpr std::size_t stage_columns = 62;  ///< of what a stage says on its line

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
void print_json(const Verdict& verdict, const fs::path& run_dir, bool is_signed, int status) {
    nlohmann::ordered_json answer{
        {"run_folder", run_dir.string()}, {"signed", is_signed}, {"exit_status", status}};
    answer["georeferenced"] = verdict.georeferenced;
    for (const ProfileVerdict& profile : verdict.profiles)
        answer["profiles"].push_back(members_json(profile));
    fmt::print("{}\n", answer.dump(2, ' ', true));
}

std::string stage_line(const StageDone& stage) {
    const std::string said =
        stage.said.empty() ? "" : wrapped(stage.said.front(), 0, 0, stage_columns);
    return fmt::format("{:<8}{:<{}} {:>6.2f} s\n", stage.name, said.substr(0, said.find('\n')),
                       stage_columns, stage.seconds);
}

/// Pages of a run in making. What draws them is started while the run is measured, and waits for
/// the report on its standard input: starting takes it longer than drawing the first page.
class PagesToCome {
  public:
    PagesToCome(const fs::path& run_dir, const std::vector<std::string>& pages) {
        std::array<int, 2> ends{};
        if (pipe2(ends.data(), O_CLOEXEC) != 0)
            throw Failure("starting a program", std::strerror(errno), "Close other programs");
        input_ = FileDescriptor(ends[0]);
        begin_ = FileDescriptor(ends[1]);
        const StepCall call{.attempt = run_dir / attempt_copy_name,
                            .run_dir = run_dir,
                            .pages = pages,
                            .waits = true};
        ProcessOptions options{.environment = {synced_by_caller()}};
        options.standard_input = fmt::format("/proc/self/fd/{}", input_.number());
        done_ = std::async(std::launch::async,
                           [call, options] { return run_step("render", call, options); });
    }
    /// The report is there.
    void begin() { (void)write(begin_.number(), "\n", 1); }
    StageDone drawn() { return done_.get(); }

  private:
    FileDescriptor input_;
    std::future<StageDone> done_;
    FileDescriptor begin_;  // closed first: a program that waits ends
};

/// report.pdf, which takes longest: drawn beside the first page, in a folder of its own, and put
/// into the run when that is in its place.
class WholeReport {
  public:
    void begin(const fs::path& staged) {
        take_report(staged, folder_.path());
        fs::copy_file(staged / attempt_copy_name, folder_.path() / attempt_copy_name);
        page_.begin();
    }
    void put_into(const fs::path& run_dir) {
        page_.drawn();
        write_file_atomically(run_dir / name, read_file(folder_.path() / name));
    }

  private:
    static constexpr const char* name = "report.pdf";
    TemporaryFolder folder_;
    PagesToCome page_{folder_.path(), {name}};
};

/// Whether a step is one that the user sees by itself: not what it takes no time to do.
bool is_shown(const StageDone& step) {
    return !step_named(step.name).program.empty();
}

/// The attempt and its text. What is no attempt may be a recording: the likeliest first try.
std::pair<Attempt, std::string> attempt_in(const std::string& file) {
    try {
        std::string text = read_handwritten(file);
        Attempt attempt = read_attempt(text, file);
        return {std::move(attempt), std::move(text)};
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

/// Those that are drawn before the run takes its place.
std::vector<std::string> first_pages(const CertifyOptions& options) {
    if (options.no_render) return {};
    if (options.no_pdf) return {"report.html"};
    return {"report.html", "certificate.pdf"};
}

int certify(const CertifyOptions& options) {
    const std::time_t started = std::time(nullptr);
    const auto read = attempt_in(options.attempt);
    const Attempt& attempt = read.first;
    const std::string& text = read.second;
    std::optional<SecretKey> key;
    std::string role;
    if (!options.key.empty()) {
        role = signing_role(attempt);
        key = load_secret_key(options.key);
    }
    const fs::path run_dir =
        options.out.empty() ? fs::path("out") / attempt.id : fs::path(options.out);
    StagingFolder staging(run_dir);
    require_a_run(staging.earlier(), inventory_of(attempt).files);
    const RunInMaking run{.attempt = attempt,
                          .text = text,
                          .source = {.file = options.attempt},
                          .folder = staging.path(),
                          .known_as = run_dir,
                          .report = {.pages = {}, .signer = options.key},
                          .latest = end_of_tomorrow(started),
                          .sign = [&] {
                              return sign_report(staging.path(), read_report_facts(staging.path()),
                                                 *key, role);
                          }};
    std::vector<StageDone> stages;
    Verdict verdict;
    Answer answer;
    const bool says_stages = !options.json && !options.quiet;
    Progress progress =
        make_progress({.style = says_stages ? progress_style_for(stdout) : ProgressStyle::plain,
                       .took = seconds_of_steps(run_dir / run_times_name)});
    const auto show = [&](const StageDone& stage) {
        StageDone shown = stage;
        stages.push_back(stage);
        if (stage.name == "check") {
            verdict = verdict_in(staging.path());
            shown.said = {"answer below"};
        }
        if (says_stages) progress({.what = Note{stage_line(shown)}});
        // The answer is there before anything is drawn; where time may run out, at the end.
        if (stage.name == (time_is_limited() ? "report" : "check") && !options.json) {
            answer = answer_of(verdict, stages, run_dir, options);
            const bool with_result = !options.no_render && !time_is_limited();
            progress({.what = Note{fmt::format("\n{}{}\n", answer.details,
                                               with_result ? answer.result : "")}});
        }
    };
    StageDone report;  // one to the user, with its pages
    std::chrono::steady_clock::time_point report_began;
    std::optional<PagesToCome> first;
    std::optional<WholeReport> whole;
    if (!options.no_render) first.emplace(staging.path(), first_pages(options));
    const bool is_whole = !options.no_render && !options.no_pdf && !options.brief;
    try {
        make_run(
            run,
            [&](const Step& step) {
                progress({.what = StepBegins{step.name}});
                if (step.name == "report") {
                    report_began = std::chrono::steady_clock::now();
                    if (is_whole) whole.emplace();
                }
                return false;
            },
            [&](const StageDone& done) {
                if (done.name == "report") {
                    report = done;
                    carry_over(staging.earlier(), staging.folder());
                } else if (is_shown(done)) {
                    show(done);
                }
            });
        if (first) {
            first->begin();
            if (whole) whole->begin(staging.path());
            report.said = first->drawn().said;
        }
        report.seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - report_began).count();
        show(report);
        // Where time may run out, all is there before anything takes the earlier run's place.
        if (whole && time_is_limited()) {
            whole->put_into(staging.path());
            whole.reset();
        }
        progress = nullptr;  // what follows is printed without it
    } catch (StageFailed& failed) {
        progress = nullptr;
        replace_all(failed.result.errors, staging.path().string(), run_dir.string());
        fmt::print(stderr, "{}", message_of(failed));
        return 2;
    }
    require_time();
    write_file_unsynced(staging.path() / run_times_name, run_times_text(started, stages));
    const bool is_signed = !signature_files(staging.path()).empty();
    staging.publish();
    if (!options.json)
        fmt::print("        {}{}\n", (run_dir / page_to_read(options)).string(),
                   is_signed ? " (signed)" : " (UNSIGNED: give --key to sign it)");
    std::fflush(stdout);
    try {
        if (whole) whole->put_into(run_dir);
    } catch (const StageFailed& failed) {
        fmt::print(stderr, "{}", message_of(failed));
        return 2;
    }
    const bool all_beaten = std::ranges::all_of(
        verdict.profiles, [](const auto& one) { return one.outcome == Outcome::beaten; });
    const int status = all_beaten ? 0 : 1;
    if (options.json) {
        print_json(verdict, run_dir, is_signed, status);
        return status;
    }
    fmt::print("{}{}", answer.result, answer.next);
    return status;
}

}  // namespace

void add_certify(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<CertifyOptions>();
    CLI::App* command = app.add_subcommand(
        "certify", "Measure an attempt: recordings in, a signed measurement report out");
    command->add_option("ATTEMPT", options->attempt, "the attempt's file (YAML)")->required();
    command->add_option("--out", options->out, "run folder to write (default: out/ID)");
    command->add_option("--key", options->key, "secret key to sign the report with");
    command->add_flag("--no-pdf", options->no_pdf, "report.json and HTML alone");
    command->add_flag("--brief", options->brief,
                      "certificate.pdf, the first page, and no report.pdf");
    command->add_flag("--no-render", options->no_render, "stop after report.json: no HTML, no PDF");
    CLI::Option* quiet = command->add_flag("--quiet", options->quiet,
                                           "print the verdict, and nothing of the stages");
    command->add_flag("--json", options->json, "print one JSON document instead")->excludes(quiet);
    add_time_limit(*command);
    command->footer(fmt::format(
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
    command->callback([&chosen, options] { chosen = [options] { return certify(*options); }; });
}

}  // namespace runcert
