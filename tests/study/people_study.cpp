#include "people_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "core/failure.h"
#include "core/parallel.h"
#include "schemas/windows/windows.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "study_verdict.h"

namespace runcert {
namespace {

constexpr double harsher_m_s = 0.1 / 3.6;

/// Processor time of this thread, s.
double processor_time_s() {
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The draws that check the budget change nothing that is counted here: the fewest are made.
const Attempt& people_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: people\ncraft: {name: people, class: board}\n"
        "receivers: [{id: primary, recording: none}]\nprofiles: [nalsa]\n"
        "parameters: {window: {monte_carlo_trials_max: 100000}}\n",
        "people");
    return attempt;
}

Profile by_position(std::string_view name) {
    Profile profile = read_profile(builtin_profile(name), std::string(name));
    profile.id += "-by-position";
    profile.definition = SpeedDefinition::displacement;
    profile.speed_source = SpeedSource::position;
    profile.margin = 0.0;
    profile.rounding.reset();
    profile.accuracy_limit_m_s.reset();
    std::erase_if(profile.clauses, [](const Clause& clause) {
        return clause.decided_by != Computation::window_complete &&
               clause.decided_by != Computation::margin;
    });
    return profile;
}

void note_window(const CertifiableWindow& window, const TruePath& path, PeopleResult& result) {
    const double from_s = window.span.start.seconds();
    result.window_start = from_s;
    result.truth = path.speed_m_s(from_s, from_s + window.span.duration.seconds());
    result.bias_limit = window.bias_limit_m_s;
    result.expected_with_velocities = window.expected_beside_velocities_m_s;
    for (const UndetectedError& error : window.reliability)
        result.undetected = std::max(result.undetected, error.speed_m_s);
    for (const BudgetRow& row : window.budget)
        result.contributions[row.symbol] += row.contribution_m_s;
}

void judge_people(const ReceiverFindings& findings, const Profile& rule, const TruePath& path,
                  PeopleResult& result) {
    const ProfileVerdict verdict = verdict_at(people_attempt(), result.record, findings, rule);
    result.outcome = verdict.outcome;
    result.reason = verdict.reason;
    result.speed = verdict.speed_m_s;
    result.expanded = verdict.expanded_uncertainty_m_s.value_or(0.0);
    if (const auto* windows = windows_of(findings.windows, rule.id); windows && windows->best)
        note_window(*windows->best, path, result);
    result.outcome_above =
        result.outcome == Outcome::beaten
            ? verdict_at(people_attempt(), result.record + harsher_m_s, findings, rule).outcome
            : result.outcome;
}

}  // namespace

bool PeopleResult::held() const {
    return std::abs(error()) <= expanded;
}

bool PeopleResult::falsely_beaten() const {
    return outcome == Outcome::beaten && *truth < record;
}

bool PeopleResult::falsely_beaten_above() const {
    return outcome_above == Outcome::beaten && *truth < record + harsher_m_s;
}

const std::vector<Profile>& people_rules() {
    static const std::vector<Profile> rules{by_position("nalsa"),
                                            by_position("gps-speed-sailing-10s")};
    return rules;
}

std::vector<PeopleResult> certify_people(const PeopleKind& kind, PeopleFault fault,
                                         std::uint64_t seed, const std::vector<Profile>& rules) {
    const PeopleRecording recording = record_people(kind, fault, seed);
    std::vector<PeopleResult> results;
    for (const Profile& rule : rules)
        results.push_back(
            {.kind = kind.name,
             .seed = seed,
             .fault = fault,
             .faults = recording.fault,
             .profile = rule.id,
             .device = recording.device,
             .epochs = std::ssize(recording.measured.rows),
             .record = recording.path.fastest_m_s(rule.duration_s, 1.0 / kind.rate_hz)});
    const double begun_s = processor_time_s();
    try {
        const Attempt& attempt = people_attempt();
        const ScreenedTable screened = screen(recording.measured, screen_config(attempt));
        for (PeopleResult& result : results)
            result.usable = summarise(screened.rows).usable;
        TrajectoryTable trajectory = smooth_trajectory(screened, smooth_config(attempt));
        Windows windows = find_windows(screened, trajectory, rules,
                                       window_config(attempt, attempt.receivers.front()));
        const ReceiverFindings findings =
            findings_of(screened, std::move(trajectory), std::move(windows));
        for (std::size_t i = 0; i < rules.size(); ++i)
            judge_people(findings, rules[i], recording.path, results[i]);
    } catch (const Failure& failure) {
        for (PeopleResult& result : results) {
            result.failed = true;
            result.reason = failure.what();
        }
    }
    for (PeopleResult& result : results)
        result.processor_s = processor_time_s() - begun_s;
    return results;
}

std::vector<PeopleResult> study_people(const PeopleKind& kind, const PeopleStudyOptions& options) {
    std::vector<PeopleResult> all;
    for (std::vector<PeopleResult>& one :
         results_of(options.runs, options.threads, [&](std::int64_t i) {
             return certify_people(kind, PeopleFault::none,
                                   options.seed * 5'000'011 + static_cast<std::uint64_t>(i));
         }))
        std::ranges::move(one, std::back_inserter(all));
    return all;
}

std::vector<PeopleResult> study_people_faults(const PeopleStudyOptions& options) {
    static constexpr std::array faults{PeopleFault::step, PeopleFault::spike, PeopleFault::ramp,
                                       PeopleFault::multipath};
    static constexpr std::array velocities{PeopleVelocities::none, PeopleVelocities::stated,
                                           PeopleVelocities::unstated};
    return results_of(options.runs, options.threads, [&](std::int64_t i) {
        const std::uint64_t seed = options.seed * 6'000'011 + static_cast<std::uint64_t>(i);
        RandomGenerator random(seed ^ 0xfa017);
        const auto choose = [&](const auto& from) -> const auto& {
            return from[static_cast<std::size_t>(random.uniform() *
                                                 static_cast<double>(from.size()))];
        };
        PeopleKind kind{.rate_hz = random.uniform() < 0.7 ? 1.0 : 5.0,
                        .shortest_s = 180.0,
                        .longest_s = 300.0,
                        .velocities = choose(velocities)};
        kind.name = fmt::format("{:g} Hz{}", kind.rate_hz, velocities_words(kind.velocities));
        return certify_people(kind, choose(faults), seed, {choose(people_rules())}).front();
    });
}

}  // namespace runcert
