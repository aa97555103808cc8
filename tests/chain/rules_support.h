#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "chain_support.h"
#include "core/random.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

// Recordings in an engineering CRS made for a rule, and what the programs say of them.

namespace runcert::chain {

struct PlanePosition {
    double east_m = 0.0, north_m = 0.0, up_m = 0.0;
};

/// A recording of a motion that is a function of time (s), with white noise.
struct PlaneRecording {
    std::function<PlanePosition(double)> position_at;
    double duration_s = 40.0;
    double first_s = 0.0;
    double noise_m = 0.0;
    double noise_up_m = 0.0;
    std::uint64_t seed = 1;

    std::string text() const {
        std::string rows = "time_s,east_m,north_m,up_m\n";
        RandomGenerator random(seed);
        for (int k = 0; 0.1 * k <= duration_s + 1e-9; ++k) {
            const double time_s = first_s + 0.1 * k;
            PlanePosition at = position_at(time_s);
            at.east_m += noise_m * random.normal();
            at.north_m += noise_m * random.normal();
            at.up_m += noise_up_m * random.normal();
            rows += fmt::format("{:.1f},{:.7f},{:.7f},{:.7f}\n", time_s, at.east_m, at.north_m,
                                at.up_m);
        }
        return rows;
    }
};

/// Towards north at constant speed, from the origin on.
inline PlaneRecording northwards(double speed_m_s, double duration_s = 40.0) {
    return {.position_at =
                [speed_m_s](double time_s) { return PlanePosition{.north_m = speed_m_s * time_s}; },
            .duration_s = duration_s};
}

/// A fix type that is empty nobody states.
inline std::string csv_receiver(const std::string& id, const std::string& file,
                                double accuracy_m = 0.01, const std::string& more = {},
                                const std::string& solution = "fixed") {
    return fmt::format(
        "{{id: {}, recording: {}, format: csv, columns: {{time: time_s, east: east_m, north: "
        "north_m, up: up_m}}, frame: local_plane, accuracy: {{horizontal_m: {}, vertical_m: "
        "{}}}{}{}}}",
        id, file, accuracy_m, 2.0 * accuracy_m, more,
        solution.empty() ? "" : ", solution: " + solution);
}

/// An attempt of one recording, recording.csv; `more` are lines of its own.
inline std::string plane_attempt(const std::string& profiles, const std::string& more = {},
                                 double accuracy_m = 0.01) {
    return fmt::format(
        "schema: attempt/1.0\nid: rules\ncraft: {{name: yacht, class: land-yacht}}\n"
        "receivers: [{}]\nprofiles: [{}]\n{}",
        csv_receiver("primary", "recording.csv", accuracy_m), profiles, more);
}

/// A profile of a file of that name, in our own words.
inline std::string profile_of(const std::string& id, const std::string& window,
                              const std::string& clauses = {}, const std::string& more = {}) {
    return fmt::format(
        "schema: profile/1.0\nid: {}\nbody: test\ntitle: test\nwindow: {}\n"
        "margin: {{kind: absolute, value: 0, unit: km/h}}\n{}clauses:\n"
        "  - {{id: complete, text: The window is complete., source: test, certainty: quoted, "
        "decided_by: window_complete}}\n{}",
        id, window, more, clauses);
}

inline std::string clause_of(const std::string& decided_by, const std::string& more = {}) {
    return fmt::format(
        "  - {{id: {0}, text: what {0} asks, source: test, certainty: quoted, decided_by: "
        "{0}{1}}}\n",
        decided_by, more);
}

/// A line across a course, its middle so far along a heading from the origin, and turned to the
/// right by so much more than a right angle asks for.
struct PlaneLine {
    double along_m = 0.0;
    double heading_deg = 0.0;
    double turned_deg = 0.0;
    double half_width_m = 20.0;

    std::string text() const {
        constexpr double degree = std::numbers::pi / 180.0;
        const double heading = heading_deg * degree;
        const double right = (heading_deg + 90.0 + turned_deg) * degree;
        const auto end = [&](double to_the_right_m) {
            return fmt::format("{{east_m: {:.7f}, north_m: {:.7f}}}",
                               along_m * std::sin(heading) + to_the_right_m * std::sin(right),
                               along_m * std::cos(heading) + to_the_right_m * std::cos(right));
        };
        return fmt::format("{{left: {}, right: {}}}", end(-half_width_m), end(half_width_m));
    }
};

inline std::string course_of(const PlaneLine& start, const PlaneLine& finish, double length_m,
                             double length_expanded_uncertainty_m = 0.0) {
    return fmt::format(
        "course: {{length_m: {}, length_expanded_uncertainty_m: {}, start: {}, finish: {}}}\n",
        length_m, length_expanded_uncertainty_m, start.text(), finish.text());
}

/// A folder with an attempt and what it names; certified, it has a run folder.
class Rules {
  public:
    void put(const std::string& name, const std::string& text) const {
        write_file_atomically(folder_.path() / name, text);
    }
    void bring_in(const fs::path& file) const { bring(file, folder_.path()); }
    ProcessResult certify(const std::string& attempt) const {
        put("attempt.yaml", attempt);
        fs::remove_all(run());
        return chain::certify(folder_.path() / "attempt.yaml", run(), {"--no-render"});
    }
    /// The verdict of an attempt that can be read.
    Verdict judge(const std::string& attempt) const {
        const ProcessResult result = certify(attempt);
        if (result.exit_status == 2) throw std::runtime_error(result.errors);
        return read_verdict(read_file(run() / "6-verdict.yaml"), "6-verdict.yaml");
    }
    ProfileVerdict judge_one(const std::string& attempt) const {
        return judge(attempt).profiles.at(0);
    }
    Windows windows() const {
        return read_windows(read_file(run() / "5-windows.yaml"), "5-windows.yaml");
    }
    fs::path path() const { return folder_.path(); }
    fs::path run() const { return folder_.path() / "run"; }

  private:
    TemporaryFolder folder_;
};

inline Requirement requirement_of(const ProfileVerdict& verdict, const std::string& clause) {
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.clause == clause) return requirement;
    return {};
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

inline bool any_contains(const std::vector<std::string>& texts, const std::string& part) {
    for (const std::string& text : texts)
        if (contains(text, part)) return true;
    return false;
}

}  // namespace runcert::chain
