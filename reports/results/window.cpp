#include <fmt/format.h>

#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

constexpr SpeedDefinition definitions[] = {SpeedDefinition::displacement,
                                           SpeedDefinition::path_length,
                                           SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n};

/// One speed, to be shown in every unit.
struct SpeedRow {
    std::string label;
    std::optional<double> speed_m_s;
    SpeedKind kind = SpeedKind::measured;
    bool counts = false;  ///< the one that the rule counts
};

/// A measured speed, named as the rule's where it is.
SpeedRow measured(const std::string& label, std::optional<double> speed_m_s, bool counts) {
    return {label + (counts ? " – the rule's" : ""), speed_m_s, SpeedKind::measured, counts};
}

/// Rows of one speed each, in every unit, the rule's own first, with the decimals of the figures on
/// the first page. Rows without a speed are left out.
Block speed_table(const std::string& title, const std::vector<SpeedRow>& rows,
                  const RuleView& rule) {
    std::vector<const SpeedUnit*> units{&rule.unit()};
    for (const SpeedUnit& unit : speed_units())
        if (unit.name != rule.unit().name) units.push_back(&unit);
    std::vector<std::string> heads{""};
    for (const SpeedUnit* unit : units)
        heads.push_back(fmt::format(">{}|14", unit->name));
    Block block = table(heads, title);
    const ShownFigures shown = rule.shown();
    for (const SpeedRow& row : rows) {
        if (!row.speed_m_s) continue;
        std::vector<std::string> cells{row.label};
        for (const SpeedUnit* unit : units)
            cells.push_back(shown_speed(row.kind, *row.speed_m_s, shown, *unit));
        add_row(block, std::move(cells), row.counts ? "chosen" : "");
    }
    return block;
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

/// The rule's speed where it is none of the four definitions, and what it is of; else empty.
std::pair<std::string, std::string> other_definition(const Profile& profile) {
    if (profile.window_kind == WindowKind::course)
        return {"Over the course",
                "over the course, the surveyed length over the time between the lines"};
    if (profile.speed_source == SpeedSource::velocity)
        return {fmt::format("Recorded velocities, {}", words_of(profile.definition)),
                "of the velocities that the recording states"};
    return {};
}

void add_definitions(std::vector<Block>& blocks, const RuleView& rule) {
    const CertifiableWindow& best = *rule.best();
    std::vector<SpeedRow> rows;
    const auto [other, of] = other_definition(rule.profile);
    if (!other.empty()) rows.push_back(measured(other, best.speed_m_s, true));
    for (const SpeedDefinition name : definitions)
        rows.push_back(measured(capitalised(words_of(name)), speed_by(best.definitions, name),
                                other.empty() && name == rule.profile.definition));
    if (!best.fitted)
        rows.push_back(
            {"Standard uncertainty", best.standard_uncertainty_m_s, SpeedKind::uncertainty});
    blocks.push_back(speed_table("By definition of speed", rows, rule));
    if (!other.empty())
        blocks.push_back(paragraph(
            fmt::format("None of the four definitions is the rule's: its speed is {}. They are of "
                        "the smoothed trajectory.",
                        of),
            "note"));
    else if (best.estimates && best.selection &&
             best.selection->treatment == SelectionTreatment::subtracted)
        blocks.push_back(
            paragraph("These figures are of the smoothed trajectory. The measured speed is the "
                      "rule's, less what choosing the fastest window makes it look higher by.",
                      "note"));
    blocks.push_back(speed_table("Mean over the window, by method",
                                 {{"Smoother, forward and backward", best.methods.smoothed_m_s},
                                  {"Batch least squares", best.methods.batch_m_s},
                                  {"Method v1 of [DHD22]: central difference", best.methods.v1_m_s},
                                  {"Method v2 of [DHD22]: path length", best.methods.v2_m_s},
                                  {"Forward filter of [DHD22]", best.methods.kalman_m_s}},
                                 rule));
}

/// Speeds of antenna and reference point, where an IMU tells both; the windows that make the figure
/// together, where it is of several.
std::vector<Block> points_and_further_blocks(const RuleView& rule) {
    std::vector<Block> blocks;
    const CertifiableWindow& best = *rule.best();
    if (const CraftSpeeds& points = best.points; points.antenna_speed_m_s) {
        const bool of_craft = rule.profile.speed_of == SpeedOf::reference_point;
        blocks.push_back(speed_table(
            "At two points of the craft",
            {measured("The antenna", points.antenna_speed_m_s, !of_craft),
             measured("The craft's reference point", points.reference_point_speed_m_s, of_craft),
             {"Expanded uncertainty of the latter (k = 2)",
              points.reference_point_expanded_uncertainty_m_s, SpeedKind::uncertainty}},
            rule));
        if (!points.reference_point_speed_m_s)
            blocks.push_back(
                paragraph("The craft's own speed is not known: IMU and positions do not agree, or "
                          "only one of the two covers the window.",
                          "note"));
    }
    if (rule.windows->further.empty()) return blocks;
    const auto label = [](const WindowSpan& span) {
        return fmt::format("{} from {}", seconds_text(span.duration), seconds_text(span.start));
    };
    std::vector<SpeedRow> rows{{label(best.span), best.speed_m_s}};
    for (const FurtherWindow& further : rule.windows->further)
        rows.push_back({label(further.span), further.speed_m_s});
    if (const auto figure = figure_of(*rule.windows))
        rows.push_back({fmt::format("Mean of the {}", rows.size()), figure->speed_m_s,
                        SpeedKind::measured, true});
    blocks.push_back(speed_table("Windows that make the figure", rows, rule));
    return blocks;
}

}  // namespace

const SpeedUnit& RuleView::unit() const {
    return speed_unit(verdict.shown ? verdict.shown->unit : rule_unit_name(profile));
}

const CertifiableWindow* RuleView::best() const {
    return windows != nullptr && windows->best ? &*windows->best : nullptr;
}

std::string RuleView::titled(const std::string& title) const {
    return several ? fmt::format("{}: rule “{}”", title, verdict.profile) : title;
}

std::string RuleView::uncertainty_text(double uncertainty_m_s) const {
    return fmt::format("{} {}", runcert::uncertainty_text(uncertainty_m_s * unit().per_m_s),
                       unit().name);
}

ShownFigures RuleView::shown() const {
    if (verdict.speed_m_s) return shown_of(verdict, unit().name);
    if (best() != nullptr)
        return shown_in({.speed_m_s = best()->speed_m_s,
                         .expanded_uncertainty_m_s =
                             expanded_uncertainty_m_s(*best(), verdict.coverage_factor)},
                        unit());
    ShownFigures figures{.unit = std::string(unit().name)};
    const auto& rounding = profile.result ? profile.result : profile.rounding;
    if (verdict.required_speed_m_s)
        figures.required_speed =
            shown_speed(SpeedKind::required, *verdict.required_speed_m_s,
                        rounding ? static_cast<int>(rounding->decimals) : unit().decimals, unit());
    return figures;
}

std::string rule_words(const Profile& profile) {
    const bool recorded = profile.speed_source == SpeedSource::velocity;
    return fmt::format(
        "{}{} over {}{}, by the definition: {}{}.{}{}",
        profile.dimension == Dimension::horizontal ? "Speed"
                                                   : capitalised(words_of(profile.dimension)),
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
    if (const auto& start = span.start_gps) {
        const GpsTime last = start->plus_nanoseconds(span.duration.nanoseconds);
        add_fact(list, "UTC", fmt::format("{} to {}", utc_text(*start), utc_text(last)));
        add_fact(list, "GPS time", fmt::format("{} to {}", gps_text(*start), gps_text(last)));
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
    std::vector<SpeedRow> rows{
        {"Measured speed", verdict.speed_m_s, SpeedKind::measured, true},
        {fmt::format("Expanded uncertainty (k = {})", coverage_text(verdict.coverage_factor)),
         verdict.expanded_uncertainty_m_s, SpeedKind::uncertainty}};
    if (verdict.decision)
        rows.push_back(
            {"Acceptance limit", verdict.decision->acceptance_limit_m_s, SpeedKind::limit});
    rows.push_back({"Required speed", verdict.required_speed_m_s, SpeedKind::required});
    return speed_table("Result", rows, rule);
}

std::vector<Block> window_blocks(const RuleView& rule, const WindowSpan& span) {
    std::vector<Block> blocks{span_facts(span)};
    if (rule.best() == nullptr) return blocks;
    const CertifiableWindow& best = *rule.best();
    Block& list = blocks.back();
    add_fact(list, "Distance between its ends", format_fixed(best.displacement_m, 3) + " m");
    add_fact(list, "Position at its ends, 95 % radius",
             format_fixed(best.position_r95_m, 3) + " m");
    add_fact(list, "Windows compared", counted(rule.windows->candidates));
    if (best.length_m)
        add_fact(list, "Length that the speed is of", format_fixed(*best.length_m, 3) + " m");
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

std::vector<Block> windows_of_all(const std::vector<RuleView>& rules) {
    Block spans = table({"Rule|26", "Begins (UTC, or from the first epoch)|27", ">Length|13",
                         ">Ends apart|13", ">95 % radius|10", ">Compared|11"},
                        "Windows", "small");
    Block speeds = table({"Rule|26", "Unit|8", ">The rule's|14", ">Displacement|14",
                          ">Path length|13", ">Mean, both ends|13", ">Mean after the first|12"},
                         "Speed by each definition", "small");
    Block own = facts({}, "By each rule's own arithmetic", "narrow");
    std::vector<Block> further;
    for (const RuleView& rule : rules) {
        const std::string& id = rule.profile.id;
        add_fact(own, id, own_arithmetic_text(rule.verdict.own_arithmetic));
        if (rule.best() == nullptr) continue;
        const CertifiableWindow& best = *rule.best();
        const SpeedUnit& unit = rule.unit();
        add_row(spans,
                {id,
                 best.span.start_gps ? to_utc_iso(*best.span.start_gps, 3)
                                     : seconds_text(best.span.start),
                 seconds_text(best.span.duration), format_fixed(best.displacement_m, 3) + " m",
                 format_fixed(best.position_r95_m, 3) + " m", counted(rule.windows->candidates)});
        const auto shown = [&, figures = rule.shown()](double speed_m_s) {
            return shown_speed(SpeedKind::measured, speed_m_s, figures, unit);
        };
        TableRow& row = add_row(speeds, {id, std::string(unit.name), shown(best.speed_m_s)});
        for (const SpeedDefinition name : definitions)
            row.cells.push_back(shown(speed_by(best.definitions, name)));
        if (std::vector<Block> more = points_and_further_blocks(rule); !more.empty()) {
            further.push_back(heading(rule.titled("Window")));
            add(further, std::move(more));
        }
    }
    std::vector<Block> blocks{std::move(spans), std::move(speeds), std::move(own)};
    add(blocks, std::move(further));
    return blocks;
}

}  // namespace runcert
