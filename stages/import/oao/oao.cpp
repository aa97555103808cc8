#include <fmt/format.h>

#include <array>
#include <limits>

#include "core/text.h"
#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"
#include "stages/import/frame_reader.h"

/// Motion OAO logs: frames of u-blox solutions, one to an epoch, little-endian, each with a
/// checksum. Layout: "OAO file format" of Motion GPS, as the loggers' public writers have it and
/// the files in hand confirm.
namespace runcert::oao {
namespace {

/// First bytes of frames; the second is always 0x0A.
constexpr std::uint8_t header_kind = 0xD0, epoch_on_the_second = 0xD4, epoch_between_seconds = 0xD5;
constexpr char second_byte = 0x0A;
constexpr std::size_t epoch_length = 52;
/// Bytes of a frame, by its first byte from `header_kind` on: header, track, emergency, point of
/// interest, epochs on the second and between seconds, inertial measurements.
constexpr std::array<std::size_t, 7> lengths{512, 12, 34, 34, epoch_length, epoch_length, 32};

/// The fields of an epoch; lengths in m, speeds in m/s, angles in degrees.
namespace field {
constexpr NumberField<std::int32_t> latitude{4, 1e-7}, longitude{8, 1e-7};
constexpr NumberField<std::int32_t> height{12, 1e-3};  ///< above mean sea level
constexpr NumberField<std::uint32_t> speed{16, 1e-3}, course{20, 1e-5};
constexpr NumberField<std::int64_t> time_ms{24};  ///< since 1970-01-01 UTC
constexpr NumberField<std::uint8_t> fix{32};      ///< fixType of UBX-NAV-PVT
constexpr NumberField<std::uint8_t> satellites{33};
constexpr NumberField<std::uint32_t> speed_sigma{34, 1e-3}, horizontal_sigma{38, 1e-3},
    vertical_sigma{42, 1e-3};  ///< then heading accuracy and DOP
// And of a header.
constexpr NumberField<std::uint16_t> identifier{4}, firmware{424};  ///< 0: an older logger
constexpr std::size_t nickname_at = 6, nickname_length = 10, signature_at = 448;
}  // namespace field

constexpr std::int64_t first_ms = 315'964'800'000;   // 1980-01-06, the GPS epoch
constexpr std::int64_t last_ms = 7'258'118'400'000;  // 2200-01-01

constexpr std::uint32_t full_circle = 36'000'000;

[[noreturn]] void refuse(const RecordingBytes& recording, const RecordPlace& place,
                         const std::string& what) {
    throw Failure(place_in(recording, place), what,
                  "The record is damaged; take the recording as the logger wrote it");
}

/// A stated standard deviation; nothing where it is zero or stands at its limit.
std::optional<double> deviation(const NumberField<std::uint32_t>& field, std::string_view frame) {
    const std::uint32_t whole = field.whole(frame);
    if (whole == 0 || whole == std::numeric_limits<std::uint32_t>::max()) return std::nullopt;
    return field.real(frame);
}

/// Puts position and velocity, with their accuracies, into a row whose fix has them.
void read_solution(std::string_view frame, const RecordingBytes& recording,
                   const RecordPlace& place, Observation& row) {
    set_position(row,
                 checked_geodetic({.latitude = Angle::from_degrees(field::latitude.real(frame)),
                                   .longitude = Angle::from_degrees(field::longitude.real(frame)),
                                   .height_m = field::height.real(frame)},
                                  recording, place));
    const double course_deg = field::course.real(frame);
    if (field::course.whole(frame) > full_circle)
        refuse(recording, place, fmt::format("a course of {} degrees is impossible", course_deg));
    set_speed(row, field::speed.real(frame), Angle::from_degrees(course_deg));
    if (const auto sigma_m = deviation(field::horizontal_sigma, frame))
        set_radial_accuracy(row, *sigma_m);
    row.sigma_up_m = deviation(field::vertical_sigma, frame);
    if (const auto sigma_m_s = deviation(field::speed_sigma, frame))
        set_velocity_accuracy(row, *sigma_m_s, 2);
}

std::size_t announced_size(std::string_view ahead) {
    if (ahead.size() < 2 || ahead[1] != second_byte) return 0;
    const unsigned kind = static_cast<unsigned char>(ahead[0]) - unsigned{header_kind};
    return kind < lengths.size() ? lengths[kind] : 0;
}

/// The checksum is Fletcher's with 8 bits, as in u-blox UBX, over the frame without the checksum's
/// own bytes 2 and 3.
bool is_good(std::string_view frame, std::size_t offset, RunningChecksum& sums) {
    const auto byte = [&](std::size_t at) {
        return unsigned{little_endian<std::uint8_t>(frame, at)};
    };
    const unsigned behind = sums.of(offset + 4, frame.size() - 4);
    const unsigned before = byte(0) + byte(1);
    const unsigned first = before + (behind & 0xff);
    const unsigned second =
        byte(0) + before + static_cast<unsigned>(frame.size() - 4) * before + (behind >> 8);
    return (first & 0xff) == byte(2) && (second & 0xff) == byte(3);
}

constexpr FrameKind frame_kind{
    .size = announced_size, .is_good = is_good, .record_size = epoch_length};

/// The row of an epoch's frame. Failure at `place` for a fix, course, position or time that cannot
/// be.
///
/// u-blox does not say in how many dimensions the stated standard deviation of the speed counts. It
/// is taken as that of the speed over ground, the only one recorded: of the two readings the one
/// that claims less.
TimedRow read_epoch(std::string_view frame, const RecordingBytes& recording,
                    const RecordPlace& place) {
    TimedRow row;
    const std::int64_t unix_ms = field::time_ms.whole(frame);
    if (unix_ms < first_ms || unix_ms >= last_ms)
        refuse(recording, place,
               fmt::format("the time, {} ms since 1970, is not between 1980 and 2200", unix_ms));
    row.instant = instant_of_unix(unix_ms * 1'000'000, recording, place);
    const unsigned fix = field::fix.whole(frame);
    if (fix > 5)
        refuse(recording, place, fmt::format("the kind of fix is {}; u-blox has 0 to 5", fix));
    row.observation.fix = fix_of_ublox(fix);
    row.observation.satellites = field::satellites.whole(frame);
    // Without a fix the logger repeats or extrapolates the last position.
    if (row.observation.fix != FixType::none)
        read_solution(frame, recording, place, row.observation);
    return row;
}

/// What a header frame says of the logger: its number, firmware, name.
std::string device_of(std::string_view header) {
    std::string device = fmt::format("logger {}", field::identifier.whole(header));
    const std::string_view padded = header.substr(field::nickname_at, field::nickname_length);
    const std::string_view nickname = trim(padded.substr(0, padded.find('\0')));
    if (!nickname.empty()) device += fmt::format(" \"{}\"", escape_for_message(nickname));
    if (const std::uint16_t firmware = field::firmware.whole(header))
        device += fmt::format(", firmware {}", firmware);
    return device;
}

/// Whether a header frame carries the logger's signature.
bool is_signed(std::string_view header) {
    return header.substr(field::signature_at).find_first_not_of('\0') != std::string_view::npos;
}

/// Goes through a recording frame by frame.
class OaoReader {
  public:
    explicit OaoReader(const RecordingBytes& recording)
        : recording_(recording), timed_(recording, {CoordinateUnit::degree, 1e-7, 1e-3}) {}

    Observations read() {
        FrameReader frames(recording_, frame_kind);
        while (const auto frame = frames.next())
            if (frame->good())
                read_frame(frame->bytes, frame->offset);
            else
                timed_.count_bad(RecordPlace(frame->offset), frames.failure_of(*frame));
        if (other_frames_ > 0)
            observations_.notes.push_back(fmt::format(
                "{} records are of other kinds than epochs (marked places, tracks, emergencies, "
                "inertial measurements) and were left out.",
                other_frames_));
        set_rows(observations_, std::move(timed_));
        return std::move(observations_);
    }

  private:
    void read_frame(std::string_view frame, std::size_t at) {
        const auto kind = static_cast<unsigned char>(frame[0]);
        if (kind == epoch_on_the_second || kind == epoch_between_seconds) {
            const RecordPlace place(at);
            return timed_.add_record(place, [&] { return read_epoch(frame, recording_, place); });
        }
        if (kind == header_kind)
            read_header(frame);
        else
            ++other_frames_;
        timed_.count_good();
    }

    void read_header(std::string_view frame) {
        if (!observations_.device.empty()) return;
        observations_.device = device_of(frame);
        // Its number is no serial number: three loggers that were worn at once have the same.
        if (const std::uint16_t firmware = field::firmware.whole(frame))
            set_instrument(observations_, {.firmware = std::to_string(firmware)});
        if (is_signed(frame))
            observations_.notes.push_back(
                "The logger's own signature in the header was not checked.");
    }

    const RecordingBytes& recording_;
    std::int64_t other_frames_ = 0;
    Observations observations_ = empty_observations("oao", "geodetic", "utc");
    RowCollector timed_;
};

bool recognises(std::string_view bytes) {
    // Or a damaged header before sound epochs.
    FrameReader frames({{}, bytes}, frame_kind);
    auto frame = frames.next();
    const std::size_t behind = frame ? frame->bytes.size() : 0;
    if (frame && !frame->good()) frame = frames.next();
    return frame && frame->good() && (frame->offset == 0 || frame->offset == behind);
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = OaoReader(recording).read();
    observations.notes.emplace_back(note_heights_above_sea_level);
    apply_attempt(observations, receiver);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "oao",
    .what = "Motion OAO",
    .place = 20,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::oao
