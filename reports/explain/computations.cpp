#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "reports/explain/parts.h"
#include "reports/explain/words.h"

namespace runcert {
namespace {

/// How a figure is compared with the limit of its clause.
enum class Bound { none, at_most, at_least };

struct Computation {
    std::string_view name;
    std::string_view how;
    Bound bound = Bound::none;
    std::string_view to_attest;  ///< what to do where the data did not decide
};

constexpr std::string_view by_survey =
    "Have it surveyed, or measured in another way, and keep the record of that; whoever signs for "
    "this clause answers for it.";

constexpr std::array<Computation, 18> computations{{
    {"georeferenced",
     "The recording itself says what its coordinates are: positions on the Earth, whose metre is "
     "the true one, or coordinates in a local plane, whose scale on the ground nobody states. Met "
     "where they are on the Earth. No uncertainty enters.",
     Bound::none,
     "Find out how the local plane was made and what its scale on the ground is. Whoever signs for "
     "this clause answers for that scale: the speed is wrong by as much as it is."},
    {"secondary_method",
     "The speed by a second receiver, or by the second method that the attempt states, over the "
     "same time is compared with the certified one: their difference is divided by the root of the "
     "sum of the squares of both expanded uncertainties (k = 2), which gives the normalised error. "
     "Of a second receiver only what the two do not share enters: noise, motion, each one's own "
     "slow error, time stamps, antenna; base station, satellites, atmosphere and frame err alike "
     "in both, and this cannot find it. Met where it is at most 1; with a receiver and a stated "
     "method, where both are.",
     Bound::none,
     "Record with a second receiver (receivers:) or state what a second method measured "
     "(secondary:) and run the attempt again; or compare by hand, and sign for it."},
    {"flatness",
     "The lowest smoothed height of the run that holds the window is taken from the highest one, "
     "heights being corrected for the Earth's curve. The expanded uncertainty (k = 2) holds that "
     "of both heights and of errors that change slowly. Noise makes the figure too large rather "
     "than too small.",
     Bound::at_most, by_survey},
    {"slope",
     "The height gained or lost between the ends of the window is divided by the distance between "
     "them: in per cent, without its sign. The expanded uncertainty (k = 2) holds that of both "
     "positions and of errors that change slowly.",
     Bound::at_most, by_survey},
    {"straightness",
     "The largest distance of the smoothed track in the window from the straight line through its "
     "ends. The expanded uncertainty (k = 2) holds that of the three positions. Noise makes the "
     "figure too large rather than too small.",
     Bound::at_most, by_survey},
    {"turning",
     "The direction of travel at the window's beginning is taken from that at its end, without "
     "sign. The expanded uncertainty (k = 2) is that of both smoothed velocities.",
     Bound::at_most, by_survey},
    {"standing_start",
     "The smallest smoothed speed is looked for from where the craft stood before the run, or the "
     "run began, up to the window. The craft stood where it is below 0.2 m/s, or where it is not "
     "above 1 m/s and its uncertainty does not tell it from zero (a chi-squared test at 95 %). Met "
     "where it stood; not met where the run began slowly, but not from rest; where the run begins "
     "with a turn, a gap or the recording, the start was not seen, and a person must answer.",
     Bound::none,
     "Somebody who saw the start must say whether the craft began from rest and by itself: a "
     "recording that begins in motion, or breaks off, cannot."},
    {"run_up",
     "The length of the smoothed path from the beginning of the run to the beginning of the "
     "window. A run begins where the craft stood, where it turned, after a gap, or where the "
     "recording begins. Its uncertainty is small beside it and not computed.",
     Bound::at_least, by_survey},
    {"wind_mean",
     "The mean over the window of the wind that the attempt gives, as a vector, samples being "
     "joined by straight lines. Not met where samples are missing for more than 60 s. The "
     "anemometer's uncertainty is not known to the program.",
     Bound::at_most,
     "Give the anemometer's series (wind:) and run the attempt again; or take the wind from its "
     "record, and sign for it."},
    {"wind_gust",
     "The largest speed of the wind that the attempt gives in the window, its ends included. Not "
     "met where samples are missing for more than 60 s. The anemometer's uncertainty is not known "
     "to the program.",
     Bound::at_most,
     "Give the anemometer's series (wind:) and run the attempt again; or take the gusts from its "
     "record, and sign for it."},
    {"current",
     "The largest speed of the current that the attempt gives in the window, its ends included. "
     "Not met where samples are missing for more than 60 s. Its expanded uncertainty (k = 2) is "
     "the one that the attempt states.",
     Bound::at_most,
     "Give the series of the current (current:) and run the attempt again; or take it from the "
     "record of who measured it, and sign for it."},
    {"sampling_rate",
     "The longest time between neighbouring epochs of the window is looked for; one over it is the "
     "lowest rate. No uncertainty enters.",
     Bound::at_least,
     "Find out from the receiver's settings how often it measured, and sign for it."},
    {"sample_accuracy",
     "For every epoch of the window: the accuracy of a speed from two positions as accurate as "
     "this one is stated to be, over the window's time (the root of two times the stated standard "
     "uncertainty, divided by the time); and, where the recording states one, the accuracy of its "
     "recorded velocity. The worst of all counts. It is an uncertainty itself and has none.",
     Bound::at_most,
     "Find out from the receiver's own files how accurate it states each sample to be, and sign "
     "for it."},
    {"opposite_runs",
     "The fastest windows of two runs in opposite directions are looked for. The figure that "
     "counts is the mean of the two speeds; its uncertainty is taken as if the errors of both were "
     "the same.",
     Bound::none,
     "Establish from the records of the runs that both count together, and sign for it."},
    {"fastest_certifiable",
     "The fastest window as recorded is looked for among all, also those that cannot be certified. "
     "Met where it is the certified one, or is no faster than that plus twice its standard "
     "uncertainty; not met where it is faster, since its speed is then not known.",
     Bound::none,
     "Establish from the recording what the speed of the fastest window was, and sign for it."},
    {"time_scale",
     "A speed is a length over a time, and wrong by as much as the clock. The format of the "
     "recording says whether its stamps are the satellites' time. Met where it does. Where it does "
     "not, the mean step of the stamps is compared with that of the rates that receivers are set "
     "to: not met where they differ by more than 1e-4 and more than the scatter of the steps can "
     "make; else a person must answer, and the budget holds a row for the clock.",
     Bound::none,
     "Find out what made the time stamps. Where they are the satellites' time, write time_source: "
     "satellites for the receiver; whoever signs for this clause answers for that."},
    {"measured_positions",
     "Not met where the recording holds more held or interpolated positions than chance makes. Met "
     "where the positions were solved here from raw observations, or a witness beside the "
     "positions agrees (a second receiver, recorded velocities) and nothing looks as if the device "
     "had filtered them: scatter far below what is stated, innovations that follow one another, "
     "motion "
     "that swings after every change of acceleration in the same rhythm.",
     Bound::none,
     "Find out from the device's settings and raw data that its positions were not filtered, "
     "predicted or interpolated, and keep the raw data; or record with a second receiver."},
    {"stated_solution",
     "Met where the recording says of its positions how they were solved, and where nobody does: "
     "they then count as those of one receiver alone, whose slow errors are the largest. Where the "
     "attempt says it, a person must answer for it.",
     Bound::none,
     "Keep what shows the kind of solution: the receiver's raw data, its settings, the log of the "
     "base station. Whoever signs for this clause answers for it."},
}};

const Computation* find_computation(const std::string& name) {
    const auto found = std::ranges::find(computations, name, &Computation::name);
    return found == computations.end() ? nullptr : &*found;
}

std::string window_complete_words(const Profile& profile) {
    const std::string ends = profile.ends_anywhere ? "beginning and ending at any instant"
                                                   : "beginning and ending at measured epochs";
    return fmt::format(
        "Every stretch of {}, {}, is looked at. Those that hold a break of the recording or an "
        "epoch that screening left out are passed over. Met where {} left: the fastest {} the "
        "speed. No uncertainty enters.",
        window_words(profile),
        profile.window_kind == "course" ? "from one line to the other" : ends,
        profile.windows == 1
            ? std::string("one is")
            : fmt::format("{} that do not overlap are", counted(profile.windows, "stretch")),
        profile.windows == 1 ? "gives" : "give");
}

std::string accuracy_words(const ClauseView& view) {
    const Profile& profile = view.of.profile;
    return fmt::format(
        "The expanded uncertainty of the speed is {:.3g} times the combined standard uncertainty "
        "of its budget, and beside that the limit of what choosing the fastest window may have "
        "left in it. The factor is the rule's k = {:.3g}, or more where the budget has few degrees "
        "of freedom. Met where it is at most the limit.",
        view.of.verdict.coverage_factor, profile.coverage_factor);
}

std::string margin_clause_words(const Profile& profile) {
    return fmt::format(
        "The speed to reach is {}; {}. From the speed and its standard uncertainty, the record's "
        "own taken in where it has one, follows the probability that the true speed reaches it. "
        "Met where that is at least {}: this is the decision itself, which `decision` explains.",
        margin_words(profile), rounding_words(profile), level_text(profile.decision_probability));
}

std::string bound_words(Bound bound) {
    if (bound == Bound::none) return {};
    const bool most = bound == Bound::at_most;
    return fmt::format(
        " Compared with the limit: met where it is {0} the limit with all of its expanded "
        "uncertainty, if it has one, not met where it is {1} the limit with all of it; in between "
        "the data cannot tell, and a person must.",
        most ? "at most" : "at least", most ? "above" : "below");
}

}  // namespace

std::string computation_words(const ClauseView& view) {
    const std::string name = view.decided_by();
    const Profile& profile = view.of.profile;
    if (name == "attest")
        return "A person. No figure in the recording could tell it, so that nothing was computed.";
    std::string words;
    if (name == "window_complete") {
        words = window_complete_words(profile);
    } else if (name == "accuracy") {
        words = accuracy_words(view);
    } else if (name == "margin") {
        words = margin_clause_words(profile);
    } else if (const Computation* computation = find_computation(name)) {
        words = std::string(computation->how) + bound_words(computation->bound);
        if (name == "opposite_runs" && profile.opposite_runs_within_s)
            words += fmt::format(" Met where both lie within {}.",
                                 plain_figure(*profile.opposite_runs_within_s, "s"));
    } else {
        return fmt::format("The computation {}, which this version of the program cannot explain.",
                           name.empty() ? "is not named" : name);
    }
    return name + ". " + words;
}

std::string to_attest_words(const ClauseView& view) {
    const std::string name = view.decided_by();
    const Computation* computation = find_computation(name);
    if (name == "margin")
        return "Name the record to beat in the attempt (record:, with speed, unit and source) and "
               "run it again; or compare the speed less its expanded uncertainty with the record "
               "by hand, and sign for it.";
    if (name == "attest" || computation == nullptr)
        return "A person who was there, or who holds the document, must find out whether it is so, "
               "and sign for it in the report's table of attestations. Whoever signs answers for "
               "it.";
    return std::string(computation->to_attest);
}

}  // namespace runcert
