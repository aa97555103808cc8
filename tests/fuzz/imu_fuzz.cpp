// The readers of IMUs: a table, and the formats that are recognised. What the bytes are of decides
// which keys the attempt has.

#include <cmath>

#include "fuzz_target.h"
#include "stages/import/imu/imu.h"
#include "stages/import/imu/propose.h"

namespace runcert::fuzz {
namespace {

Receiver receiver_for(std::string_view bytes) {
    Receiver receiver;
    receiver.id = "primary";
    receiver.place = "attempt.yaml:5:5";
    Imu& imu = receiver.imu.emplace();
    imu.file = "imu";
    imu.place = "attempt.yaml:7:9";
    const bool even = bytes.size() % 2 == 0;
    if (even) imu.rate_hz = 100.0;
    if (bytes.size() % 3 == 0) imu.samples = ImuSampling::instant;
    if (imu::is_kf_gins(bytes)) return receiver;
    if (imu::is_rawimu(bytes)) {
        imu.gyro_scale = 0.1 / (3600.0 * 256.0);
        imu.accelerometer_scale = 0.05 / 32768.0;
        return receiver;
    }
    imu.columns = {{"time", "1"},           {"gyro_x", "2"},          {"gyro_y", "3"},
                   {"gyro_z", "4"},         {"accelerometer_x", "5"}, {"accelerometer_y", "6"},
                   {"accelerometer_z", "7"}};
    return receiver;
}

void check_rows(const imu::StreamedImu& samples) {
    std::int64_t rows = 0;
    std::optional<std::int64_t> before;
    samples.give([&](const ImuRow& row) {
        ++rows;
        for (const double value :
             {row.interval_s, row.rate_forward_rad_s, row.rate_right_rad_s, row.rate_down_rad_s,
              row.force_forward_m_s2, row.force_right_m_s2, row.force_down_m_s2})
            require(std::isfinite(value), "readings are finite");
        require(row.interval_s > 0.0, "intervals are positive");
        require(!before || row.time.nanoseconds >= *before, "times do not go back");
        before = row.time.nanoseconds;
    });
    require(rows == samples.rows, "as many rows as are said");
}

}  // namespace

void read_input(std::string_view bytes) {
    const RecordingBytes file{.name = "imu", .bytes = bytes};
    if (const auto proposal = imu::propose(file)) (void)imu::recognition_of(*proposal);
    const imu::RecordingSpan span{
        .first_epoch = GpsTime::from_week(2400, 100'000'000'000'000),
        .span_s = 3600.0,
        .count_ns = bytes.size() % 5 == 0 ? std::optional<std::int64_t>(0) : std::nullopt};
    check_rows(imu::import_imu(receiver_for(bytes), file, span));
}

}  // namespace runcert::fuzz
