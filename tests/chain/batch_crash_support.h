#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "chain_support.h"
#include "core/text.h"
#include "daemon_support.h"
#include "day_support.h"

// A day that is disturbed: batches that are killed, interrupted and held up.

namespace runcert::chain {

using Words = std::vector<std::string>;

inline bool holds(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

/// Name and bytes of every file of a day's results but those that tell when they were made, on
/// which nothing depends, and the batch's own.
inline std::map<std::string, std::string> results_of(const fs::path& out) {
    std::map<std::string, std::string> results = contents_of(out);
    std::erase_if(results, [](const auto& file) {
        return file.first.starts_with(".runcert/") || file.first.ends_with("/run.yaml") ||
               file.first.find("/superseded/") != std::string::npos;
    });
    return results;
}

/// Names of files whose bytes are not those expected, or that are in one of the two alone.
inline Words differences(const std::map<std::string, std::string>& made,
                         const std::map<std::string, std::string>& expected) {
    Words names;
    for (const auto& [name, bytes] : expected)
        if (const auto found = made.find(name); found == made.end())
            names.push_back(name + " is missing");
        else if (found->second != bytes)
            names.push_back(name + " differs");
    for (const auto& [name, bytes] : made)
        if (!expected.contains(name)) names.push_back(name + " is too much");
    return names;
}

/// Files of a temporary name, in a folder and those in it.
inline Words half_written(const fs::path& folder) {
    Words names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".tmp") names.push_back(entry.path().string());
    return names;
}

/// Whether none is left, which a busy machine may take a while for; far less than those sleep that
/// are to be ended.
inline bool gone_soon(const std::string& text) {
    return holds_within(60, [&text] { return test::processes_with(text).empty(); });
}

/// A program in a process group of its own, beside the test.
class Started {
  public:
    Started(Words command, const fs::path& output) : output_(output) {
        process_ = fork();
        if (process_ == 0) become(std::move(command));
        setpgid(process_, process_);
    }
    ~Started() {
        if (status_) return;
        ::kill(process_, SIGKILL);
        waitpid(process_, nullptr, 0);
    }
    Started(const Started&) = delete;
    Started& operator=(const Started&) = delete;

    pid_t number() const { return process_; }
    std::string output() const { return fs::exists(output_) ? read_file(output_) : ""; }

    bool has_ended() {
        int status = 0;
        if (!status_ && waitpid(process_, &status, WNOHANG) == process_)
            status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        return status_.has_value();
    }
    void send(int signal) {
        if (!has_ended()) ::kill(process_, signal);
    }
    void send_to_group(int signal) {
        if (!has_ended()) ::kill(-process_, signal);
    }
    /// Its exit status, 128 + signal where one ended it; -1 where it hangs.
    int exit_status() {
        return holds_within(240, [this] { return has_ended(); }) ? *status_ : -1;
    }

  private:
    [[noreturn]] void become(Words command) const {
        setpgid(0, 0);
        std::vector<char*> words;
        for (std::string& word : command)
            words.push_back(word.data());
        words.push_back(nullptr);
        const int output = open(output_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
        dup2(output, STDOUT_FILENO);
        dup2(output, STDERR_FILENO);
        execv(words[0], words.data());
        _exit(127);
    }

    fs::path output_;
    pid_t process_ = -1;
    std::optional<int> status_;
};

/// A copy of the folder of programs, in which a stage can be another program for a while.
class Programs {
  public:
    explicit Programs(fs::path folder) : folder_(std::move(folder)) {
        fs::create_directories(folder_);
        for (const auto& entry : fs::directory_iterator(RUNCERT_PROGRAMS))
            if (entry.path().filename() != "runcert")
                fs::create_symlink(entry.path(), folder_ / entry.path().filename());
        // It finds the others beside the file that it is.
        fs::copy_file(RUNCERT_PROGRAMS "/runcert", folder_ / "runcert");
    }

    std::string runcert() const { return (folder_ / "runcert").string(); }
    /// The program as it was built.
    static std::string real(const std::string& name) { return RUNCERT_PROGRAMS "/" + name; }

    /// Puts a shell script in a program's place.
    void replace(const std::string& name, const std::string& script) const {
        fs::remove(folder_ / name);
        std::ofstream(folder_ / name) << "#!/bin/sh\n" << script << "\n";
        fs::permissions(folder_ / name, fs::perms::owner_all);
    }
    void restore(const std::string& name) const {
        fs::remove(folder_ / name);
        fs::create_symlink(real(name), folder_ / name);
    }

  private:
    fs::path folder_;
};

/// A small day, and a folder for its results when it is disturbed.
class DisturbedDay {
  public:
    DisturbedDay(int attempts, int epochs, Words options = {"--no-render"})
        : options_(std::move(options)) {
        make_day(day, attempts, epochs);
    }

    Words command(const std::string& program, const fs::path& to, const Words& more = {}) const {
        Words words{program, "batch", (day / "day.yaml").string(), "--out", to.string(), "--json"};
        words.insert(words.end(), options_.begin(), options_.end());
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    /// The batch, to its end.
    ProcessResult batch(const Words& more = {}, const Environment& environment = {}) const {
        return run_process(command(programs.runcert(), out, more),
                           {.environment = environment, .time_limit = std::chrono::minutes(10)});
    }
    /// The results of the undisturbed day, which is made when this is first asked.
    const std::map<std::string, std::string>& expected() {
        const fs::path undisturbed = folder.path() / "undisturbed";
        if (fs::exists(undisturbed)) return expected_;
        const ProcessResult result = run_process(command(programs.runcert(), undisturbed));
        if (result.exit_status != 0)
            throw std::runtime_error("the undisturbed day: " + result.errors + result.output);
        return expected_ = results_of(undisturbed);
    }
    /// What differs from it.
    Words differing() { return differences(results_of(out), expected()); }

    /// Another record to beat: only the claim, check and report are to be recomputed.
    void change_record() const {
        std::string text = read_file(day / "day.yaml");
        text.replace(text.find("202.9"), 5, "190.5");
        write_file_atomically(day / "day.yaml", text);
    }

    TemporaryFolder folder;
    Programs programs{folder.path() / "programs"};
    fs::path day = folder.path() / "day";
    fs::path out = folder.path() / "out";

  private:
    Words options_;
    std::map<std::string, std::string> expected_;
};

using Event = nlohmann::json;

/// The events of a batch. What is no whole line of JSON throws.
inline std::vector<Event> events_in(const std::string& output) {
    std::vector<Event> events;
    for (const std::string& line : lines_of(output))
        events.push_back(Event::parse(line));
    return events;
}

/// What it says of an attempt that could not be processed; empty where it could.
inline std::string error_of(const std::vector<Event>& events, const std::string& id) {
    for (const Event& event : events)
        if (event.at("event") == "attempt" && event.at("id") == id) return event.at("error");
    return {};
}

}  // namespace runcert::chain
