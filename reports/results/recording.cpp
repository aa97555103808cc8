#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/claimed_text.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"
#include "reports/words/attempt.h"

namespace runcert {
namespace {

std::string noise_status_text(const NoiseSummary& noise) {
    if (noise.status == NoiseBasis::fitted)
        return fmt::format("estimated from {}", counted(noise.epochs, "epoch"));
    if (noise.status == NoiseBasis::too_few_epochs)
        return fmt::format("not estimated: {}, at least {} required; the stated noise is used",
                           counted(noise.epochs, "usable epoch"), counted(noise.epochs_needed));
    return fmt::format("not estimated: {}; the stated noise is used", words_of(noise.status));
}

/// A parameter with its standard uncertainty: as a sum where that is small, else as a factor, since
/// it is the logarithm that is nearly normal: "0.0121 m ± 0.0009 m", "0.42 m, × or ÷ 1.7".
std::string noise_parameter_text(const NoiseParameter& parameter, const NoiseSummary& noise,
                                 std::string_view unit) {
    constexpr double small = 0.3;
    constexpr double hardly_any = 5.0;  // a factor of 150 either way
    const auto with_unit = [&](std::string figure) {
        return unit.empty() ? figure : fmt::format("{} {}", figure, unit);
    };
    const auto& relative = parameter.relative_uncertainty;
    const std::string value = with_unit(significant_text(parameter.value, 3));
    if (noise.status != NoiseBasis::fitted) return value;
    const std::string limit = parameter.at_bound ? "; at the limit of its range" : "";
    if (!relative || !(*relative < hardly_any))
        return value + ", uncertainty not determined by the data" + limit;
    const double sigma = *relative * parameter.value;
    if (*relative < small && sigma > 0.0)
        return fmt::format("{} ± {}{}",
                           with_unit(format_fixed(parameter.value, uncertainty_decimals(sigma))),
                           with_unit(uncertainty_text(sigma)), limit);
    return fmt::format("{}, × or ÷ {}{}", value, significant_text(std::exp(*relative), 3), limit);
}

/// The lines of the table of noise, with their cells for one set of axes.
std::vector<std::pair<const char*, std::string>> noise_lines(const AxesEstimation& axes) {
    const NoiseSummary& noise = axes.noise;
    const FilterHealth& health = axes.health;
    const bool fitted = noise.status == NoiseBasis::fitted;
    const bool tested = health.innovations > 0;
    const auto parameter = [&](const NoiseParameter& value, const char* unit) {
        return noise_parameter_text(value, noise, unit);
    };
    const auto of_error = [&](const std::optional<NoiseParameter>& value, const char* unit) {
        if (noise.correlated_error_detected && value) return parameter(*value, unit);
        return std::string(fitted ? "not determined by the data" : "not looked for");
    };
    return {
        {"Noise", noise_status_text(noise)},
        {"Jerk density of the motion", parameter(noise.jerk_density, "m s^-2.5")},
        {"Correlation time of the acceleration", noise.acceleration_time_s
                                                     ? parameter(*noise.acceleration_time_s, "s")
                                                     : "acceleration persists"},
        {"Log-likelihood, gained where the acceleration decays",
         fitted ? format_fixed(noise.singer_gain, 2) : "not looked for"},
        {"Scale of the stated standard deviations",
         fmt::format("{}; stated {} m, {}", parameter(noise.measurement_scale, ""),
                     significant_text(noise.stated_sigma_m, 2),
                     noise.stated_all_equal ? "equal at all epochs" : "root mean square")},
        {"Time-correlated position error, standard deviation", of_error(noise.error_sigma_m, "m")},
        {"its correlation time", of_error(noise.error_tau_s, "s")},
        {"its diffusion over short times", of_error(noise.error_diffusion, "m s^-0.5")},
        {"Search", fitted
                       ? fmt::format("{} after {} forward passes over the recording",
                                     noise.converged ? "converged" : "stopped before it converged",
                                     format_fixed(noise.passes, 1))
                       : "none"},
        {"Autocorrelation of the innovations, lag 1",
         tested ? fmt::format("{} with noise as stated, {} with the noise used: {}",
                              format_fixed(health.autocorrelation_stated, 3),
                              format_fixed(health.autocorrelation, 3),
                              health.white ? "white" : "not white")
                : "no innovations"},
        {"Innovation test",
         tested
             ? fmt::format("{}: mean square {} of {}, limits {} to {}; {} of {} outside, {} "
                           "allowed",
                           health.consistent ? "passed" : "not passed",
                           format_fixed(health.mean_statistic, 3),
                           counted(health.innovations, "innovation"), format_fixed(health.lower, 3),
                           format_fixed(health.upper, 3), health.spans_outside,
                           counted(health.spans, "span"), health.spans_allowed)
             : "no innovations"},
        {"Covariances", fmt::format("condition at most {}, asymmetry at most {}",
                                    significant_text(health.largest_condition, 3),
                                    scientific_text(health.largest_asymmetry))}};
}

/// How the format was known, and what exactly it is.
std::string format_words(const Receiver& receiver, const Observations& observations) {
    return fmt::format("{}{}{}", observations.format,
                       observations.variant.empty() ? "" : " (" + observations.variant + ")",
                       receiver.format == "auto" ? ", recognised by the recording's content"
                                                 : ", because the attempt says so");
}

std::string frame_words(const std::string& frame) {
    return frame == "geodetic"      ? "latitude, longitude and height on WGS 84"
           : frame == "ecef"        ? "Earth-centred coordinates on WGS 84"
           : frame == "utm"         ? "UTM coordinates"
           : frame == "local_plane" ? "engineering coordinates of the recording"
                                    : frame;
}

std::string place_words(const Geodetic& at) {
    return fmt::format("latitude {}°, longitude {}°, ellipsoidal height {} m",
                       format_fixed(at.latitude.degrees(), 9),
                       format_fixed(at.longitude.degrees(), 9), format_fixed(at.height_m, 3));
}

std::string scale_words(const std::string& scale) {
    return scale == "gps"        ? "GPS time"
           : scale == "utc"      ? "UTC, taken to GPS time by the leap seconds of the day"
           : scale == "relative" ? "relative to a beginning that the recording does not state"
                                 : scale;
}

std::string accuracy_words(const std::string& source) {
    return source == "recording" ? "as the recording states it, epoch by epoch"
           : source == "attempt" ? "as the attempt states it: the recording states none"
                                 : "not stated";
}

std::string clock_words(const std::string& source, const std::string& origin) {
    const std::string whose = source == "satellites" ? "the satellites' time, as the format says"
                              : source == "attempt"  ? "the satellites' time, as the attempt states"
                                                     : "";
    if (origin.empty()) return whose.empty() ? "whose clock made them is not known" : whose;
    return whose.empty() ? origin : origin + ": " + whose;
}

std::string resolution_words(const RecordingFacts& facts) {
    const auto part = [](const std::optional<double>& step, const char* unit) {
        return step ? fmt::format("{:.2g} {}", *step, unit) : std::string("unknown");
    };
    return fmt::format("{} in position, {} in time", part(facts.position_resolution_m, "m"),
                       part(facts.time_resolution_s, "s"));
}

/// What the attempt states of the receiver.
void add_stated(Block& list, const Receiver& receiver, bool heights_measured) {
    const auto add_one = [&](const char* name, const std::optional<double>& value,
                             const char* unit = "m") {
        if (value) add_fact(list, name, number_text(*value, unit));
    };
    if (!heights_measured) add_one("Height of the course stated by the attempt", receiver.height_m);
    const AttemptAccuracy accuracy = receiver.accuracy.value_or(AttemptAccuracy{});
    add_one("Horizontal accuracy stated, each coordinate", accuracy.horizontal_m);
    add_one("Vertical accuracy stated", accuracy.vertical_m);
    add_one("Accuracy of velocities stated by the attempt", accuracy.velocity_m_s, "m/s");
    add_one("Antenna above the ground", receiver.antenna_height_m);
    if (const auto& arm = receiver.lever_arm) add_fact(list, "Lever arm stated", arm_text(*arm));
    add_fact(list, "Date of the beginning, stated", receiver.start_date);
    if (receiver.start_gps) add_fact(list, "Beginning stated, UTC", utc_text(*receiver.start_gps));
    add_one("Offset to UTC stated", receiver.utc_offset_h, "h");
    add_fact(list, "Calibration",
             receiver.calibration ? calibration_text(*receiver.calibration) : "none is stated");
}

}  // namespace

Block recording_facts(const Observations& observations, const Receiver& receiver,
                      std::int64_t epochs, ElapsedTime last) {
    const RecordingFacts& recorded = observations.facts;
    Block list = facts({});
    const auto add_one = [&](const char* name, std::string value) {
        add_fact(list, name, std::move(value));
    };
    add_one("Recording", claimed_value(recording_names(receiver)));
    add_one("Format", format_words(receiver, observations));
    add_one("Device", observations.device);
    for (const std::string& said : observations.written_by)
        add_one("The recording says", said);
    if (const auto& processing = observations.processing; processing && !observations.simulated) {
        add_one("Positions", processing_text(*processing));
        if (!processing->begin.empty() && !processing->end.empty())
            add_one("Solved from, to", fmt::format("{}, {}", processing->begin, processing->end));
        if (!processing->options.empty())
            add_one("Options of the solution",
                    fmt::format("{}", fmt::join(processing->options, "; ")));
    }
    add_one("Coordinates", frame_words(observations.frame));
    add_one("Time scale", scale_words(observations.time_scale));
    add_one("Time stamps", clock_words(recorded.time_source, observations.time_origin));
    add_one("Fix type", std::string(words_of(observations.solution_source)));
    if (const auto& first = recorded.first_epoch) {
        add_one("First epoch, UTC", utc_text(*first));
        add_one("First epoch, GPS time", gps_text(*first));
    }
    add_one("Epochs", counted(epochs, "epoch"));
    if (const double interval = recorded.nominal_interval_s; interval > 0.0)
        add_one("Rate", format_fixed(1.0 / interval, 2) + " Hz");
    add_one("Length", format_fixed(last.seconds(), 3) + " s");
    add_one("Smallest steps", resolution_words(recorded));
    add_one("Heights",
            recorded.vertical_measured ? "measured" : "not measured: the estimate is in the plane");
    add_one("Accuracy", accuracy_words(observations.accuracy_source));
    add_stated(list, receiver, recorded.vertical_measured);
    for (const SignedNavigation& one : observations.signed_navigation) {
        add_one("Navigation messages", one.text());
        if (one.result == NavigationAuthenticity::authentic)
            add_one(
                "What that shows",
                "the log was not made before these bits were sent, its date is theirs, and the "
                "orbits are Galileo's. It shows nothing of ranges, place or craft, and not that "
                "the log was made at once: half a minute later the keys are public. A time stamp "
                "of the log, or of its hash, bounds that");
    }
    for (const std::string& note : observations.notes)
        add_one("Noticed", note);
    return list;
}

Block frame_facts(const std::optional<FrameOrigin>& origin) {
    Block list = facts({}, "Coordinates");
    add_fact(list, "Frame",
             origin ? "east, north and up at the origin, on WGS 84, without the scale of a map"
                    : "engineering CRS, not tied to the Earth: its place, orientation and scale "
                      "are not stated");
    if (!origin) return list;
    add_fact(list, "Origin", place_words(origin->position));
    add_fact(list, "Chosen by",
             origin->source == "attempt" ? "the attempt" : "the first usable position");
    for (const FramePlace& place : origin->places)
        add_fact(list, "Another place, from",
                 fmt::format("{} s on: {}", format_fixed(place.from.seconds(), 1),
                             place_words(place.position)));
    return list;
}

std::vector<Block> estimation_blocks(const EstimationSummary& estimation) {
    Block list = facts(
        {{"Arcs", counted(estimation.arcs)},
         {"Degrees of freedom", counted(estimation.degrees_of_freedom)},
         {"Variance of unit weight, a posteriori", format_fixed(estimation.variance_factor, 2)},
         {"Factor on the stated covariances, horizontal",
          format_fixed(estimation.variance_factor_applied, 2)},
         {"Stretches solved by batch least squares", counted(estimation.batch_stretches)},
         {"Epochs at less than half weight in the robust estimate",
          counted(estimation.robust_downweighted)}},
        "Estimate");
    if (estimation.robust_unsolved > 0)
        add_fact(list, "Arcs without a robust estimate", counted(estimation.robust_unsolved));
    add_fact(list, "Smoother and batch least squares, largest difference of position",
             scientific_text(estimation.largest_position_difference_m) + " m");
    add_fact(list, "and of velocity",
             scientific_text(estimation.largest_velocity_difference_m_s) + " m/s");
    // The estimated noise, and whether filter and smoother behaved by it.
    const bool heights = estimation.vertical.has_value();
    Block noise = table(heights ? std::vector<std::string>{"|30", "Horizontal|35", "Vertical|35"}
                                : std::vector<std::string>{"|40", "Horizontal|60"},
                        "Noise estimated from the recording");
    for (const auto& [label, text] : noise_lines(estimation.horizontal))
        add_row(noise, {label, text});
    auto row = noise.rows.begin();
    if (heights)
        for (auto& line : noise_lines(*estimation.vertical))
            (row++)->cells.push_back(std::move(line.second));
    return {std::move(list), std::move(noise)};
}

std::vector<Block> attitude_facts(const AttitudeTable& attitude) {
    const InertialConsistency& found = attitude.consistency;
    Block list = facts({});
    add_fact(list, "Agreement",
             found.standing == InertialStanding::consistent
                 ? std::string(words_of(found.standing))
                 : found.reason + " Nothing rests on this solution.");
    add_fact(list, "Positions that took part", counted(found.epochs));
    if (found.epochs > 0) {
        add_fact(list, "Normalised innovations",
                 fmt::format("mean square {}, 0.3 to 2 is accepted; {} % beyond the 99.9 % point",
                             format_fixed(found.normalised_innovations, 2),
                             format_fixed(100.0 * found.beyond_share, 1)));
        add_fact(list, "Start of the attitude", std::string(words_of(found.start)));
    }
    add_fact(list, "Added to the IMU's times",
             fmt::format("{} s, {} s stated", format_fixed(attitude.time_offset.used_s, 4),
                         format_fixed(attitude.time_offset.declared_s, 4)));
    const EstimatedArm& arm = attitude.antenna;
    const bool as_stated = arm.used == arm.declared;
    add_fact(list, "From the IMU to the antenna",
             arm_text(arm.declared) + (as_stated ? "" : ", stated and not used"));
    if (arm.estimated && arm.sigma)
        add_fact(
            list, "The same as the motion shows it",
            arm_text(*arm.estimated, arm.sigma) + (as_stated ? "" : "; the solution rests on it"));
    add_fact(list, "Stretches that only the IMU bridges", counted(std::ssize(attitude.bridged)));
    std::vector<Block> blocks{std::move(list)};
    if (!attitude.mount.judgement.empty()) blocks.push_back(paragraph(attitude.mount.judgement));
    if (attitude.baseline) blocks.push_back(paragraph(attitude.baseline->judgement));
    if (!attitude.notes.empty()) blocks.push_back(list_of(attitude.notes));
    return blocks;
}

}  // namespace runcert
