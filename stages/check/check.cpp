#include "stages/check/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/statistics.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "stages/check/notes.h"
#include "stages/check/requirements.h"
#include "witness/evidence.h"

namespace runcert {
namespace {

using Requirements = std::vector<Requirement>;

/// What a window that cannot be certified shows, where that reaches the required speed; else empty.
std::string shown_though_refused(const ClauseContext& context) {
    const auto& indicated = context.windows.indicated;
    if (!indicated || indicated->refusals.empty() || !context.required_speed) return {};
    const double shown_m_s = indicated->mean_m_s.value_or(indicated->speed_m_s);
    if (shown_m_s < context.required_speed->speed_m_s) return {};
    return fmt::format(
        "The recording shows {}, at or above the required {}. That window cannot be certified "
        "(it holds {}).",
        indicated_text(context),
        speed_of_rule(context, context.required_speed->speed_m_s, SpeedKind::required),
        fmt::join(indicated->refusals, ", "));
}

// What rules a certificate out: each says why it does, or nothing.

/// Unreadable records.
std::string refused_for_records(const ClauseContext& context, const Requirements&) {
    const RecordCount& records = context.input.judged.records;
    if (context.counted.empty()) return {};
    if (100 * records.bad > records.total)
        return fmt::format(
            "{} of {} records of the recording could not be read, more than 1 %: it is damaged, or "
            "was changed.",
            records.bad, records.total);
    for (const FurtherWindow& window : context.counted) {
        const auto [first, last] = std::minmax(window.span.first_epoch, window.span.last_epoch);
        for (const BadRecord& bad : records.bad_records)
            if (bad.epoch >= first && bad.epoch <= last)
                return fmt::format(
                    "A record inside the window could not be read ({}{} {}, after epoch {}): {}.",
                    bad.file ? fmt::format("file {}, ", *bad.file) : "", bad.line ? "line" : "byte",
                    bad.line ? *bad.line : bad.byte, bad.epoch, bad.what);
        if (records.bad > std::ssize(records.bad_records))
            return fmt::format(
                "{} records could not be read, more than are listed, so it is not known whether "
                "one is inside the window.",
                records.bad);
    }
    return {};
}

std::string refused_for_another_speed(const ClauseContext& context, const Requirements&) {
    const auto& velocity = context.input.judged.tests.velocity;
    return velocity && is_another_speed(*velocity) ? another_speed_text(*velocity) : std::string();
}

/// Too many times that contradict the others.
std::string refused_for_times(const ClauseContext& context, const Requirements&) {
    const ReceiverFindings& judged = context.input.judged;
    const std::int64_t left_out = judged.tests.time.left_out;
    const std::int64_t epochs = std::ssize(judged.trajectory);
    const double share = static_cast<double>(left_out) / static_cast<double>(epochs);
    const double share_max = context.input.attempt.parameters.screen.time_share_max;
    if (left_out == 0 || share <= share_max) return {};
    std::string refused = fmt::format(
        "{} of {} epochs were left out for their times alone, more than {:g} % "
        "(screen.time_share_max): which times are right cannot be told.",
        left_out, epochs, 100.0 * share_max);
    // A speed that would reach the record is named elsewhere in any case.
    if (context.windows.indicated && shown_though_refused(context).empty())
        refused += " The recording shows " + indicated_text(context) + ".";
    return refused;
}

/// Recorded velocities that do not belong to these positions, under a rule of them. The absence of
/// windows is a consequence.
std::string refused_for_unfit(const ClauseContext& context, const Requirements& requirements) {
    const auto& velocity = context.input.judged.tests.velocity;
    const auto asked =
        std::ranges::find(requirements, Computation::recorded_speeds, &Requirement::decided_by);
    if (!velocity || !velocity->unfit || asked == requirements.end()) return {};
    return "Not met: " + asked->clause + ": " + asked->evidence + ".";
}

/// A decision of screening that removed too much of the recording.
std::string refused_for_decision(const ClauseContext& context, const Requirements&) {
    const ReceiverFindings& judged = context.input.judged;
    const auto& largest = judged.tests.largest_decision;
    const double share_max = context.input.attempt.parameters.screen.decision_share_max;
    if (!largest || largest->share <= share_max) return {};
    return fmt::format(
        "One decision of screening left out {:.0f} % of all epochs, more than {:.0f} % "
        "(screen.decision_share_max): {}, from epoch {} {} (statistic {:.1f}, threshold {:.1f}).",
        100.0 * largest->share, 100.0 * share_max, words_of(largest->hypothesis),
        largest->first_epoch,
        instant_text(judged.facts.first_epoch, ElapsedTime{std::llround(largest->time_s * 1e9)}),
        largest->statistic, largest->threshold);
}

/// A clause other than the margin that the data decide and that is not met.
std::string refused_for_clause(const ClauseContext&, const Requirements& requirements) {
    for (const Requirement& one : requirements)
        if (one.status == RequirementStatus::not_met && one.decided_by != Computation::margin)
            return "Not met: " + one.clause + ": " + one.evidence;
    return {};
}

std::string refused_for_windows(const ClauseContext& context, const Requirements&) {
    if (!context.windows.best)
        return context.files_attested || context.windows.missing.empty()
                   ? "There is no certifiable window."
                   : capitalised(context.windows.missing) + ".";
    if (context.speed) return {};
    return figure_of(context.windows)
               ? "The rule subtracts the current, which is not known for the window: give "
                 "current: in the attempt, with a series that covers it."
               : "There are too few certifiable windows for the mean that the rule takes.";
}

/// A robust estimate that contradicts a window of the speed, or the lack of one.
std::string refused_for_robust(const ClauseContext& context, const Requirements&) {
    const SpeedUnit& unit = context.unit();
    for (const FurtherWindow& window : context.counted) {
        const auto& robust = window.robust;
        if (robust && !robust->agrees)
            return fmt::format(
                "A robust estimate over the same epochs gives {:+.3f} {} against the screened one, "
                "more than their uncertainty of {:.3f} {}: screening may have kept an outlier or "
                "rejected a right one.",
                robust->difference_m_s * unit.per_m_s, unit.name, robust->limit_m_s * unit.per_m_s,
                unit.name);
        if (!robust && context.input.judged.estimation.robust_unsolved > 0)
            return "The robust estimate, which is the check on screening, did not converge over "
                   "the stretch of this window.";
    }
    return {};
}

/// Witnesses of one window that contradict its positions, or one another.
std::string contradiction_in(const FurtherWindow& window, const SpeedUnit& unit) {
    const auto signed_text = [&](const WitnessedSpeed& one) {
        return fmt::format("{:+.3f} {}", -one.difference_m_s * unit.per_m_s, unit.name);
    };
    const auto one = std::ranges::find_if(window.witnesses, &contradicts);
    if (one == window.witnesses.end()) {
        if (!window.evidence || window.evidence->disagreement <= 1.0) return {};
        std::vector<std::string> differences;
        for (const WitnessedSpeed& each : window.witnesses)
            if (each.confirms)
                differences.push_back(fmt::format("{} {}", witness_name(each), signed_text(each)));
        return fmt::format(
            "The witnesses contradict one another. Against the positions they give {}: together "
            "{:.2f} times as far apart as chance makes them once in a thousand. One of them is "
            "wrong.",
            fmt::join(differences, ", "), window.evidence->disagreement);
    }
    return fmt::format(
        "{} give {} against {} over {}{}, in size or direction more than both uncertainties allow "
        "(normalised error {:.2f}): one of the two is wrong. The displacements differ by {:.3f} "
        "m{}.",
        capitalised(witness_name(*one)), signed_text(*one), compared_with(one->kind), span_of(*one),
        one->compared_over_s ? ", of which they say nothing themselves" : "", one->normalised_error,
        one->apart_m,
        one->apart_azimuth_deg
            ? fmt::format(", towards {:.0f} degrees from north", *one->apart_azimuth_deg)
            : "");
}

std::string refused_for_witnesses(const ClauseContext& context, const Requirements&) {
    for (const FurtherWindow& window : context.counted)
        if (std::string why = contradiction_in(window, context.unit()); !why.empty()) return why;
    return {};
}

std::string refused_for_declared(const ClauseContext& context, const Requirements&) {
    if (!context.declared || !context.declared->contradicts()) return {};
    return capitalised(second_method_text(context)) +
           " That is more than both uncertainties allow: one of the two is wrong.";
}

/// Why nothing can be certified. Empty if something can. Unreadable records cast doubt on every
/// other finding; else the cause of other failures comes first.
std::string refusal_of(const ClauseContext& context, const Requirements& requirements) {
    for (const auto refused_for :
         {refused_for_records, refused_for_another_speed, refused_for_times, refused_for_unfit,
          refused_for_decision, refused_for_clause, refused_for_windows, refused_for_robust,
          refused_for_witnesses, refused_for_declared})
        if (std::string why = refused_for(context, requirements); !why.empty()) return why;
    return {};
}

/// What screening does not find of drifts that are this share of the smallest one that it finds
/// with its power: by the normal distribution of its statistic.
std::string missed_words(double share, double power, double test_size) {
    const auto is_probability = [](double p) { return p > 0.0 && p < 1.0; };
    if (is_probability(test_size) && is_probability(power)) {
        const double threshold = -normal_quantile(0.5 * test_size);
        if (share * (threshold + normal_quantile(power)) < threshold)
            return "screening would miss most drifts that small";
    }
    return fmt::format("screening finds drifts that small with a probability below {:.0f} %",
                       100.0 * power);
}

/// The drift of the positions that would reverse the decision, and how much drift could have gone
/// undetected by a witness, or otherwise by screening.
std::string drift_words(const Decision& decision, const ClauseContext& context) {
    if (!decision.drift_survived_m) return {};
    const CertifiableWindow& best = *context.windows.best;
    const double duration_s = best.span.duration.seconds();
    const std::string span = time_span_text(duration_s);
    // A witness fitted to the positions has their drift, and bounds nothing.
    const WitnessedSpeed* sharpest = nullptr;
    for (const WitnessedSpeed& one : best.witnesses)
        if (one.confirms &&
            (!sharpest || largest_error_given(one) < largest_error_given(*sharpest)))
            sharpest = &one;
    const auto& power = best.detection_power;
    const double found_m = decision.drift_found_m_s.value_or(0.0) * duration_s;
    if (!sharpest && power && *decision.drift_survived_m < found_m)
        return fmt::format(" A drift of {:.2f} m over {} would reverse this outcome; {}.",
                           *decision.drift_survived_m, span,
                           missed_words(*decision.drift_survived_m / found_m, *power,
                                        context.input.judged.tests.test_size));
    std::string also;
    if (sharpest)
        also = fmt::format("; beside the {} their error is at most {:.2f} m (k = 2)",
                           words_of(sharpest->kind), largest_error_given(*sharpest) * duration_s);
    else if (decision.drift_found_m_s && power)
        also = fmt::format(
            "; screening finds a drift of {:.2f} m there with a probability of {:.0f} %", found_m,
            100.0 * *power);
    return fmt::format(" To undo this, the positions would have to drift by {:.2f} m in {}{}.",
                       *decision.drift_survived_m, span, also);
}

/// "1 in 12,000", or "80 %" if not small.
std::string chance_text(double probability) {
    constexpr double not_small = 0.1, hardly_any = 1e-9;
    if (probability > not_small) return fmt::format("{:.0f} %", 100.0 * probability);
    return probability > hardly_any
               ? fmt::format("1 in {}", counted(std::llround(1.0 / probability)))
               : "1 in more than a thousand million";
}

/// How often positions err unseen, what a witness makes of that, and the lowest likely true speed.
std::string fault_words(const ClauseContext& context) {
    const auto& evidence = context.speed->evidence;
    if (!evidence || !(evidence->fault_probability > 0.0) || !(evidence->fault_m_s > 0.0))
        return {};
    const SpeedUnit& unit = context.unit();
    const std::string by_up_to = fmt::format(
        "by up to {} {}", significant_text(evidence->fault_m_s * unit.per_m_s, 2), unit.name);
    constexpr double rare = 0.05;
    std::string words;
    if (!evidence->witnesses.empty())
        words = fmt::format(
            " That the positions drifted in this window has a probability of {} beside the "
            "witnesses.",
            chance_text(fault_posteriors(speeds_of(*evidence, context.speed->speed_m_s)).front()));
    else if (evidence->fault_probability > rare)
        words = fmt::format(
            " Row d says why positions are taken to err in this window with a probability of {}, "
            "{}.",
            chance_text(evidence->fault_probability), by_up_to);
    else
        words = fmt::format(
            " In one window of {} positions are taken to drift unseen, {}; the interval carries "
            "that risk on average and would not hold the speed of such a window.",
            counted(std::llround(1.0 / evidence->fault_probability)), by_up_to);
    const auto& decision = *context.decision;
    return words +
           fmt::format(" With a risk of {} the true speed is below {} {}.",
                       chance_text(*decision.tail_risk),
                       in_decimals_of(*context.shown, *decision.tail_speed_m_s, SafeSide::down),
                       unit.name);
}

/// Whether the fastest window, which proves less, could have reached the required speed.
bool fastest_might_reach(const ClauseContext& context) {
    const auto& fastest = context.windows.fastest;
    return fastest &&
           fastest->speed_m_s + expanded_uncertainty_m_s(*fastest, context.coverage_factor) >=
               context.required_speed->speed_m_s;
}

/// The outcome and its probability, in one sentence.
std::string reason_of(const ClauseContext& context, Outcome outcome) {
    const ShownFigures& shown = *context.shown;
    std::string figures = fmt::format(
        "{}, required {} {}; conformance probability {} (at least {} required).",
        measured_speed_text(shown), shown.required_speed, shown.unit,
        probability_text(context.decision->probability), level_text(context.decision->level));
    const bool alone = !context.observed && context.profile.speed_source == SpeedSource::position;
    const char* const by = context.profile.speed_of == SpeedOf::reference_point
                               ? "By positions and the motion of the antenna on the craft, the"
                               : "By positions alone, the";
    const auto sentence = [&](const char* finding) {
        return fmt::format("{} {}: {}", alone ? by : "The", finding, figures);
    };
    switch (outcome) {
        case Outcome::beaten:
            return sentence(
                       "measured speed exceeds the required speed with the required probability") +
                   drift_words(*context.decision, context) + fault_words(context);
        case Outcome::not_beaten:
            return sentence("measured speed is below the required speed beyond its uncertainty");
        case Outcome::not_proven:
            if (context.decision->by_uncertainty >= context.decision->level)
                return sentence(
                           "measured speed exceeds the required speed beyond its uncertainty, but "
                           "an error that nothing found is too probable") +
                       fault_words(context);
            if (!fastest_might_reach(context))
                return sentence("required speed lies within the uncertainty of the measured speed");
            return sentence(
                std::ranges::any_of(context.windows.fastest->witnesses, &contradicts)
                    ? "window of the best proof is below the required speed, but a faster one, "
                      "which a witness contradicts, may reach it"
                    : "window of the best proof is below the required speed, but a faster one, "
                      "which proves less, may reach it");
        case Outcome::not_certifiable:
            break;
    }
    return figures;
}

void set_outcome(const ClauseContext& context, ProfileVerdict& verdict) {
    const std::string shown = shown_though_refused(context);
    if (const std::string refused = refusal_of(context, verdict.requirements); !refused.empty()) {
        verdict.outcome = Outcome::not_certifiable;
        verdict.reason = refused;
        if (!shown.empty()) verdict.reason += (refused.ends_with('.') ? " " : ". ") + shown;
    } else if (!context.decision) {
        verdict.outcome = Outcome::not_proven;
        verdict.reason = "The attempt names no record to beat.";
    } else {
        Outcome outcome = decide(*context.speed, *context.required_speed, context.decision->level);
        if (outcome == Outcome::not_beaten && fastest_might_reach(context))
            outcome = Outcome::not_proven;
        // A speed below the required one proves nothing if the recording shows more.
        if (outcome == Outcome::not_beaten && !shown.empty()) {
            verdict.outcome = Outcome::not_certifiable;
            verdict.reason = fmt::format(
                "{} The fastest certifiable window, {}, does not show that the record was not "
                "beaten.",
                shown, measured_speed_text(*context.shown));
            return;
        }
        verdict.outcome = outcome;
        verdict.reason = reason_of(context, outcome);
        if (outcome == Outcome::not_proven && !shown.empty()) verdict.reason += " " + shown;
        verdict.decision->risk = decision_risk(*context.speed, *context.required_speed, outcome);
    }
}

RecordToBeat record_to_beat(const Record& record) {
    RecordToBeat result{.speed = record.speed,
                        .unit = record.unit,
                        .source = record.source,
                        .speed_m_s = record.speed * metres_per_second(record.unit)};
    if (record.expanded_uncertainty > 0.0)
        result.expanded_uncertainty = record.expanded_uncertainty;
    return result;
}

/// The smallest drift (m/s) of the positions over the window that their tests would have detected
/// with the stated power. Empty if a witness was evaluated, or the rule uses recorded
/// velocities.
std::optional<double> unseen_drift_m_s(const ClauseContext& context) {
    if (context.observed || context.profile.speed_source != SpeedSource::position ||
        !context.windows.best)
        return std::nullopt;
    const auto& all = context.windows.best->reliability;
    const auto ramp = std::ranges::find(all, Hypothesis::ramp, &UndetectedError::hypothesis);
    if (ramp == all.end() || ramp->size <= 0.0) return std::nullopt;
    return ramp->size;
}

void set_figures(const ClauseContext& context, ProfileVerdict& verdict) {
    verdict.coverage_factor = context.coverage_factor;
    verdict.expanded_uncertainty_m_s = context.expanded_uncertainty_m_s;
    if (context.speed) verdict.speed_m_s = context.speed->speed_m_s;
    if (context.required_speed) verdict.required_speed_m_s = context.required_speed->speed_m_s;
    if (context.windows.best) verdict.window = context.windows.best->span;
    if (context.record != nullptr) verdict.record = record_to_beat(*context.record);
    if (context.profile.current == CurrentUse::subtracted && context.speed)
        verdict.current_subtracted_m_s = context.current->along_m_s;
    verdict.decision = context.decision;
    verdict.witnesses = context.witnesses;
    verdict.unseen_drift_m_s = unseen_drift_m_s(context);
    verdict.shown = context.shown;
    verdict.own_arithmetic = own_arithmetic(context);
    verdict.notes = notes_of(context);
    verdict.course = course_figures(context);
    verdict.runs = run_summaries(context);
    for (const FigureOverride& one : context.profile.overrides)
        verdict.overrides.push_back({.figure = one.figure,
                                     .rule = one.rule,
                                     .used = one.used,
                                     .unit = one.unit,
                                     .reason = one.reason});
    if (const auto& indicated = context.windows.indicated;
        indicated && !indicated->refusals.empty())
        verdict.indicated = RefusedWindow{.span = indicated->span,
                                          .speed_m_s = indicated->speed_m_s,
                                          .refusals = indicated->refusals};
}

ProfileVerdict judge(const CheckInput& input, const Profile& profile, const ProfileWindows& windows,
                     bool files_attested) {
    const ClauseContext context = gather_context(input, profile, windows, files_attested);
    ProfileVerdict verdict;
    verdict.profile = profile.id;
    verdict.rule = {
        .revision = profile.revision, .sha256 = profile.sha256, .origin = profile.origin};
    verdict.body = profile.body;
    verdict.title = profile.title;
    verdict.definition = profile.definition;
    for (const Clause& clause : clauses_asked(profile, input.attempt))
        verdict.requirements.push_back(decide_clause(clause, context));
    std::int64_t signatures = 0;
    for (const RoleSignatures& role : combined(profile.signatures, input.attempt.signatures))
        signatures += role.count;
    verdict.standing = standing_of(verdict.requirements, signatures);
    set_figures(context, verdict);
    set_outcome(context, verdict);
    return verdict;
}

/// The clauses in which officials answer for the second files of an attempt: what was handed in,
/// but for what the positions are computed with, and a current, which its rule alone counts.
std::vector<std::string> second_files(const Attempt& attempt) {
    std::vector<std::string> files;
    for (const AttemptInput& input : attempt.inputs)
        if (const std::string& clause = input.origin.clause;
            input.origin.origin == to_text(InputOrigin::handed_in) && !clause.empty() &&
            clause != "base-station" && clause != "current-as-measured" &&
            std::ranges::count(files, clause) == 0)
            files.push_back(clause);
    return files;
}

std::string second_files_text(const std::vector<std::string>& files, const ProfileVerdict& other,
                              bool answered) {
    return fmt::format(
        "{} ({}). {} them: {}{}.",
        answered ? "Officials have answered for the second files, which therefore count"
                 : "Second files can only contradict until officials have answered for them",
        fmt::join(files, ", "), answered ? "Without" : "With",
        other.shown ? measured_speed_text(*other.shown) + "; " : "", words_of(other.outcome));
}

/// Gives the verdicts with second files beside those without. Files that contradict one another
/// need no answer.
void add_verdicts_with_files(const CheckInput& input, Verdict& verdict) {
    const Windows& windows = input.judged.windows;
    bool differ = false;
    for (std::size_t i = 0; i < input.profiles.size(); ++i) {
        const Profile& profile = input.profiles[i];
        ProfileVerdict& without = verdict.profiles[i];
        ProfileVerdict& with = verdict.with_files.emplace_back(
            judge(input, profile, windows_of(windows, profile, true), true));
        if (with.outcome == Outcome::not_certifiable) {
            without.outcome = with.outcome;
            without.reason = with.reason;
        }
        if (with.outcome == without.outcome && with.speed_m_s == without.speed_m_s &&
            with.expanded_uncertainty_m_s == without.expanded_uncertainty_m_s &&
            std::ranges::equal(with.requirements, without.requirements, {}, &Requirement::status,
                               &Requirement::status))
            continue;
        differ = true;
        without.second_files = second_files_text(verdict.second_files, with, false);
        with.second_files = second_files_text(verdict.second_files, without, true);
        for (ProfileVerdict* const one : {&without, &with})
            one->notes.insert(one->notes.begin(), one->second_files);
    }
    if (differ) return;
    verdict.with_files.clear();
    verdict.second_files.clear();
}

/// Keeps the row where the window holds it. The rows are in order of time, which need not be that
/// of their numbers.
void keep_inside(const WindowSpan& window, const ScreenedEpoch& row,
                 std::vector<ScreenedEpoch>& epochs) {
    const bool begins = row.epoch == window.first_epoch;
    const bool inside = !epochs.empty() && epochs.back().epoch != window.last_epoch;
    if (begins || inside) epochs.push_back(row);
}

}  // namespace

void ScreenedSelection::add(const ScreenedEpoch& row, const Windows& windows) {
    screening.add(row);
    const auto keep = [&](const ProfileWindows& entry, const std::string& key) {
        if (!entry.best) return;
        keep_inside(entry.best->span, row, window_epochs[key]);
        auto& others = further_epochs[key];
        others.resize(entry.further.size());
        for (std::size_t i = 0; i < others.size(); ++i)
            keep_inside(entry.further[i].span, row, others[i]);
    };
    for (const ProfileWindows& entry : windows.profiles)
        keep(entry, entry.profile);
    for (const ProfileWindows& entry : windows.with_files)
        keep(entry, key_with_files(entry.profile));
}

Verdict check(const CheckInput& input) {
    Verdict verdict;
    verdict.attempt = input.attempt.id;
    verdict.receiver = input.judged.receiver;
    verdict.georeferenced = input.judged.facts.georeferenced;
    if (input.attempt.record) verdict.record = record_to_beat(*input.attempt.record);
    verdict.origins = verdict_inputs(input);
    verdict.statements = statements_of(input);
    verdict.second_files = second_files(input.attempt);
    for (const Profile& profile : input.profiles)
        verdict.profiles.push_back(judge(input, profile, windows_of(input.judged.windows, profile),
                                         verdict.second_files.empty()));
    if (!verdict.second_files.empty()) add_verdicts_with_files(input, verdict);
    if (std::string compared = compared_rules(input.profiles, verdict.profiles); !compared.empty())
        verdict.statements.push_back(std::move(compared));
    return verdict;
}

}  // namespace runcert
