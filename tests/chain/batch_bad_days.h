#pragma once

#include <fmt/format.h>

#include "batch_support.h"

namespace runcert::chain {

/// A folder of attempts, to begin with without any.
class BadDays : public testing::Test {
  protected:
    void SetUp() override {
        make_day(folder_.path() / "made", 1, 110);
        fs::create_directories(day());
        fs::copy_file(recording(), day() / "run.pos");
    }

    fs::path path(const std::string& name) const { return folder_.path() / name; }
    fs::path day() const { return path("day"); }
    fs::path out() const { return path("out"); }
    fs::path recording() const { return path("made/recordings/0001.pos"); }

    static std::string attempt(const std::string& id, const std::string& recording = "run.pos") {
        return fmt::format(
            "schema: attempt/1.0\nid: {}\ncraft: {{name: simulated, class: land-yacht}}\n"
            "receivers: [{{id: primary, recording: {}}}]\nprofiles: [nalsa]\n"
            "parameters: {{window: {{selection_samples: 100, monte_carlo_trials_max: 100000}}}}\n",
            id, Json(recording).dump());
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(day() / name, std::ios::binary) << text;
    }
    BatchSaid run(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> options{"--no-render"};
        options.insert(options.end(), more.begin(), more.end());
        return batch_json(day(), out(), options);
    }
    /// What is said where the day as a whole is refused.
    static std::string refusal(std::vector<std::string> arguments, const Environment& more = {}) {
        arguments.insert(arguments.begin(), "batch");
        const ProcessResult result = runcert(arguments, more);
        EXPECT_EQ(result.exit_status, 2) << result.output << result.errors;
        EXPECT_EQ(result.errors.find("terminate called"), std::string::npos) << result.errors;
        return result.errors;
    }
    static bool holds(const std::string& text, const std::string& words) {
        return text.find(words) != std::string::npos;
    }

  private:
    TemporaryFolder folder_;
};

}  // namespace runcert::chain
