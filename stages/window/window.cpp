#include "stages/window/window.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/failure.h"
#include "core/figures.h"
#include "core/parallel.h"
#include "core/speed_unit.h"
#include "stages/window/certify.h"
#include "stages/window/certify_velocity.h"
#include "stages/window/contradictions.h"
#include "stages/window/course_windows.h"
#include "stages/window/instants.h"
#include "stages/window/opposite_runs.h"
#include "stages/window/sample_series.h"
#include "stages/window/stands.h"
#include "stages/window/trajectory_part.h"
#include "stages/window/window_courses.h"
#include "stages/window/window_quality.h"

namespace runcert {
namespace {

/// Where the craft stood, by what was handed in beside the recording or by its positions.
std::vector<Stand> stands_in(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const WitnessRecords& records) {
    const auto& series = records.handed_in.series;
    const auto wheel = series.find("wheel");
    return stands_of(screened, trajectory, records.still_by_imu,
                     wheel == series.end() ? nullptr : &wheel->second);
}

/// The data in which a profile's windows are searched.
struct Candidates {
    const ScreenedTable& screened;
    const TrajectoryTable& trajectory;
    const std::vector<ArcRows>& rows;
    const Profile& profile;
    const std::optional<SurveyedCourse>& gates;
    WindowCriteria rule;
    std::vector<SampleSeries> series;
    bool files_attested = true;  ///< whether second files count
};

/// The data from which the profiles of one receiver are searched and certified.
class ReceiverEstimates {
  public:
    ReceiverEstimates(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                      const std::vector<Profile>& profiles, const WindowConfig& config,
                      const WitnessRecords& records)
        : screened_(screened),
          trajectory_(trajectory),
          inertial_(records.inertial),
          horizontal_(estimate_of<2>(screened, trajectory, config, records,
                                     stands_in(screened, trajectory, records))) {
        const auto of_craft = [](const Profile& profile) {
            return profile.speed_of == SpeedOf::reference_point;
        };
        if (inertial_ && std::ranges::any_of(profiles, of_craft))
            of_craft_ = at_reference_point(trajectory, *inertial_);
        const auto of_heights = [](const Profile& profile) {
            return profile.dimension != Dimension::horizontal;
        };
        if (has_heights() && std::ranges::any_of(profiles, of_heights))
            vertical_.emplace(
                estimate_of<1>(screened, trajectory, config, records, horizontal_.stands));
        for (const Profile& profile : profiles)
            if (profile.speed_source == SpeedSource::velocity &&
                !velocities_.contains(profile.dimension))
                velocities_.emplace(
                    profile.dimension,
                    VelocityEstimate{screened, trajectory, horizontal_.rows, horizontal_.times,
                                     config,
                                     compared_speeds(screened, trajectory, horizontal_.rows,
                                                     profile.dimension)});
    }

    const std::vector<ArcRows>& rows() const { return horizontal_.rows; }
    const std::vector<Stand>& stands() const { return horizontal_.stands; }

    /// The witnesses that cover a window: a bit for each that confirms, or that contradicts another
    /// window (`contradicting`).
    std::uint64_t covering(const Candidates& among, const FoundWindow& found,
                           std::uint64_t contradicting) const {
        const std::vector<ElapsedTime>& times = horizontal_.times[found.series];
        return witnesses_that(among, [&](const auto& one, std::uint64_t bit) {
            return !one.is_copy && (one.confirms || (contradicting & bit) != 0) &&
                   one.motion->between(times[found.first].seconds(), times[found.last].seconds());
        });
    }

    /// The witnesses that contradict a certified window.
    std::uint64_t contradicting(const Candidates& among, const CertifiableWindow& window) const {
        return witnesses_that(among, [&](const auto& witness, std::uint64_t) {
            return std::ranges::any_of(window.witnesses, [&](const WitnessedSpeed& one) {
                return contradicts(one) && is_same_witness(one, witness);
            });
        });
    }

    /// The trajectory in which a profile's windows are searched.
    const TrajectoryTable& trajectory_for(const Profile& profile) const {
        return counts_craft(profile) ? of_craft_ : trajectory_;
    }

    /// Why the speed that the profile counts is not known. Empty if it is.
    std::string craft_is_unknown(const Profile& profile, const WindowConfig& config) const {
        if (profile.speed_of != SpeedOf::reference_point) return {};
        if (inertial_)
            return inertial_->epochs.empty() || !inertial_->consistency.consistent()
                       ? "the rule counts the speed of the craft's reference point, which the IMU "
                         "does not give: it and the positions do not agree"
                       : "";
        return config.antenna_motion
                   ? ""
                   : "the rule counts the speed of the craft's reference point: give an IMU "
                     "(receivers[].imu), or bounds of the antenna's motion "
                     "(receivers[].antenna_motion)";
    }

    /// Whether second files can change what is certified under the profile.
    bool depends_on_files(const Profile& profile) const {
        using Assessed = AssessedWitness<2>;
        return profile.speed_source != SpeedSource::velocity &&
               (counts_craft(profile) ||
                !std::ranges::equal(horizontal_.witnesses, horizontal_.unattested, {},
                                    &Assessed::confirms, &Assessed::confirms));
    }

    /// Whether windows are those of the reference point by the IMU.
    bool counts_craft(const Profile& profile) const {
        return inertial_ && profile.speed_of == SpeedOf::reference_point;
    }

    bool has_heights() const { return trajectory_.estimation.vertical.has_value(); }

    /// Notes on the witnesses of horizontal motion: those that were not used, the parameters
    /// estimated for them, and windows that they do not cover, contradict or fail to confirm.
    std::vector<std::string> witness_notes(const std::vector<Profile>& profiles,
                                           const std::vector<ProfileWindows>& windows,
                                           const WitnessRecords& records) const {
        std::vector<std::string> notes = unused_witness_notes(records, horizontal_.witnesses);
        if (std::string stood = standing_text(stands()); !stood.empty())
            notes.push_back(std::move(stood));
        if (const LastingDifference& lasting = horizontal_.lasting; lasting.size_m_s > 0.0)
            notes.push_back(fmt::format(
                "Positions and recorded velocities differ all over the recording by {:.2f} m/s, "
                "which the errors of neither explain: {}.",
                lasting.size_m_s,
                lasting.is_scale
                    ? fmt::format("the velocities are {:.2f} % too {}, or the positions drift in "
                                  "proportion to the speed: with these data the two cannot be "
                                  "separated",
                                  100.0 * std::abs(lasting.scale),
                                  lasting.scale > 0.0 ? "high" : "low")
                    : "one of the two is wrong, and the recording does not tell which"));
        for (const AssessedWitness<2>& witness : horizontal_.witnesses) {
            if (!witness.note.empty()) notes.push_back(witness.note);
            if (witness.is_copy) continue;
            for (std::size_t i = 0; i < windows.size(); ++i) {
                const auto& best = windows[i].best;
                if (!best || profiles[i].dimension == Dimension::vertical ||
                    profiles[i].speed_source == SpeedSource::velocity)
                    continue;
                const auto said = std::ranges::find_if(
                    best->witnesses,
                    [&](const WitnessedSpeed& one) { return is_same_witness(one, witness); });
                std::string note = said == best->witnesses.end()
                                       ? silence_text(witness, trajectory_, windows[i].profile)
                                   : contradicts(*said)
                                       ? contradiction_text(witness, screened_)
                                       : unconfirming_text(witness, best->span, windows[i].profile);
                if (!note.empty() && std::ranges::find(notes, note) == notes.end())
                    notes.push_back(std::move(note));
            }
        }
        return notes;
    }

    /// Certifies a window by the source of speed and in the dimension that its rule asks for.
    CertifiableWindow certify(const Candidates& among, FoundWindow found,
                              const std::vector<FoundWindow>& all,
                              std::span<const Contradiction> contradictions,
                              CertificateExtent extent = CertificateExtent::whole) const {
        const Profile& profile = among.profile;
        const bool by_velocities = profile.speed_source == SpeedSource::velocity;
        const bool over_course = profile.window_kind == WindowKind::course && !by_velocities;
        std::vector<FoundWindow> refined;
        if (over_course) refined = refine_crossings(profile, *among.gates, all, found);
        const auto choice = [&](Dimension dimension) {
            WindowChoice one{
                .profile = profile,
                .found = found,
                .all = over_course ? refined : all,
                .quantity = quantity_of(profile),
                .craft = by_velocities ? std::nullopt : craft_of(profile, found, dimension),
                // Of the two parts of a speed in space a witness may cover
                // one, and each budget counts its own share of it.
                .by_positions_alone = profile.dimension == Dimension::space && !over_course,
                .files_attested = among.files_attested,
                .contradictions = contradictions,
                .extent = extent};
            if (!over_course) return one;
            one.quantity.length_m = among.gates->length_m;
            one.quantity.start_normal = along_course(among.gates->start);
            one.quantity.finish_normal = along_course(among.gates->finish);
            one.length_standard_uncertainty_m = among.gates->length_standard_uncertainty_m;
            return one;
        };
        if (by_velocities)
            return certify_by_velocities(velocities_.at(profile.dimension),
                                         choice(profile.dimension));
        if (profile.dimension == Dimension::vertical && !over_course)
            return certify_by_positions(*vertical_, choice(Dimension::vertical));
        const CertifiableWindow level =
            certify_by_positions(horizontal_, choice(Dimension::horizontal));
        return profile.dimension == Dimension::space && !over_course
                   ? speed_in_space(level,
                                    certify_by_positions(*vertical_, choice(Dimension::vertical)))
                   : level;
    }

    /// The contradictions in a certified window by positions.
    std::vector<Contradiction> contradictions_in(const Profile& profile, const FoundWindow& found,
                                                 const CertifiableWindow& window) const {
        if (profile.speed_source == SpeedSource::velocity || !window.evidence) return {};
        return profile.dimension == Dimension::vertical
                   ? runcert::contradictions_in(*vertical_, found, window)
                   : runcert::contradictions_in(horizontal_, found, window);
    }

  private:
    std::uint64_t witnesses_that(const Candidates& among, const auto& is) const {
        const auto bits = [&](const auto& witnesses) {
            std::uint64_t found = 0;
            for (std::size_t i = 0; i < witnesses.size(); ++i)
                if (const std::uint64_t bit = std::uint64_t{1} << i; is(witnesses[i], bit))
                    found |= bit;
            return found;
        };
        if (among.profile.speed_source == SpeedSource::velocity) return 0;
        return among.profile.dimension == Dimension::vertical
                   ? bits(admitted_witnesses(*vertical_, among.files_attested))
                   : bits(admitted_witnesses(horizontal_, among.files_attested));
    }

    std::optional<CraftCorrection> craft_of(const Profile& profile, const FoundWindow& found,
                                            Dimension dimension) const {
        if (!counts_craft(profile)) return std::nullopt;
        auto craft = craft_correction(*inertial_, {.from_s = found.start.seconds(),
                                                   .to_s = found.end.seconds(),
                                                   .definition = profile.definition,
                                                   .dimension = dimension});
        if (!craft)
            throw Failure(
                "receiver " + screened_.facts.receiver,
                fmt::format("a window under {} lies where the IMU says nothing", profile.id),
                "This is a fault of the program; please report it");
        return craft;
    }

    /// Moves a window over a course to the crossings of the smoothed track, in place of those of
    /// straight lines between epochs. Returns all windows, with this one among them.
    std::vector<FoundWindow> refine_crossings(const Profile& profile, const SurveyedCourse& gates,
                                              std::vector<FoundWindow> all,
                                              FoundWindow& found) const {
        const auto listed = std::ranges::find_if(all, [&](const FoundWindow& one) {
            return one.series == found.series && one.start == found.start && one.end == found.end;
        });
        const auto& times = horizontal_.times[found.series];
        const Arc<2>& arc = horizontal_.arcs[found.series];
        const EpochPair enclosing{found.first, found.last};
        const ArcPart<2> part =
            part_around(arc, times, enclosing, memory_s(arc, enclosing, horizontal_.model));
        // The reference point's crossings were found on its own track.
        const CrossingTimes straight{.start = found.start, .end = found.end};
        const CrossingTimes crossed =
            counts_craft(profile) ? straight
                                  : smoothed_crossings(part.arc, part.times, horizontal_.model,
                                                       straight, gates.start, gates.finish);
        found.start = crossed.start;
        found.end = crossed.end;
        found.first =
            static_cast<std::size_t>(std::ranges::upper_bound(times, found.start) - times.begin()) -
            1;
        found.last =
            static_cast<std::size_t>(std::ranges::lower_bound(times, found.end) - times.begin());
        found.speed_m_s = gates.length_m / found.duration_s();
        if (listed != all.end()) *listed = found;
        return all;
    }

    const ScreenedTable& screened_;
    const TrajectoryTable& trajectory_;
    std::shared_ptr<const InertialSolution> inertial_;
    TrajectoryTable of_craft_;  ///< of the reference point, where a profile counts it
    AxesEstimate<2> horizontal_;
    std::optional<AxesEstimate<1>> vertical_;
    std::map<Dimension, VelocityEstimate> velocities_;
};

bool overlap(const FoundWindow& one, const FoundWindow& other) {
    return one.start < other.end && other.start < one.end;
}

/// The windows from which a profile may choose, and those that it chooses.
struct Choice {
    std::vector<FoundWindow> all;
    std::vector<FoundWindow> chosen;
    std::string missing;
    bool refused = false;  ///< a passage over the course was
};

Candidates candidates_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                         const std::vector<ArcRows>& rows, const Profile& profile,
                         const WindowConfig& config, const std::optional<SurveyedCourse>& gates,
                         const std::optional<WindowPart>& part,
                         SeriesPositions positions = SeriesPositions::smoothed) {
    Candidates among{.screened = screened,
                     .trajectory = trajectory,
                     .rows = rows,
                     .profile = profile,
                     .gates = gates,
                     .rule = window_criteria(profile, config.duration_tolerance_s,
                                             trajectory.facts.nominal_interval_s),
                     .series = certifiable_series(screened, trajectory, rows, profile, positions)};
    if (part)
        for (SampleSeries& series : among.series)
            restrict_to(part, std::vector(series.times), series);
    return among;
}

/// The passages over a course, choosing the highest assured speeds.
Choice choose_passages(const Candidates& among, const Allowance& allowance) {
    const auto wanted = static_cast<std::size_t>(among.profile.windows);
    Choice choice;
    choice.all = course_windows(among.series, *among.gates);
    if (choice.all.empty()) {
        choice.missing = refused_passage(among.series, *among.gates);
        choice.refused = !choice.missing.empty();
        if (!choice.refused)
            choice.missing = why_no_passage(among.series, among.gates->start, among.gates->finish);
    }
    make_allowances(choice.all, allowance);
    std::ranges::stable_sort(choice.all, preferred);
    choice.chosen.assign(
        choice.all.begin(),
        choice.all.begin() + static_cast<std::ptrdiff_t>(std::min(wanted, choice.all.size())));
    return choice;
}

/// The fastest windows or, with an allowance, those with the highest assured speeds.
Choice choose(const Candidates& among, const Allowance& allowance = {}) {
    const Profile& profile = among.profile;
    Choice choice;
    if (among.rule.kind == WindowKind::course) {
        choice = choose_passages(among, allowance);
    } else {
        AllowedWindows windows = allowed_and_best(
            among.series, among.rule, static_cast<std::size_t>(profile.windows), allowance);
        choice.all = std::move(windows.all);
        choice.chosen = std::move(windows.best);
    }
    if (profile.opposite_runs_within_s) {
        const OppositeRuns pair =
            best_opposite_runs(among.trajectory, among.rows, choice.all, profile);
        choice.chosen = pair.windows;
        choice.missing = pair.missing;
    }
    if (profile.speed_source == SpeedSource::velocity && !choice.chosen.empty())
        for (const FoundWindow& found : choice.chosen)
            if (!states_velocity_accuracy(among.screened, among.rows[found.series], profile,
                                          found)) {
                choice.chosen.clear();
                choice.missing = "the recording does not state how accurate its velocities are";
                break;
            }
    return choice;
}

/// A reason, in the recording as a whole, why no window under the rule is possible. Empty if
/// there is none.
std::string unfit_for(const ScreenedTable& screened, const Profile& profile) {
    if (profile.speed_source == SpeedSource::velocity &&
        std::ranges::none_of(screened.rows, [&](const ScreenedEpoch& row) {
            return recorded_speed(row, profile.dimension).has_value();
        }))
        return "the recording has no speeds, which this rule measures";
    const std::int64_t shared =
        std::ranges::count(screened.rows, Reason::duplicate_time, &ScreenedEpoch::reason);
    if (2 * shared > std::ssize(screened.rows))
        return fmt::format(
            "{} of {} epochs have the time of another at another place: several positions share "
            "one time stamp",
            shared, screened.rows.size());
    const double interval_s = screened.facts.nominal_interval_s;
    const auto longest_s = longest_step_of(profile, interval_s);
    if (longest_s && interval_s > *longest_s)
        return fmt::format(
            "the recording has an epoch every {} s, and the rule asks for one every {} s",
            significant_text(interval_s, 3), significant_text(*longest_s, 3));
    if (profile.definition == SpeedDefinition::mean_n && interval_s >= profile.duration_s)
        return fmt::format(
            "a mean of the speeds after the first over {} s needs two of them, and the recording "
            "has an epoch every {} s",
            significant_text(profile.duration_s, 3), significant_text(interval_s, 3));
    return {};
}

/// Why the speeds that the rule takes are no measurement: one figure all over, while the craft
/// moves otherwise at a tenth of the epochs or more. Empty if they may be one.
std::string constant_speed_text(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                                const Profile& profile) {
    constexpr std::size_t least_rows = 30;
    constexpr double by_chance = 3.29, unseen_m_s = 0.5;
    if (profile.speed_source != SpeedSource::velocity || profile.dimension != Dimension::horizontal)
        return {};
    std::vector<double> recorded_m_s, moving_m_s;
    for (const ScreenedEpoch& row : screened.rows)
        if (const auto speed = recorded_speed(row, profile.dimension))
            recorded_m_s.push_back(speed->speed_m_s);
    if (recorded_m_s.size() < least_rows) return {};
    const auto [least, most] = std::ranges::minmax(recorded_m_s);
    std::size_t otherwise = 0;
    for (const TrajectoryEpoch& row : trajectory.rows) {
        if (!row.arc || !row.speed_m_s) continue;
        moving_m_s.push_back(*row.speed_m_s);
        const double allowed_m_s =
            unseen_m_s + by_chance * std::hypot(row.sigma_velocity_east_m_s.value_or(0.0),
                                                row.sigma_velocity_north_m_s.value_or(0.0));
        otherwise += std::abs(*row.speed_m_s - most) > allowed_m_s;
    }
    if (most - least > 1e-6 * most || otherwise == 0 || 10 * otherwise < moving_m_s.size())
        return {};
    const auto [slowest, fastest] = std::ranges::minmax(moving_m_s);
    return fmt::format(
        "the recorded speed is {} m/s at all {} epochs while the positions move at {} to {} m/s",
        significant_text(most, 3), recorded_m_s.size(), significant_text(slowest, 3),
        significant_text(fastest, 3));
}

FurtherWindow further_window(const CertifiableWindow& window) {
    return {.span = window.span,
            .arc = window.arc,
            .speed_m_s = window.speed_m_s,
            .standard_uncertainty_m_s = window.standard_uncertainty_m_s,
            .bias_limit_m_s = window.bias_limit_m_s,
            .robust = window.robust,
            .evidence = window.evidence,
            .witnesses = window.witnesses};
}

/// Each chosen window, certified among those that do not overlap a previously chosen one.
std::vector<CertifiableWindow> certified_windows(const ReceiverEstimates& estimates,
                                                 const Candidates& among, Choice choice,
                                                 std::span<const Contradiction> contradictions) {
    std::vector<CertifiableWindow> certified;
    for (const FoundWindow& found : choice.chosen) {
        certified.push_back(estimates.certify(among, found, choice.all, contradictions));
        std::erase_if(choice.all, [&](const FoundWindow& one) { return overlap(one, found); });
    }
    return certified;
}

/// Whether every witness that contradicts the first windows covers each of the others. A window
/// that it does not cover must not avoid the contradiction.
bool cover_what_contradicts(const std::vector<CertifiableWindow>& others,
                            const std::vector<CertifiableWindow>& first) {
    const auto covers = [&](const WitnessedSpeed& contradicting) {
        return std::ranges::all_of(others, [&](const CertifiableWindow& window) {
            return std::ranges::any_of(window.witnesses, [&](const WitnessedSpeed& one) {
                return is_same_witness(one, contradicting);
            });
        });
    };
    for (const CertifiableWindow& window : first)
        for (const WitnessedSpeed& one : window.witnesses)
            if (contradicts(one) && !covers(one)) return false;
    return true;
}

bool contradicted(const std::vector<CertifiableWindow>& windows) {
    return std::ranges::any_of(windows, [](const CertifiableWindow& window) {
        return std::ranges::any_of(window.witnesses, &contradicts);
    });
}

/// Mean over windows of the speed that each proves: its speed minus its expanded uncertainty.
double proven_m_s(const std::vector<CertifiableWindow>& windows, const Profile& profile) {
    double sum = 0.0;
    for (const CertifiableWindow& window : windows)
        sum += window.speed_m_s - expanded_uncertainty_by_rule_m_s(window, profile.coverage_factor);
    return sum / static_cast<double>(windows.size());
}

/// The same of windows as they were compared: by their own allowances.
double assured_m_s(const std::vector<FoundWindow>& windows) {
    double sum = 0.0;
    for (const FoundWindow& window : windows)
        sum += window.assured_m_s();
    return sum / static_cast<double>(windows.size());
}

/// Whether these windows can be certified as they are: no witness contradicts them, and the speed
/// is as accurate as the rule asks.
bool are_fit(const std::vector<CertifiableWindow>& windows, const Profile& profile) {
    const auto& limit_m_s = profile.accuracy_limit_m_s;
    return !contradicted(windows) && (!limit_m_s || windows.size() > 1 ||
                                      expanded_uncertainty_by_rule_m_s(
                                          windows.front(), profile.coverage_factor) <= *limit_m_s);
}

/// The few windows that are certified in the search for the best proof, and what they tell of all
/// others.
class ProofSearch {
  public:
    ProofSearch(const ReceiverEstimates& estimates, const Candidates& among)
        : estimates_(estimates),
          among_(among),
          qualities_(among.screened, among.rows, among.profile) {}

    /// Where witnesses contradict windows certified so far.
    const std::vector<Contradiction>& contradictions() const { return contradictions_; }

    /// Takes what witnesses say of a certified window. One that overlaps a contradicted one
    /// contains part of the fault, and no speed is claimed for it. Others of the same motion are
    /// suspect. Returns whether anything is new.
    bool learn(const FoundWindow& found, const CertifiableWindow& window) {
        bool is_new = contradicted({window}) && !is_wrong(found);
        if (contradicted({window})) wrong_.push_back(found);
        contradicting_ |= estimates_.contradicting(among_, window);
        for (Contradiction& one : estimates_.contradictions_in(among_.profile, found, window)) {
            const bool is_known = std::ranges::any_of(contradictions_, [&](const auto& other) {
                return other.series == one.series && is_same_witness(other, one) &&
                       other.window.first_s == one.window.first_s;
            });
            if (is_known) continue;
            contradictions_.push_back(std::move(one));
            is_new = true;
        }
        return is_new;
    }

    bool is_wrong(const FoundWindow& one) const {
        return std::ranges::any_of(wrong_,
                                   [&](const FoundWindow& other) { return overlap(one, other); });
    }

    /// Certifies the fastest of these windows, and those of lower speeds that may prove more. A
    /// window proves no more than its speed, so that none counts that is not faster than
    /// `proven_m_s`. Begins again where a witness contradicts one.
    void certify(const std::vector<FoundWindow>& all, double proven_m_s) {
        constexpr int most_rounds = 5;
        proven_m_s_ = proven_m_s;
        std::vector<FoundWindow> fastest;
        std::ranges::copy_if(all, std::back_inserter(fastest),
                             [&](const FoundWindow& one) { return one.speed_m_s > proven_m_s; });
        std::ranges::sort(fastest, preferred);
        for (int round = 1; round <= most_rounds; ++round) {
            trials_.clear();
            if (!learns_from(fastest, all, round == most_rounds)) break;
        }
    }

    /// The expanded uncertainty (m/s) of a window as those certified tell it. Infinite where no
    /// speed can be claimed.
    double expanded_m_s(const FoundWindow& one) const {
        constexpr double none = std::numeric_limits<double>::infinity();
        double least_m_s = none, like_m_s = 0.0;
        const bool is_slow = one.speed_m_s <= proven_m_s_;
        const WindowQuality quality = is_slow ? WindowQuality{} : quality_of(one);
        if (!is_slow && is_out(one, quality)) return none;
        for (const Trial& other : trials_) {
            if (other.found.series == one.series && other.found.start == one.start &&
                other.found.end == one.end)
                return other.is_fit ? other.expanded_m_s : none;
            if (!other.is_sound || !other.is_fit) continue;
            least_m_s = std::min(least_m_s, other.expanded_m_s);
            if (!is_slow && is_like(one, quality, other))
                like_m_s = std::max(like_m_s, other.expanded_m_s);
        }
        if (is_suspect(one)) return none;
        return like_m_s > 0.0 ? like_m_s : least_m_s;
    }

  private:
    struct Trial {
        FoundWindow found;
        WindowQuality quality;
        double expanded_m_s = 0.0;
        bool is_fit = true;    ///< to be certified
        bool is_sound = true;  ///< no witness makes its positions suspect
        bool agrees = true;    ///< with all of its witnesses
    };

    /// Goes through windows, fastest first. One is certified where its epochs are measured better
    /// than those of all before it, or where witnesses do not agree with these within a standard
    /// uncertainty. Of suspect ones, which their own witnesses may clear, few are certified that
    /// overlap. Returns at once if that tells anything new, but in the last round.
    bool learns_from(const std::vector<FoundWindow>& fastest, const std::vector<FoundWindow>& all,
                     bool is_last) {
        constexpr int most = 60;
        for (const FoundWindow& one : fastest) {
            const WindowQuality quality = quality_of(one);
            if (is_out(one, quality) || std::ranges::any_of(trials_, [&](const Trial& other) {
                    return is_like(one, quality, other) || begins_near(one, other);
                }))
                continue;
            if (std::ssize(trials_) == most) break;
            const CertifiableWindow window = estimates_.certify(among_, one, all, contradictions_,
                                                                CertificateExtent::to_compare);
            if (learn(one, window) && !is_last) return true;
            trials_.push_back(
                {.found = one,
                 .quality = quality,
                 .expanded_m_s = among_.profile.coverage_factor * window.standard_uncertainty_m_s,
                 .is_fit = are_fit({window}, among_.profile),
                 .is_sound =
                     !window.evidence || window.evidence->fault_probability < as_likely_as_not,
                 .agrees = std::ranges::all_of(
                     window.witnesses,
                     [](const WitnessedSpeed& each) {
                         return std::abs(each.difference_m_s) <= sigma_of_difference(each);
                     })});
        }
        return false;
    }

    WindowQuality quality_of(const FoundWindow& one) const {
        WindowQuality quality = qualities_(one);
        quality.witnesses = estimates_.covering(among_, one, contradicting_);
        return quality;
    }

    /// Whether no speed can be claimed for a window. One that a contradicting witness does not
    /// cover must not avoid the contradiction.
    bool is_out(const FoundWindow& one, const WindowQuality& quality) const {
        return quality.silent || (contradicting_ & ~quality.witnesses) != 0 || is_wrong(one);
    }

    bool is_suspect(const FoundWindow& one) const {
        return suspected_by(contradictions_, one, {}) != nullptr;
    }

    /// Whether the certified window tells what this one would be certified with, or with less.
    bool is_like(const FoundWindow& one, const WindowQuality& quality, const Trial& other) const {
        return other.is_sound && other.is_fit && quality.no_better_than(other.quality) &&
               (other.agrees || overlap(one, other.found));
    }

    /// Whether both are suspect, and begin within a tenth of a window of one another.
    bool begins_near(const FoundWindow& one, const Trial& other) const {
        constexpr double near = 0.1;
        return is_suspect(one) && is_suspect(other.found) && one.series == other.found.series &&
               std::abs(one.start.seconds() - other.found.start.seconds()) <
                   near * one.duration_s();
    }

    const ReceiverEstimates& estimates_;
    const Candidates& among_;
    WindowQualities qualities_;
    double proven_m_s_ = 0.0;
    std::uint64_t contradicting_ = 0;
    std::vector<FoundWindow> wrong_;
    std::vector<Contradiction> contradictions_;
    std::vector<Trial> trials_;
};

/// The fastest windows are not always the best proof. This also certifies those that may prove
/// more, and takes them if they do by over a tenth of the fastest's uncertainty, or if the fastest
/// cannot be certified as they are. The fastest is then given beside it.
void certify_best(const ReceiverEstimates& estimates, const Candidates& among,
                  const Choice& fastest, ProfileWindows& entry) {
    constexpr double worth_it = 0.1;
    constexpr int most_searches = 5;
    if (fastest.chosen.empty()) return;
    const Profile& profile = among.profile;
    ProofSearch proofs(estimates, among);
    std::vector<CertifiableWindow> windows;
    const auto learn = [&](const Choice& choice, const std::vector<CertifiableWindow>& from) {
        for (std::size_t i = 0; i < from.size(); ++i)
            proofs.learn(choice.chosen[i], from[i]);
    };
    const auto certify_fastest = [&] {
        windows = certified_windows(estimates, among, fastest, proofs.contradictions());
        learn(fastest, windows);
    };
    certify_fastest();
    const auto least_proven_m_s = [&] {
        double least_m_s = std::numeric_limits<double>::infinity();
        // A pair may gain by a slower run that has a faster one in the opposite direction.
        if (profile.opposite_runs_within_s) return 0.0;
        if (are_fit(windows, profile)) {
            for (const CertifiableWindow& window : windows)
                least_m_s = std::min(least_m_s, proven_m_s({window}, profile));
            return least_m_s;
        }
        // What the craft did at half the speed says nothing of how fast it was.
        constexpr double slow = 0.5;
        for (const CertifiableWindow& window : windows) {
            least_m_s = std::min(least_m_s, slow * window.speed_m_s);
            for (const WitnessedSpeed& one : window.witnesses)
                least_m_s = std::min(least_m_s, slow * one.speed_m_s);
        }
        return least_m_s;
    };
    for (int search = 0; search < most_searches; ++search) {
        const std::size_t known = proofs.contradictions().size();
        proofs.certify(fastest.all, least_proven_m_s());
        if (proofs.contradictions().size() > known && !contradicted(windows)) certify_fastest();
        const Choice proof =
            choose(among, [&](const FoundWindow& one) { return proofs.expanded_m_s(one); });
        if (proof.chosen.size() < fastest.chosen.size() ||
            std::ranges::any_of(proof.chosen,
                                [&](const FoundWindow& one) { return proofs.is_wrong(one); }))
            break;
        const auto gains = [&](double proof_m_s, double fastest_m_s) {
            return !are_fit(windows, profile) ||
                   proof_m_s - fastest_m_s > worth_it * (windows.front().speed_m_s - fastest_m_s);
        };
        std::vector<FoundWindow> compared = fastest.chosen;
        for (std::size_t i = 0; i < compared.size(); ++i)
            compared[i].allowance_m_s =
                profile.coverage_factor * windows[i].standard_uncertainty_m_s;
        if (!gains(assured_m_s(proof.chosen), assured_m_s(compared))) break;
        std::vector<CertifiableWindow> proving =
            certified_windows(estimates, among, proof, proofs.contradictions());
        if (contradicted(proving)) {
            // What was found there holds for the fastest, too.
            learn(proof, proving);
            if (!contradicted(windows)) certify_fastest();
            continue;
        }
        if (cover_what_contradicts(proving, windows) && are_fit(proving, profile) &&
            gains(proven_m_s(proving, profile), proven_m_s(windows, profile))) {
            entry.fastest = further_window(windows.front());
            windows = std::move(proving);
        }
        break;
    }
    entry.best = std::move(windows.front());
    for (std::size_t i = 1; i < windows.size(); ++i)
        entry.further.push_back(further_window(windows[i]));
}

/// The mean speed of windows, and the span of the first. Empty if there are too proofs.
std::optional<RuleScore> score_over(const ScreenedTable& screened,
                                    const std::vector<FoundWindow>& chosen,
                                    const std::vector<std::size_t>& rows, std::int64_t count) {
    if (chosen.empty() || std::ssize(chosen) < count) return std::nullopt;
    double sum = 0.0;
    for (const FoundWindow& window : chosen)
        sum += window.speed_m_s;
    const FoundWindow& first = chosen.front();
    return RuleScore{
        .span = window_span(screened.facts, screened.rows[rows[first.first]].epoch,
                            screened.rows[rows[first.last]].epoch, first.start, first.end),
        .speed_m_s = sum / static_cast<double>(chosen.size())};
}

/// The speed by the body's own arithmetic: the fastest window of the usable epochs as recorded; if
/// there is none, of all that show a speed.
std::optional<RuleScore> score_of(const Candidates& certifiable, const WindowConfig& config,
                                  const std::optional<WindowPart>& part) {
    const std::optional<RuleArithmetic>& arithmetic = certifiable.profile.arithmetic;
    if (!arithmetic) return std::nullopt;
    const ScreenedTable& screened = certifiable.screened;
    Profile by_body = certifiable.profile;
    by_body.speed_source = arithmetic->source;
    by_body.definition = arithmetic->definition;
    const Candidates among =
        candidates_of(screened, certifiable.trajectory, certifiable.rows, by_body, config,
                      certifiable.gates, part, SeriesPositions::recorded);
    if (const std::vector<FoundWindow> chosen = choose(among).chosen; !chosen.empty())
        return score_over(screened, chosen, among.rows[chosen.front().series].rows,
                          by_body.windows);
    if (among.rule.kind == WindowKind::course) return std::nullopt;
    IndicatedSeries recorded = indicated_series(screened, by_body, config.gap_factor);
    restrict_to(part, screened, recorded);
    const std::vector<FoundWindow> chosen =
        best_windows(recorded.series, among.rule, static_cast<std::size_t>(by_body.windows));
    if (chosen.empty()) return std::nullopt;
    auto score =
        score_over(screened, chosen, recorded.rows[chosen.front().series], by_body.windows);
    if (score) score->screened = false;
    return score;
}

/// The windows of a rule before officials have answered for second files, and after.
using BothWindows = std::array<ProfileWindows, 2>;

/// These windows, in which no second file confirms anything.
ProfileWindows without_second_files(ProfileWindows windows, const WitnessRecords& records) {
    const auto mark = [&](auto& window) {
        for (WitnessedSpeed& one : window.witnesses)
            if ((one.unanswered = is_second_file(one.kind, records))) one.confirms = false;
    };
    if (windows.best) mark(*windows.best);
    std::ranges::for_each(windows.further, mark);
    return windows;
}

/// Certifies twice only where second files have a share in the result, or an IMU carries it. Of the
/// two results the one that proves less stands before officials have answered.
BothWindows certify_both(const ReceiverEstimates& estimates, Candidates among,
                         const Choice& fastest, const ProfileWindows& entry,
                         const WitnessRecords& records) {
    BothWindows both{entry, entry};
    auto& [before, after] = both;
    certify_best(estimates, among, fastest, after);
    if (!estimates.depends_on_files(among.profile)) return {after, after};
    if (estimates.counts_craft(among.profile)) {
        before.missing =
            "the rule counts the speed of the craft's reference point, which the IMU alone gives: "
            "an official must first answer for it (imu-as-measured)";
        return both;
    }
    among.files_attested = false;
    certify_best(estimates, among, fastest, before);
    const auto proven_m_s = [&](const ProfileWindows& one) {
        const auto figure = figure_of(one);
        return figure ? figure->speed_m_s -
                            expanded_uncertainty_by_rule_m_s(*figure, among.profile.coverage_factor)
                      : 0.0;
    };
    if (proven_m_s(after) < proven_m_s(before)) before = without_second_files(after, records);
    return both;
}

BothWindows windows_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                       const ReceiverEstimates& estimates, const Profile& profile,
                       const WindowConfig& config, const std::optional<SurveyedCourse>& gates,
                       const WitnessRecords& records) {
    ProfileWindows entry;
    entry.profile = profile.id;
    entry.rule = rule_of(profile);
    entry.part = counted_part(screened, trajectory, profile, config.part, gates);
    entry.indicated = fastest_indicated(screened, profile, config, gates, entry.part);
    if (entry.part && !entry.part->from) {
        entry.missing = fmt::format("{}", fmt::join(entry.part->missing, "; "));
        return {entry, entry};
    }
    entry.missing = profile.dimension != Dimension::horizontal && !estimates.has_heights()
                        ? "the recording has no heights that could be estimated"
                        : estimates.craft_is_unknown(profile, config);
    if (entry.missing.empty()) entry.missing = constant_speed_text(screened, trajectory, profile);
    if (!entry.missing.empty()) return {entry, entry};
    const Candidates among = candidates_of(screened, estimates.trajectory_for(profile),
                                           estimates.rows(), profile, config, gates, entry.part);
    entry.score = score_of(among, config, entry.part);
    const Choice choice = choose(among);
    entry.candidates = std::ssize(choice.all);
    entry.missing = choice.missing;
    if (choice.chosen.empty())
        if (std::string unfit = unfit_for(screened, profile); !unfit.empty())
            entry.missing = std::move(unfit);
    if (profile.window_kind == WindowKind::course && choice.chosen.empty() && !choice.refused &&
        entry.indicated)
        entry.missing =
            "as recorded the track passes over the course, but not within one stretch of usable "
            "epochs";
    return certify_both(estimates, among, choice, entry, records);
}

}  // namespace

WindowConfig window_config(const Attempt& attempt, const Receiver& receiver) {
    WindowConfig config{attempt.parameters.window};
    config.fault_probability_given =
        std::ranges::count(attempt.overrides, "window.fault_probability") > 0;
    config.gap_max_s = attempt.parameters.screen.gap_max_s;
    config.gap_factor = attempt.parameters.screen.gap_factor;
    if (receiver.lever_arm) config.lever_arm = vector_of(*receiver.lever_arm);
    config.rotation_bound_deg = receiver.rotation_bound_deg;
    config.antenna_motion = receiver.antenna_motion;
    config.part = {.ground_height_m = attempt.ground_height_m, .part = attempt.part};
    if (const auto& calibration = receiver.calibration;
        calibration && calibration->quantity == "speed")
        config.calibration_standard_uncertainty_m_s =
            *calibration->expanded_uncertainty / 2.0 * metres_per_second(calibration->unit);
    config.velocity_accuracy_claimed =
        receiver.accuracy && receiver.accuracy->velocity_m_s.has_value();
    return config;
}

Windows find_windows(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                     const std::vector<Profile>& profiles, const WindowConfig& config,
                     const std::optional<Course>& course, const WitnessRecords& records) {
    Windows windows;
    windows.receiver = trajectory.facts.receiver;
    windows.first_epoch = trajectory.facts.first_epoch;
    windows.georeferenced = trajectory.facts.georeferenced;
    const ReceiverEstimates estimates(screened, trajectory, profiles, config, records);
    std::optional<SurveyedCourse> gates;
    if (course) gates = surveyed_course(*course, trajectory.origin);
    const auto one = [&](std::int64_t i) {
        const Profile& profile = profiles[static_cast<std::size_t>(i)];
        if (profile.window_kind == WindowKind::course && !gates)
            throw Failure("attempt", "the profile " + profile.id + " needs a course",
                          "Run runcert-import again, with the same attempt");
        return windows_of(screened, trajectory, estimates, profile, config, gates, records);
    };
    for (auto& [before, after] : results_of(std::ssize(profiles), threads_allowed(), one)) {
        windows.profiles.push_back(std::move(before));
        windows.with_files.push_back(std::move(after));
    }
    const auto depends = [&](const Profile& profile) {
        return estimates.depends_on_files(profile);
    };
    if (std::ranges::none_of(profiles, depends)) windows.with_files.clear();
    set_courses(trajectory, windows);
    windows.stands = estimates.stands();
    windows.witness_notes = estimates.witness_notes(profiles, windows.profiles, records);
    return windows;
}

}  // namespace runcert
