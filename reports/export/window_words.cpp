#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/claimed_text.h"
#include "core/text.h"
#include "reports/export/track.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"

namespace runcert {
namespace {

constexpr int speed_decimals = 6;
constexpr std::string_view refused_rgb = "D55E00";
constexpr std::array<std::string_view, 4> rule_rgb{"0072B2", "009E73", "CC79A7", "56B4E9"};
constexpr int widest = 10;
constexpr int narrower = 2;
constexpr int narrowest = 4;

/// The speed for people: as the verdict shows it, or in km/h.
std::string speed_words(const TrackWindow& window) {
    if (window.kind == TrackWindowKind::best && window.verdict->shown)
        return measured_speed_text(*window.verdict->shown);
    const SpeedUnit& unit = speed_unit("km/h");
    return fmt::format("{} {}", speed_text(window.speed_m_s, std::nullopt, unit), unit.name);
}

void add_time(std::vector<MapFact>& facts, const std::string& label,
              const std::optional<GpsTime>& instant) {
    if (instant) facts.push_back({label, to_utc_iso(*instant)});
}

std::string name_of(const TrackWindow& window) {
    const std::string name = fmt::format("{}: {}", window.verdict->profile, speed_words(window));
    switch (window.kind) {
        case TrackWindowKind::further:
            return name + ", another window of the mean";
        case TrackWindowKind::refused:
            return name + " REFUSED, not certified";
        case TrackWindowKind::best:
            break;
    }
    return name;
}

std::vector<MapFact> facts_of(const TrackWindow& window) {
    const bool certified = window.kind != TrackWindowKind::refused;
    std::vector<MapFact> facts{
        {"Rule", window.verdict->profile},
        {"Body", window.verdict->body},
        {"Title", window.verdict->title},
        {"Speed defined as", std::string(to_text(window.verdict->definition))}};
    if (certified) {
        facts.push_back({"Outcome", outcome_words(state_of(*window.verdict)).title});
        facts.push_back({"Why", window.verdict->reason});
    }
    facts.push_back({"Speed (m/s)", format_fixed(window.speed_m_s, speed_decimals)});
    if (window.expanded_uncertainty_m_s)
        facts.push_back({"Expanded uncertainty, k = 2 (m/s)",
                         format_fixed(*window.expanded_uncertainty_m_s, speed_decimals)});
    if (!window.refusals.empty())
        facts.push_back(
            {"Not certified, because", fmt::format("{}", fmt::join(window.refusals, "; "))});
    if (window.span.start_gps) {
        add_time(facts, "Begins (UTC)", window.span.start_gps);
        add_time(facts, "Ends (UTC)",
                 window.span.start_gps->plus_nanoseconds(window.span.duration.nanoseconds));
    }
    facts.push_back(
        {"Begins (s after the first epoch)", format_fixed(window.span.start.seconds(), 3)});
    facts.push_back({"Duration (s)", format_fixed(window.span.duration.seconds(), 3)});
    facts.push_back({"First epoch", std::to_string(window.span.first_epoch)});
    facts.push_back({"Last epoch", std::to_string(window.span.last_epoch)});
    return facts;
}

std::vector<MapFact> facts_of(const TrackArc& arc) {
    std::vector<MapFact> facts;
    add_time(facts, "Begins (UTC)", arc.points.front().instant);
    add_time(facts, "Ends (UTC)", arc.points.back().instant);
    facts.push_back(
        {"Begins (s after the first epoch)", format_fixed(arc.points.front().time.seconds(), 3)});
    return facts;
}

LineStyle style_of(const TrackWindow& window) {
    const int order = static_cast<int>(std::min<std::size_t>(window.rule, widest));
    const int width = std::max(narrowest, widest - narrower * order);
    if (window.kind == TrackWindowKind::refused)
        return {std::string(refused_rgb), width + narrower};
    return {std::string(rule_rgb[window.rule % rule_rgb.size()]), width};
}

}  // namespace

std::vector<MapFeature> features_of(const Track& track, MapFeature::Kind kind) {
    std::vector<MapFeature> features;
    if (kind == MapFeature::Kind::track)
        for (const TrackArc& arc : track.arcs)
            features.push_back({fmt::format("track, arc {}", arc.number),
                                {"333333", 2},
                                facts_of(arc),
                                arc.points});
    if (kind == MapFeature::Kind::course)
        for (const TrackGate& gate : track.gates)
            features.push_back(
                {fmt::format("{} line", gate.name), {"000000", 4}, {}, {gate.left, gate.right}});
    if (kind == MapFeature::Kind::windows)
        for (const TrackWindow& window : track.windows)
            features.push_back(
                {name_of(window), style_of(window), facts_of(window), window.points});
    std::erase_if(features, [](const MapFeature& feature) { return feature.points.empty(); });
    return features;
}

std::vector<std::string> about(const Track& track) {
    std::vector<std::string> lines{fmt::format("Craft, as claimed: {}", claimed(track.craft))};
    if (!track.place.empty())
        lines.push_back(fmt::format("Place, as claimed: {}", claimed(track.place)));
    lines.push_back(fmt::format("Receiver: {}", track.receiver));
    lines.emplace_back(
        "Track: smoothed positions (WGS 84), cut at gaps; a map for looking, not the record: that "
        "is report.json.");
    lines.emplace_back(track.heights_measured
                           ? "Ellipsoidal heights: above the WGS 84 ellipsoid, not above sea level."
                           : "Heights were not measured.");
    return lines;
}

}  // namespace runcert
