#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <thread>

namespace runcert {

/// The last line of a terminal while a step works: what it does, for how long, and how long it took
/// the last time. Nothing where there is no file, or it is no terminal that can do so. Others write
/// after `clear`.
class MovingLine {
  public:
    /// `last_time`: seconds that each step took when the run was made before, by its name.
    MovingLine(std::FILE* to, std::map<std::string, double> last_time);
    ~MovingLine();
    MovingLine(const MovingLine&) = delete;
    MovingLine& operator=(const MovingLine&) = delete;

    /// From now on the line is of that step.
    void begins(const std::string& step);
    /// Takes the line away, until another step begins.
    void clear();

  private:
    void draw();

    std::FILE* to_;
    std::map<std::string, double> last_time_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::string step_;
    std::chrono::steady_clock::time_point began_;
    bool is_drawn_ = false;
    bool ends_ = false;
    std::thread drawer_;
};

/// Seconds of each step in a run.yaml, by its name; none if there is no such file, or it cannot be
/// read.
std::map<std::string, double> seconds_of_steps(const std::filesystem::path& run_times);

}  // namespace runcert
