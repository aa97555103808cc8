#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/certificate_document.h"
#include "reports/words/attempt.h"
#include "reports/words/recording.h"

namespace runcert {
namespace {

std::string innovations_text(const FilterHealth& health) {
    if (health.innovations == 0) return "no innovations";
    return fmt::format("{}: mean square {} of {}, limits {} to {}; {} of {} outside, {} allowed",
                       health.consistent ? "passed" : "not passed",
                       format_fixed(health.mean_statistic, 3),
                       counted(health.innovations, "innovation"), format_fixed(health.lower, 3),
                       format_fixed(health.upper, 3), health.spans_outside,
                       counted(health.spans, "span"), health.spans_allowed);
}

std::string autocorrelation_text(const FilterHealth& health) {
    if (health.innovations == 0) return "no innovations";
    return fmt::format("{} with noise as stated, {} with the noise used: {}",
                       format_fixed(health.autocorrelation_stated, 3),
                       format_fixed(health.autocorrelation, 3),
                       health.white ? "white" : "not white");
}

/// The lines of the table of noise, with their cells for one set of axes.
std::vector<std::pair<const char*, std::string>> noise_lines(const AxesEstimation& axes) {
    const NoiseSummary& noise = axes.noise;
    const FilterHealth& health = axes.health;
    const bool fitted = noise.status == NoiseBasis::fitted;
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
        {"Scale of the stated standard deviations",
         fmt::format("{}; stated {} m, {}", parameter(noise.measurement_scale, ""),
                     significant_text(noise.stated_sigma_m, 2),
                     noise.stated_all_equal ? "equal at all epochs" : "root mean square")},
        {"Time-correlated position error, standard deviation", of_error(noise.error_sigma_m, "m")},
        {"its correlation time", of_error(noise.error_tau_s, "s")},
        {"its diffusion over short times", of_error(noise.error_diffusion, "m s^-0.5")},
        {"Search", fitted
                       ? fmt::format("{} after {} of the likelihood",
                                     noise.converged ? "converged" : "stopped before it converged",
                                     counted(noise.evaluations, "evaluation"))
                       : "none"},
        {"Autocorrelation of the innovations, lag 1", autocorrelation_text(health)},
        {"Innovation test", innovations_text(health)},
        {"Covariances", fmt::format("condition at most {}, asymmetry at most {}, {} repaired",
                                    significant_text(health.largest_condition, 3),
                                    scientific_text(health.largest_asymmetry), health.repaired)}};
}

/// The estimated noise, and whether filter and smoother behaved by it: a column for the horizontal
/// axes, and one for the vertical one where heights were measured.
Block noise_table(const EstimationSummary& estimation) {
    const bool heights = estimation.vertical.has_value();
    Block block =
        heights ? table({"|30", "Horizontal|35", "Vertical|35"}) : table({"|40", "Horizontal|60"});
    for (const auto& [label, text] : noise_lines(estimation.horizontal))
        add_row(block, {label, text});
    if (!heights) return block;
    auto row = block.rows.begin();
    for (const auto& line : noise_lines(*estimation.vertical))
        (row++)->cells.push_back(line.second);
    return block;
}

std::string accuracy_words(const std::string& source) {
    if (source == "recording") return "in the recording";
    if (source == "attempt") return "in the attempt";
    return "nowhere";
}

ElapsedTime last_time(const std::vector<ScreenedEpoch>& rows) {
    ElapsedTime last;
    for (const ScreenedEpoch& row : rows)
        last = std::max(last, row.time);
    return last;
}

/// What the attempt states of the receiver.
void add_stated(Block& list, const Receiver& receiver, bool heights_measured) {
    const auto add_stated = [&](const char* name, const std::optional<double>& value,
                                const char* unit = "m") {
        if (value) add_fact(list, name, number_text(*value, unit));
    };
    if (!heights_measured)
        add_stated("Height of the course stated by the attempt", receiver.height_m);
    const AttemptAccuracy accuracy = receiver.accuracy.value_or(AttemptAccuracy{});
    add_stated("Horizontal accuracy stated, each coordinate", accuracy.horizontal_m);
    add_stated("Vertical accuracy stated", accuracy.vertical_m);
    add_stated("Accuracy of velocities stated by the attempt", accuracy.velocity_m_s, "m/s");
    add_stated("Antenna above the ground", receiver.antenna_height_m);
    add_fact(list, "Calibration",
             receiver.calibration ? calibration_text(*receiver.calibration) : "none is stated");
}

Block recording_facts(const ReceiverResults& results, const Receiver& receiver) {
    const Observations& observations = results.observations;
    Block list = facts({});
    const auto add_one = [&](const char* name, std::string value) {
        add_fact(list, name, std::move(value));
    };
    add_one("Recording", recording_names(receiver));
    add_one("Format", observations.format);
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
    add_one("Coordinates", observations.frame);
    add_one("Time scale", observations.time_scale);
    add_one("Time stamps", observations.time_origin);
    add_one("Fix type", std::string(words_of(observations.solution_source)));
    if (const auto& first = observations.facts.first_epoch) {
        add_one("First epoch, UTC", utc_text(*first));
        add_one("First epoch, GPS time", gps_text(*first));
    }
    add_one("Epochs", counted(std::ssize(results.screened.rows), "epoch"));
    if (const double interval = observations.facts.nominal_interval_s; interval > 0.0)
        add_one("Rate", format_fixed(1.0 / interval, 2) + " Hz");
    add_one("Length", format_fixed(last_time(results.screened.rows).seconds(), 3) + " s");
    add_one("Heights", observations.facts.vertical_measured
                           ? "measured"
                           : "not measured: the estimate is in the plane");
    add_one("Accuracy stated", accuracy_words(observations.accuracy_source));
    add_stated(list, receiver, observations.facts.vertical_measured);
    for (const std::string& note : observations.notes)
        add_one("Noticed", note);
    if (results.phases)
        for (const std::string& sentence : phase_sentences(*results.phases))
            add_one("Noticed", sentence);
    return list;
}

Block estimation_facts(const EstimationSummary& estimation) {
    Block list = facts({}, "Estimate");
    add_fact(list, "Degrees of freedom", counted(estimation.degrees_of_freedom));
    add_fact(list, "Variance of unit weight, a posteriori",
             format_fixed(estimation.variance_factor, 2));
    add_fact(list, "Factor on the stated covariances, horizontal",
             format_fixed(estimation.variance_factor_applied, 2));
    add_fact(list, "Stretches solved by batch least squares", counted(estimation.batch_stretches));
    add_fact(list, "Epochs at less than half weight in the robust estimate",
             counted(estimation.robust_downweighted));
    add_fact(list, "Smoother and batch least squares, largest difference of position",
             scientific_text(estimation.largest_position_difference_m) + " m");
    add_fact(list, "and of velocity",
             scientific_text(estimation.largest_velocity_difference_m_s) + " m/s");
    return list;
}

Block frame_facts(const ScreenedTable& screened) {
    Block list = facts({}, "Coordinates");
    if (!screened.facts.georeferenced)
        add_fact(list, "Coordinates",
                 "engineering CRS: its place, orientation and scale on the Earth are not stated");
    if (!screened.origin) return list;
    const Geodetic& position = screened.origin->position;
    add_fact(list, "Coordinates", "east, north, up on the WGS 84 ellipsoid");
    add_fact(list, "Origin, latitude", format_fixed(position.latitude.degrees(), 9) + "°");
    add_fact(list, "Origin, longitude", format_fixed(position.longitude.degrees(), 9) + "°");
    add_fact(list, "Origin, ellipsoidal height", format_fixed(position.height_m, 3) + " m");
    add_fact(list, "Chosen by",
             screened.origin->source == "attempt" ? "the attempt" : "the first usable position");
    for (const FramePlace& place : screened.origin->places)
        add_fact(list, "Another place, from", place_text(place));
    return list;
}

}  // namespace

Section recording_section(const ReportInputs& inputs) {
    Section section{.anchor = "recording", .title = "Recording and estimate"};
    for (std::size_t i = 0; i < inputs.receivers.size(); ++i) {
        const ReceiverResults& results = inputs.receivers[i];
        if (inputs.receivers.size() > 1)
            add(section, heading(fmt::format("Receiver “{}”", results.windows.receiver)));
        add(section, recording_facts(results, inputs.attempt.receivers[i]));
        add(section, estimation_facts(results.trajectory.estimation));
        Block noise = noise_table(results.trajectory.estimation);
        noise.text = "Noise estimated from the recording";
        add(section, std::move(noise));
    }
    add(section, frame_facts(inputs.receivers.front().screened));
    return section;
}

}  // namespace runcert
