#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/prose.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/inspect.h"

namespace runcert {
namespace {

constexpr std::size_t most_notes = 4;
/// Of the larger: a difference of the two bests beyond this is worth a sentence.
constexpr double notable_difference = 0.05;
constexpr double notable_delay_s = 0.03;

std::string fixed(double value, int decimals) {
    return format_fixed(value, decimals);
}

std::string frame_text(const std::string& frame) {
    if (frame == "geodetic") return "latitude, longitude, height";
    if (frame == "ecef") return "Earth-centred x, y, z";
    if (frame == "utm") return "UTM grid";
    return "engineering CRS";
}

std::string time_scale_text(const std::string& time_scale) {
    if (time_scale == "gps") return "GPS time";
    if (time_scale == "utc") return "UTC";
    return "relative time";
}

std::string duration_text(double seconds) {
    const double tenths = std::round(seconds * 10.0);
    const double hours = std::floor(tenths / 36000.0);
    const double minutes = std::floor((tenths - hours * 36000.0) / 600.0);
    const double rest = (tenths - hours * 36000.0 - minutes * 600.0) / 10.0;
    std::string text;
    if (hours > 0.0) text += fixed(hours, 0) + " h ";
    if (hours > 0.0 || minutes > 0.0) text += fixed(minutes, 0) + " min ";
    return text + fixed(rest, 1) + " s";
}

/// "2026-08-01 14:03:05" in a zone so many hours ahead of UTC.
std::string local_text(GpsTime time, int zone_h) {
    constexpr std::int64_t hour_ns = 3600 * GpsTime::nanoseconds_per_second;
    std::string text = to_utc_iso(time.plus_nanoseconds(zone_h * hour_ns), 0);
    text.pop_back();
    text[10] = ' ';
    return text;
}

/// When the recording was made, on each time scale.
void add_times(const Inspection& it, FactGroup& facts) {
    const std::string length = duration_text(it.span_s);
    if (!it.first || !it.last) return add_fact(facts, "Time", length + ", from an unknown start");
    add_fact(facts, "Duration", length);
    add_fact(facts, "UTC", fmt::format("{} to {}", to_utc_iso(*it.first), to_utc_iso(*it.last)));
    add_fact(facts, "GPS time", fmt::format("{} to {}", to_iso(*it.first), to_iso(*it.last)));
    if (it.zone_h)
        add_fact(facts, "Local time",
                 fmt::format("{} to {}, if UTC{:+} as the longitude suggests",
                             local_text(*it.first, *it.zone_h), local_text(*it.last, *it.zone_h),
                             *it.zone_h));
}

/// "31.60° S, 136.00° E", of the first position.
std::string place_text(const std::vector<Observation>& rows) {
    const auto first = std::ranges::find_if(
        rows, [](const Observation& row) { return row.latitude_deg && row.longitude_deg; });
    if (first == rows.end()) return {};
    const auto side = [](double degrees, const char* positive, const char* negative) {
        return fmt::format("{}\u00b0 {}", fixed(std::abs(degrees), 2),
                           degrees < 0.0 ? negative : positive);
    };
    return fmt::format("{}, {}", side(*first->latitude_deg, "N", "S"),
                       side(*first->longitude_deg, "E", "W"));
}

std::string epochs_text(const Inspection& it) {
    if (it.nominal_interval_s <= 0.0) return fmt::format("{}", it.epochs);
    if (!it.bursts.empty()) return fmt::format("{}, in bursts", it.epochs);
    return fmt::format("{}, mostly {} s apart ({} Hz)", it.epochs, fixed(it.nominal_interval_s, 3),
                       fixed(1.0 / it.nominal_interval_s, 2));
}

std::string fixes_text(const Inspection& it) {
    std::string text;
    for (const auto& [kind, count] : it.fixes)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", to_text(kind), count);
    return fmt::format("{}; {} changes", text, it.fix_changes);
}

std::string gaps_text(const Inspection& it) {
    std::string text =
        it.gaps == 0 ? "none"
                     : fmt::format("{}, the longest {} s", it.gaps, fixed(it.longest_gap_s, 1));
    return text +
           fmt::format("; {} repeated and {} backward times", it.repeated_times, it.backward_times);
}

/// With two digits that count, where these are behind the point.
std::string size_text(double size) {
    constexpr int most = 9;
    const int decimals =
        size > 0.0 ? std::clamp(1 - static_cast<int>(std::floor(std::log10(size))), 0, most) : 0;
    return fixed(size, decimals);
}

/// A step, trailing zeros left out.
std::string step_text(const std::optional<double>& step, std::string_view unit) {
    if (!step) return "unclear steps";
    std::string text = size_text(*step);
    if (text.find('.') != std::string::npos) text.erase(text.find_last_not_of('0') + 1);
    if (text.ends_with('.')) text.pop_back();
    return fmt::format("steps of {} {}", text, unit);
}

std::string accuracy_text(const Inspection& it, const std::string& source) {
    if (!it.median_horizontal_m) return "none stated";
    std::string text =
        fmt::format("horizontal {} m (median), {} m (worst), stated by the {}",
                    size_text(*it.median_horizontal_m), size_text(*it.worst_horizontal_m), source);
    if (it.with_accuracy < it.epochs) text += fmt::format(" in {} epochs", it.with_accuracy);
    return text;
}

/// "43 s ± 0.3 s behind the positions".
std::string raw_delay_text(const RawDelay& delay) {
    return fmt::format("{:.3g} s ± {:.1g} s {} the positions", std::abs(delay.delay_s),
                       delay.sigma_s, delay.delay_s < 0.0 ? "ahead of" : "behind");
}

/// By velocities where they tell it; what their lengths tell beyond that, or instead.
std::string delays_text(const Inspection& it) {
    constexpr std::size_t named = 4;
    std::vector<std::string> parts;
    if (it.velocity_delay_s)
        parts.push_back(fmt::format("{} s {} the positions",
                                    fixed(std::abs(*it.velocity_delay_s), 2),
                                    *it.velocity_delay_s < 0.0 ? "ahead of" : "behind"));
    std::size_t more = 0;
    for (const RawDelay& one : it.velocity_delays) {
        if (it.velocity_delay_s && !one.beyond) continue;
        if (parts.size() == named)
            ++more;
        else if (!it.velocity_delay_s && it.velocity_delays.size() == 1)
            parts.push_back(raw_delay_text(one));
        else
            parts.push_back(fmt::format("from {:.0f} s to {:.0f} s {}", one.from_s, one.to_s,
                                        raw_delay_text(one)));
    }
    if (parts.empty()) return ", its delay behind the positions cannot be told";
    if (more > 0) parts.push_back(fmt::format("other delays in {} more parts", more));
    return fmt::format(", {}", fmt::join(parts, ", "));
}

std::string velocity_text(const Inspection& it) {
    if (it.with_velocity == 0) return "not recorded";
    std::string text = fmt::format("in {} epochs", it.with_velocity);
    if (it.speeds_alone == it.with_velocity)
        text = "speed without a course " + text;
    else if (it.speeds_alone > 0)
        text += fmt::format(", in {} of them without a course", it.speeds_alone);
    text += delays_text(it);
    if (!it.median_velocity_m_s) return text + "; no accuracy stated";
    return text + fmt::format("; stated {} m/s (median), {} m/s (worst)",
                              size_text(*it.median_velocity_m_s),
                              size_text(*it.worst_velocity_m_s));
}

std::string best_text(const std::optional<RawBest>& best) {
    if (!best) return "no stretch of 3 s";
    std::string at = fixed(best->start.seconds(), 3) + " s after the first epoch";
    if (best->start_gps) at += fmt::format(", {} UTC", to_utc_iso(*best->start_gps));
    return fmt::format("{} km/h over {} s, from {} (epochs {} to {})",
                       fixed(best->speed_m_s * km_h_per_m_s, 1), fixed(best->duration_s, 3), at,
                       best->first_epoch, best->last_epoch);
}

std::size_t count_of(const Inspection& it, FixType kind) {
    for (const auto& [candidate, count] : it.fixes)
        if (candidate == kind) return count;
    return 0;
}

std::string percent(std::size_t part, std::size_t whole) {
    return fixed(100.0 * static_cast<double>(part) / static_cast<double>(whole), 1) + " %";
}

/// The first date in a text that names a firmware, as v2024.08.07 or 2024-08-07.
std::optional<GpsTime> date_in(std::string_view text) {
    constexpr std::size_t length = 10;
    for (std::size_t at = 0; at + length <= text.size(); ++at) {
        const auto year = digits_at(text, at, 4), month = digits_at(text, at + 5, 2),
                   day = digits_at(text, at + 8, 2);
        const char between = text[at + 4];
        if (!year || !month || !day || (between != '.' && between != '-') ||
            text[at + 7] != between)
            continue;
        if (const auto number = day_number(*year, *month, *day))
            return GpsTime::from_nanoseconds(*number * GpsTime::nanoseconds_per_day);
    }
    return std::nullopt;
}

/// What an official should look at.
class Concerns {
  public:
    Concerns(const Observations& observations, const Inspection& inspection)
        : of_(observations), it_(inspection) {}

    std::vector<Concern> found(const std::optional<GpsTime>& now) {
        if (of_.simulated) said_.push_back(simulated_concern());
        if (100 * of_.records.bad > of_.records.total)
            add(ConcernCode::unreadable_records,
                "More than 1 % of its records cannot be read: nothing in it can be certified.");
        add_fixes();
        add_accuracy();
        add_speeds();
        add_times();
        add_dates(now);
        add_fastest();
        const std::size_t shown = std::min(of_.notes.size(), most_notes);
        for (std::size_t i = 0; i < shown; ++i)
            add(ConcernCode::reading, of_.notes[i]);
        return std::move(said_);
    }

  private:
    void add(ConcernCode code, std::string says) {
        said_.push_back({.code = code, .says = std::move(says)});
    }

    void add_fixes() {
        const std::size_t unknown = count_of(it_, FixType::unknown);
        const std::size_t lesser = it_.epochs - count_of(it_, FixType::fixed) - unknown;
        if (unknown < it_.epochs && lesser > 0)
            add(ConcernCode::fix_types, fmt::format("{} of the epochs are not fixed solutions.",
                                                    percent(lesser, it_.epochs)));
        if (it_.without_position > 0)
            add(ConcernCode::no_positions,
                fmt::format("{} epochs have no position.", it_.without_position));
    }

    void add_accuracy() {
        if (it_.with_accuracy > 0 &&
            (*it_.worst_horizontal_m > 10.0 || *it_.median_horizontal_m < 0.001))
            add(ConcernCode::accuracy, "Some stated standard deviations are implausible.");
    }

    void add_speeds() {
        if (it_.with_velocity == 0)
            add(ConcernCode::no_speeds,
                fmt::format("The recording has no speeds, its positions {}: a rule that measures "
                            "recorded speeds cannot be met.",
                            it_.nominal_interval_s > 0.0
                                ? fmt::format("come {} times a second",
                                              fixed(1.0 / it_.nominal_interval_s, 2))
                                : "at unknown times"));
        if (it_.velocity_delay_s && std::abs(*it_.velocity_delay_s) > notable_delay_s)
            add(ConcernCode::speeds,
                *it_.velocity_delay_s > 0.0
                    ? "The recorded velocity is late: it shows the speed of a moment before."
                    : "The recorded velocity is early: its times are behind those of the "
                      "positions.");
        const auto beyond = std::ranges::find_if(it_.velocity_delays, &RawDelay::beyond);
        if (beyond != it_.velocity_delays.end())
            add(ConcernCode::speeds,
                fmt::format("The recorded speeds are not those of the positions beside them: they "
                            "are {}. A rule of recorded speeds certifies none of them.",
                            raw_delay_text(*beyond)));
        if (it_.velocity_origin == VelocityOrigin::positions)
            add(ConcernCode::speeds,
                "The recorded velocities were computed from the positions: they are no evidence "
                "beside them.");
        else if (it_.velocities_stated > 0 && it_.with_velocity > it_.velocities_stated)
            add(ConcernCode::speeds,
                fmt::format("{} recorded velocities state no accuracy: the attempt may give one "
                            "(accuracy: {{velocity_mps: ...}}).",
                            it_.with_velocity - it_.velocities_stated));
    }

    void add_times() {
        if (!it_.bursts.empty())
            add(ConcernCode::times,
                fmt::format("Time stamps come in bursts ({}): a computer stamped what it read from "
                            "a buffer, and no receiver's time does so. Nothing can be certified by "
                            "these times.",
                            it_.bursts));
        else if (it_.gaps > 0)
            add(ConcernCode::gaps,
                fmt::format("Epochs are missing in {}; a speed is certified across a gap only "
                            "where the rule and screen.gap_max_s allow it.",
                            counted(static_cast<std::int64_t>(it_.gaps), "place")));
        const bool shared = 3 * it_.repeated_times >= it_.epochs;
        if (shared)
            add(ConcernCode::times,
                fmt::format("Up to {} positions share one time stamp: the recording does not say "
                            "when each was taken.",
                            it_.most_at_one_time));
        if ((it_.repeated_times > 0 && !shared) || it_.backward_times > 0)
            add(ConcernCode::times,
                "Times repeat or run backwards. Stretches that were written out of order are put "
                "in the order of time; what contradicts the rest is left out, and counted.");
        if (!of_.facts.georeferenced)
            add(ConcernCode::place, "The recording does not show where it was made.");
    }

    /// Dates that cannot be: before the firmware that wrote them, or still to come.
    void add_dates(const std::optional<GpsTime>& now) {
        if (!it_.first || !it_.last) return;
        constexpr std::int64_t rollover_ns = 1024 * 7 * GpsTime::nanoseconds_per_day;
        const auto date = [](const GpsTime& time) { return to_iso(time).substr(0, 10); };
        std::optional<GpsTime> firmware = date_in(of_.device);
        for (const std::string& said : of_.written_by)
            if (!firmware) firmware = date_in(said);
        if (firmware && *it_.first < *firmware)
            add(ConcernCode::date,
                fmt::format(
                    "The recording is dated {}, before the firmware that wrote it ({}): the date "
                    "is wrong. 1024 weeks later, the rollover of the GPS week, it would be {}.",
                    date(*it_.first), date(*firmware),
                    date(it_.first->plus_nanoseconds(rollover_ns))));
        if (now && *it_.last > *now)
            add(ConcernCode::date,
                fmt::format("The recording is dated {}, which is still to come: the date is wrong.",
                            date(*it_.last)));
    }

    void add_fastest() {
        if (!it_.best_by_position)
            add(ConcernCode::fastest, "There is no stretch of 3 s to measure a speed over.");
        else if (!it_.best_by_position->all_fixed && count_of(it_, FixType::unknown) != it_.epochs)
            add(ConcernCode::fastest,
                "The fastest stretch by position is not made of fixed solutions alone.");
        if (!it_.best_by_position || !it_.best_by_velocity) return;
        const double a = it_.best_by_position->speed_m_s;
        const double b = it_.best_by_velocity->speed_m_s;
        if (!it_.misread_positions.empty())
            add(ConcernCode::fastest,
                fmt::format("The best by position is that of the recorded speeds if {}: look at "
                            "what the columns of positions hold.",
                            it_.misread_positions));
        else if (std::abs(a - b) > notable_difference * std::max(a, b))
            add(ConcernCode::fastest,
                "The best by position and by recorded velocity differ: one of the two is wrong.");
    }

    const Observations& of_;
    const Inspection& it_;
    std::vector<Concern> said_;
};

/// How the positions were solved, as the header says: files, times, options.
std::string solving_text(const Processing& processing) {
    std::vector<std::string> parts = processing.options;
    if (!processing.begin.empty() && !processing.end.empty())
        parts.insert(parts.begin(), fmt::format("{} to {}", processing.begin, processing.end));
    if (!processing.files.empty())
        parts.insert(parts.begin(), fmt::format("from {}", fmt::join(processing.files, ", ")));
    return fmt::format("{}", fmt::join(parts, "; "));
}

FactGroup recording_facts(const Observations& of, const Inspection& it) {
    FactGroup all{.title = "Positions"};
    add_fact(
        all, "Format",
        fmt::format("{}; {}, {}",
                    of.variant.empty() ? of.format : fmt::format("{} ({})", of.format, of.variant),
                    frame_text(of.frame), time_scale_text(of.time_scale)));
    add_fact(all, "Made by", of.device);
    for (const std::string& said : of.written_by)
        if (said != of.device) add_fact(all, "It says", said);
    if (of.processing) add_fact(all, "Solved", solving_text(*of.processing));
    add_times(it, all);
    add_fact(all, "Clock", of.time_origin);
    for (const SignedNavigation& one : of.signed_navigation)
        add_fact(all, "Messages", one.text());
    add_fact(all, "Place", place_text(of.rows));
    add_fact(all, "Epochs", epochs_text(it));
    add_fact(all, "Gaps", gaps_text(it));
    add_fact(all, "Solutions", fixes_text(it));
    add_fact(
        all, "Written",
        fmt::format("positions in {}, times in {}", step_text(of.facts.position_resolution_m, "m"),
                    step_text(of.facts.time_resolution_s, "s")));
    add_fact(all, "Accuracy", accuracy_text(it, of.accuracy_source));
    add_fact(all, "Velocity", velocity_text(it));
    return all;
}

FactGroup best_facts(const Inspection& it) {
    FactGroup bests{.title = "Fastest 3 s, unscreened, not for a certificate"};
    add_fact(bests, "By position", best_text(it.best_by_position));
    if (it.with_velocity > 0)
        add_fact(bests, "By recorded velocity", best_text(it.best_by_velocity));
    if (!it.is_vertical()) return bests;
    add_fact(bests, "Vertical, by height", best_text(it.best_vertical_by_position));
    add_fact(bests, "Vertical, by velocity", best_text(it.best_vertical_by_velocity));
    return bests;
}

}  // namespace

void add_fact(FactGroup& group, std::string name, std::string value) {
    if (!value.empty()) group.facts.push_back({.name = std::move(name), .value = std::move(value)});
}

Concern simulated_concern() {
    return {.code = ConcernCode::simulated,
            .says = "The recording says that it was simulated: no craft was measured."};
}

std::vector<FactGroup> positions_said(const Observations& observations,
                                      const Inspection& inspection) {
    return {recording_facts(observations, inspection), best_facts(inspection)};
}

std::vector<Concern> positions_concerns(const Observations& observations,
                                        const Inspection& inspection,
                                        const std::optional<GpsTime>& now) {
    return Concerns(observations, inspection).found(now);
}

}  // namespace runcert
