#include "core/failure.h"
#include "stages/import/cell.h"
#include "stages/import/clock.h"
#include "stages/import/imu/raw.h"
#include "stages/import/novatel/log.h"
#include "stages/import/row_collector.h"

namespace runcert::imu {
namespace {

bool is_rawimu_line(std::string_view line) {
    return novatel::is_log(line, "RAWIMUA") || novatel::is_log(line, "RAWIMUSA");
}

/// After the semicolon: week, seconds, status, then Z, -Y, X of velocity and of angle. RAWIMUX,
/// which has two fields more, is another log.
constexpr std::size_t rawimu_fields = 9;

/// Counts of Z, -Y, X as x, y, z.
Eigen::Vector3d counts(const std::vector<Cell>& fields, std::size_t first, const char* meaning) {
    const double z = read_real(fields[first], meaning);
    const double minus_y = read_real(fields[first + 1], meaning);
    return {read_real(fields[first + 2], meaning), -minus_y, z};
}

}  // namespace

bool is_rawimu(std::string_view bytes) {
    LineReader lines(bytes);
    for (auto line = lines.next(); line; line = lines.next())
        if (is_rawimu_line(line->text)) return true;
    return false;
}

RawFile read_rawimu(const Receiver& receiver, const RecordingBytes& file) {
    require_text(file);
    const Imu& imu = *receiver.imu;
    if (!imu.gyro_scale || !imu.accelerometer_scale)
        throw Failure(imu.place, "RAWIMU logs hold counts, and do not say what a count is",
                      "Write gyro_scale (rad, or with gyro_unit: deg/s degrees, a count) and "
                      "accelerometer_scale (m/s a count), as NovAtel's manual has them for this "
                      "IMU and rate");
    RawFile raw;
    raw.format = "novatel";
    raw.stamps = Stamps::gps;
    raw.increments = true;
    read_lines(
        file,
        [&](const SourceLine& line, bool) -> std::optional<RawSample> {
            if (!is_rawimu_line(line.text)) return std::nullopt;
            const novatel::Log read = novatel::read_log(line, file);
            require_count(read.fields.size(), rawimu_fields, line, file, false, "a RAWIMU log has",
                          "Hand in the file as the receiver wrote it");
            RawSample sample{
                .time_ns =
                    read_week_time(read.fields[0], read.fields[1], Clock::gps).nanoseconds()};
            sample.accelerometer =
                accelerometer_unit(imu) * counts(read.fields, 3, "count of velocity");
            sample.gyro = gyro_unit(imu) * counts(read.fields, 6, "count of angle");
            require_possible(sample, read.fields.front());
            return sample;
        },
        raw);
    raw.notes.push_back(
        "RAWIMU logs are read by their published description; none that was recorded was at hand.");
    return raw;
}

}  // namespace runcert::imu
