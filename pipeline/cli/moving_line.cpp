#include "moving_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <string_view>
#include <utility>

#include "core/failure.h"
#include "store/atomic_file.h"
#include "store/yaml_input.h"

namespace runcert {
namespace {

constexpr std::chrono::milliseconds redraw_interval{250};

bool can_move(std::FILE* file) {
    const char* terminal = std::getenv("TERM");
    return isatty(fileno(file)) != 0 && terminal && std::string_view(terminal) != "dumb";
}

std::string_view doing(const std::string& step) {
    static const std::map<std::string, std::string_view> words{
        {"claim", "takes in the attempt"},      {"import", "reads the recordings"},
        {"enu", "converts to east, north, up"}, {"screen", "tests every epoch"},
        {"smooth", "estimates the motion"},     {"window", "searches the best window"},
        {"check", "decides each requirement"},  {"report", "writes report.json"},
        {"sign", "signs the report"},           {"render", "draws the pages"}};
    const auto found = words.find(step);
    return found == words.end() ? std::string_view("works") : found->second;
}

}  // namespace

MovingLine::MovingLine(std::FILE* to, std::map<std::string, double> last_time)
    : to_(to), last_time_(std::move(last_time)) {
    if (to == nullptr || !can_move(to)) return;
    drawer_ = std::thread([this] {
        std::unique_lock lock(mutex_);
        while (!ends_) {
            if (!step_.empty()) draw();
            changed_.wait_for(lock, redraw_interval);
        }
    });
}

MovingLine::~MovingLine() {
    if (!drawer_.joinable()) return;
    clear();
    {
        const std::lock_guard lock(mutex_);
        ends_ = true;
    }
    changed_.notify_all();
    drawer_.join();
}

void MovingLine::begins(const std::string& step) {
    if (!drawer_.joinable()) return;
    const std::lock_guard lock(mutex_);
    step_ = step;
    began_ = std::chrono::steady_clock::now();
    changed_.notify_all();
}

void MovingLine::clear() {
    if (!drawer_.joinable()) return;
    const std::lock_guard lock(mutex_);
    step_.clear();
    if (is_drawn_) fmt::print(to_, "\r\033[K");
    std::fflush(to_);
    is_drawn_ = false;
}

void MovingLine::draw() {
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    std::string text = fmt::format("{:<8} {}, {:.0f} s", step_, doing(step_), seconds);
    if (const auto before = last_time_.find(step_); before != last_time_.end())
        text += fmt::format(" of about {:.0f} s, as the last time", before->second);
    fmt::print(to_, "\r\033[K{}", text);
    std::fflush(to_);
    is_drawn_ = true;
}

std::map<std::string, double> seconds_of_steps(const std::filesystem::path& run_times) {
    std::map<std::string, double> seconds;
    try {
        const YamlValue times(parse_yaml(read_file(run_times), run_times.string()),
                              run_times.string());
        for (const YamlValue& stage : times["stages"].list())
            seconds[stage["stage"].text()] = stage["seconds"].real();
        // Report and pages are one to whoever reads it, and pages take nearly all of it.
        if (auto report = seconds.extract("report")) {
            report.key() = "render";
            seconds.insert(std::move(report));
        }
    } catch (const Failure&) {
        seconds.clear();
    }
    return seconds;
}

}  // namespace runcert
