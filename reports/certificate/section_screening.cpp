#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/certificate_document.h"
#include "reports/certificate/json_parts.h"
#include "reports/words/screening.h"

namespace runcert {
namespace {

constexpr std::size_t faults_shown = 3;  ///< in words

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

/// Fix types in their order, a line for each with all of its axes.
void add_kinds(Block& facts, const std::vector<FixTypeErrors>& kinds) {
    std::vector<std::pair<FixType, std::string>> lines;
    for (const FixTypeErrors& kind : kinds) {
        const auto line = std::find_if(lines.begin(), lines.end(),
                                       [&](const auto& each) { return each.first == kind.fix; });
        if (line == lines.end())
            lines.emplace_back(kind.fix, fix_type_errors_text(kind));
        else
            line->second += "; " + fix_type_errors_text(kind);
    }
    for (auto& [fix, text] : lines)
        add_fact(facts, capitalised(words_of(fix)), std::move(text));
}

std::string fault_text(const TimeFault& fault) {
    return fmt::format("epoch {}: {}", fault.epoch, time_fault_text(fault));
}

std::string time_text(const TimeStampSummary& time) {
    const std::int64_t faults = time_stamp_faults(time);
    if (faults == 0) return "no fault";
    std::string text = counted(faults, "fault");
    const std::size_t shown = std::min(time.faults.size(), faults_shown);
    for (std::size_t i = 0; i < shown; ++i)
        text += (i == 0 ? ": " : "; ") + fault_text(time.faults[i]);
    const std::int64_t left = faults - static_cast<std::int64_t>(shown);
    return left > 0 ? text + fmt::format("; and {} more", left) : text;
}

/// What was decided for, as a noun that can be counted.
struct Noun {
    std::string one;
    std::string several;
};

Noun decided_for(Hypothesis hypothesis) {
    switch (hypothesis) {
        case Hypothesis::outlier:
            return {"single outlier", "single outliers"};
        case Hypothesis::burst:
            return {"position in a run of wrong ones", "positions in runs of wrong ones"};
        case Hypothesis::step:
            return {"step of the positions", "steps of the positions"};
        case Hypothesis::ramp:
            return {"drift of the positions", "drifts of the positions"};
        case Hypothesis::time_shift:
            return {"jump of the time stamps", "jumps of the time stamps"};
        case Hypothesis::model:
            return {"position in a stretch that no single error explains",
                    "positions in stretches that no single error explains"};
        case Hypothesis::velocity:
            return {"position that the recorded velocity contradicts",
                    "positions that the recorded velocities contradict"};
        case Hypothesis::acceleration:
            return {"acceleration that the craft cannot make",
                    "accelerations that the craft cannot make"};
        case Hypothesis::jerk:
            return {"jerk that the craft cannot make", "jerks that the craft cannot make"};
        case Hypothesis::vertical_rate:
            return {"vertical rate that the craft cannot make",
                    "vertical rates that the craft cannot make"};
        case Hypothesis::baseline:
            return {"position that the other receiver contradicts",
                    "positions that the other receiver contradicts"};
        default:
            break;
    }
    const auto witness = witness_of(hypothesis);
    return {fmt::format("position that the {} contradict", witness.at(0)),
            fmt::format("positions that the {} contradict", witness.at(0))};
}

std::string decisions_text(const ScreeningSummary& summary) {
    std::string text;
    for (const auto& [hypothesis, count] : summary.decisions) {
        const Noun noun = decided_for(hypothesis);
        text += fmt::format("{}{} {}", text.empty() ? "" : "; ", count,
                            count == 1 ? noun.one : noun.several);
    }
    return text.empty() ? "nothing" : text;
}

std::string used_text(const ScreenedTable& table, const ScreeningSummary& summary) {
    std::string used = fmt::format("{} of {}", summary.usable, table.rows.size());
    if (summary.arcs == 0) return used;
    const std::string longest = format_fixed(longest_arc_s(table.rows), 3);
    if (summary.arcs == 1) return fmt::format("{}, in one arc, of {} s", used, longest);
    return fmt::format("{}, in {} arcs, the longest of {} s", used, summary.arcs, longest);
}

void add_basis(Block& facts, const ScreeningBasis& basis) {
    add_fact(facts, "False alarms", false_alarm_text(basis));
    add_fact(facts, "Noise assumed by the tests", noise_text(basis.models));
    add_kinds(facts, basis.fix_types);
    add_fact(facts, "Recorded velocities",
             basis.velocity ? velocity_comparison_text(*basis.velocity)
                            : "too few were recorded to compare");
    for (const DisplacementComparison& each : basis.displacements)
        add_fact(facts, "Displacements by a witness", displacement_comparison_text(each));
    if (basis.device)
        add_fact(facts, "Signs of positions that were not measured",
                 device_signs_text(*basis.device));
    add_fact(facts, "Order and spacing of the time stamps", time_text(basis.time));
    if (basis.baseline)
        add_fact(facts, "Other receiver", baseline_comparison_text(*basis.baseline));
}

}  // namespace

std::vector<Block> screening_blocks(const ReceiverResults& results) {
    const ScreenedTable& screened = results.screened;
    const ScreeningSummary summary = summarise(screened.rows);
    Block list = facts({});
    add_fact(list, "Epochs used", used_text(screened, summary));
    add_fact(list, "Decided by the tests", decisions_text(summary));
    add_basis(list, screened.basis);
    Block counts = table({">Epochs|14", "Decision of screening|86"});
    for (const auto& [reason, count] : summary.reasons)
        add_row(counts,
                {counted(count), reason == Reason::none ? "used" : std::string(words_of(reason))});
    return {std::move(list), std::move(counts),
            paragraph("runcert audit RUN_FOLDER lists every decision with its row of the "
                      "recording.",
                      "note")};
}

Section screening_section(const ReportInputs& inputs, const nlohmann::ordered_json& figures) {
    Section section{.anchor = "screening", .title = "Screening"};
    for (const ReceiverResults& results : inputs.receivers) {
        if (inputs.receivers.size() > 1)
            add(section, heading(fmt::format("Receiver “{}”", results.windows.receiver)));
        add(section, screening_blocks(results));
    }
    add(section, plots_of(figures, "innovations"));
    add(section, plots_of(figures, "residuals"));
    return section;
}

}  // namespace runcert
