#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/angle.h"
#include "core/failure.h"
#include "core/statistics.h"
#include "stages/import/byte_order.h"
#include "stages/import/imu/raw.h"
#include "stages/import/row_collector.h"
#include "stages/import/ubx/epoch.h"
#include "stages/import/ubx/frames.h"

namespace runcert::imu {
namespace {

constexpr ubx::MessageId esf_meas = 0x1002, esf_raw = 0x1003;
constexpr double gyro_unit_deg_s = 1.0 / 4096.0, accelerometer_unit_m_s2 = 1.0 / 1024.0;

/// Which of the six readings a type of data is: gyros x, y, z, then accelerometers; nothing for
/// temperatures, wheel ticks and such.
std::optional<std::size_t> reading_of(std::uint32_t type) {
    constexpr std::array<std::uint32_t, 6> types{14, 13, 5, 16, 17, 18};
    const auto found = std::ranges::find(types, type);
    if (found == types.end()) return std::nullopt;
    return static_cast<std::size_t>(found - types.begin());
}

/// The lower 24 bits, two's complement.
std::int32_t signed_24(std::uint32_t data) {
    return static_cast<std::int32_t>(data << 8) >> 8;
}

/// A sample with the sensor's time tag, and where it stands among the NAV-PVT messages.
struct TaggedSample {
    RawSample sample;
    std::int64_t tag = 0;  ///< counted on where the 32 bits begin anew
    std::size_t epochs_before = 0;
};

/// Goes through a log, and puts the readings of one tag together.
class EsfReader {
  public:
    explicit EsfReader(const RecordingBytes& file) : file_(file), maker_(file) {}

    void read() {
        ubx::FrameReader frames(file_.bytes);
        while (const auto frame = frames.next()) {
            if (frame->id == ubx::part_messages[0].id && frame->good)
                take_epoch(*frame);
            else if (frame->id == esf_meas || frame->id == esf_raw)
                take_data(*frame);
        }
    }

    std::vector<TaggedSample> samples;
    std::vector<GpsTime> epochs;  ///< of the NAV-PVT messages
    RecordLog log;

  private:
    void take_epoch(const ubx::Frame& frame) {
        if (ubx::part_of(frame) != ubx::Part::pvt) return;
        ubx::Epoch epoch{.time_of_week_ms = ubx::time_of_week_ms(ubx::Part::pvt, frame.payload),
                         .parts = {}};
        epoch.parts[0] = frame;
        try {
            if (const auto row = maker_.row(epoch)) epochs.push_back(row->instant);
        } catch (const Failure&) {
            // An epoch of an impossible position: its time is not used.
        }
    }

    void take_data(const ubx::Frame& frame) {
        const RecordPlace place(frame.offset);
        if (!frame.good) return log.count_bad(place, failure_of(frame, file_), count());
        const std::string_view payload = frame.payload;
        const bool raw = frame.id == esf_raw;
        const std::size_t head = raw ? 4 : 8, step = raw ? 8 : 4;
        if (payload.size() < head)
            return log.count_bad(place,
                                 Failure(place_in(file_, place), "the ESF message is cut short",
                                         "Hand in the log as the receiver wrote it"),
                                 count());
        const std::size_t said =
            raw ? payload.size() : little_endian<std::uint16_t>(payload, 4) >> 11U;
        for (std::size_t i = 0; i < said && head + (i + 1) * step <= payload.size(); ++i) {
            const std::size_t at = head + i * step;
            const auto data = little_endian<std::uint32_t>(payload, at);
            take_reading(data, little_endian<std::uint32_t>(payload, raw ? at + 4 : 0), raw,
                         frame.offset);
        }
        log.count_good();
    }

    void take_reading(std::uint32_t data, std::uint32_t tag, bool raw, std::size_t offset) {
        const auto reading = reading_of(raw ? data >> 24U : data >> 24U & 0x3fU);
        if (!reading) return;
        if (has_[*reading]) has_.fill(false);  // what was not completed is left out
        if (std::ranges::none_of(has_, [](bool has) { return has; }))
            current_ = {.sample = {.byte = static_cast<std::int64_t>(offset)}};
        has_[*reading] = true;
        const double value = signed_24(data);
        const auto axis = static_cast<Eigen::Index>(*reading % 3);
        if (*reading < 3)
            current_.sample.gyro[axis] = Angle::from_degrees(value * gyro_unit_deg_s).radians();
        else
            current_.sample.accelerometer[axis] = value * accelerometer_unit_m_s2;
        if (!std::ranges::all_of(has_, [](bool has) { return has; })) return;
        has_.fill(false);
        if (!samples.empty()) {
            // Steps of an unsigned count, which begins anew.
            const auto last = static_cast<std::uint32_t>(samples.back().tag);
            current_.tag = samples.back().tag + static_cast<std::int32_t>(tag - last);
        } else {
            current_.tag = tag;
        }
        current_.epochs_before = epochs.size();
        samples.push_back(current_);
    }

    std::int64_t count() const { return std::ssize(samples); }

    const RecordingBytes& file_;
    ubx::RowMaker maker_;
    TaggedSample current_;
    std::array<bool, 6> has_{};
};

/// A straight line of time over tags.
struct TagLine {
    std::int64_t tag0 = 0;
    GpsTime time0;
    double seconds_at_tag0 = 0.0, seconds_a_tag = 0.0;

    GpsTime at(std::int64_t tag) const {
        const double seconds = seconds_at_tag0 + seconds_a_tag * static_cast<double>(tag - tag0);
        return time0.plus_nanoseconds(std::llround(seconds * 1e9));
    }
};

/// By least squares, the samples between two NAV-PVT messages spread evenly between their times.
/// Nothing where fewer than ten stand between two.
std::optional<TagLine> line_of(const std::vector<TaggedSample>& samples,
                               const std::vector<GpsTime>& epochs) {
    if (epochs.size() < 2 || samples.empty()) return std::nullopt;
    TagLine line{.tag0 = samples.front().tag, .time0 = epochs.front()};
    double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
    for (std::size_t i = 0; i < samples.size();) {
        std::size_t end = i;
        while (end < samples.size() && samples[end].epochs_before == samples[i].epochs_before)
            ++end;
        const std::size_t before = samples[i].epochs_before;
        if (before > 0 && before < epochs.size())
            for (std::size_t k = i; k < end; ++k) {
                const double part = static_cast<double>(k - i + 1) / static_cast<double>(end - i);
                const double y = epochs[before - 1].seconds_since(line.time0) +
                                 part * epochs[before].seconds_since(epochs[before - 1]);
                const auto x = static_cast<double>(samples[k].tag - line.tag0);
                n += 1.0, sx += x, sy += y, sxx += x * x, sxy += x * y;
            }
        i = end;
    }
    const double determinant = n * sxx - sx * sx;
    if (n < 10.0 || !(determinant > 0.0)) return std::nullopt;
    line.seconds_a_tag = (n * sxy - sx * sy) / determinant;
    line.seconds_at_tag0 = (sy - line.seconds_a_tag * sx) / n;
    return line;
}

/// Without NAV-PVT: the tags' unit by the nominal rate.
double nanoseconds_a_tag(const std::vector<TaggedSample>& samples, double rate_hz) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < samples.size(); ++i)
        steps.push_back(static_cast<double>(samples[i].tag - samples[i - 1].tag));
    const double step = steps.empty() ? 0.0 : median(std::move(steps));
    return step > 0.0 ? 1e9 / rate_hz / step : 0.0;
}

}  // namespace

bool is_esf(std::string_view bytes) {
    ubx::FrameReader frames(bytes);
    while (const auto frame = frames.next())
        if (frame->good && (frame->id == esf_meas || frame->id == esf_raw)) return true;
    return false;
}

RawFile read_esf(const Receiver& receiver, const RecordingBytes& file) {
    const Imu& imu = *receiver.imu;
    EsfReader reader(file);
    reader.read();
    RawFile raw;
    raw.format = "ubx";
    const std::optional<TagLine> line = line_of(reader.samples, reader.epochs);
    if (!line && !(imu.rate_hz && imu.start_gps))
        throw Failure(imu.place,
                      "sensor time tags of the ESF messages cannot be tied to GPS time: no NAV-PVT "
                      "messages stand between them",
                      "Log NAV-PVT beside ESF; or give rate_hz, and start_gps, the GPS time of the "
                      "first sample");
    raw.stamps = line && !imu.start_gps ? Stamps::gps : Stamps::count;
    const double tag_ns = line ? 0.0 : nanoseconds_a_tag(reader.samples, *imu.rate_hz);
    for (const TaggedSample& one : reader.samples) {
        RawSample sample = one.sample;
        sample.time_ns =
            line ? line->at(one.tag).nanoseconds()
                 : std::llround(static_cast<double>(one.tag - reader.samples.front().tag) * tag_ns);
        raw.samples.push_back(sample);
    }
    raw.records = std::move(reader.log).finish(raw.notes);
    if (line)
        raw.notes.push_back(fmt::format(
            "Sensor time tags are tied to GPS time by the NAV-PVT messages between them, {} ms a "
            "tag; a constant delay of the messages remains.",
            fmt::format("{:.6f}", line->seconds_a_tag * 1e3)));
    raw.notes.push_back(
        "ESF messages are read by their published description; no recorded log was at hand.");
    return raw;
}

}  // namespace runcert::imu
