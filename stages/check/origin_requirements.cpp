#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/figures.h"
#include "core/gps_time.h"
#include "core/speed_unit.h"
#include "stages/check/course.h"
#include "stages/check/requirements.h"
#include "witness/continuity.h"

namespace runcert {
namespace {

/// By how much scatter of the steps may put the mean interval of the stamps off the receiver's.
double rate_by_chance(const ReceiverFindings& judged) {
    const auto& rows = judged.trajectory;
    if (rows.size() < 2) return 1.0;
    constexpr double coverage = 5.0;
    const double length_s = rows.back().time.seconds() - rows.front().time.seconds();
    // For independent steps. Rounded stamps vary less, because errors of neighbours cancel.
    return length_s > 0.0 ? coverage * judged.tests.time.jitter_s *
                                std::sqrt(static_cast<double>(rows.size())) / length_s
                          : 1.0;
}

/// Signs in the recording that the device modified its positions, in words.
std::vector<std::string> signs_of_filter(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    std::vector<std::string> signs;
    constexpr double too_smooth = 0.3;
    constexpr double as_stated = 0.1;
    for (const ScreeningModel& model : judged.tests.models)
        if (model.axes == TestedAxes::horizontal && model.noise == NoiseBasis::fitted &&
            model.white_scale < too_smooth)
            signs.push_back(fmt::format(
                "from epoch to epoch the positions scatter by {:.2f} times what is stated",
                model.white_scale));
    if (const double lag_1 = judged.estimation.horizontal.health.autocorrelation; lag_1 > as_stated)
        signs.push_back(fmt::format("innovations follow one another (lag 1: {:+.2f})", lag_1));
    if (const Overshoot overshoot = find_overshoot(judged.trajectory); overshoot.found())
        signs.push_back(fmt::format(
            "after {} of {} changes of acceleration the motion overshoots and oscillates with a "
            "period of {:.1f} s, at first by {:.0f} %",
            overshoot.swings, overshoot.changes, overshoot.period_s, overshoot.part * 100.0));
    return signs;
}

/// Evidence for and against positions as the receiver measured them. Only people can confirm that
/// the files are as the receiver wrote them.
std::string evidence_of_measuring(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    std::vector<std::string> evidence;
    if (judged.simulated) evidence.emplace_back("the recording says that it was simulated");
    if (judged.format == "rinex")
        evidence.emplace_back("positions were solved here, from raw observations that are kept");
    else if (judged.processing && !judged.simulated)
        evidence.push_back("positions were " + processing_text(*judged.processing));
    if (context.witnesses.empty())
        evidence.emplace_back("only the positions themselves could show it");
    evidence.insert(evidence.end(), context.witnesses.begin(), context.witnesses.end());
    std::string text = fmt::format("{}", fmt::join(evidence, "; "));
    if (const std::vector<std::string> signs = signs_of_filter(context); !signs.empty())
        text += fmt::format("; {} {}", context.witnesses.empty() ? "signs found in them:" : "but",
                            fmt::join(signs, "; "));
    return text;
}

/// How the steps of the time stamps differ from a receiver's. Empty if they do not.
std::string unusual_steps(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    const TimeStampSummary& time = judged.tests.time;
    if (!time.departure_s) return {};
    const double allowed_s = 2e-3 + judged.facts.time_resolution_s.value_or(0.0);
    if (*time.departure_s <= allowed_s) {
        double in_sum_s = 0.0;
        for (const std::vector<ScreenedEpoch>& window : samples_of(context))
            in_sum_s = std::max(in_sum_s, beyond_whole_intervals_s(window, *time.usual_interval_s));
        if (in_sum_s <= allowed_s) return {};
        return fmt::format(
            "over the window the steps lead, in sum, {:.4f} s away from {:.6g} s, the nearest "
            "interval that receivers are set to",
            in_sum_s, *time.usual_interval_s);
    }
    return fmt::format(
        "steps in a row lead {:.3f} s away from {:.6g} s, the nearest interval that receivers are "
        "set to (mean step {:.6g} s): somebody must show by the receiver's settings that it "
        "recorded at such steps",
        *time.departure_s, *time.usual_interval_s, *time.interval_s);
}

/// Whether a wrong rate of the stamps would have shown: positions solved here from raw measurements
/// hold at the true times alone, and what a receiver records beside them has another speed.
bool could_show_rate(const Clause& clause, const ClauseContext& context) {
    if (context.profile.speed_source == SpeedSource::velocity)
        return computation::recorded_speeds(clause, context).status == RequirementStatus::met;
    return context.observed || context.input.judged.format == "rinex";
}

/// The receiver whose positions are judged, as the attempt has it. Null if it has none of that id.
const Receiver* judged_receiver(const ClauseContext& context) {
    const auto& receivers = context.input.attempt.receivers;
    const auto one = std::ranges::find(receivers, context.input.judged.receiver, &Receiver::id);
    return one == receivers.end() ? nullptr : &*one;
}

double days_of(double seconds) {
    return std::floor(seconds / 86'400.0);
}

/// Days from the GPS epoch to the local date at a longitude, by mean solar time.
double days_there(const GpsTime& time, double longitude_deg) {
    const double utc_s = GpsTime::from_calendar(utc_from_gps(time).time).seconds_since(GpsTime());
    return days_of(utc_s + longitude_deg / 360.0 * 86'400.0);
}

/// The local day of the recording's middle, in days from the GPS epoch.
double day_of_recording(const ReceiverFindings& judged) {
    const TrajectoryEpoch& middle = judged.trajectory[judged.trajectory.size() / 2];
    const double longitude_deg =
        judged.facts.georeferenced && judged.origin
            ? judged.origin->place_at(middle.time).position.longitude.degrees()
            : 0.0;
    return days_there(judged.facts.first_epoch->plus_nanoseconds(middle.time.nanoseconds),
                      longitude_deg);
}

/// Whether days that lie so far apart are one but for a rollover of the GPS week.
bool is_rolled_over(double days) {
    constexpr double rollover_days = 1024.0 * 7.0;
    const double rollovers = std::round(days / rollover_days);
    return rollovers != 0.0 && std::abs(days - rollovers * rollover_days) <= 1.0;
}

}  // namespace

Finding computation::recording_date(const Clause&, const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    const std::string& named = context.input.attempt.date;
    if (!judged.facts.first_epoch || judged.trajectory.empty())
        return to_attest("the recording has no date; the attempt names {}",
                         named.empty() ? "none" : named);
    const double there = day_of_recording(judged);
    const CalendarTime day =
        GpsTime().plus_nanoseconds(std::llround(there) * GpsTime::nanoseconds_per_day).calendar();
    const std::string date = fmt::format("{:04}-{:02}-{:02}", day.year, day.month, day.day);
    const std::string what = fmt::format("the recording is of {}, the attempt {}", date,
                                         named.empty() ? "names no date" : "of " + named);
    const double days =
        named.empty()
            ? 0.0
            : there - days_of(parse_gps_iso(named + "T00:00:00").seconds_since(GpsTime()));
    if (std::abs(days) > 1.0)
        return not_met("{}: {:.0f} days apart{}", what, std::abs(days),
                       is_rolled_over(days)
                           ? ", which is the rollover of the GPS week after 1024 weeks: the "
                             "receiver's firmware, or what converted its file, is older than the "
                             "day; hand in what a current version writes"
                           : "; hand in the recording of that day, or name its day");
    const Profile& rule = context.profile;
    const auto in_force = [&](const std::string& on) {
        return on >= rule.valid_from && (rule.superseded_by.empty() || on < rule.superseded_from);
    };
    if (!named.empty() && in_force(named) != in_force(date))
        return to_attest("{}: on one of them the rule was not in force", what);
    if (date < rule.valid_from)
        return to_attest("{}; the rule holds from {} on", what, rule.valid_from);
    if (!in_force(date))
        return not_met("{}; by then {} had replaced the rule", what, rule.superseded_by);
    return named.empty() ? to_attest("{}", what) : met("{}", what);
}

Finding computation::calibration(const Clause&, const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    const Receiver* const receiver = judged_receiver(context);
    if (!receiver || !receiver->calibration)
        return to_attest("the attempt states no calibration of receiver \"{}\"", judged.receiver);
    const std::string& day = receiver->calibration->date;
    const auto& recorded = judged.facts.first_epoch;
    if (!recorded)
        return to_attest("calibrated on {}; the recording has no date to compare it with", day);
    const std::string recorded_on = to_utc_iso(*recorded, 0).substr(0, day.size());
    if (begins_after(day, *recorded))
        return not_met(
            "calibrated on {}, after the recording of {}: state the calibration that held on that "
            "day",
            day, recorded_on);
    return met("calibrated on {}; the recording is of {}", day, recorded_on);
}

Finding computation::device_deduction(const Clause&, const ClauseContext& context) {
    const Receiver* const receiver = judged_receiver(context);
    if (!receiver || !receiver->device_deduction)
        return to_attest(
            "the attempt states no deduction for the device (receivers[].device_deduction)");
    const DeviceDeduction& taken = *receiver->device_deduction;
    Finding finding = to_attest("the attempt states a deduction of {} {} for the device",
                                number_text(taken.speed), taken.unit);
    finding.figures = {plain("deduction for the device", taken.speed, taken.unit)};
    if (!context.speed) return finding;
    const double left_m_s = context.speed->speed_m_s - taken.speed * metres_per_second(taken.unit);
    const std::string left = speed_of_rule(context, left_m_s);
    finding.evidence += fmt::format("; it leaves {} of the measured speed", left);
    if (context.required_speed)
        finding.evidence += fmt::format(
            ", which {} the required {} {}",
            left_m_s >= context.required_speed->speed_m_s ? "reaches" : "does not reach",
            context.shown->required_speed, context.shown->unit);
    finding.figures.push_back(
        speed_figure("measured speed less the deduction", left_m_s, context.shown->unit, left));
    return finding;
}

Finding computation::sail_area(const Clause&, const ClauseContext& context) {
    const auto& area_m2 = context.input.attempt.craft.sail_area_m2;
    if (!area_m2)
        return to_attest("the attempt states no sail area (craft: {{sail_area_m2: ...}})");
    return to_attest("the attempt states a sail area of {}", number_text(*area_m2, "m²"))
        .by({plain("sail area", *area_m2, "m²")});
}

Finding computation::claims(const Clause& clause, const ClauseContext& context) {
    return to_attest("{}", stated_text(inputs_answered_in(clause, context)));
}

Finding computation::time_scale(const Clause& clause, const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    const std::string& source = judged.facts.time_source;
    const std::string what = judged.time_origin.empty() ? "the time stamps" : judged.time_origin;
    const double rate = judged.tests.time.rate_deviation;
    const std::vector<Figure> figures{{.name = "rate of the time stamps less the nominal one",
                                       .value = rate * 1e6,
                                       .note = "in millionths"}};
    const std::string steps = unusual_steps(context);
    // Even steps prove no rate: whoever writes stamps anew writes even ones.
    const std::string doubt =
        !steps.empty() ? "but " + steps
        : could_show_rate(clause, context)
            ? ""
            : "no witness shares the stamps, so nothing shows their rate (recorded velocities, "
              "phases, a second receiver or the receiver's raw measurements would)";
    if (source == "satellites" && doubt.empty())
        return met("{}; at another rate the witnesses would contradict the speed", what)
            .by(figures);
    if (source == "satellites") return to_attest("{}, by the format; {}", what, doubt).by(figures);
    constexpr double allowed = 1e-4;
    if (source == "unknown" && std::abs(rate) > std::max(allowed, rate_by_chance(judged)))
        return not_met(
                   "{}; their steps are on average {:.3f} % {} than those of a usual rate; either "
                   "the clock or the rate is not what it seems: write time_source: satellites in "
                   "the attempt if they are the satellites' time",
                   what, std::abs(rate) * 100.0, rate < 0.0 ? "shorter" : "longer")
            .by(figures);
    if (source == "attempt")
        return to_attest("{}; the attempt states that they are the satellites' time{}{}", what,
                         steps.empty() ? "" : "; but ", steps)
            .by(figures);
    return to_attest("{}; the recording cannot show whether its rate is true", what).by(figures);
}

Finding computation::measured_positions(const Clause&, const ClauseContext& context) {
    const DeviceSigns device = context.input.judged.tests.device.value_or(DeviceSigns{});
    constexpr double share = 0.01;
    const auto moving = static_cast<double>(device.moving);
    if (static_cast<double>(device.held) > std::max(3.0, share * moving))
        return not_met(
            "{} of {} positions recorded in motion repeat the one before: they are held, not "
            "measured; record at the rate at which the receiver measures",
            device.held, device.moving);
    if (static_cast<double>(device.interpolated) >
        std::max({10.0, 0.2 * moving, 3.0 * device.by_chance}))
        return not_met(
            "{} of {} positions recorded in motion lie on a line or curve through others to the "
            "last digit, where chance makes {:.0f}: they are interpolated, not measured; hand in "
            "the "
            "recording before it was resampled",
            device.interpolated, device.moving, device.by_chance);
    return to_attest("{}", evidence_of_measuring(context));
}

Finding computation::stated_solution(const Clause&, const ClauseContext& context) {
    const auto& best = context.windows.best;
    const std::string taken = best && best->bound && best->bound->floor_fix
                                  ? fmt::format(
                                        " (in the window: {}, whose time-correlated errors are "
                                        "taken to be at least {:g} m)",
                                        to_text(*best->bound->floor_fix), best->bound->floor_m)
                                  : "";
    const auto& rows = context.epochs();
    const SolutionSource source = context.input.judged.solution_source;
    if (source == SolutionSource::attempt)
        return to_attest("the recording does not state it; the attempt states {}{}",
                         rows.empty() ? "the fix type" : to_text(rows[0].fix), taken);
    return met("{}{}",
               source == SolutionSource::recording ? "the recording states it"
               : source == SolutionSource::partly
                   ? "the recording states it for some positions; the others count as those of one "
                     "receiver alone"
                   : "the recording does not state it, so the positions count as those of one "
                     "receiver alone",
               taken);
}

}  // namespace runcert
