#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/claimed_text.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/certificate/plots.h"
#include "reports/words/answer.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "reports/words/recording.h"
#include "schemas/verdict/outcome.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// What must be seen before anything else.
void add_cautions(Section& page, const ReportInputs& inputs) {
    if (const auto& amends = inputs.attempt.amends)
        add(page,
            paragraph(fmt::format("The claimant states that this report replaces report {}, for "
                                  "the reason {}. That counts only if a key that signed that "
                                  "report signed this one. SHA-256 of that report: {}.",
                                  amends->report_id, claimed(amends->reason), amends->sha256),
                      "caution"));
    for (const ReceiverResults& results : inputs.receivers)
        if (results.observations.simulated)
            add(page, paragraph(fmt::format("Simulated. The recording of receiver “{}” says that "
                                            "it was simulated: no craft was measured.",
                                            results.windows.receiver),
                                "caution"));
    if (!inputs.receivers.front().screened.facts.georeferenced)
        add(page, paragraph("Not georeferenced. The positions are engineering coordinates: their "
                            "place, orientation and scale on the Earth are not stated.",
                            "caution"));
}

std::string rule_line(const RuleView& rule) {
    return fmt::format("{}: {} ({}{}).", rule.verdict.body, rule.verdict.title,
                       rule_identity_text(rule.verdict),
                       rule.profile.looked_at.empty()
                           ? ""
                           : fmt::format(", texts checked on {}", rule.profile.looked_at));
}

Block outcome_block(const RuleView& rule) {
    const OutcomeWords words = outcome_words(state_of(rule.verdict));
    Block block = paragraph(words.title, "outcome_" + words.tone);
    block.sign = words.mark;
    block.slot = "outcome/" + rule.verdict.profile;
    return block;
}

/// A speed that the press may print stands large only where it is the answer; else the reason does.
void add_large_words(Section& page, const RuleView& rule) {
    if (rule.verdict.outcome == Outcome::beaten && rule.verdict.speed_m_s) {
        Block block{.kind = BlockKind::headline, .text = measured_speed_text(rule.shown())};
        block.beside = fmt::format("({})", coverage_words(rule));
        add(page, std::move(block));
        return;
    }
    add(page, paragraph(rule.verdict.reason, "reason"));
}

/// "31.6000° S, 136.0000° E", to some ten metres.
std::string coordinates_text(const Geodetic& place) {
    const auto degrees = [](Angle angle, const char* positive, const char* negative) {
        return fmt::format("{}° {}", format_fixed(std::abs(angle.degrees()), 4),
                           angle.degrees() < 0.0 ? negative : positive);
    };
    return fmt::format("{}, {}", degrees(place.latitude, "N", "S"),
                       degrees(place.longitude, "E", "W"));
}

std::string joined(std::initializer_list<std::string> parts, const char* between = ", ") {
    std::string text;
    for (const std::string& part : parts)
        if (!part.empty()) text += (text.empty() ? "" : between) + part;
    return text;
}

std::string or_not_stated(std::string text) {
    return text.empty() ? "not stated" : text;
}

std::string labelled(const char* label, const std::string& text) {
    return text.empty() ? text : fmt::format("{} {}", label, text);
}

/// "maker model, serial 42, firmware 1.2, antenna choke ring"; empty where nothing is known.
std::string parts_text(const Instrument& one) {
    return joined(
        {claimed(joined({one.make, one.model}, " ")), labelled("serial", claimed(one.serial)),
         labelled("firmware", claimed(one.firmware)), labelled("antenna", claimed(one.antenna))});
}

/// As the attempt says, and as the recording does.
std::string instrument_text(const Receiver& receiver, const Observations& recording) {
    const std::string stated = receiver.instrument ? parts_text(*receiver.instrument) : "";
    std::string recorded = recording.instrument ? parts_text(*recording.instrument) : "";
    if (recorded.empty()) recorded = claimed(recording.device);
    if (recorded == stated) recorded.clear();
    return or_not_stated(
        joined({stated, labelled("the recording says", recorded),
                labelled("calibration:",
                         receiver.calibration ? calibration_text(*receiver.calibration) : "")},
               "; "));
}

/// Two columns beside each other cannot go on to another page: very long facts stand in one.
void set_columns(Block& facts, const char* columns) {
    constexpr std::size_t long_fact = 400;
    const bool fit = std::ranges::none_of(facts.facts, [](const Fact& fact) {
        return fact.name.size() + fact.value.size() > long_fact;
    });
    facts.look = fit ? columns : "narrow";
}

/// As the attempt says, else as the recording does.
std::string date_text(const ReportInputs& inputs) {
    const auto& first = inputs.receivers.front().observations.facts.first_epoch;
    if (!inputs.attempt.date.empty() || !first) return inputs.attempt.date;
    return to_utc_iso(*first, 0).substr(0, 10) + ", as recorded";
}

/// Craft, people, place and instrument: each said, or said to be missing.
void add_identity(Section& page, const ReportInputs& inputs) {
    const Attempt& attempt = inputs.attempt;
    Block list = facts({});
    add_fact(list, "Attempt", attempt.id);
    add_fact(list, "Craft",
             joined({claimed(attempt.craft.name), claimed(attempt.craft.registration),
                     attempt.craft.kind,
                     attempt.craft.sail_area_m2
                         ? fmt::format("sail area {} m²", number_text(*attempt.craft.sail_area_m2))
                         : ""}));
    add_fact(list, "Pilot", or_not_stated(claimed(attempt.pilot)));
    add_fact(list, "Organisation",
             or_not_stated(joined({claimed(attempt.organisation), claimed(attempt.contact)})));
    const auto& origin = inputs.receivers.front().screened.origin;
    add_fact(
        list, "Place",
        or_not_stated(joined(
            {claimed(attempt.place), origin ? coordinates_text(origin->position) : ""}, "; ")));
    add_fact(list, "Date", or_not_stated(date_text(inputs)));
    for (std::size_t i = 0; i < inputs.receivers.size(); ++i)
        add_fact(list,
                 inputs.receivers.size() == 1
                     ? "Instrument"
                     : fmt::format("Instrument “{}”", attempt.receivers[i].id),
                 instrument_text(attempt.receivers[i], inputs.receivers[i].observations));
    add_fact(list, "Officials", or_not_stated(officials_text(attempt.officials)));
    set_columns(list, "two_columns");
    add(page, std::move(list));
    add(page, paragraph("What stands in “quotation marks” was stated by whoever claims the record, "
                        "and was not measured.",
                        "note"));
}

/// "✓ by the data", "☐ open: judge".
std::string state_line(const Requirement& requirement) {
    if (requirement.status == RequirementStatus::attest)
        return "☐ open: " + answerer_text(requirement);
    return requirement.status == RequirementStatus::met ? "✓ by the data" : "✗ NOT MET by the data";
}

/// A line each: what it is about, its state, and who answered.
void add_requirements(Section& page, const RuleView& rule) {
    Block list = facts({}, "Requirements");
    list.slot = "requirements/" + rule.verdict.profile;
    for (const Requirement& requirement : rule.verdict.requirements)
        list.facts.push_back({.name = clause_name(requirement.clause),
                              .value = state_line(requirement),
                              .mark = std::string(to_text(requirement.status)),
                              .clause = requirement.clause});
    set_columns(list, "requirements");
    add(page, std::move(list));
}

std::string witnesses_text(const RuleView& rule) {
    if (rule.verdict.unseen_drift_m_s) return positions_alone_text(rule.verdict);
    if (rule.verdict.witnesses.empty()) return {};
    return fmt::format("Beside the positions, {}.", fmt::join(rule.verdict.witnesses, "; "));
}

/// In UTC and, where the attempt says how far apart they are, local time.
std::string times_text(const RuleView& rule) {
    const auto& window = rule.verdict.window;
    if (!window) return "none";
    return joined({window_line(*window),
                   window->start_gps ? local_time(*window->start_gps, rule.attempt) : ""});
}

/// A line for each rule; each has its requirements in the annex.
void add_overview(Section& page, const std::vector<RuleView>& rules) {
    for (const RuleView& rule : rules) {
        const ShownFigures shown = rule.shown();
        Block outcome = outcome_block(rule);
        outcome.text = fmt::format("{}: {}", rule.verdict.profile, outcome.text);
        outcome.look = "strong";
        Block row = table({"Rule|34", ">Measured speed|22", ">Required speed|16", "Window|28"}, {},
                          "small");
        add_row(
            row,
            {fmt::format("{}, {}", rule.verdict.title, rule.verdict.body),
             rule.verdict.speed_m_s ? measured_speed_text(shown) : "none",
             shown.required_speed.empty() ? "no record"
                                          : fmt::format("{} {}", shown.required_speed, shown.unit),
             times_text(rule)},
            outcome_words(state_of(rule.verdict)).tone);
        if (&rule != &rules.front())
            for (TableColumn& column : row.columns)
                column.head.clear();
        add(page, std::move(outcome));
        add(page, std::move(row));
        const std::string refused = rule.verdict.outcome == Outcome::not_certifiable
                                        ? capitalised(refusal_text(rule.verdict))
                                        : "";
        const std::string record =
            rule.verdict.record ? "Record to beat: " + record_text(*rule.verdict.record) + "." : "";
        if (std::string more = joined({refused, record, witnesses_text(rule)}, " "); !more.empty())
            add(page, paragraph(std::move(more), "note"));
    }
    add(page, paragraph("Reasons, requirements and uncertainty of each rule follow.", "note"));
}

void add_small_plots(Section& page, const ReportInputs& inputs, Json& figures) {
    Block block{.kind = BlockKind::plots, .look = "small"};
    for (const Plots& plots : {place_plot(inputs), result_plot(inputs)})
        for (const Block& one : shown(plots, figures))
            block.plots.push_back(one.plots.front());
    if (!block.plots.empty()) add(page, std::move(block));
}

}  // namespace

Section first_page(const ReportInputs& inputs, const std::string& report_id, Json& figures) {
    Section page{.anchor = "certificate", .layout = "first_page"};
    const std::vector<RuleView> rules = rule_views(inputs);
    add_cautions(page, inputs);
    if (rules.size() == 1) {
        const RuleView& rule = rules.front();
        add(page, paragraph(rule_line(rule), "note"));
        add(page, outcome_block(rule));
        add_large_words(page, rule);
        add(page, decision_facts(rule, Level::page, Level::page));
        if (rule.verdict.outcome == Outcome::beaten)  // the headline has it
            std::erase_if(page.blocks.back().facts,
                          [](const Fact& fact) { return fact.name == "Measured speed"; });
    } else {
        add_overview(page, rules);
    }
    for (const RuleView& rule : rules)
        if (!rule.verdict.second_files.empty())
            add(page,
                paragraph((rule.several ? rule.profile.id + ": " : "") + rule.verdict.second_files,
                          "caution"));
    add(page, paragraph("Neither answered nor closed when this report was made.", "note"));
    page.blocks.back().slot = "closing";
    add_identity(page, inputs);
    constexpr std::size_t fills_the_page = 3;
    if (rules.size() < fills_the_page) add_small_plots(page, inputs, figures);
    if (rules.size() == 1) {
        add_requirements(page, rules.front());
        if (std::string words = witnesses_text(rules.front()); !words.empty())
            add(page, paragraph(std::move(words), "note"));
    }
    add(page, {.kind = BlockKind::signers});
    add(page, {.kind = BlockKind::check,
               .text = fmt::format(
                   "To check report {}: runcert verify RUN_FOLDER --roster ROSTER. What counts is "
                   "report.json; the code names it. Figures: speed rounded down; uncertainty, "
                   "required speed and acceptance limit rounded up.",
                   report_id)});
    return page;
}

}  // namespace runcert
