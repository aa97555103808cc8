#include <fmt/format.h>

#include <algorithm>

#include "core/speed_unit.h"
#include "core/text.h"
#include "reports/explain/parts.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

/// The unit that the verdict shows speeds in, else the rule's.
std::string unit_of(const ProfileView& view) {
    return view.verdict.shown ? view.verdict.shown->unit : rule_unit_name(view.profile);
}

/// The speed as it is to be read: "216.00 km/h ± 0.02 km/h (k = 2)"; empty where there is none.
std::string speed_shown(const ProfileView& view) {
    if (!view.verdict.speed_m_s) return {};
    return measured_speed_text(shown_of(view.verdict, unit_of(view)), view.verdict.coverage_factor);
}

Section titled(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    return {.anchor = verdict.profile,
            .title = fmt::format("{}: {}, {}", verdict.profile, verdict.title, verdict.body)};
}

Block outcome_facts(const ProfileView& view) {
    OutcomeState state = state_of(view.verdict);
    state.vouched_by = view.options.vouched_by;
    return facts({{"Outcome", outcome_words(state).title + "."},
                  {"Standing", capitalised(standing_text(state.standing)) + "."}});
}

std::string window_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    if (!verdict.window)
        return fmt::format("None of {} could be certified.", window_words(view.profile));
    const WindowSpan& span = *verdict.window;
    const std::string asked =
        view.profile.opposite_runs_within_s
            ? fmt::format("The rule asks for the mean of two runs over {}. The faster:",
                          window_words(view.profile))
        : view.profile.windows > 1
            ? fmt::format("The rule asks for the mean of {} windows of {}. The fastest:",
                          view.profile.windows, window_words(view.profile))
            : fmt::format("The rule asks for {}. The window:", window_words(view.profile));
    return fmt::format("{} {} s from {} s after the first epoch{}.", asked,
                       format_fixed(span.duration.seconds(), 3),
                       format_fixed(span.start.seconds(), 3),
                       span.start_gps ? " (" + to_utc_iso(*span.start_gps, 3) + ")" : "");
}

std::string record_words(const ProfileView& view) {
    const auto& record = view.verdict.record;
    if (!record) return "The attempt names none.";
    return sentence(record_text(*record)) +
           (record->expanded_uncertainty.value_or(0.0) > 0.0
                ? ""
                : " No uncertainty of its own is stated, so that it is taken as exact.");
}

std::string speed_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    std::string text =
        fmt::format("{}, the speed rounded down and the uncertainty up.", speed_shown(view));
    if (verdict.current_subtracted_m_s)
        text += fmt::format(
            " The current's component along the course, {}, has been subtracted from it.",
            speed_beside(verdict, *verdict.current_subtracted_m_s, unit_of(view), SafeSide::down));
    return text + " " + own_arithmetic_text(verdict.own_arithmetic);
}

std::string uncertainty_text(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    const SpeedUnit& unit = speed_unit(unit_of(view));
    const auto rounded_up = [&](double uncertainty_m_s) {
        return fmt::format("{} {}", uncertainty_rounded_up(uncertainty_m_s * unit.per_m_s),
                           unit.name);
    };
    const double expanded_m_s = verdict.expanded_uncertainty_m_s.value_or(0.0);
    const double limit_m_s = verdict.decision ? verdict.decision->bias_limit_m_s : 0.0;
    const double standard_m_s = (expanded_m_s - limit_m_s) / verdict.coverage_factor;
    const ShownFigures shown = shown_of(verdict, unit.name);
    const std::string expanded = fmt::format("{} {}", shown.expanded_uncertainty, shown.unit);
    std::string text =
        limit_m_s > 0.0
            ? fmt::format(
                  "Expanded {}: {} times the standard uncertainty, {}, and {} for what "
                  "choosing the fastest window may have left in the speed.",
                  expanded, coverage_text(verdict.coverage_factor), rounded_up(standard_m_s),
                  rounded_up(limit_m_s))
            : fmt::format("Expanded {} (k = {}), standard {}.", expanded,
                          coverage_text(verdict.coverage_factor), rounded_up(standard_m_s));
    if (verdict.decision && verdict.decision->required_speed_standard_uncertainty_m_s > 0.0)
        text += fmt::format(
            " The required speed has a standard uncertainty of {}, from the record's own; the two "
            "are combined.",
            rounded_up(verdict.decision->required_speed_standard_uncertainty_m_s));
    return text;
}

/// What compares the speed with a record.
void add_comparison(Block& told, const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    const std::string unit = unit_of(view);
    add_fact(told, "Record", record_words(view));
    if (verdict.required_speed_m_s) {
        add_fact(told, "Margin",
                 fmt::format("The rule asks for {}; {}.", margin_words(view.profile),
                             rounding_words(view.profile)));
        add_fact(told, "Required speed",
                 speed_beside(verdict, *verdict.required_speed_m_s, unit, SafeSide::up) + ".");
    }
    if (verdict.speed_m_s) {
        add_fact(told, "Speed", speed_text(view));
        add_fact(told, "Uncertainty", uncertainty_text(view));
    }
    if (!verdict.decision) return;
    add_fact(told, "Conformance",
             fmt::format("Probability {} that the true speed reaches the required speed.",
                         probability_text(verdict.decision->probability)));
    const std::int64_t made = verdict.decision->attempts_made;
    add_fact(told, "Decision rule",
             (made > 1 ? fmt::format(
                             "As the best of {} attempts it may take one share of the risk. ", made)
                       : "") +
                 decision_rule_text(view.profile, verdict));
    add_fact(told, "Agreement", agreement_text(view.options.rule_agreed, verdict.window));
    add_fact(told, "Acceptance limit",
             fmt::format("{}: the lowest measured speed that would count as beaten with this "
                         "uncertainty.",
                         speed_beside(verdict, verdict.decision->acceptance_limit_m_s, unit,
                                      SafeSide::up)));
    add_fact(told, "Guard band", guard_band_text(verdict, speed_unit(unit)));
    add_fact(told, "Risk", capitalised(risk_text(verdict)));
}

}  // namespace

std::string margin_words(const Profile& profile) {
    const std::string above = profile.margin_above == MarginBase::upper_limit
                                  ? "the record's upper limit, its value plus its own expanded "
                                    "uncertainty"
                                  : "the record";
    if (profile.margin_kind == MarginKind::relative)
        return fmt::format("{:.6g} % above {}", profile.margin * 100.0, above);
    if (profile.margin_kind == MarginKind::elapsed_time)
        return fmt::format("a time over the course that is shorter than that of {} by {}", above,
                           number_text(profile.margin, "s"));
    const std::string& unit = profile.margin_unit;
    return fmt::format(
        "{} above {}",
        number_text(profile.margin / (unit.empty() ? 1.0 : metres_per_second(unit)), unit), above);
}

std::string rounding_words(const Profile& profile) {
    if (!profile.rounding) return "the required speed is not rounded";
    return fmt::format("the required speed is {} to {} of {}, as the body does",
                       profile.rounding->mode == DecimalMode::truncate
                           ? "cut off"
                           : "rounded to the nearest figure",
                       counted(profile.rounding->decimals, "decimal"), profile.rounding->unit);
}

std::vector<std::string> notes_of(const ProfileVerdict& verdict) {
    std::vector<std::string> notes = verdict.notes;
    std::erase_if(notes, [&](const std::string& note) {
        return std::ranges::any_of(verdict.overrides, [&](const Override& figure) {
            return note.find(figure.figure) != std::string::npos;
        });
    });
    return notes;
}

Section decision_section(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    Block told = outcome_facts(view);
    add_fact(told, "Window", window_text(view));
    add_comparison(told, view);
    add_fact(told, "Why",
             (verdict.outcome == Outcome::not_certifiable
                  ? "The speed cannot be certified, so that no comparison with a record counts: "
                  : "") +
                 sentence(verdict.reason) +
                 (verdict.outcome == Outcome::not_proven && verdict.decision
                      ? " A more accurate measurement of the same run could decide it."
                      : ""));
    for (std::string& words : override_words(verdict))
        add_fact(told, "Replaced", std::move(words));
    for (std::string& note : notes_of(verdict))
        add_fact(told, "Note", std::move(note));
    if (verdict.indicated)
        add_fact(
            told, "Refused",
            sentence(fmt::format("{} at {} s, of the raw positions: {}",
                                 speed_beside(verdict, verdict.indicated->speed_m_s, unit_of(view)),
                                 format_fixed(verdict.indicated->span.start.seconds(), 3),
                                 listed(verdict.indicated->refusals))));
    Section section = titled(view);
    add(section, std::move(told));
    return section;
}

Section decision_in_short(const ProfileView& view) {
    const ProfileVerdict& verdict = view.verdict;
    Block told = outcome_facts(view);
    if (const std::string speed = speed_shown(view); !speed.empty()) {
        const std::string required_speed =
            verdict.required_speed_m_s
                ? fmt::format("; required {}", speed_beside(verdict, *verdict.required_speed_m_s,
                                                            unit_of(view), SafeSide::up))
                : "";
        add_fact(told, "Speed", speed + required_speed);
    }
    if (verdict.decision && verdict.outcome != Outcome::not_certifiable)
        add_fact(told, "Conformance", "probability " + conformance_text(*verdict.decision));
    if (verdict.decision)
        add_fact(told, "Decision rule", agreement_text(view.options.rule_agreed, verdict.window));
    add_fact(told, "Why", sentence(verdict.reason));
    Section section = titled(view);
    add(section, std::move(told));
    return section;
}

}  // namespace runcert
