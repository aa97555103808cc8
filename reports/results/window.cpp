#include <fmt/format.h>

#include <algorithm>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

std::string dimension_words(const Profile& profile) {
    if (profile.dimension == Dimension::horizontal) return "Speed";
    return capitalised(words_of(profile.dimension));
}

/// How many windows make the figure.
std::string count_words(const Profile& profile) {
    if (profile.opposite_runs_within_s)
        return fmt::format(", the mean of two runs in opposite directions within {:g} s",
                           *profile.opposite_runs_within_s);
    if (profile.windows == 1) return "";
    return fmt::format(", the mean of the {} fastest windows that do not overlap", profile.windows);
}

std::string ends_words(const Profile& profile) {
    if (profile.window_kind == WindowKind::course || profile.speed_source == SpeedSource::velocity)
        return "";
    if (profile.ends == WindowEnds::any) return " A window may begin and end at any instant.";
    return profile.exact_duration ? " A window's ends are measured epochs exactly that far apart."
                                  : "";
}

void add_best_facts(Block& list, const RuleView& rule) {
    const CertifiableWindow& best = *rule.best();
    add_fact(list, "Distance between its ends", format_fixed(best.displacement_m, 3) + " m");
    add_fact(list, "Position at its ends, 95 % radius",
             format_fixed(best.position_r95_m, 3) + " m");
    add_fact(list, "Windows compared", counted(rule.windows->candidates));
    if (best.length_m)
        add_fact(list, "Length that the speed is of", format_fixed(*best.length_m, 3) + " m");
}

/// The rule's speed where it is none of the four definitions; empty where it is one.
std::string other_definition(const Profile& profile) {
    if (profile.window_kind == WindowKind::course) return "Over the course";
    if (profile.speed_source == SpeedSource::velocity)
        return fmt::format("Recorded velocities, {}", words_of(profile.definition));
    return {};
}

std::string definition_note(const RuleView& rule) {
    if (rule.profile.window_kind == WindowKind::course)
        return "None of the four definitions is the rule's: its speed is over the course, the "
               "surveyed length over the time between the lines. They are of the smoothed "
               "trajectory.";
    if (rule.profile.speed_source == SpeedSource::velocity)
        return "None of the four definitions is the rule's: its speed is of the velocities that "
               "the recording states. They are of the smoothed trajectory.";
    const CertifiableWindow& best = *rule.best();
    if (best.estimates && best.selection &&
        best.selection->treatment == SelectionTreatment::subtracted)
        return "These figures are of the smoothed trajectory. The measured speed is the rule's, "
               "less what choosing the fastest window makes it look higher by.";
    return {};
}

void add_definitions(std::vector<Block>& blocks, const RuleView& rule) {
    const CertifiableWindow& best = *rule.best();
    std::vector<SpeedRow> rows;
    const std::string other = other_definition(rule.profile);
    if (!other.empty())
        rows.push_back({other + " – the rule's", best.speed_m_s, SpeedKind::measured, true});
    for (const SpeedDefinition name : {SpeedDefinition::displacement, SpeedDefinition::path_length,
                                       SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
        const bool counts = other.empty() && name == rule.profile.definition;
        rows.push_back({capitalised(words_of(name)) + (counts ? " – the rule's" : ""),
                        speed_by(best.definitions, name), SpeedKind::measured, counts});
    }
    if (!best.fitted)
        rows.push_back(
            {"Standard uncertainty", best.standard_uncertainty_m_s, SpeedKind::uncertainty});
    blocks.push_back(speed_table("By definition of speed", rows, rule));
    if (std::string note = definition_note(rule); !note.empty())
        blocks.push_back(paragraph(std::move(note), "note"));
    blocks.push_back(speed_table("Mean over the window, by method",
                                 {{"Smoother, forward and backward", best.methods.smoothed_m_s},
                                  {"Batch least squares", best.methods.batch_m_s},
                                  {"Method v1 of [DHD22]: central difference", best.methods.v1_m_s},
                                  {"Method v2 of [DHD22]: path length", best.methods.v2_m_s},
                                  {"Forward filter of [DHD22]", best.methods.kalman_m_s}},
                                 rule));
}

std::string window_label(const WindowSpan& span) {
    return fmt::format("{} from {}", seconds_text(span.duration), seconds_text(span.start));
}

/// The windows that make the figure together with the best one.
void add_further(std::vector<Block>& blocks, const RuleView& rule) {
    const ProfileWindows& windows = *rule.windows;
    if (windows.further.empty()) return;
    const CertifiableWindow& best = *rule.best();
    std::vector<SpeedRow> rows{{window_label(best.span), best.speed_m_s}};
    for (const FurtherWindow& further : windows.further)
        rows.push_back({window_label(further.span), further.speed_m_s});
    if (const auto figure = figure_of(windows))
        rows.push_back({fmt::format("Mean of the {}", rows.size()), figure->speed_m_s,
                        SpeedKind::measured, true});
    blocks.push_back(speed_table("Windows that make the figure", rows, rule));
}

/// The speeds of antenna and reference point, where an IMU tells both.
void add_points(std::vector<Block>& blocks, const RuleView& rule) {
    const CraftSpeeds& points = rule.best()->points;
    if (!points.antenna_speed_m_s) return;
    const bool of_craft = rule.profile.speed_of == SpeedOf::reference_point;
    const auto label = [](const char* point, bool counts) {
        return fmt::format("{}{}", point, counts ? " – the rule's" : "");
    };
    blocks.push_back(
        speed_table("At two points of the craft",
                    {{label("The antenna", !of_craft), *points.antenna_speed_m_s,
                      SpeedKind::measured, !of_craft},
                     {label("The craft's reference point", of_craft),
                      points.reference_point_speed_m_s, SpeedKind::measured, of_craft},
                     {"Expanded uncertainty of the latter (k = 2)",
                      points.reference_point_expanded_uncertainty_m_s, SpeedKind::uncertainty}},
                    rule));
    if (!points.reference_point_speed_m_s)
        blocks.push_back(
            paragraph("The craft's own speed is not known: IMU and positions do not "
                      "agree, or only one of the two covers the window.",
                      "note"));
}

}  // namespace

std::string rule_words(const Profile& profile) {
    const bool recorded = profile.speed_source == SpeedSource::velocity;
    return fmt::format(
        "{}{} over {}{}, by the definition: {}{}.{}{}", dimension_words(profile),
        profile.speed_of ? fmt::format(" of {}", words_of(*profile.speed_of)) : "",
        window_words(profile), count_words(profile), capitalised(words_of(profile.definition)),
        recorded ? ", from the velocities that the recording states" : "", ends_words(profile),
        profile.current == CurrentUse::subtracted
            ? " The current's component along the course is subtracted."
            : "");
}

Block span_facts(const WindowSpan& span) {
    Block list = facts({});
    const ElapsedTime end{span.start.nanoseconds + span.duration.nanoseconds};
    if (span.start_gps) {
        const GpsTime last = span.start_gps->plus_nanoseconds(span.duration.nanoseconds);
        add_fact(list, "UTC", fmt::format("{} to {}", utc_text(*span.start_gps), utc_text(last)));
        add_fact(list, "GPS time",
                 fmt::format("{} to {}", gps_text(*span.start_gps), gps_text(last)));
    } else {
        add_fact(list, "UTC", "not known: the recording's time is relative");
    }
    add_fact(list, "Length", seconds_text(span.duration));
    add_fact(list, "From the first epoch",
             fmt::format("{} to {}", seconds_text(span.start), seconds_text(end)));
    add_fact(list, "Epochs", fmt::format("{} to {}", span.first_epoch, span.last_epoch));
    return list;
}

Block result_table(const RuleView& rule) {
    const ProfileVerdict& verdict = rule.verdict;
    const auto& uncertainty = verdict.expanded_uncertainty_m_s;
    std::optional<double> acceptance;
    if (verdict.decision) acceptance = verdict.decision->acceptance_limit_m_s;
    return speed_table(
        "Result",
        {{"Measured speed", verdict.speed_m_s, SpeedKind::measured, true},
         {fmt::format("Expanded uncertainty (k = {})", coverage_text(verdict.coverage_factor)),
          uncertainty, SpeedKind::uncertainty},
         {"Acceptance limit", acceptance, SpeedKind::limit},
         {"Required speed", verdict.required_speed_m_s, SpeedKind::required}},
        rule);
}

std::vector<Block> points_and_further_blocks(const RuleView& rule) {
    std::vector<Block> blocks;
    add_points(blocks, rule);
    add_further(blocks, rule);
    return blocks;
}

std::vector<Block> window_blocks(const RuleView& rule, const WindowSpan& span) {
    std::vector<Block> blocks{span_facts(span)};
    if (rule.best() == nullptr) return blocks;
    add_best_facts(blocks.back(), rule);
    add_definitions(blocks, rule);
    add(blocks, points_and_further_blocks(rule));
    return blocks;
}

std::vector<Block> refused_blocks(const RuleView& rule) {
    const auto& indicated = rule.verdict.indicated;
    if (!indicated) return {};
    return {
        heading(rule.titled("Fastest window of the raw positions, refused")),
        paragraph(fmt::format("The raw positions show {} in this window. It is not certified:",
                              speed_beside(rule.verdict, indicated->speed_m_s, rule.unit().name))),
        list_of(indicated->refusals), span_facts(indicated->span)};
}

}  // namespace runcert
