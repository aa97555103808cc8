#include "stages/import/recognise.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "stages/import/csv/propose.h"
#include "stages/import/import.h"
#include "stages/import/inspect.h"
#include "store/measured_series.h"

namespace runcert {
namespace {

constexpr std::size_t rows_shown = 3;

/// "2026-03-14T10:00:00.000Z, 52.10000000 N, ...": a row as it was read.
std::string row_as_read(const Observation& row, const Observations& observations) {
    const auto& first = observations.facts.first_epoch;
    std::string text = first ? to_utc_iso(first->plus_nanoseconds(row.time.nanoseconds))
                             : format_fixed(row.time.seconds(), 3) + " s";
    const auto add = [&](std::string_view name, double value, int decimals, std::string_view unit) {
        text += fmt::format(", {} {}{}{}", name, format_fixed(value, decimals),
                            unit.empty() ? "" : " ", unit);
    };
    if (row.latitude_deg) add("latitude", *row.latitude_deg, 7, "");
    if (row.longitude_deg) add("longitude", *row.longitude_deg, 7, "");
    if (row.plane_east_m) add("east", *row.plane_east_m, 3, "m");
    if (row.plane_north_m) add("north", *row.plane_north_m, 3, "m");
    if (row.height_m && observations.facts.vertical_measured) add("height", *row.height_m, 2, "m");
    if (const auto speed = horizontal_speed(row)) add("speed", *speed * km_h_per_m_s, 2, "km/h");
    return text;
}

/// Adds what the receiver leaves out, of what is not said yet to be needed.
void add_needs(const Observations& observations, const Inspection& inspection,
               const Receiver& receiver, Recognition& is) {
    const auto add = [&](const char* key, bool required = false) {
        if (std::ranges::find(is.needed, key, &NeededKey::key) == is.needed.end())
            is.needed.push_back(needed_key(key, required));
    };
    const RecordingFacts& facts = observations.facts;
    const AttemptAccuracy stated = receiver.accuracy.value_or(AttemptAccuracy{});
    const bool by_recording = observations.accuracy_source == "recording";
    if ((inspection.with_accuracy == 0 || !by_recording) && !stated.horizontal_m)
        add("accuracy.horizontal_m", true);
    if (facts.vertical_measured && inspection.with_vertical_accuracy == 0 && !stated.vertical_m)
        add("accuracy.vertical_m", true);
    if (inspection.with_velocity > 0 && inspection.velocities_stated == 0 &&
        inspection.velocity_origin != VelocityOrigin::positions && !stated.velocity_m_s)
        add("accuracy.velocity_mps");
    if (facts.georeferenced && !facts.vertical_measured && !receiver.height_m)
        add("height_m", true);
    const bool unsaid =
        inspection.fixes.size() == 1 && inspection.fixes.front().first == FixType::unknown;
    if (unsaid && receiver.solution.empty()) add("solution");
    if (facts.time_source != "satellites" && receiver.time_source.empty()) add("time_source");
    const bool by_day = observations.format == "nmea" || observations.format == "vbo";
    if (!inspection.first && by_day && receiver.start_date.empty())
        add("start_date");
    else if (!inspection.first && !by_day && !receiver.start_gps)
        add("start_gps");
}

/// What an attempt is arranged by.
void add_facts(const Observations& observations, const Inspection& inspection, Recognition& is) {
    is.format = observations.format;
    is.device = observations.device;
    is.simulated = observations.simulated;
    is.first = inspection.first;
    is.last = inspection.last;
    is.span_s = inspection.span_s;
    is.epochs = static_cast<std::int64_t>(inspection.epochs);
    is.interval_s = inspection.nominal_interval_s;
    for (const auto& [fix, count] : inspection.fixes)
        is.fixes.push_back(
            {.fix = std::string(to_text(fix)), .epochs = static_cast<std::int64_t>(count)});
    const auto first = std::ranges::find_if(observations.rows, [](const Observation& row) {
        return row.latitude_deg && row.longitude_deg;
    });
    if (first != observations.rows.end()) {
        is.latitude_deg = *first->latitude_deg;
        is.longitude_deg = *first->longitude_deg;
    }
    for (const Observation& row : observations.rows)
        if (observations.format == "csv" && is.rows.size() < rows_shown && has_position(row))
            is.rows.push_back(row_as_read(row, observations));
    if (inspection.best_by_position) is.speed_m_s = inspection.best_by_position->speed_m_s;
    is.falls = inspection.is_vertical();
}

/// Adds what was read: facts, needs and concerns.
void add_positions(const Observations& observations, const Receiver& receiver,
                   const std::optional<GpsTime>& now, Recognition& is) {
    const Inspection inspection = inspect(observations);
    add_facts(observations, inspection, is);
    add_needs(observations, inspection, receiver, is);
    for (FactGroup& group : positions_said(observations, inspection))
        is.said.push_back(std::move(group));
    for (Concern& concern : positions_concerns(observations, inspection, now))
        is.concerns.push_back(std::move(concern));
}

}  // namespace

bool is_navigation(std::string_view bytes) {
    const std::string_view line = bytes.substr(0, bytes.find('\n'));
    return line.find("RINEX VERSION / TYPE") != std::string_view::npos &&
           line.find("NAV") != std::string_view::npos;
}

std::vector<std::string> series_in(const RecordingBytes& file) {
    std::vector<std::string> keys;
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (rule.series.empty()) continue;
        try {
            (void)read_series(file.bytes, file.name, GpsTime{}, rule.series);
            keys.push_back(rule.path);
        } catch (const Failure&) {
            // Of another kind, or none.
        }
    }
    return keys;
}

NeededKey needed_key(const std::string& key, bool required) {
    const FieldRule* rule = attempt_schema().find("receivers[]." + key);
    return {.key = key, .reason = rule->why, .values = rule->values, .required = required};
}

Recognition recognition_of(const Observations& observations, const Receiver& receiver,
                           const std::optional<GpsTime>& now) {
    Recognition is;
    add_positions(observations, receiver, now, is);
    return is;
}

Recognition recognition_of_table(const RecordingBytes& recording, const CsvColumns& given,
                                 const std::optional<GpsTime>& now) {
    auto proposal = csv::propose(recording, given);
    if (!proposal) {
        // Says what it is, and which formats are read.
        (void)import_recording({.id = "recognised", .format = "auto", .place = recording.name},
                               recording);
        throw Failure(recording.name, "the file is no recording that is read",
                      "Give the recording as the receiver or logger wrote it");
    }
    Recognition& is = proposal->is;
    is.format = "csv";
    if (!proposal->read) {
        is.kind = RecordingKind::table;
        is.rows = {std::move(proposal->first_row)};
        return std::move(is);
    }
    add_positions(*proposal->read, proposal->receiver, now, is);
    return std::move(is);
}

}  // namespace runcert
