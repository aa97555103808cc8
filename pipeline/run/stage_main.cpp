#include "run/stage_main.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "run/run_lock.h"
#include "store/process.h"
#include "store/program.h"

namespace runcert {
namespace {

/// Reads the command line; the exit status where it asked for help or the version.
std::optional<int> parsed(CLI::App& app, int argc, char** argv) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    }
    return std::nullopt;
}

void say_failure(const Failure& failure) {
    const std::string said = fmt::format(
        "error: {}\n  where: {}\n  what to do: {}\n", sentence(plain_text(failure.problem())),
        plain_text(failure.where()), sentence(plain_text(failure.remedy())));
    std::fputs(said.c_str(), stderr);  // which may be full or closed too
}

/// Where a standard file is closed, the next file opened would take its place. Writing to standard
/// output then still fails.
void hold_standard_files() {
    for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
        if (fcntl(number, F_GETFD) < 0 && errno == EBADF)
            (void)open("/dev/null", number == STDERR_FILENO ? O_WRONLY : O_RDONLY);
}

/// Failure where not all was written to standard output.
void require_output(int error) {
    if (std::fflush(stdout) != 0) error = errno;
    if (std::ferror(stdout) == 0 && error == 0) return;
    std::clearerr(stdout);
    throw Failure("standard output",
                  fmt::format("it could not be written: {}",
                              error == 0 ? "an earlier line was lost" : std::strerror(error)),
                  "Make room, or send the output elsewhere; files already written are whole");
}

}  // namespace

void CommandLine::text(const std::string& name, std::string& value, const std::string& about,
                       Need need) {
    app_.add_option(name, value, about)->required(need == Need::required);
}

void CommandLine::text(const std::string& name, std::optional<std::string>& value,
                       const std::string& about) {
    app_.add_option(name, value, about);
}

void CommandLine::word(const std::string& name, std::string& value, const std::string& about,
                       const std::vector<std::string>& words, Need need) {
    app_.add_option(name, value, about)
        ->required(need == Need::required)
        ->check(CLI::IsMember(words).description(""));
}

void CommandLine::texts(const std::string& name, std::vector<std::string>& values,
                        const std::string& about, Need need) {
    app_.add_option(name, values, about)
        ->required(need == Need::required)
        ->allow_extra_args(!name.starts_with("-"));
}

void CommandLine::integer(const std::string& name, std::int64_t& value, const std::string& about,
                          std::int64_t least, std::int64_t most) {
    app_.add_option(name, value, about)->check(CLI::Range(least, most).description(""));
}

void CommandLine::number(const std::string& name, double& value, const std::string& about,
                         double least, double most) {
    app_.add_option(name, value, about)->check(CLI::Range(least, most).description(""));
}

void CommandLine::time_limit() {
    app_.add_option_function<std::int64_t>(
            "--time-limit", [](std::int64_t limit_s) { limit_time(std::chrono::seconds(limit_s)); },
            "seconds after which it ends with 2 and without a result; what was there stays")
        ->check(CLI::Range(std::int64_t{1}, std::int64_t{1'000'000}));
}

void CommandLine::flag(const std::string& name, bool& value, const std::string& about) {
    app_.add_flag(name, value, about);
}

void CommandLine::exclude(const std::string& one, const std::vector<std::string>& others) {
    for (const std::string& other : others)
        app_.get_option(one)->excludes(app_.get_option(other));
}

void CommandLine::need(const std::string& one, const std::string& other) {
    app_.get_option(one)->needs(app_.get_option(other));
}

void CommandLine::show_default(const std::string& name) {
    app_.get_option(name)->capture_default_str();
}

void CommandLine::footer(const std::string& text) {
    app_.footer(text);
}

int guarded_main(const std::function<int()>& body) {
    end_with_caller();
    // A file-size limit is then an error of the write, with a message, and not a sudden end.
    std::signal(SIGXFSZ, SIG_IGN);
    hold_standard_files();
    try {
        try {
            const int status = body();
            require_output(0);
            return status;
        } catch (const std::system_error& error) {
            if (std::ferror(stdout) != 0) require_output(error.code().value());
            throw;
        }
    } catch (const Failure& failure) {
        say_failure(failure);
    } catch (const CLI::Error& error) {
        say_failure({"the command line", error.what(), "See --help"});
    } catch (const std::bad_alloc&) {
        // Nothing that would take memory.
        std::fputs(
            "error: This computer failed: there is not enough memory.\n  where: its memory\n"
            "  what to do: Close other programs, or cut the recording down to the runs.\n",
            stderr);
    } catch (const std::filesystem::filesystem_error& error) {
        say_failure({escape_for_message(error.path1().string(), 400), error.code().message(),
                     "Check that it can be read and written"});
    } catch (const std::exception& fault) {
        say_failure({"inside the program", fault.what(),
                     "This is a fault of the program; please report it with the attempt and its "
                     "recordings"});
    }
    return 2;
}

int reader_main(int argc, char** argv, const std::string& summary,
                const std::function<void(CommandLine&)>& options, const std::function<int()>& run) {
    return guarded_main([&]() -> int {
        CLI::App app(summary, std::filesystem::path(argv[0]).filename());
        CommandLine line(app);
        options(line);
        const auto status = parsed(app, argc, argv);
        return status ? *status : run();
    });
}

int stage_main(int argc, char** argv, const std::string& stage, const std::string& summary,
               const std::function<void(StageRun&)>& body,
               const std::function<void(CommandLine&)>& options,
               const std::function<void()>& before) {
    return guarded_main([&]() -> int {
        CLI::App app(summary, "runcert-" + stage);
        std::string attempt;
        std::string run_dir;
        app.add_option("--attempt", attempt, "the attempt (schema attempt/1.0)")->required();
        app.add_option("--run-dir", run_dir, "folder of the run's files")->required();
        CommandLine line(app);
        if (options) options(line);
        app.set_version_flag("--version",
                             fmt::format("{} {}", program_version(), source_revision()));
        if (const auto status = parsed(app, argc, argv)) return *status;
        if (before) before();
        StageRun run(stage, attempt, run_dir);
        const RunLock lock(run_dir);
        body(run);
        for (const std::string& said : run.said())
            fmt::print("{}\n", plain_text(said));
        return 0;
    });
}

}  // namespace runcert
