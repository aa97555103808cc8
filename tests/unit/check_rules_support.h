#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "stages/check/check.h"

// One run of a craft, straight north, and a window in it, judged by a profile given as text.

namespace runcert::test {

inline std::string clause_text(const std::string& decided_by, const std::string& more = {}) {
    return fmt::format(
        "  - {{id: {0}, text: what {0} asks, source: test, certainty: quoted, decided_by: "
        "{0}{1}}}\n",
        decided_by, more);
}

/// A profile of a 3 s window, 202.9 km/h and 1 km/h to reach, with these clauses.
inline std::string profile_text(
    const std::string& clauses, const std::string& more = {},
    const std::string& margin = "{kind: absolute, value: 1, unit: km/h}",
    const std::string& window =
        "{duration_s: 3, definition: "
        "displacement}") {
    return fmt::format(
        "schema: profile/1.0\nid: rule\nbody: b\ntitle: t\nwindow: {}\nmargin: {}\n{}clauses:\n{}",
        window, margin, more, clauses);
}

/// At rest until 5 s, then 4 m/s^2 up to 60 m/s at 20 s, which it keeps until 40 s; rows at 10 Hz.
/// The window is from 25 s to 28 s; run-up and window are of one run, which begins at 5.2 s, the
/// last row below 1 m/s.
struct RuleScene {
    static constexpr std::size_t window_first = 250, window_last = 280;
    static constexpr double sigma_m = 0.01, sigma_up_m = 0.02, sigma_velocity_m_s = 0.05;

    Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n"
        "record: {speed: 202.9, unit: km/h, source: published}\n",
        "attempt");
    std::vector<Profile> profiles;
    ReceiverFindings judged;
    std::optional<MeasuredSeries> wind, current;

    explicit RuleScene(const std::string& profile) {
        judged.receiver = "primary";
        judged.accuracy_source = "recording";
        judged.facts.georeferenced = false;
        judged.facts.first_epoch = GpsTime::from_week(2200, 100'000'000'000'000);
        judged.facts.nominal_interval_s = 0.1;
        for (std::int64_t k = 0; k <= 400; ++k)
            judged.trajectory.push_back(row_at(k));
        use(profile);
    }

    /// Judges by this profile from now on; the best window is recomputed.
    void use(const std::string& profile) {
        profiles = {read_profile(profile, "rule.yaml")};
        const Profile& rule = profiles[0];
        ProfileWindows entry{.profile = rule.id,
                             .rule = rule_of(rule),
                             .candidates = 5,
                             .best = CertifiableWindow{},
                             .indicated = std::nullopt};
        CertifiableWindow& window = *entry.best;
        window.speed_m_s = 60.0;
        window.standard_uncertainty_m_s = 0.005;
        window.definitions = {.displacement_m_s = 60.0,
                              .path_length_m_s = 60.0,
                              .mean_n_plus_1_m_s = 60.0,
                              .mean_n_m_s = 60.0};
        window.span =
            window_span(judged.facts, judged.trajectory[window_first].epoch,
                        judged.trajectory[window_last].epoch, judged.trajectory[window_first].time,
                        judged.trajectory[window_last].time);
        judged.windows.profiles = {entry};
        judged.window_epochs[rule.id] = epochs();
    }

    ProfileWindows& windows() { return judged.windows.profiles[0]; }
    CertifiableWindow& best() { return *windows().best; }
    TrajectoryEpoch& row(double time_s) {
        return judged.trajectory[static_cast<std::size_t>(std::llround(10.0 * time_s))];
    }
    std::vector<ScreenedEpoch>& rows() { return judged.window_epochs[profiles[0].id]; }

    Verdict all() const {
        return check({.attempt = attempt,
                      .profiles = profiles,
                      .judged = judged,
                      .wind = wind ? &*wind : nullptr,
                      .current = current ? &*current : nullptr});
    }
    ProfileVerdict verdict() const { return all().profiles.at(0); }
    Requirement clause(const std::string& id) const {
        for (const Requirement& requirement : verdict().requirements)
            if (requirement.clause == id) return requirement;
        return {};
    }

  private:
    static TrajectoryEpoch row_at(std::int64_t k) {
        const double time_s = 0.1 * static_cast<double>(k);
        const double gaining_s = std::clamp(time_s - 5.0, 0.0, 15.0);
        TrajectoryEpoch row;
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = row.up_m = row.velocity_east_m_s = row.velocity_up_m_s = 0.0;
        row.velocity_north_m_s = row.speed_m_s = 4.0 * gaining_s;
        row.acceleration_east_m_s2 = 0.0;
        row.acceleration_north_m_s2 = time_s > 5.0 && time_s < 20.0 ? 4.0 : 0.0;
        row.north_m = 2.0 * gaining_s * gaining_s + 60.0 * std::max(0.0, time_s - 20.0);
        row.sigma_east_m = row.sigma_north_m = sigma_m;
        row.sigma_up_m = sigma_up_m;
        row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = sigma_velocity_m_s;
        row.sigma_velocity_up_m_s = sigma_velocity_m_s;
        row.sigma_acceleration_east_m_s2 = row.sigma_acceleration_north_m_s2 = 0.1;
        row.arc = 1;
        row.usable = true;
        return row;
    }
    /// The window's epochs, as screening leaves them.
    std::vector<ScreenedEpoch> epochs() const {
        std::vector<ScreenedEpoch> result;
        for (std::size_t i = window_first; i <= window_last; ++i) {
            ScreenedEpoch& one = result.emplace_back();
            one.epoch = judged.trajectory[i].epoch;
            one.time = judged.trajectory[i].time;
            one.sigma_east_m = one.sigma_north_m = sigma_m;
            one.sigma_up_m = sigma_up_m;
            one.usable = true;
        }
        return result;
    }
};

/// The same flow from `from_s` to `to_s`, a sample every 10 s.
inline MeasuredSeries steady(double speed_m_s, double direction_deg, double from_s, double to_s) {
    MeasuredSeries series{.where = "series.csv", .samples = {}};
    for (double time_s = from_s; time_s <= to_s; time_s += 10.0)
        series.samples.push_back({time_s, speed_m_s, direction_deg});
    return series;
}

inline void set_current(RuleScene& scene, double speed_m_s, double direction_deg,
                        double expanded_uncertainty_m_s) {
    scene.current = steady(speed_m_s, direction_deg, 0.0, 50.0);
    scene.attempt.current = CurrentSeries{.file = "current.csv",
                                          .source = "meter",
                                          .expanded_uncertainty_m_s = expanded_uncertainty_m_s,
                                          .place = "attempt:1:1"};
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace runcert::test
