#include <fmt/format.h>

#include <algorithm>

#include "reports/certificate/json_parts.h"

namespace runcert {
namespace {

std::string value_text(const Json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (!value.is_array()) return value.dump();
    std::string text;
    for (const Json& item : value)
        text += (text.empty() ? "" : ", ") + value_text(item);
    return text;
}

Json parameter_json(const std::string& stage, const std::string& name, const Json& value,
                    const std::vector<std::string>& overrides) {
    const std::string path = stage + "." + name;
    Json json{{"parameter", path}, {"value", value}, {"value_text", value_text(value)}};
    const bool import = stage == "import";  // what the attempt states of the receiver
    if (const FieldRule* rule =
            attempt_schema().find(import ? "receivers[]." + name : "parameters." + path)) {
        if (!rule->unit.empty()) json["value_unit"] = rule->unit;
        json["meaning"] = rule->description;
    }
    json["set_by_attempt"] =
        import || std::find(overrides.begin(), overrides.end(), path) != overrides.end();
    return json;
}

/// A stage with the parameters it says it used.
Json stage_json(const Header& header, const Attempt& attempt) {
    std::string stage = header.stage;
    if (stage.starts_with("runcert-")) stage.erase(0, 8);
    Json json{{"stage", header.stage},
              {"stage_version", header.program_version},
              {"stage_revision", header.source_revision},
              {"stage_parameters", *header.parameters},
              {"parameters", Json::array()}};
    if (header.parameters->is_object())
        for (const auto& [name, value] : header.parameters->items())
            if (!value.is_null() && !value.is_object())
                json["parameters"].push_back(parameter_json(stage, name, value, attempt.overrides));
    return json;
}

void describe_tests(Json& words, const ScreeningBasis& basis) {
    words.push_back(
        "Every epoch is screened. Epochs are marked, never deleted. First each by itself: the kind "
        "of its solution, what the recording says of satellites, ambiguities and corrections, its "
        "stated standard deviation, the order of time. A gap in time ends a stretch.");
    words.push_back(fmt::format(
        "Then by detection, identification and adaptation (Baarda 1968; Teunissen 2018) in the "
        "state-space model of the motion, horizontally and, where heights were measured, "
        "vertically. The noise is estimated from what a first look leaves, with a variance factor "
        "for each fix type. Every epoch is tested for an outlier, for up to {} outliers in a row, "
        "and for a step and a drift of the positions. It is tested for a jump of the time stamps; "
        "every span of epochs for the model as a whole. Each test uses all measurements of the "
        "arc, before and after the supposed error. One pass of the Kalman filter forward and one "
        "of scores backward (de Jong & Penzer 1998) do this. They give what a least-squares "
        "adjustment with that error as an unknown would.",
        basis.burst_epochs_max));
    words.push_back(
        "The best supported error is adapted to: outliers are left out; a step, a drift or a jump "
        "of the time stamps ends the arc. Where the attempt requires it, a step is bridged with "
        "its offset as an unknown of the estimate. The tests are repeated until they find nothing "
        "more. If the noise is as estimated, all of them together raise a false alarm at most at "
        "the family-wise rate.");
    words.push_back(
        "Witnesses beside the positions follow: the displacements by carrier phases, where raw "
        "signals were handed in; the recorded velocities, whose delay is estimated first; the "
        "accelerations, jerks and vertical rates that a craft of the class can make; and the other "
        "receiver, where there is one.");
}

void describe_estimated_noise(Json& words) {
    words.push_back(
        "The noise is estimated from the recording unless the attempt requires the stated one. It "
        "is the most likely one given all usable epochs: the jerk density of the motion, the scale "
        "of the stated standard deviations, and the size and correlation time of a time-correlated "
        "position error. Where the recording does not determine them, the stated noise is used. "
        "Its variances are multiplied by the a posteriori variance of unit weight where that "
        "exceeds one.");
    words.push_back(
        "Within each arc position, velocity and acceleration are estimated from all usable epochs "
        "at once, in two ways that must agree: batch least squares, and a Kalman filter with "
        "Rauch-Tung-Striebel smoothing. A batch with a robust loss, over the epochs that the tests "
        "rejected too, is the check on screening.");
    words.push_back(
        "Every window of the rule's length that lies within one arc and holds usable epochs only "
        "is compared; the fastest gives the measured speed. Its speed is estimated with a bound on "
        "time-correlated position errors in place of the fitted ones. Its standard uncertainty is "
        "that of the budget, one row for each source, by the law of propagation of uncertainty; a "
        "Monte Carlo propagation of the same distributions checks it.");
    words.push_back(
        "The undetected error is bounded by the external reliability of the speed (Baarda 1968). "
        "For each kind of error, at every epoch and in every direction, it is the size that its "
        "test finds with the stated power only. What that size does to the speed is the undetected "
        "effect. The largest that is not a drift is a row of the budget. Where a witness agrees, "
        "that row is what screening and the witness together would have missed, drifts included.");
}

Json description(const ReportInputs& inputs) {
    Json words = Json::array();
    if (inputs.receivers.front().screened.facts.georeferenced)
        words.push_back(
            "Positions are taken from the recording as they are. They are expressed as east, north "
            "and up at the origin given above, on the WGS 84 ellipsoid; their covariances are "
            "rotated with them.");
    else
        words.push_back("Engineering coordinates are taken from the recording as they are.");
    describe_tests(words, inputs.receivers.front().screened.basis);
    describe_estimated_noise(words);
    words.push_back(
        "The speeds of [DHD22] are computed beside it for comparison and decide nothing: Deakin, "
        "Holden & Daddo 2022, Precision of Derived Velocity from Kinematic GPS for Land Yachting "
        "Speed Record Attempt.");
    return words;
}

}  // namespace

Json method_json(const ReportInputs& inputs) {
    Json json{{"description", description(inputs)}, {"stages", Json::array()}};
    const ReceiverResults& judged = inputs.receivers.front();
    for (const Header* header :
         {&judged.observations.header, &judged.enu_header, &judged.screened.header,
          &judged.trajectory.header, &judged.windows.header, &inputs.verdict.header})
        json["stages"].push_back(stage_json(*header, inputs.attempt));
    return json;
}

}  // namespace runcert
