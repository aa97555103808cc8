#include "reports/words/decision.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"
#include "reports/words/attempt.h"

namespace runcert {
namespace {

/// Facts of those levels alone; those without a value are left out.
struct LevelledFacts {
    Level from, to;
    Block block = facts({}, {}, "narrow");

    void add(Level level, const char* name, std::string value) {
        if (from <= level && level <= to) add_fact(block, name, std::move(value));
    }
};

std::string with_unit(const std::string& figure, const ShownFigures& shown) {
    return figure.empty() ? figure : fmt::format("{} {}", figure, shown.unit);
}

/// Of which point of the craft the speed is, and what the other one did; empty where neither rule
/// nor IMU says anything of points.
std::string point_words(const RuleView& rule) {
    const auto& counted_point = rule.profile.speed_of;
    if (rule.best() == nullptr) return {};
    const CraftSpeeds& points = rule.best()->points;
    if (!counted_point && !points.antenna_speed_m_s) return {};
    const std::string point(words_of(counted_point.value_or(SpeedOf::antenna)));
    if (!points.reference_point_speed_m_s) return point;
    const auto beside = [&](const auto& speed_m_s, SafeSide side = SafeSide::down) {
        return speed_beside(rule.verdict, *speed_m_s, rule.unit().name, side);
    };
    return counted_point == SpeedOf::reference_point
               ? fmt::format("{}; the antenna made {}", point, beside(points.antenna_speed_m_s))
               : fmt::format("{}; the craft's reference point made {} ± {}", point,
                             beside(points.reference_point_speed_m_s),
                             beside(points.reference_point_expanded_uncertainty_m_s, SafeSide::up));
}

std::string uncertainty_words(const RuleView& rule) {
    const ProfileVerdict& verdict = rule.verdict;
    const SpeedUnit& unit = rule.unit();
    const auto rounded_up = [&](double uncertainty_m_s) {
        return fmt::format("{} {}", uncertainty_rounded_up(uncertainty_m_s * unit.per_m_s),
                           unit.name);
    };
    const double limit_m_s = verdict.decision ? verdict.decision->bias_limit_m_s : 0.0;
    const double standard_m_s =
        (verdict.expanded_uncertainty_m_s.value_or(0.0) - limit_m_s) / verdict.coverage_factor;
    const double required_m_s =
        verdict.decision ? verdict.decision->required_speed_standard_uncertainty_m_s : 0.0;
    return fmt::format(
        "Expanded {}: {} times the standard uncertainty, {}{}.{}",
        with_unit(rule.shown().expanded_uncertainty, rule.shown()),
        coverage_text(verdict.coverage_factor), rounded_up(standard_m_s),
        limit_m_s > 0.0
            ? fmt::format(
                  ", and {} for what choosing the fastest window may have left in the speed",
                  rounded_up(limit_m_s))
            : "",
        required_m_s > 0.0
            ? fmt::format(" The required speed has a standard uncertainty of {}, from the record's "
                          "own; the two are combined.",
                          rounded_up(required_m_s))
            : "");
}

/// What it was decided by.
void add_decision(LevelledFacts& levelled, const RuleView& rule) {
    const ProfileVerdict& verdict = rule.verdict;
    const bool counts = verdict.outcome != Outcome::not_certifiable;
    if (verdict.decision)
        levelled.add(
            counts ? Level::page : Level::annex, "Conformance probability",
            fmt::format("{} (at least {} required){}",
                        probability_text(verdict.decision->probability),
                        level_text(verdict.decision->level),
                        counts ? "" : "; it does not count, since the speed cannot be certified"));
    levelled.add(Level::annex, "Decision rule", decision_rule_text(rule.profile, verdict));
    levelled.add(Level::annex, "Agreement",
                 agreement_text(rule.attempt.decision_rule_agreed, verdict.window));
    levelled.add(Level::annex, "Guard band", guard_band_text(verdict, rule.unit()));
    levelled.add(Level::annex, "Risk", capitalised(risk_text(verdict)));
    const OwnArithmetic& own = verdict.own_arithmetic;
    levelled.add(Level::page, "By the body's arithmetic",
                 levelled.to >= Level::record ? own_arithmetic_text(own)
                 : own.shown.empty()          ? "not known"
                                              : own.shown);
    const auto& window = verdict.window;
    if (!window) {
        if (!verdict.speed_m_s) levelled.add(Level::page, "Window", "none could be certified");
        return;
    }
    levelled.add(Level::page, "Window", window_line(*window));
    if (window->start_gps) {
        levelled.add(Level::page, "Local time", local_time(*window->start_gps, rule.attempt));
        levelled.add(Level::record, "From the first epoch", seconds_text(window->start));
    }
    if (rule.profile.margin_kind == MarginKind::elapsed_time)
        levelled.add(Level::page, "Elapsed time", seconds_text(window->duration));
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

std::string window_line(const WindowSpan& span) {
    return fmt::format("{} from {}", seconds_text(span.duration),
                       span.start_gps ? to_utc_iso(*span.start_gps, 3)
                                      : seconds_text(span.start) +
                                            " after the first epoch; the recording's time is "
                                            "relative");
}

std::string local_time(GpsTime time, const Attempt& attempt) {
    if (!attempt.utc_offset_minutes) return {};
    const std::int64_t offset_s = *attempt.utc_offset_minutes * 60;
    return fmt::format("{} (UTC{})",
                       utc_text(time.plus_nanoseconds(offset_s * GpsTime::nanoseconds_per_second)),
                       attempt.utc_offset);
}

std::string coverage_words(const RuleView& rule) {
    return fmt::format("k = {}, {} %", coverage_text(rule.verdict.coverage_factor),
                       format_fixed(100.0 * coverage_probability(rule.profile.coverage_factor), 0));
}

double coverage_probability(double nominal_factor) {
    return std::erf(nominal_factor / std::numbers::sqrt2);
}

Block decision_facts(const RuleView& rule, Level from, Level to) {
    const ProfileVerdict& verdict = rule.verdict;
    const ShownFigures shown = rule.shown();
    LevelledFacts levelled{from, to};
    if (verdict.speed_m_s)
        levelled.add(
            Level::page,
            verdict.outcome == Outcome::not_certifiable ? "Not certified" : "Measured speed",
            fmt::format("{} ({})", measured_speed_text(shown), coverage_words(rule)));
    levelled.add(Level::page, "Speed of", point_words(rule));
    levelled.add(Level::annex, "Rule", rule_words(rule.profile));
    if (verdict.speed_m_s) {
        levelled.add(Level::page, "Required speed", with_unit(shown.required_speed, shown));
        levelled.add(Level::page, "Acceptance limit", with_unit(shown.acceptance_limit, shown));
    }
    if (verdict.record) levelled.add(Level::page, "Record to beat", record_text(*verdict.record));
    if (verdict.required_speed_m_s)
        levelled.add(Level::annex, "Margin",
                     fmt::format("The rule asks for {}; {}.", margin_words(rule.profile),
                                 rounding_words(rule.profile)));
    if (verdict.speed_m_s) levelled.add(Level::annex, "Uncertainty", uncertainty_words(rule));
    if (verdict.current_subtracted_m_s)
        levelled.add(
            Level::annex, "Current",
            fmt::format("Its component along the course, {}, has been subtracted.",
                        speed_beside(verdict, *verdict.current_subtracted_m_s, rule.unit().name)));
    add_decision(levelled, rule);
    return std::move(levelled.block);
}

}  // namespace runcert
