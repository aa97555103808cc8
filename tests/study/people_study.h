#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "people_recording.h"
#include "schemas/profile/profile.h"
#include "schemas/verdict/declared.h"

namespace runcert {

/// One rule's verdict on one recording, and what was true. Speeds in m/s.
struct PeopleResult {
    std::string kind = {};
    std::uint64_t seed = 0;
    PeopleFault fault = PeopleFault::none;
    std::string faults = {};  ///< in words
    std::string profile = {};
    PeopleDevice device = {};
    std::int64_t epochs = 0;
    std::int64_t usable = 0;
    double record = 0.0;  ///< the true best speed of the recording, which is the required speed
    Outcome outcome = Outcome::not_certifiable;
    Outcome outcome_above = Outcome::not_certifiable;  ///< at a required speed 0.1 km/h higher
    std::string reason = {};                           ///< or what a stage could not do
    bool failed = false;
    std::optional<double> speed = std::nullopt;
    std::optional<double> truth = std::nullopt;         ///< of the window that was certified
    std::optional<double> window_start = std::nullopt;  ///< s
    double expanded = 0.0;                              ///< U
    double bias_limit = 0.0;
    std::optional<double> expected_with_velocities = {};  ///< m/s
    double undetected = 0.0;                              ///< the worst undetected error
    std::map<std::string, double> contributions = {};  ///< of the budget's rows, by their symbols
    double processor_s = 0.0;                          ///< of all stages and rules together

    bool certified() const { return outcome != Outcome::not_certifiable && speed.has_value(); }
    double error() const { return *speed - *truth; }
    bool held() const;
    /// Beaten, and the true speed of the window below the required one.
    bool falsely_beaten() const;
    bool falsely_beaten_above() const;
};

/// Displacement over 3 s and over 10 s by positions, as `nalsa` and `gps-speed-sailing-10s` have
/// it, any higher speed exceeding the record; without requirements that no recording decides.
const std::vector<Profile>& people_rules();

/// Records, screens, smooths, searches and checks; one result a rule.
std::vector<PeopleResult> certify_people(const PeopleKind& kind, PeopleFault fault,
                                         std::uint64_t seed,
                                         const std::vector<Profile>& rules = people_rules());

struct PeopleStudyOptions {
    std::int64_t runs = 200;  ///< a kind; with faults, of all together
    std::uint64_t seed = 1;
    unsigned threads = 0;  ///< 0: as many as there are
};

/// All runs of a kind, in the order of their seeds.
std::vector<PeopleResult> study_people(const PeopleKind& kind, const PeopleStudyOptions& options);

/// Recordings of 3 to 5 minutes at 1 and 5 Hz without velocities and with them, each under one of
/// the rules, with faults of one kind.
std::vector<PeopleResult> study_people_faults(const PeopleStudyOptions& options);

/// A heading and a line for each kind and rule; then why the others were refused, by kind.
std::string people_table(const std::vector<PeopleResult>& results);

/// By kind of fault: outcomes, and how often beaten is false; then the falsely beaten runs.
std::string people_faults_table(const std::vector<PeopleResult>& results);

/// A line for each result, the time it took left out, with the contribution of each row of the
/// budget.
std::string people_csv(const std::vector<PeopleResult>& results);

}  // namespace runcert
