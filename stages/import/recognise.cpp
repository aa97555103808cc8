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

/// What the receiver leaves out.
class Needs {
  public:
    Needs(const Receiver& receiver, Recognition& is) : receiver_(receiver), is_(is) {}

    void find(const Inspection& inspection) {
        const auto& accuracy = receiver_.accuracy;
        if (!is_.accuracy && !(accuracy && accuracy->horizontal_m))
            add("accuracy.horizontal_m",
                "The recording states no accuracy, and the uncertainty of the speed begins with "
                "it.",
                {}, true);
        if (is_.heights && !is_.height_accuracy && !(accuracy && accuracy->vertical_m))
            add("accuracy.vertical_m", "The recording states no accuracy of heights.", {}, true);
        if (is_.velocities && !is_.velocity_accuracy && !(accuracy && accuracy->velocity_m_s))
            add("accuracy.velocity_mps",
                "The recorded speeds state no accuracy; without it they bear less witness.");
        if (is_.georeferenced && !is_.heights && !receiver_.height_m)
            add("height_m",
                "The recording has no heights, and each kilometre of it changes the speed by "
                "0.016 %.",
                {}, true);
        const bool unsaid = is_.fixes.size() == 1 && is_.fixes.front().fix == "unknown";
        if (unsaid && receiver_.solution.empty())
            add("solution",
                "The recording does not say how its positions were solved; unsaid, they count as "
                "those of one receiver alone (single).",
                {"fixed", "float", "ppp", "dgps", "sbas", "single"});
        if (!is_.satellites_time && receiver_.time_source.empty())
            add("time_source",
                "Nothing says that the time stamps are the satellites' time; unsaid, the clock's "
                "rate counts as uncertain.",
                {"satellites"});
        const bool by_day = inspection.format == "nmea" || inspection.format == "vbo";
        if (!is_.first && by_day && receiver_.start_date.empty())
            add("start_date", "The recording has times of day and no date.");
        else if (!is_.first && !by_day && !receiver_.start_gps)
            add("start_gps",
                "Times count from an unknown start, so that the report could not say when the run "
                "was.");
    }

  private:
    void add(const std::string& key, std::string reason, std::vector<std::string> values = {},
             bool required = false) {
        if (std::ranges::find(is_.needed, key, &NeededKey::key) == is_.needed.end())
            is_.needed.push_back({.key = key,
                                  .reason = std::move(reason),
                                  .values = std::move(values),
                                  .required = required});
    }

    const Receiver& receiver_;
    Recognition& is_;
};

void add_facts(const Observations& observations, const Inspection& inspection, Recognition& is) {
    is.format = inspection.format;
    is.device = inspection.device;
    is.simulated = inspection.simulated;
    is.first = inspection.first;
    is.last = inspection.last;
    is.span_s = inspection.span_s;
    is.epochs = static_cast<std::int64_t>(inspection.epochs);
    is.interval_s = inspection.nominal_interval_s;
    for (const auto& [fix, count] : inspection.fixes)
        is.fixes.push_back(
            {.fix = std::string(to_text(fix)), .epochs = static_cast<std::int64_t>(count)});
    is.georeferenced = inspection.georeferenced;
    for (const Observation& row : observations.rows) {
        if (!row.latitude_deg || !row.longitude_deg) continue;
        is.latitude_deg = *row.latitude_deg;
        is.longitude_deg = *row.longitude_deg;
        break;
    }
    for (const Observation& row : observations.rows)
        if (inspection.format == "csv" && is.rows.size() < rows_shown && has_position(row))
            is.rows.push_back(row_as_read(row, observations));
    is.heights = inspection.vertical_measured;
    is.accuracy = inspection.with_accuracy > 0 && inspection.accuracy_source == "recording";
    is.height_accuracy = inspection.with_vertical_accuracy > 0;
    is.velocities = inspection.with_velocity > 0;
    is.velocity_accuracy = inspection.velocities_stated > 0;
    is.satellites_time = inspection.time_source == "satellites";
    if (inspection.best_by_position) is.speed_m_s = inspection.best_by_position->speed_m_s;
    is.falls =
        inspection.best_vertical_by_velocity && inspection.best_by_velocity &&
        inspection.best_vertical_by_velocity->speed_m_s > inspection.best_by_velocity->speed_m_s;
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

Recognition recognition_of(const Observations& observations, const Receiver& receiver) {
    const Inspection inspection = inspect(observations);
    Recognition is;
    add_facts(observations, inspection, is);
    Needs(receiver, is).find(inspection);
    return is;
}

Recognition recognition_of_table(const RecordingBytes& recording, const CsvColumns& given) {
    auto proposal = csv::propose(recording, given);
    if (!proposal) {
        // Says what it is, and which formats are read.
        (void)import_recording({.id = "recognised", .format = "auto", .place = recording.name},
                               recording);
        throw Failure(recording.name, "the file is no recording that is read",
                      "Give the recording as the receiver or logger wrote it");
    }
    Recognition is;
    if (proposal->read) {
        const Inspection inspection = inspect(*proposal->read);
        add_facts(*proposal->read, inspection, is);
        is.needed = proposal->needed;
        Needs(proposal->receiver, is).find(inspection);
    } else {
        is.kind = RecordingKind::table;
        is.needed = proposal->needed;
        is.rows = {proposal->first_row};
    }
    is.format = "csv";
    is.proposed = std::move(proposal->keys);
    is.problem = std::move(proposal->problem);
    return is;
}

}  // namespace runcert
