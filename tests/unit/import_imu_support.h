#pragma once

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "import_test_support.h"
#include "stages/import/imu/imu.h"
#include "witness/gyro_noise.h"

namespace runcert::import_test {

/// A receiver with an IMU whose table has the columns t, gx, ..., az, in rad/s and m/s^2 along
/// forward, right, down.
inline Receiver imu_receiver() {
    Receiver receiver = pos_receiver();
    receiver.imu.emplace();
    Imu& imu = *receiver.imu;
    imu.file = "imu.csv";
    imu.place = "attempt.yaml:7:9";
    imu.columns = {{"time", "t"},
                   {"gyro_x", "gx"},
                   {"gyro_y", "gy"},
                   {"gyro_z", "gz"},
                   {"accelerometer_x", "ax"},
                   {"accelerometer_y", "ay"},
                   {"accelerometer_z", "az"}};
    imu.axes = ImuAxes{.x = CraftAxis::forward, .y = CraftAxis::right, .z = CraftAxis::down};
    return receiver;
}

/// A recording of 100 s with relative times that begin at 0.
inline imu::RecordingSpan relative_span() {
    return {.first_epoch = std::nullopt, .span_s = 100.0, .count_ns = 0};
}

/// What a sample holds: t, gx, gy, gz, ax, ay, az.
using SampleText = std::array<double, 7>;

/// A table of samples at 100 Hz that begin at 0.01 s: an IMU at rest, its readings never the same
/// twice, changed by `change`.
inline std::string imu_table(std::size_t samples,
                             const std::function<void(std::size_t, SampleText&)>& change = {},
                             std::string_view separator = ",") {
    std::string text = "t";
    for (const char* name : {"gx", "gy", "gz", "ax", "ay", "az"})
        text += fmt::format("{}{}", separator, name);
    text += "\n";
    for (std::size_t i = 0; i < samples; ++i) {
        const double shake = 0.001 * std::sin(1.7 * static_cast<double>(i));
        SampleText sample{0.01 * static_cast<double>(i + 1),
                          0.01 + shake,
                          -0.02,
                          0.03,
                          0.1 + 10.0 * shake,
                          -0.2,
                          -9.79};
        if (change) change(i, sample);
        for (std::size_t k = 0; k < sample.size(); ++k)
            text += fmt::format("{}{:.6f}", k > 0 ? separator : "", sample[k]);
        text += "\n";
    }
    return text;
}

struct ReadImu {
    ImuTable head;
    std::vector<ImuRow> rows;
};

inline ReadImu read_imu_text(const Receiver& receiver, std::string_view text,
                             const imu::RecordingSpan& span = relative_span()) {
    const imu::StreamedImu streamed =
        imu::import_imu(receiver, {.name = "imu.csv", .bytes = text}, span);
    ReadImu read{.head = streamed.head, .rows = {}};
    streamed.give([&](const ImuRow& row) { read.rows.push_back(row); });
    EXPECT_EQ(std::ssize(read.rows), streamed.rows);
    return read;
}

/// What the verdict says of an IMU's gyros that are quieter than its grade.
inline std::string said_of_quiet_gyros(const Receiver& receiver, std::string_view text,
                                       const imu::RecordingSpan& span = relative_span()) {
    ReadImu read = read_imu_text(receiver, text, span);
    read.head.rows = std::move(read.rows);
    return quiet_gyros_text(read.head, *receiver.imu);
}

/// The failure of reading, as the user sees it; "read" where there is none.
inline std::string imu_failure(const Receiver& receiver, std::string_view text,
                               const imu::RecordingSpan& span = relative_span()) {
    try {
        (void)read_imu_text(receiver, text, span);
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.remedy().empty());
        return failure.what();
    }
    return "read";
}

inline bool imu_has_note(const ReadImu& read, std::string_view part) {
    return std::ranges::any_of(read.head.notes,
                               [&](const std::string& note) { return has(note, part); });
}

}  // namespace runcert::import_test
