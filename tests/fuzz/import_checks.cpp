#include "import_checks.h"

#include <cmath>

#include "fuzz_target.h"
#include "schemas/observations/observations.h"
#include "stages/import/import.h"
#include "stages/import/recognise.h"

namespace runcert::fuzz {
namespace {

bool in_range(const OptionalReal& value, double limit) {
    return !value || (std::isfinite(*value) && std::abs(*value) <= limit);
}

bool is_deviation(const OptionalReal& value) {
    return !value || (std::isfinite(*value) && *value >= 0.0);
}

void check_row(const Observation& row, std::size_t size) {
    require(in_range(row.latitude_deg, 90.0), "latitude within 90 degrees");
    require(in_range(row.longitude_deg, 360.0), "longitude within 360 degrees");
    require(row.latitude_deg.has_value() == row.longitude_deg.has_value(),
            "latitude and longitude");
    require(!(row.latitude_deg && row.plane_east_m), "one position in a row");
    for (const OptionalReal& value :
         {row.height_m, row.plane_east_m, row.plane_north_m, row.plane_up_m,
          row.recorded_velocity_east_m_s, row.recorded_velocity_north_m_s,
          row.recorded_velocity_up_m_s, row.recorded_speed_m_s, row.age_s, row.ratio})
        require(in_range(value, 1e300), "finite figures");
    for (const OptionalReal& sigma :
         {row.sigma_east_m, row.sigma_north_m, row.sigma_up_m, row.sigma_recorded_velocity_east_m_s,
          row.sigma_recorded_velocity_north_m_s, row.sigma_recorded_velocity_up_m_s,
          row.sigma_recorded_speed_m_s})
        require(is_deviation(sigma), "standard deviations not negative");
    // What cannot be, as a correlation above 1, is for screening to mark.
    for (const OptionalReal& correlation :
         {row.correlation_east_north, row.correlation_east_up, row.correlation_north_up})
        require(in_range(correlation, 1e300), "finite correlations");
    require(!(row.recorded_speed_m_s && row.recorded_velocity_east_m_s),
            "a speed or its components");
    require(!row.recorded_speed_m_s || *row.recorded_speed_m_s > 0.0, "a speed above zero");
    require(!row.source_line || *row.source_line >= 1, "lines counted from 1");
    require(!row.source_byte ||
                (*row.source_byte >= 0 && *row.source_byte < static_cast<std::int64_t>(size)),
            "bytes within the recording");
}

void check(const Observations& observations, std::size_t size) {
    require(!observations.rows.empty(), "epochs");
    for (std::size_t i = 0; i < observations.rows.size(); ++i) {
        require(observations.rows[i].epoch == static_cast<std::int64_t>(i) + 1,
                "rows numbered from 1");
        check_row(observations.rows[i], size);
    }
    const RecordCount& records = observations.records;
    require(records.bad >= 0 && 2 * records.bad <= records.total, "half of the records good");
    require(records.bad_records.size() <= bad_records_listed_at_most, "bad records listed");
    require(observations.facts.first_epoch.has_value() == (observations.time_scale != "relative"),
            "a first epoch");
}

/// What was read can be written, and comes back.
void check_written(Observations observations) {
    observations.header.stage = "import";
    observations.header.program_version = "1.0.0";
    observations.header.source_revision = "0123456789ab";
    const std::string text = write_observations(observations);
    const Observations again = read_observations(text, "written");
    require(again.rows.size() == observations.rows.size(), "every row is written");
    require(again.notes == observations.notes, "every note is written");
    require(write_observations(again) == text, "written, read and written again: equal");
}

}  // namespace

void import_and_check(const Receiver& receiver, std::string_view bytes) {
    const Observations observations =
        import_recording(receiver, {.name = "recording", .bytes = bytes});
    check(observations, bytes.size());
    // These take longer than the reading.
    const std::size_t chosen = bytes.size() % 32;
    if (chosen == 0) (void)recognition_of(observations, receiver);
    if (chosen != 1 && chosen != 2) return;
    try {
        check_written(observations);
    } catch (const Failure& failure) {
        throw std::logic_error(std::string("what was read cannot be written: ") + failure.what());
    }
}

}  // namespace runcert::fuzz
