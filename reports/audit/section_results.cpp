#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "core/rounding.h"
#include "core/text.h"
#include "reports/audit/sections.h"
#include "reports/run_speeds/run_speeds.h"

namespace runcert {
namespace {

/// The speeds by each method at the window's epochs, as [DHD22] prints them; no block where none of
/// them has all.
std::vector<Block> method_blocks(const TrajectoryTable& trajectory, const WindowSpan& span,
                                 const SpeedUnit& unit) {
    const auto methods = method_speeds(trajectory, span.first_epoch, span.last_epoch);
    if (methods.empty()) return {};
    Block speeds = table({"method", fmt::format(">mean, {}", unit.name), ">s", ">95 % interval"},
                         fmt::format("Horizontal speeds at the {} epochs of the window, by method: "
                                     "mean, standard deviation s of one speed, and the interval of "
                                     "1.96 s, as [DHD22] prints them. The interval is not the "
                                     "uncertainty of the mean, which the budget has",
                                     methods.front().epochs));
    for (const MethodSpeeds& one : methods) {
        const int decimals = uncertainty_decimals(one.standard_deviation_m_s * unit.per_m_s);
        const auto shown = [&](double speed_m_s) {
            return format_fixed(speed_m_s * unit.per_m_s, decimals);
        };
        add_row(speeds,
                {std::string(one.method), shown(one.mean_m_s), shown(one.standard_deviation_m_s),
                 fmt::format("{} to {}", shown(one.mean_m_s - one.half_width_m_s()),
                             shown(one.mean_m_s + one.half_width_m_s()))});
    }
    return {std::move(speeds)};
}

/// What was found by a rule, in these windows; nothing where the folder lacks the rule's text.
std::optional<RuleView> rule_view(const RunRecord& record, const std::string& profile,
                                  const ProfileWindows* windows) {
    static const ProfileVerdict none;
    const auto rule = std::ranges::find(record.profiles, profile, &Profile::id);
    if (rule == record.profiles.end()) return std::nullopt;
    const auto& verdicts = record.verdict.profiles;
    const auto verdict = std::ranges::find(verdicts, profile, &ProfileVerdict::profile);
    return RuleView{record.attempt, verdict == verdicts.end() ? none : *verdict, *rule, windows};
}

Block rule_is_missing(const std::string& profile) {
    return paragraph(fmt::format(
        "The text of the rule {} is MISSING from the folder: what was found by it is not shown.",
        profile));
}

std::string indicated_text(const IndicatedWindow& indicated, const RuleView& rule) {
    return fmt::format("{} from {} on: {}",
                       speed_beside(rule.verdict, indicated.speed_m_s, rule.unit().name),
                       seconds_text(indicated.span.start),
                       indicated.refusals.empty()
                           ? "certifiable"
                           : fmt::format("REFUSED: {}", fmt::join(indicated.refusals, "; ")));
}

/// A course by its definitions, and what they differ by.
Block course_facts(const std::string& name, const CourseDirections& course) {
    const auto degrees = [](double angle) { return format_fixed(angle, 4); };
    std::string text = fmt::format(
        "{}° along the loxodrome; {}° along the geodesic at its beginning, {}° at its end; {}° in "
        "the plane",
        degrees(course.loxodrome_deg), degrees(course.geodesic_deg),
        degrees(course.geodesic_end_deg), degrees(course.plane_deg));
    if (course.heading_deg)
        text +=
            fmt::format("; mean heading of the craft {}°", format_fixed(*course.heading_deg, 2));
    const double difference_deg = std::remainder(course.loxodrome_deg - course.geodesic_deg, 360.0);
    text += fmt::format(". Loxodrome less geodesic: {}°", degrees(difference_deg));
    return facts({{name, text}});
}

std::vector<Block> rule_windows(const RunRecord& record, const ReceiverResults& one,
                                const ProfileWindows& windows) {
    std::vector<Block> blocks{heading("Rule " + windows.profile)};
    const auto rule = rule_view(record, windows.profile, &windows);
    if (!rule) return {blocks.front(), rule_is_missing(windows.profile)};
    Block block = facts({{"Looked for", rule_words(rule->profile)}});
    if (windows.indicated)
        add_fact(block, "Fastest raw window", indicated_text(*windows.indicated, *rule));
    if (!rule->best()) {
        add_fact(block, "Windows compared", counted(windows.candidates));
        add_fact(block, "Certified",
                 windows.missing.empty()
                     ? "none: breaks and epochs left out leave no stretch long enough"
                     : "none: " + windows.missing);
    }
    blocks.push_back(std::move(block));
    if (!rule->best()) return blocks;
    add(blocks, window_blocks(*rule, rule->best()->span));
    if (const auto& course = rule->best()->course)
        blocks.push_back(course_facts("Course of the window", *course));
    add(blocks, witness_blocks({*rule}));
    add(blocks, uncertainty_blocks(*rule));
    if (is_there(one.trajectory.header))
        add(blocks, method_blocks(one.trajectory, rule->best()->span, rule->unit()));
    return blocks;
}

std::vector<Block> rule_verdict(const RunRecord& record, const ProfileVerdict& verdict) {
    std::vector<Block> blocks{
        heading(fmt::format("Rule {}: {}, {}", verdict.profile, verdict.title, verdict.body))};
    const auto rule = rule_view(record, verdict.profile, nullptr);
    if (!rule) return {blocks.front(), rule_is_missing(verdict.profile)};
    blocks.push_back(outcome_facts(verdict));
    add_fact(blocks.back(), "SHA-256 of its text", verdict.rule.sha256);
    add(blocks, verdict_blocks(*rule, Level::page, Level::record));
    blocks.push_back(requirement_rows(verdict, Level::record));
    if (verdict.window) blocks.push_back(span_facts(*verdict.window));
    if (verdict.speed_m_s) blocks.push_back(result_table(*rule));
    add(blocks, refused_blocks(*rule));
    add(blocks, course_blocks({*rule}));
    return blocks;
}

/// Where the craft stood, and what its positions moved there.
Block stand_table(const std::vector<Stand>& stands) {
    Block table_of_stands =
        table({">From, s", ">To, s", "Shown by", ">Moved in 3 s, mm", ">By what is stated, mm"},
              "Where the craft stood");
    const auto millimetres = [](const std::optional<double>& length_m) {
        return length_m ? format_fixed(1e3 * *length_m, 1) : std::string();
    };
    for (const Stand& stand : stands)
        add_row(table_of_stands, {format_fixed(stand.from_s, 1), format_fixed(stand.to_s, 1),
                                  std::string(words_of(stand.shown_by)), millimetres(stand.moved_m),
                                  millimetres(stand.stated_m)});
    return table_of_stands;
}

}  // namespace

ProductPart trajectory_part(const RunRecord& record, const ReceiverResults& one, Level level) {
    const TrajectoryTable& table = one.trajectory;
    const auto smoothed = std::ranges::count_if(
        table.rows, [](const TrajectoryEpoch& row) { return row.speed_m_s.has_value(); });
    std::vector<Block> blocks = parameter_blocks(record.attempt, {&table.header}, level);
    add(blocks, estimation_blocks(table.estimation));
    return {fmt::format("{}, {} with a smoothed speed", counted(std::ssize(table.rows), "epoch"),
                        counted(smoothed)),
            std::move(blocks)};
}

ProductPart attitude_part(const RunRecord& /*record*/, const ReceiverResults& one,
                          Level /*level*/) {
    return {counted(one.attitude->consistency.epochs, "position") + " took part",
            attitude_facts(*one.attitude)};
}

ProductPart windows_part(const RunRecord& record, const ReceiverResults& one, Level level) {
    const Windows& windows = one.windows;
    std::vector<Block> blocks = parameter_blocks(record.attempt, {&windows.header}, level);
    if (!windows.witness_notes.empty()) blocks.push_back(list_of(windows.witness_notes));
    if (!windows.stands.empty()) blocks.push_back(stand_table(windows.stands));
    if (windows.course) blocks.push_back(course_facts("Course of the run", *windows.course));
    for (const ProfileWindows& each : windows.profiles)
        add(blocks, rule_windows(record, one, each));
    return {counted(std::ssize(windows.profiles), "rule"), std::move(blocks)};
}

ProductPart verdict_part(const RunRecord& record, const ReceiverResults& /*one*/, Level level) {
    const Verdict& verdict = record.verdict;
    std::vector<Block> blocks = parameter_blocks(record.attempt, {&verdict.header}, level);
    for (const ProfileVerdict& each : verdict.profiles)
        add(blocks, rule_verdict(record, each));
    if (!verdict.statements.empty())
        blocks.push_back(titled_list("What holds for the whole measurement", verdict.statements));
    return {counted(std::ssize(verdict.profiles), "verdict") + ", of receiver " + verdict.receiver,
            std::move(blocks)};
}

}  // namespace runcert
