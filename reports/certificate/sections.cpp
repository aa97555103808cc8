#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "reports/certificate/plots.h"
#include "reports/words/recording.h"
#include "schemas/verdict/outcome.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// The same rule by each receiver, where there are several.
void add_receivers(Section& section, const ReportInputs& inputs, const RuleView& rule) {
    if (inputs.receivers.size() < 2) return;
    Block list = facts({}, "By each receiver");
    for (const ReceiverResults& results : inputs.receivers) {
        const ProfileWindows* windows = windows_of(results.windows, rule.profile.id);
        const auto figure = windows == nullptr ? std::nullopt : figure_of(*windows);
        add_fact(list, results.windows.receiver,
                 figure ? fmt::format("{}, {} after its first epoch",
                                      speed_with_uncertainty_text(
                                          figure->speed_m_s,
                                          expanded_uncertainty_by_rule_m_s(
                                              *figure, rule.profile.coverage_factor),
                                          rule.unit()),
                                      seconds_text(windows->best->span.start))
                        : "no certifiable window");
    }
    add(section, std::move(list));
}

void add_window(Section& section, const ReportInputs& inputs, const RuleView& rule, Json& figures) {
    if (!rule.verdict.window) return;
    if (rule.several) add(section, heading(rule.titled("Window")));
    if (rule.verdict.speed_m_s) add(section, result_table(rule));
    add(section, paragraph(own_arithmetic_text(rule.verdict.own_arithmetic), "note"));
    add(section, shown(window_plot(inputs, rule), figures));
    add(section, window_blocks(rule, *rule.verdict.window));
}

/// From so many rules on, windows and budgets are shown beside each other.
constexpr std::size_t shown_together = 3;

/// The windows of several rules, two figures beside each other.
void add_windows(Section& section, const ReportInputs& inputs, const std::vector<RuleView>& rules,
                 Json& figures) {
    add(section, windows_of_all(rules));
    constexpr std::size_t beside = 2;
    std::vector<Block> blocks;
    for (const RuleView& rule : rules)
        for (const Block& one : shown(window_plot(inputs, rule), figures)) {
            if (blocks.empty() || blocks.back().plots.size() == beside)
                blocks.push_back({.kind = BlockKind::plots, .look = "small"});
            blocks.back().plots.push_back({.plot = one.plots.front().plot,
                                           .plot_title = capitalised(rule.verdict.title),
                                           .caption = "Rule " + rule.profile.id + "."});
        }
    add(section, std::move(blocks));
}

/// Names the receiver of what follows, where there are several.
void add_receiver_heading(Section& section, const ReportInputs& inputs,
                          const ReceiverResults& results) {
    if (inputs.receivers.size() > 1)
        add(section, heading(fmt::format("Receiver “{}”", results.windows.receiver)));
}

/// Who says what the recordings do not.
void add_sources(Section& section, const Attempt& attempt) {
    Block list = facts({}, "Handed in beside the recordings");
    if (attempt.wind) add_fact(list, "Wind, by", attempt.wind->source);
    if (attempt.current) add_fact(list, "Current, by", attempt.current->source);
    if (attempt.secondary_method)
        add_fact(list, "Second method",
                 fmt::format("{} ({})", attempt.secondary_method->method,
                             attempt.secondary_method->source));
    if (!list.facts.empty()) add(section, std::move(list));
}

/// What the raw signals say, under each rule and over the whole; empty where none were looked at.
std::vector<std::string> raw_signal_sentences(const ReportInputs& inputs) {
    const ReceiverResults& results = inputs.receivers.front();
    std::vector<std::string> sentences;
    if (!inputs.phase_view || inputs.phase_view->satellites.empty() || !results.screened_phase)
        return sentences;
    for (const ProfileWindows& entry : results.windows.profiles)
        if (entry.best)
            for (const WitnessedSpeed& one : entry.best->witnesses)
                if (one.kind == WitnessKind::phases)
                    sentences.push_back(fmt::format("Under the rule {}: {}", entry.profile,
                                                    phase_window_sentence(one)));
    for (const std::string& sentence : phase_sentences(*results.screened_phase))
        sentences.push_back(sentence);
    return sentences;
}

}  // namespace

Section requirements_section(const ReportInputs& inputs) {
    Section section{.anchor = "requirements", .title = "Requirements of the rules"};
    const std::vector<RuleView> rules = rule_views(inputs);
    const Level from = rules.size() > 1 ? Level::page : Level::annex;
    const SaidOfAll said = said_of_all(rules, from, Level::annex);
    for (const RuleView& rule : rules) {
        if (rule.several)
            add(section, heading(fmt::format("Rule “{}”: {}, {}", rule.verdict.profile,
                                             rule.verdict.title, rule.verdict.body)));
        add(section, verdict_blocks(rule, from, Level::annex, said));
    }
    if (!said.facts.empty())
        add(section,
            facts(said.facts, fmt::format("Alike for all {} rules", rules.size()), "narrow"));
    if (!said.notes.empty()) add(section, list_of(said.notes));
    add(section, requirements_table(rules));
    if (Block origins = origin_facts(inputs.verdict.origins); !origins.facts.empty()) {
        origins.text = "Who says what the figures rest on";
        add(section, std::move(origins));
    }
    Block answers = facts({}, "Answers");
    answers.slot = "answers";
    add_fact(answers, "Given", "none when this report was made");
    add(section, std::move(answers));
    return section;
}

Section window_section(const ReportInputs& inputs, Json& figures) {
    Section section{.anchor = "window", .title = "Window"};
    const std::vector<RuleView> rules = rule_views(inputs);
    const bool in_one = rules.size() >= shown_together;
    if (in_one) add_windows(section, inputs, rules, figures);
    for (const RuleView& rule : rules) {
        if (!in_one) add_window(section, inputs, rule, figures);
        add_receivers(section, inputs, rule);
        add(section, refused_blocks(rule));
    }
    add(section, shown(average_plots(inputs), figures));
    return section;
}

Section uncertainty_section(const ReportInputs& inputs) {
    Section section{.anchor = "uncertainty", .title = "Uncertainty"};
    const std::vector<RuleView> rules = rule_views(inputs);
    const bool in_one = rules.size() >= shown_together;
    if (in_one) add(section, budgets_of_all(rules));
    for (const RuleView& rule : rules) {
        if (in_one || rule.best() == nullptr) continue;
        if (rule.several) add(section, heading(rule.titled("Uncertainty")));
        add(section,
            paragraph(fmt::format("Measured speed: {}",
                                  measured_speed_text(rule.shown(), rule.verdict.coverage_factor)),
                      "strong"));
        add(section, uncertainty_blocks(rule));
    }
    add(section, titled_list("What the uncertainty covers, and what it does not",
                             inputs.verdict.statements));
    return section;
}

Section screening_section(const ReportInputs& inputs, Json& figures) {
    Section section{.anchor = "screening", .title = "Screening"};
    for (const ReceiverResults& results : inputs.receivers) {
        add_receiver_heading(section, inputs, results);
        add(section, screening_blocks(results.screened, Level::annex));
        add(section, paragraph("runcert audit RUN_FOLDER lists every decision with its row of the "
                               "recording.",
                               "note"));
    }
    const ReceiverResults& judged = inputs.receivers.front();
    add(section, shown(test_plot(judged.screened), figures));
    add(section, shown(residual_plot(judged), figures));
    return section;
}

Section witnesses_section(const ReportInputs& inputs, Json& figures) {
    Section section{.anchor = "witnesses", .title = "Witnesses"};
    add(section, witness_blocks(rule_views(inputs)));
    if (const auto& notes = inputs.receivers.front().windows.witness_notes; !notes.empty())
        add(section, list_of(notes));
    const auto sentences = raw_signal_sentences(inputs);
    if (sentences.empty()) return section;
    add(section, heading("The receiver's raw signals"));
    for (const std::string& sentence : sentences)
        add(section, paragraph(sentence));
    add(section, shown(phase_plots(inputs), figures));
    return section;
}

Section attitude_section(const ReportInputs& inputs, Json& figures) {
    Section section{.anchor = "attitude", .title = "Attitude of the craft"};
    for (std::size_t i = 0; i < inputs.receivers.size(); ++i) {
        const ReceiverResults& results = inputs.receivers[i];
        if (!results.attitude) continue;
        add_receiver_heading(section, inputs, results);
        add(section, attitude_facts(*results.attitude));
        const auto& imu = inputs.attempt.receivers[i].imu;
        if (imu && !imu->reference_point_name.empty())
            add(section, paragraph("The reference point: " + imu->reference_point_name + "."));
    }
    add(section, shown(attitude_plots(inputs), figures));
    return section;
}

Section run_section(const ReportInputs& inputs, Json& figures) {
    Section section{.anchor = "run", .title = "Run and course"};
    for (const Plots& plots : {speed_plot(inputs), track_plot(inputs), ground_plot(inputs)})
        add(section, shown(plots, figures));
    if (figures.empty())
        add(section, paragraph("There is nothing to draw: no stretch of the recording could be "
                               "estimated."));
    add(section, course_blocks(rule_views(inputs)));
    add(section, run_blocks(rule_views(inputs)));
    add_sources(section, inputs.attempt);
    return section;
}

Section recording_section(const ReportInputs& inputs) {
    Section section{.anchor = "recording", .title = "Recording and estimate"};
    for (std::size_t i = 0; i < inputs.receivers.size(); ++i) {
        const ReceiverResults& results = inputs.receivers[i];
        const auto& rows = results.screened.rows;
        add_receiver_heading(section, inputs, results);
        Block recorded = recording_facts(results.observations, inputs.attempt.receivers[i],
                                         std::ssize(rows), last_time(rows));
        if (results.screened_phase)
            for (const std::string& sentence : phase_sentences(*results.screened_phase))
                add_fact(recorded, "Noticed", sentence);
        if (i < inputs.handed_in.size() && !inputs.handed_in[i].empty())
            add_fact(recorded, "Handed in", inputs.handed_in[i]);
        add(section, std::move(recorded));
        add(section, estimation_blocks(results.trajectory.estimation));
    }
    add(section, frame_facts(inputs.receivers.front().screened.origin));
    return section;
}

}  // namespace runcert
