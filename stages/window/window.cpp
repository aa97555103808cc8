#include "stages/window/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/failure.h"
#include "core/parallel.h"
#include "stages/window/arc_part.h"
#include "stages/window/certify.h"
#include "stages/window/certify_velocity.h"
#include "stages/window/course_windows.h"
#include "stages/window/instants.h"
#include "stages/window/opposite_runs.h"
#include "stages/window/sample_series.h"

namespace runcert {
namespace {

/// What the profiles of one receiver are searched and certified from.
class Certifier {
  public:
    Certifier(const ScreenedTable& screened, const TrajectoryTable& trajectory,
              const std::vector<Profile>& profiles, const WindowConfig& config)
        : screened_(screened),
          trajectory_(trajectory),
          horizontal_(estimate_of<2>(screened, trajectory, config)) {
        const auto of_heights = [](const Profile& profile) {
            return profile.dimension != Dimension::horizontal;
        };
        if (has_heights() && std::ranges::any_of(profiles, of_heights))
            vertical_.emplace(estimate_of<1>(screened, trajectory, config));
    }

    const std::vector<ArcRows>& rows() const { return horizontal_.rows; }
    bool has_heights() const { return trajectory_.estimation.vertical.has_value(); }

    CertifiableWindow certify(const Profile& profile, FoundWindow found,
                              const std::vector<FoundWindow>& all,
                              const std::optional<CourseGates>& gates) const {
        if (profile.speed_source == SpeedSource::velocity)
            return certified_by_velocity(screened_, trajectory_, rows()[found.series], profile,
                                         found, all);
        WindowChoice choice{
            .profile = profile, .found = found, .all = all, .quantity = quantity_of(profile)};
        if (profile.window_kind == WindowKind::course)
            return certify_course(profile, found, all, *gates);
        if (profile.dimension == Dimension::vertical) return certified(*vertical_, choice);
        const CertifiableWindow level = certified(horizontal_, choice);
        return profile.dimension == Dimension::space
                   ? in_space(level, certified(*vertical_, choice))
                   : level;
    }

  private:
    /// The crossings by the smoothed track in place of those by straight lines between epochs.
    CertifiableWindow certify_course(const Profile& profile, FoundWindow found,
                                     std::vector<FoundWindow> all, const CourseGates& gates) const {
        const auto same = [&](const FoundWindow& one) {
            return one.series == found.series && one.start == found.start && one.end == found.end;
        };
        const auto listed = std::ranges::find_if(all, same);
        const auto& times = horizontal_.times[found.series];
        const Arc<2>& arc = horizontal_.arcs[found.series];
        const EpochPair enclosing{found.first, found.last};
        const ArcPart<2> part =
            part_around(arc, times, enclosing, memory_s(arc, enclosing, horizontal_.model));
        const CrossingTimes crossed =
            smoothed_crossings(part.arc, part.times, horizontal_.model,
                               {.start = found.start, .end = found.end}, gates.start, gates.finish);
        found.start = crossed.start;
        found.end = crossed.end;
        found.first =
            static_cast<std::size_t>(std::ranges::upper_bound(times, found.start) - times.begin()) -
            1;
        found.last =
            static_cast<std::size_t>(std::ranges::lower_bound(times, found.end) - times.begin());
        found.speed_m_s = gates.length_m / (found.end.seconds() - found.start.seconds());
        if (listed != all.end()) *listed = found;
        SpeedQuantity quantity = quantity_of(profile);
        quantity.length_m = gates.length_m;
        quantity.start_normal = along_course(gates.start);
        quantity.finish_normal = along_course(gates.finish);
        return certified(horizontal_,
                         {.profile = profile,
                          .found = found,
                          .all = all,
                          .quantity = quantity,
                          .length_standard_uncertainty_m = gates.length_standard_uncertainty_m});
    }

    const ScreenedTable& screened_;
    const TrajectoryTable& trajectory_;
    AxesEstimate<2> horizontal_;
    std::optional<AxesEstimate<1>> vertical_;
};

WindowRule rule_of(const Profile& profile) {
    return {.kind = profile.window_kind,
            .duration_s = profile.duration_s,
            .distance_m = profile.distance_m,
            .definition = profile.definition,
            .dimension = profile.dimension,
            .source = profile.speed_source,
            .ends = profile.ends,
            .exact = profile.exact_duration,
            .count = profile.windows,
            .opposite_runs = profile.opposite_runs_within_s.has_value()};
}

bool overlap(const FoundWindow& one, const FoundWindow& other) {
    return one.start < other.end && other.start < one.end;
}

/// The windows that a profile may choose from, and those that it chooses.
struct Choice {
    std::vector<FoundWindow> all;
    std::vector<FoundWindow> chosen;
    std::string missing;
};

Choice choose(const ScreenedTable& screened, const TrajectoryTable& trajectory,
              const std::vector<ArcRows>& rows, const Profile& profile, const WindowConfig& config,
              const std::optional<CourseGates>& gates) {
    const auto series = certifiable_series(screened, trajectory, rows, profile);
    const WindowCriteria rule =
        window_criteria(profile, config.duration_tolerance_s, trajectory.facts.nominal_interval_s);
    const auto wanted = static_cast<std::size_t>(profile.windows);
    Choice choice;
    if (rule.kind == WindowKind::course) {
        choice.all = course_windows(series, *gates);
        if (choice.all.empty()) choice.missing = why_no_course_window(series, *gates);
        choice.chosen.assign(
            choice.all.begin(),
            choice.all.begin() + static_cast<std::ptrdiff_t>(std::min(wanted, choice.all.size())));
    } else {
        AllowedWindows windows = allowed_and_best(series, rule, wanted);
        choice.all = std::move(windows.all);
        choice.chosen = std::move(windows.best);
    }
    if (profile.opposite_runs_within_s) {
        const OppositeRuns pair = best_opposite_runs(trajectory, rows, choice.all, profile);
        choice.chosen = pair.windows;
        choice.missing = pair.missing;
    }
    if (profile.speed_source == SpeedSource::velocity && !choice.chosen.empty())
        for (const FoundWindow& found : choice.chosen)
            if (!states_velocity_accuracy(screened, rows[found.series], profile, found)) {
                choice.chosen.clear();
                choice.missing = "the recording does not state how accurate its velocities are";
                break;
            }
    return choice;
}

void add_window(const CertifiableWindow& window, ProfileWindows& entry) {
    if (!entry.best)
        entry.best = window;
    else
        entry.further.push_back({.span = window.span,
                                 .arc = window.arc,
                                 .speed_m_s = window.speed_m_s,
                                 .standard_uncertainty_m_s = window.standard_uncertainty_m_s,
                                 .bias_limit_m_s = window.bias_limit_m_s,
                                 .robust = window.robust});
}

ProfileWindows windows_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                          const Certifier& certifier, const Profile& profile,
                          const WindowConfig& config, const std::optional<CourseGates>& gates) {
    ProfileWindows entry{.profile = profile.id,
                         .rule = rule_of(profile),
                         .candidates = 0,
                         .missing = {},
                         .best = std::nullopt,
                         .further = {},
                         .indicated = fastest_indicated(screened, profile, config, gates)};
    if (profile.dimension != Dimension::horizontal && !certifier.has_heights()) {
        entry.missing = "the recording has no heights that could be estimated";
        return entry;
    }
    Choice choice = choose(screened, trajectory, certifier.rows(), profile, config, gates);
    entry.candidates = std::ssize(choice.all);
    entry.missing = choice.missing;
    if (profile.window_kind == WindowKind::course && choice.chosen.empty() && entry.indicated)
        entry.missing =
            "as recorded the track passes over the course, but not within one stretch of usable "
            "epochs";
    // Each is certified among those that do not overlap one chosen before it.
    for (const FoundWindow& found : choice.chosen) {
        add_window(certifier.certify(profile, found, choice.all, gates), entry);
        std::erase_if(choice.all, [&](const FoundWindow& one) { return overlap(one, found); });
    }
    return entry;
}

/// Profiles are certified beside one another; which of several failures is told must not depend on
/// which comes first.
struct ProfileOrFailure {
    std::optional<ProfileWindows> windows;
    std::exception_ptr failure;
};

template <class Task>
ProfileOrFailure result_or_failure(const Task& task) {
    try {
        return {task(), nullptr};
    } catch (...) {
        return {std::nullopt, std::current_exception()};
    }
}

}  // namespace

WindowConfig window_config(const Attempt& attempt, const Receiver& receiver) {
    const nlohmann::ordered_json& parameters = attempt.parameters.at("window");
    std::optional<Eigen::Vector3d> lever_arm;
    if (receiver.lever_arm) lever_arm = Eigen::Vector3d(receiver.lever_arm->data());
    return {.duration_tolerance_s = parameters.at("duration_tolerance_s"),
            .seed = parameters.at("seed"),
            .selection_samples = parameters.at("selection_samples"),
            .monte_carlo_trials_max = parameters.at("monte_carlo_trials_max"),
            .plane_scale_bound = parameters.at("plane_scale_bound"),
            .clock_rate_bound = parameters.at("clock_rate_bound"),
            .lever_arm = lever_arm,
            .rotation_bound_deg = receiver.rotation_bound_deg};
}

Windows find_windows(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                     const std::vector<Profile>& profiles, const WindowConfig& config,
                     const std::optional<Course>& course) {
    Windows windows;
    windows.receiver = trajectory.facts.receiver;
    windows.first_epoch = trajectory.facts.first_epoch;
    windows.georeferenced = trajectory.facts.georeferenced;
    const Certifier certifier(screened, trajectory, profiles, config);
    std::optional<CourseGates> gates;
    if (course) gates = course_gates(*course, trajectory.origin);
    const auto one = [&](std::int64_t i) {
        const Profile& profile = profiles[static_cast<std::size_t>(i)];
        return result_or_failure([&] {
            if (profile.window_kind == WindowKind::course && !gates)
                throw Failure("attempt", "the profile " + profile.id + " needs a course",
                              "Run runcert-import again, with the same attempt");
            return windows_of(screened, trajectory, certifier, profile, config, gates);
        });
    };
    for (ProfileOrFailure& entry : results_of(std::ssize(profiles), threads_allowed(), one)) {
        if (entry.failure) std::rethrow_exception(entry.failure);
        windows.profiles.push_back(std::move(*entry.windows));
    }
    return windows;
}

}  // namespace runcert
