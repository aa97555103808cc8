#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/enu/enu.h"

namespace runcert {

/// Why an epoch is not usable.
enum class Reason {
    none,  ///< usable
    no_position,
    no_fix,
    float_ambiguities,
    other_fix,  ///< a kind of solution the attempt does not allow
    duplicate_time,
    backward_time,
    accuracy_missing,
    accuracy_absurd,
    innovation,  ///< written by revision 1.1 and before
    short_arc,
    outlier,         ///< alone, among good epochs
    burst,           ///< one of several wrong epochs in a row
    model,           ///< in a stretch that no hypothesis explains
    velocity,        ///< contradicted by the recorded velocity
    physical_limit,  ///< motion that the craft cannot make
    baseline,        ///< contradicted by the other receiver
    few_satellites,  ///< so few that nothing checks the position
    low_ratio,       ///< the runner-up set of ambiguities fits almost as well
    old_corrections
};
std::string_view to_text(Reason reason);
bool from_text(std::string_view text, Reason& reason);
/// For people: "ambiguities not fixed".
std::string_view words_of(Reason reason);

/// Why a new arc begins at an epoch.
enum class ArcBreak {
    start,
    gap,
    innovation,  ///< written by revision 1.1 and before
    step,
    ramp,
    time_shift,
    bridged  ///< a step inside an arc, whose offset is an unknown of the estimate
};
std::string_view to_text(ArcBreak arc_break);
bool from_text(std::string_view text, ArcBreak& arc_break);

/// What a test of screening supposed.
enum class Hypothesis {
    outlier,
    burst,
    step,
    ramp,
    time_shift,
    model,  ///< only that the model is wrong: the overall test
    velocity,
    acceleration,
    jerk,
    vertical_rate,
    baseline
};
std::string_view to_text(Hypothesis hypothesis);
bool from_text(std::string_view text, Hypothesis& hypothesis);

/// Which axes a test was about.
enum class TestedAxes { horizontal, vertical };
std::string_view to_text(TestedAxes axes);
bool from_text(std::string_view text, TestedAxes& axes);

/// The error that a test supposed, as estimated; what does not belong to the hypothesis is empty.
struct EstimatedError {
    std::optional<double> east_m;
    std::optional<double> north_m;
    std::optional<double> up_m;
    std::optional<double> sigma_east_m;
    std::optional<double> sigma_north_m;
    std::optional<double> sigma_up_m;
    std::optional<double> correlation_east_north;
    std::optional<double> rate_east_mps;  ///< of a ramp
    std::optional<double> rate_north_mps;
    std::optional<double> rate_up_mps;
    std::optional<double> time_s;  ///< by how much the stamps are late
};

/// The smallest error that the tests of an epoch find with the stated power, in the direction in
/// which it is hardest to find; empty where none could be found.
struct DetectableError {
    std::optional<double> outlier_m;
    std::optional<double> step_m;
    std::optional<double> ramp_mps;
    std::optional<double> time_s;
    std::optional<double> outlier_up_m;
    std::optional<double> step_up_m;
};

struct ScreenedEpoch : EnuEpoch {
    bool usable = false;
    Reason reason = Reason::none;
    std::optional<double> statistic;
    std::optional<double> threshold;
    std::optional<std::int64_t> arc;  ///< counted from 1
    std::optional<ArcBreak> break_before;
    std::optional<Hypothesis> hypothesis;  ///< of the statistic
    std::optional<TestedAxes> tested_axes;
    EstimatedError estimated;  ///< filled where the hypothesis was decided for
    DetectableError detectable;
    /// By how much the innovations around the epoch exceed the noise learnt; the tests allow for
    /// it.
    std::optional<double> local_variance_factor;
    /// By how much (m/s^2) the craft's acceleration was found to change before the epoch, beyond
    /// the motion that the tests take for granted; they allow for it. Since revision 1.4.
    std::optional<double> manoeuvre_mps2 = std::nullopt;
    std::optional<double> manoeuvre_up_mps2 = std::nullopt;
};

/// The noise that the tests rested on.
struct ScreeningModel {
    TestedAxes axes = TestedAxes::horizontal;
    std::string noise;  ///< fitted, or why not
    double jerk_density = 0.0;
    double measurement_scale = 1.0;
    double white_scale = 1.0;  ///< were white noise alone the model
    double error_sigma_m = 0.0;
    double error_tau_s = 1.0;
};

/// How large the errors of one kind of solution are against what it states.
struct FixKindEvidence {
    FixKind fix = FixKind::unknown;
    TestedAxes axes = TestedAxes::horizontal;
    std::int64_t epochs = 0;
    double variance_factor = 1.0;  ///< robust
    std::string judgement;         ///< as_stated, too_good, too_bad, too_few_epochs
};

/// The recorded velocities against the smoothed ones.
struct VelocityEvidence {
    std::int64_t compared = 0;
    std::optional<double> delay_s;  ///< of the velocity behind the position; empty if not told
    std::optional<double> sigma_delay_s;
    double scale_mps = 0.0;  ///< robust standard deviation of the differences, per axis
    std::int64_t rejected = 0;
};

/// A fault of the time stamps.
struct TimeFault {
    std::int64_t epoch = 0;
    std::string kind;  ///< gap, backward, duplicate, whole_second_shift, session
    double size_s = 0.0;
};

struct TimeEvidence {
    std::int64_t sessions = 1;
    std::int64_t gaps = 0;
    double longest_gap_s = 0.0;
    std::int64_t duplicates = 0;
    std::int64_t backward = 0;
    double rate_deviation = 0.0;  ///< of the mean interval from the nominal, relative
    double jitter_s = 0.0;        ///< standard deviation of the intervals
    std::vector<TimeFault> faults;
};

/// The motion against the limits of the craft's class.
struct LimitEvidence {
    double acceleration_max_mps2 = 0.0;
    double jerk_max_mps3 = 0.0;
    double vertical_rate_max_mps = 0.0;
    double acceleration_mps2 = 0.0;  ///< the largest of the epochs kept
    double jerk_mps3 = 0.0;
    double vertical_rate_mps = 0.0;
    std::int64_t rejected = 0;
};

/// The other receiver's positions against this one's.
struct BaselineEvidence {
    std::string receiver;
    std::int64_t compared = 0;
    double length_m = 0.0;
    double sd_m = 0.0;  ///< of the length
    std::int64_t rejected = 0;
};

/// Signs that the device wrote positions that it did not measure; of all rows while the craft
/// moved.
struct DeviceEvidence {
    std::int64_t moving = 0;        ///< rows looked at
    std::int64_t held = 0;          ///< that repeat the position before
    std::int64_t interpolated = 0;  ///< in line with their neighbours to the last digit
    double by_chance = 0.0;         ///< how many of these chance may make
};

/// What the tests rested on and decided over the whole table.
struct ScreeningEvidence {
    double family_false_alarm_rate = 0.0;  ///< of all tests of the recording together
    std::int64_t tests = 0;
    double test_size = 0.0;             ///< of one
    double power = 0.0;                 ///< at the detectable sizes
    std::int64_t burst_epochs_max = 0;  ///< longest run of wrong epochs tested as one error
    std::int64_t passes = 0;
    std::vector<ScreeningModel> models;
    std::vector<FixKindEvidence> fix_kinds;
    std::optional<VelocityEvidence> velocity;
    std::optional<DeviceEvidence> device = std::nullopt;  ///< since revision 1.4
    TimeEvidence time;
    LimitEvidence limits;
    std::optional<BaselineEvidence> baseline;
};

/// 3-screened.ecsv, `schemas/screened/v1.yaml`.
struct ScreenedTable {
    Header header;
    RecordingFacts facts;
    std::optional<FrameOrigin> origin;
    double variance_factor = 1.0;
    std::optional<ScreeningEvidence> evidence;  ///< absent in files of revision 1.1 and before
    std::vector<ScreenedEpoch> rows;
};

/// Rows by reason, arcs and usable rows, counted from the rows; and how often each hypothesis was
/// decided for: by the hypothesis of a row that a test rejected, by the break before a row (bridged
/// is a step).
struct ScreeningSummary {
    std::int64_t usable = 0;
    std::int64_t arcs = 0;
    std::map<Reason, std::int64_t> reasons;
    std::map<Hypothesis, std::int64_t> decisions;

    void add(const ScreenedEpoch& row);
};
ScreeningSummary summarise(const std::vector<ScreenedEpoch>& rows);

std::string write_screened(const ScreenedTable& table);
ScreenedTable read_screened(std::string_view text, const std::string& where);
/// The same row by row. `text` must outlive what is returned.
OpenTable<ScreenedTable> open_screened(std::string_view text, const std::string& where);

}  // namespace runcert
