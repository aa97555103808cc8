#include "stages/check/requirements.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/failure.h"
#include "core/prose.h"
#include "reports/words/figures.h"
#include "stages/check/context.h"
#include "stages/check/inputs.h"

namespace runcert {
namespace {

Figure speed_figure(std::string name, double speed_m_s, const std::string& unit,
                    std::string shown) {
    return {.name = std::move(name),
            .value = speed_m_s / metres_per_second(unit),
            .unit = unit,
            .shown = std::move(shown)};
}

/// Which key of the attempt decides what a reason rules out, and how to answer it; empty where
/// none.
std::string_view what_decides(Reason reason, const ReceiverFindings& judged) {
    switch (reason) {
        case Reason::float_ambiguities:
        case Reason::other_fix:
            return judged.solution_source == SolutionSource::unknown
                       ? "the recording states no fix type, which counts as single: if they are "
                         "fixed solutions, write solution: fixed in the receiver, a claim that "
                         "somebody must attest"
                       : "to use other fix types, write parameters: {screen: {allowed_fixes: "
                         "[fixed, float, ...]}}";
        case Reason::accuracy_missing:
            return judged.facts.vertical_measured
                       ? "state it in the attempt, accuracy: {horizontal_m: ..., vertical_m: ...}"
                       : "state it in the attempt, accuracy: {horizontal_m: ...}";
        case Reason::accuracy_absurd:
            return "screen.accuracy_max_m decides";
        case Reason::few_satellites:
            return "screen.satellites_min decides";
        case Reason::low_ratio:
            return "screen.ratio_min decides";
        case Reason::old_corrections:
            return "screen.correction_age_max_s decides";
        case Reason::short_arc:
            return "screen.min_arc_epochs decides";
        case Reason::no_position:
            return "where heights alone are missing, give height_m";
        default:
            return {};
    }
}

/// Why not one epoch may take part: the three commonest reasons with the first epoch of each.
std::string nothing_usable(const ReceiverFindings& judged) {
    constexpr std::size_t named = 3;
    const ScreeningSummary& screening = judged.screening;
    std::int64_t epochs = 0;
    std::vector<std::pair<std::int64_t, Reason>> reasons;
    for (const auto& [reason, count] : screening.reasons) {
        epochs += count;
        if (reason != Reason::none) reasons.emplace_back(count, reason);
    }
    std::stable_sort(reasons.begin(), reasons.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<std::string> words;
    for (std::size_t i = 0; i < std::min(named, reasons.size()); ++i) {
        const auto [count, reason] = reasons[i];
        const auto& [epoch, time] = screening.first_of.at(reason);
        const std::string_view decides = what_decides(reason, judged);
        words.push_back(fmt::format("{} {} (first epoch {}, {}{}{})", count, words_of(reason),
                                    epoch, instant_text(judged.facts.first_epoch, time),
                                    decides.empty() ? "" : "; ", decides));
    }
    return fmt::format("none of the {} epochs is usable: {}{}", epochs, fmt::join(words, ", "),
                       reasons.size() > named ? ", and other reasons" : "");
}

double longest_stretch_s(const std::vector<TrajectoryEpoch>& rows) {
    double longest_s = 0.0;
    const TrajectoryEpoch* first = nullptr;
    for (const TrajectoryEpoch& row : rows) {
        if (!row.arc || !row.usable) continue;
        if (!first || first->arc != row.arc) first = &row;
        longest_s = std::max(longest_s, row.time.seconds() - first->time.seconds());
    }
    return longest_s;
}

/// Why there is no certifiable window.
std::string no_window(const ClauseContext& context) {
    const ReceiverFindings& judged = context.input.judged;
    if (judged.screening.usable == 0) return nothing_usable(judged);
    const std::string wanted = window_words(context.profile);
    std::string evidence =
        context.windows.missing.empty()
            ? fmt::format(
                  "no {} of the recording are without a break and without an unusable "
                  "epoch, the longest arc having {}",
                  wanted, time_span_text(longest_stretch_s(judged.trajectory)))
            : context.windows.missing;
    if (const auto& indicated = context.windows.indicated;
        indicated && !indicated->refusals.empty())
        evidence += fmt::format("; the fastest {} as recorded hold {}", wanted,
                                fmt::join(indicated->refusals, ", "));
    return evidence;
}

/// The times at which the lines of a course were crossed, from the first epoch: a position error is
/// one of time at the craft's speed. The epoch beside a crossing stands for it.
std::vector<Figure> crossing_figures(const ClauseContext& context) {
    const CertifiableWindow& best = *context.windows.best;
    std::vector<Figure> figures;
    const auto add = [&](const char* name, std::int64_t epoch, double time_s) {
        const auto& rows = context.input.judged.trajectory;
        const auto row = std::ranges::find(rows, epoch, &TrajectoryEpoch::epoch);
        if (row == rows.end() || !row->sigma_east_m || !row->speed_m_s) return;
        const double slow_m = best.bound ? best.bound->sigma_m : 0.0;
        const double position_m =
            std::hypot(std::max(*row->sigma_east_m, *row->sigma_north_m), slow_m);
        figures.push_back({.name = name,
                           .value = time_s,
                           .unit = "s",
                           .expanded_uncertainty = 2.0 * position_m / *row->speed_m_s,
                           .note = "from the first epoch"});
    };
    const double start_s = best.span.start.seconds();
    add("start line crossed", best.span.first_epoch, start_s);
    add("finish line crossed", best.span.last_epoch, start_s + best.span.duration.seconds());
    return figures;
}

/// Why the second receiver says nothing of the window.
std::string_view silence_of_receiver(const CheckInput& input) {
    const auto& baseline = input.judged.tests.baseline;
    if (baseline && baseline->same_errors)
        return "has the errors of the first one's positions: one recording was made from the other";
    if (!input.judged.facts.first_epoch || !input.secondary->facts.first_epoch)
        return "cannot be compared: the time of a recording is relative (give its start_gps)";
    if (input.judged.origin.has_value() != input.secondary->origin.has_value())
        return "cannot be compared: only one of the two has a place on the Earth";
    return "has no estimate over the whole of that time without a break or a step";
}

/// By the normalised error; what agrees is met only where it could have failed.
RequirementStatus status_of(double normalised_error, bool could_fail) {
    if (normalised_error > 1.0) return RequirementStatus::not_met;
    return could_fail ? RequirementStatus::met : RequirementStatus::attest;
}

std::string doubt(double expanded_uncertainty_m_s, const ClauseContext& context) {
    return could_have_failed(expanded_uncertainty_m_s, context)
               ? std::string()
               : "; " + too_uncertain_text(expanded_uncertainty_m_s);
}

/// What the second receiver says.
Finding by_receiver(const ClauseContext& context) {
    const std::string& receiver = context.input.secondary->receiver;
    if (!context.windows.best)
        return {RequirementStatus::not_met, "there is no certifiable window to compare"};
    const auto& witnesses = context.windows.best->witnesses;
    const auto one = std::ranges::find(witnesses, receiver, &WitnessedSpeed::receiver);
    if (one == witnesses.end())
        return {RequirementStatus::not_met,
                fmt::format("receiver \"{}\" {}", receiver, silence_of_receiver(context.input))};
    const double expanded_m_s = 2.0 * one->standard_uncertainty_m_s;
    return {status_of(one->normalised_error, could_have_failed(expanded_m_s, context)),
            fmt::format(
                "receiver \"{}\" gives {:.3f} km/h over the same {:.3f} s, {:+.3f} km/h "
                "against the primary one; normalised error {:.2f}, at most 1, with what the two do "
                "not share: noise, each receiver's own time-correlated error, antenna. They share "
                "base station, satellites, atmosphere, frame and time scale{}",
                receiver, one->speed_m_s * 3.6, context.windows.best->span.duration.seconds(),
                -one->difference_m_s * 3.6, one->normalised_error, doubt(expanded_m_s, context)),
            {{.name = "normalised error of receiver " + receiver, .value = one->normalised_error}}};
}

/// What the method says that the attempt declares.
Finding by_declaration(const ClauseContext& context) {
    if (!context.declared)
        return {RequirementStatus::not_met, "there is no certifiable window to compare"};
    const DeclaredAgreement& agreement = *context.declared;
    if (!agreement.missing.empty())
        return {RequirementStatus::not_met,
                fmt::format("{}: {}", agreement.method, agreement.missing)};
    const double expanded_m_s = agreement.other_expanded_uncertainty_m_s;
    return {
        status_of(agreement.normalised_error, could_have_failed(expanded_m_s, context)),
        fmt::format(
            "{} gives {}, {:+.3f} km/h against the primary method; normalised error "
            "{:.2f}, at most 1{}",
            agreement.method,
            speed_with_uncertainty_text(agreement.other_m_s, expanded_m_s, speed_unit("km/h")),
            (agreement.other_m_s - agreement.judged_m_s) * 3.6, agreement.normalised_error,
            doubt(expanded_m_s, context)),
        {{.name = "normalised error of the second method", .value = agreement.normalised_error}}};
}

/// What witnesses of the same receiver say: they meet the clause where it accepts them.
Finding by_own_witnesses(const Clause& clause, const ClauseContext& context) {
    Finding finding{RequirementStatus::attest, {}};
    if (context.windows.best)
        for (const WitnessedSpeed& one : context.windows.best->witnesses) {
            finding.figures.push_back(
                {.name = fmt::format("normalised error of the {}", words_of(one.kind)),
                 .value = one.normalised_error});
            finding.evidence +=
                fmt::format("{}{}", finding.evidence.empty() ? "" : "; ", witness_text(one));
            finding.evidence += doubt(2.0 * one.standard_uncertainty_m_s, context);
            const bool accepted =
                std::ranges::find(clause.accepts, to_text(one.kind)) != clause.accepts.end();
            if (accepted && confirms(one, context)) finding.status = RequirementStatus::met;
        }
    if (finding.evidence.empty())
        finding.evidence = "the attempt has one receiver; another method is not part of it";
    else if (finding.status == RequirementStatus::attest)
        finding.evidence += "; whether that counts as a second method the rule does not say";
    return finding;
}

Finding computed(const Clause& clause, const ClauseContext& context) {
    switch (clause.decided_by) {
#define RUNCERT_CASE(word)  \
    case Computation::word: \
        return computation::word(clause, context);
        RUNCERT_EACH_COMPUTATION(RUNCERT_CASE)
#undef RUNCERT_CASE
    }
    throw Failure("clause " + clause.id, "its computation is none of this program's",
                  "This is a fault of the program; please report it");
}

}  // namespace

Finding computation::window_complete(const Clause&, const ClauseContext& context) {
    if (!context.windows.best) return {RequirementStatus::not_met, no_window(context)};
    if (!figure_of(context.windows))
        return {RequirementStatus::not_met,
                fmt::format("of {} windows of {} that the rule takes the mean of, {} "
                            "are certifiable without overlapping",
                            context.profile.windows, window_words(context.profile),
                            context.windows.further.size() + 1)};
    const WindowSpan& span = context.windows.best->span;
    std::string evidence = fmt::format(
        "{:.3f} s from epoch {} to epoch {}, no break and no unusable epoch inside; "
        "the {}",
        span.duration.seconds(), span.first_epoch, span.last_epoch,
        context.windows.candidates == 1
            ? std::string("only such window")
            : fmt::format("best of {} such windows", context.windows.candidates));
    if (!context.windows.further.empty())
        evidence += fmt::format("; with {} more the mean", context.windows.further.size());
    std::vector<Figure> figures{
        {.name = "length of the window", .value = span.duration.seconds(), .unit = "s"}};
    if (context.profile.window_kind == WindowKind::course)
        for (Figure& figure : crossing_figures(context))
            figures.push_back(std::move(figure));
    return {RequirementStatus::met, std::move(evidence), std::move(figures)};
}

Finding computation::accuracy(const Clause&, const ClauseContext& context) {
    if (!context.speed || !context.profile.accuracy_limit_m_s)
        return {RequirementStatus::not_met,
                "there is no certifiable window whose accuracy could be stated"};
    const double u = *context.expanded_uncertainty_m_s;
    const double bias_limit_m_s = context.speed->bias_limit_m_s;
    const bool met = u <= *context.profile.accuracy_limit_m_s;
    const SpeedUnit& unit = speed_unit(context.profile.accuracy_unit);
    const auto rounded_up = [&](double uncertainty_m_s) {
        return fmt::format("{} {}", uncertainty_rounded_up(uncertainty_m_s * unit.per_m_s),
                           unit.name);
    };
    const std::string limit =
        number_text(*context.profile.accuracy_limit_m_s * unit.per_m_s, unit.name);
    return {met ? RequirementStatus::met : RequirementStatus::not_met,
            fmt::format(
                "expanded uncertainty {} (k = {}{}), limit {}; {}", rounded_up(u),
                coverage_text(context.coverage_factor),
                bias_limit_m_s > 0.0 ? fmt::format(", with {} for the choice of the window",
                                                   rounded_up(bias_limit_m_s))
                                     : std::string(),
                limit,
                context.profile.speed_source == SpeedSource::velocity
                    ? "it rests on what the recording shows and states of its velocities' errors"
                    : "it includes the bound on time-correlated errors and, as mean "
                      "square, an error of any kind that nothing found"),
            {speed_figure("expanded uncertainty", u, std::string(unit.name), rounded_up(u)),
             speed_figure("limit", *context.profile.accuracy_limit_m_s, std::string(unit.name),
                          limit)}};
}

Finding computation::margin(const Clause&, const ClauseContext& context) {
    if (context.record == nullptr)
        return {RequirementStatus::attest, "the attempt names no record to beat"};
    if (!context.speed) return {RequirementStatus::not_met, "there is no certifiable window"};
    const Decision& decision = *context.decision;
    const ShownFigures& shown = *context.shown;
    const bool met = decision.probability >= decision.level;
    const double u = *context.expanded_uncertainty_m_s;
    const double required_u = 2.0 * context.required_speed->standard_uncertainty_m_s;
    Figure speed = speed_figure("measured speed", context.speed->speed_m_s, shown.unit,
                                measured_speed_text(shown, context.coverage_factor));
    speed.expanded_uncertainty = u / metres_per_second(shown.unit);
    Figure required = speed_figure("required speed", context.required_speed->speed_m_s, shown.unit,
                                   fmt::format("{} {}", shown.required_speed, shown.unit));
    required.expanded_uncertainty = required_u / metres_per_second(shown.unit);
    if (required_u > 0.0)
        required.shown += fmt::format(
            " ± {} {} (k = 2)", uncertainty_rounded_up(*required.expanded_uncertainty), shown.unit);
    return {met ? RequirementStatus::met : RequirementStatus::not_met,
            fmt::format("measured speed {}, required {} {}: conformance probability {} (at least "
                        "{} required); acceptance limit {} {}",
                        measured_speed_text(shown), shown.required_speed, shown.unit,
                        probability_text(decision.probability), level_text(decision.level),
                        shown.acceptance_limit, shown.unit),
            {std::move(speed),
             std::move(required),
             {.name = "conformance probability",
              .value = decision.probability,
              .shown = probability_text(decision.probability)}}};
}

Finding computation::georeferenced(const Clause&, const ClauseContext& context) {
    if (context.input.judged.facts.georeferenced)
        return {RequirementStatus::met,
                "WGS 84 positions, taken to a local frame without a grid's scale factor"};
    return {RequirementStatus::attest,
            "the recording holds engineering coordinates, not georeferenced: their unit "
            "must be the true metre on the ground"};
}

Finding computation::secondary_method(const Clause& clause, const ClauseContext& context) {
    const bool declared = context.input.attempt.secondary_method.has_value();
    if (!context.input.secondary && !declared) return by_own_witnesses(clause, context);
    if (!declared) return by_receiver(context);
    Finding finding = by_declaration(context);
    if (!context.input.secondary) return finding;
    Finding other = by_receiver(context);
    finding.observed = other.status == RequirementStatus::met;
    if (finding.status != RequirementStatus::not_met) finding.status = other.status;
    finding.evidence += "; " + other.evidence;
    finding.figures.insert(finding.figures.end(), other.figures.begin(), other.figures.end());
    return finding;
}

Finding computation::attest(const Clause&, const ClauseContext&) {
    return {RequirementStatus::attest, "not decidable from the recording"};
}

Requirement decide_clause(const Clause& clause, const ClauseContext& context) {
    Finding finding = computed(clause, context);
    const std::vector<AttemptInput> stated = inputs_answered_in(clause, context);
    if (finding.status == RequirementStatus::met && !finding.observed && !stated.empty()) {
        finding.status = RequirementStatus::attest;
        finding.evidence += "; it rests on what nobody observed: " + stated_text(stated);
    }
    std::optional<AnsweredBy> answered_by;
    if (finding.status == RequirementStatus::attest)
        answered_by = {.role = clause.answered_by.role, .count = clause.answered_by.count};
    return {.clause = clause.id,
            .status = finding.status,
            .evidence = finding.evidence,
            .text = clause.text,
            .source = clause.source,
            .certainty = clause.certainty,
            .decided_by = clause.decided_by,
            .figures = std::move(finding.figures),
            .answered_by = std::move(answered_by)};
}

}  // namespace runcert
