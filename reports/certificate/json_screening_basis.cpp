#include "reports/certificate/json_screening_basis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/json_facts.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

constexpr std::ptrdiff_t faults_listed = 20;  ///< in the report
constexpr std::size_t faults_shown = 3;       ///< in words

/// Counts hold every fault, the table a thousand of them at most.
std::int64_t faults_of(const TimeStampSummary& time) {
    return std::max(time.gaps + time.duplicates + time.backward, std::ssize(time.faults));
}

std::string false_alarm_text(const ScreeningBasis& basis) {
    const double rate = basis.family_false_alarm_rate;
    if (!(rate > 0.0)) return "not stated";
    return fmt::format(
        "of {} recordings without an outlier at most one would have anything marked, by all "
        "{} tests together",
        std::llround(std::floor(1.0 / rate + 1e-9)), basis.tests);
}

std::string model_text(const ScreeningModel& model) {
    if (model.noise == NoiseBasis::fitted) return std::string(words_of(model.noise));
    return fmt::format("{} times the stated one ({})", significant_text(model.measurement_scale, 2),
                       words_of(model.noise));
}

/// Once, where it is the same on all axes.
std::string noise_text(const std::vector<ScreeningModel>& models) {
    if (models.empty()) return "none: nothing could be tested";
    std::string first = model_text(models.front());
    if (std::all_of(models.begin(), models.end(),
                    [&](const ScreeningModel& model) { return model_text(model) == first; }))
        return first;
    std::string text;
    for (const ScreeningModel& model : models)
        text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", to_text(model.axes),
                            model_text(model));
    return text;
}

/// What the innovations show: a time-correlated error is not in it.
std::string kind_text(const FixTypeErrors& kind) {
    if (kind.judgement == AccuracyJudgement::too_few_epochs)
        return fmt::format("{}: too few epochs ({}) to tell", to_text(kind.axes), kind.epochs);
    const std::string_view judgement =
        kind.judgement == AccuracyJudgement::optimistic    ? "clearly larger"
        : kind.judgement == AccuracyJudgement::pessimistic ? "clearly smaller"
                                                           : "as stated, within chance";
    return fmt::format("{}: errors from epoch to epoch {} times as large as stated ({})",
                       to_text(kind.axes), significant_text(std::sqrt(kind.variance_factor), 2),
                       judgement);
}

/// Fix types in their order, a line for each with all of its axes.
void add_kinds(Json& facts, const std::vector<FixTypeErrors>& kinds) {
    std::vector<std::pair<FixType, std::string>> lines;
    for (const FixTypeErrors& kind : kinds) {
        const auto line = std::find_if(lines.begin(), lines.end(),
                                       [&](const auto& each) { return each.first == kind.fix; });
        if (line == lines.end())
            lines.emplace_back(kind.fix, kind_text(kind));
        else
            line->second += "; " + kind_text(kind);
    }
    for (auto& [fix, text] : lines)
        facts.push_back(
            fact(fmt::format("Solutions of the kind “{}”", to_text(fix)), std::move(text)));
}

std::string velocity_text(const std::optional<VelocityComparison>& velocity) {
    if (!velocity) return "hardly any were recorded: no witness of the positions";
    if (velocity->compared == 0) return "could not be compared with the motion";
    std::string delay = "how late they are cannot be told from the motion";
    if (velocity->delay_s) {
        const double delay_s = *velocity->delay_s;
        const int decimals = velocity->sigma_delay_s && *velocity->sigma_delay_s > 0.0
                                 ? uncertainty_decimals(*velocity->sigma_delay_s)
                                 : 3;
        delay = format_fixed(std::abs(delay_s), decimals);
        if (velocity->sigma_delay_s)
            delay += fmt::format(" ± {}", format_fixed(*velocity->sigma_delay_s, decimals));
        delay += fmt::format(" s {} the positions, which is allowed for",
                             delay_s < 0.0 ? "ahead of" : "behind");
    }
    return fmt::format("{}; compared at {}, of which they contradict {}", delay,
                       counted(velocity->compared, "epoch"), velocity->rejected);
}

std::string fault_text(const TimeFault& fault) {
    const std::string size = format_fixed(std::abs(fault.size_s), 3) + " s";
    std::string what(to_text(fault.kind));
    if (fault.kind == TimeFaultKind::gap) what = size + " missing";
    if (fault.kind == TimeFaultKind::backward) what = "back by " + size;
    if (fault.kind == TimeFaultKind::duplicate) what = "the time of the epoch before";
    if (fault.kind == TimeFaultKind::session)
        what = fmt::format("another session, {} {}", size, fault.size_s < 0.0 ? "back" : "later");
    if (fault.kind == TimeFaultKind::whole_second_shift)
        what = fmt::format("the clock jumps by {} while the positions go on", size);
    return fmt::format("epoch {}: {}", fault.epoch, what);
}

std::string time_text(const TimeStampSummary& time) {
    const std::int64_t faults = faults_of(time);
    if (faults == 0) return "no fault";
    std::string text = counted(faults, "fault");
    const std::size_t shown = std::min(time.faults.size(), faults_shown);
    for (std::size_t i = 0; i < shown; ++i)
        text += (i == 0 ? ": " : "; ") + fault_text(time.faults[i]);
    const std::int64_t left = faults - static_cast<std::int64_t>(shown);
    return left > 0 ? text + fmt::format("; and {} more", left) : text;
}

std::string device_text(const DeviceSigns& device) {
    if (device.moving == 0) return "none looked for: the craft hardly moved";
    if (device.held + device.interpolated == 0)
        return fmt::format("none in {}", counted(device.moving, "moving row"));
    return fmt::format(
        "{} of {} repeat the position before, {} lie in line with their neighbours to the last "
        "digit; chance makes {} of them",
        device.held, counted(device.moving, "moving row"), device.interpolated,
        significant_text(device.by_chance, 2));
}

std::string baseline_text(const BaselineComparison& baseline) {
    if (baseline.compared == 0) return "could not be compared: no epochs at the same time";
    return fmt::format(
        "“{}” {} m away, standard deviation {} m over {}; they contradict each "
        "other at {}",
        baseline.receiver, format_fixed(baseline.length_m, 3), format_fixed(baseline.sd_m, 3),
        counted(baseline.compared, "epoch"), baseline.rejected);
}

}  // namespace

Json screening_basis_json(const ScreeningBasis& basis) {
    Json json = members_json(basis);
    Json& faults = json["time"]["faults"];
    if (std::ssize(basis.time.faults) > faults_listed)
        faults.erase(faults.begin() + faults_listed, faults.end());
    json["time"]["faults_found"] = faults_of(basis.time);
    return json;
}

Json screening_basis_facts(const ScreeningBasis& basis) {
    Json facts = Json::array();
    facts.push_back(fact("False alarms", false_alarm_text(basis)));
    facts.push_back(fact("Noise that the tests rest on", noise_text(basis.models)));
    add_kinds(facts, basis.fix_types);
    facts.push_back(fact("Recorded velocities", velocity_text(basis.velocity)));
    if (basis.device)
        facts.push_back(
            fact("Signs of positions that were not measured", device_text(*basis.device)));
    facts.push_back(fact("Order and spacing of the time stamps", time_text(basis.time)));
    if (basis.baseline) facts.push_back(fact("Other receiver", baseline_text(*basis.baseline)));
    return facts;
}

}  // namespace runcert
