#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "chain_support.h"

// Runs a program on input that is wrong, odd or meant to harm, and measures what it takes.

namespace runcert::chain {

/// Of the processor: ten times what any of them takes, and far less than what has no bound would.
inline constexpr double longest_s = 20.0 * slower;
inline constexpr auto hung = std::chrono::minutes(10);
inline constexpr double most_bytes = 512.0 * 1024 * 1024 * slower;

struct Measured {
    int exit_status = 0;      ///< 128 + signal where it was ended by one
    double seconds = 0.0;     ///< of the processor, with the programs it started and waited for
    double peak_bytes = 0.0;  ///< of the program or of one it started, whichever has the most
    std::string output, errors;
};

/// What the child does between fork and exec.
[[noreturn]] inline void become(std::vector<char*> arguments, const std::string& out,
                                const std::string& err) {
    dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
    dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
    dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
    execv(arguments[0], arguments.data());
    _exit(127);
}

/// Runs a program of the build by its name; one that does not end is killed.
inline Measured run_measured(std::vector<std::string> command) {
    const TemporaryFolder folder;
    const std::string out = folder.path() / "out", err = folder.path() / "err";
    command[0] = std::string(RUNCERT_PROGRAMS "/") + command[0];
    std::vector<char*> arguments;
    for (std::string& text : command)
        arguments.push_back(text.data());
    arguments.push_back(nullptr);
    const auto begin = std::chrono::steady_clock::now();
    const pid_t child = fork();
    if (child == 0) become(arguments, out, err);
    Measured run;
    int status = 0;
    rusage usage{};
    while (wait4(child, &status, WNOHANG, &usage) == 0) {
        if (std::chrono::steady_clock::now() - begin > hung) kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    const auto seconds_of = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    run.seconds = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
    run.peak_bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
    run.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    run.output = read_file(out);
    run.errors = read_file(err);
    return run;
}

/// Input that must be refused.
struct HostileCase {
    std::string name;
    /// Puts the files into a folder, beside or in place of the good ones.
    std::function<void(const fs::path& folder)> prepare;
    std::vector<std::string> said;  ///< what the message must hold
    /// Arguments after the program's name, with FOLDER for the folder; by default the attempt there
    /// is certified into its `run`.
    std::vector<std::string> command = {"runcert", "certify",    "FOLDER/attempt.yaml",
                                        "--out",   "FOLDER/run", "--no-render"};
};

inline const std::string good_attempt =
    "schema: attempt/1.0\n"                          // 1
    "id: hostile\n"                                  // 2
    "craft: {name: yacht, class: land-yacht}\n"      // 3
    "receivers:\n"                                   // 4
    "  - {id: primary, recording: recording.pos}\n"  // 5
    "profiles: [nalsa]\n";                           // 6

/// A .pos of 20 epochs whose lines end in `end`.
inline std::string good_recording(const std::string& end = "\n") {
    std::string text =
        "%  GPST   latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  "
        "sdne(m)  sdeu(m)  sdun(m) age(s)  ratio" +
        end;
    for (int i = 0; i < 20; ++i)
        text += fmt::format(
            "2022/03/18 08:51:{:02}.000  35.1000{:05}  137.0000000  10.000 1 10 0.01 0.01 0.02 0 0 "
            "0 0 9{}",
            i, i * 10, end);
    return text;
}

inline std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    if (at != std::string::npos) text.replace(at, what.size(), by);
    return text;
}

inline std::string repeated(const std::string& text, std::size_t times) {
    std::string all;
    all.reserve(text.size() * times);
    for (std::size_t i = 0; i < times; ++i)
        all += text;
    return all;
}

inline std::string utf16(const std::string& text) {
    std::string bytes = "\xff\xfe";
    for (const char c : text)
        bytes += std::string{c, '\0'};
    return bytes;
}

/// Creates a file without a sync: some cases write a GiB.
inline void write_plainly(const fs::path& path, const std::string& bytes, std::size_t times = 1) {
    std::ofstream out(path, std::ios::binary);
    for (std::size_t i = 0; i < times; ++i)
        out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline void expect_hostile_refused(const HostileCase& one) {
    SCOPED_TRACE(one.name);
    const TemporaryFolder folder;
    const fs::path run_dir = folder.path() / "run";
    fs::create_directory(run_dir);
    write_plainly(run_dir / "result.txt", "an earlier result");
    write_plainly(folder.path() / "attempt.yaml", good_attempt);
    write_plainly(folder.path() / "recording.pos", good_recording());
    one.prepare(folder.path());
    const auto before = contents_of(run_dir);
    std::vector<std::string> command = one.command;
    for (std::string& argument : command)
        if (argument.starts_with("FOLDER")) argument.replace(0, 6, folder.path().string());
    const Measured run = run_measured(command);
    EXPECT_EQ(run.exit_status, 2) << run.output << run.errors;
    EXPECT_EQ(run.output, "");
    EXPECT_LE(run.seconds, longest_s);
    EXPECT_LE(run.peak_bytes, most_bytes);
    for (const char* part : {"error: ", "where: ", "what to do: "})
        EXPECT_NE(run.errors.find(part), std::string::npos) << run.errors;
    EXPECT_EQ(run.errors.find("fault of the program"), std::string::npos) << run.errors;
    for (const std::string& said : one.said)
        EXPECT_NE(run.errors.find(said), std::string::npos) << said << "\n" << run.errors;
    EXPECT_LT(run.errors.size(), 5000u) << one.name;
    for (const auto& [name, bytes] : before)
        EXPECT_TRUE(contents_of(run_dir)[name] == bytes) << name;
}

}  // namespace runcert::chain
