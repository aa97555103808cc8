#include <fmt/format.h>

#include <array>
#include <limits>

#include "core/text.h"
#include "stages/import/byte_order.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/format.h"

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

/// The length that the two bytes at `at` announce; 0 where no frame begins with them.
std::size_t announced_length(std::string_view bytes, std::size_t at) {
    if (bytes.size() - at < 2 || bytes[at + 1] != second_byte) return 0;
    const unsigned kind = static_cast<unsigned char>(bytes[at]) - unsigned{header_kind};
    return kind < lengths.size() ? lengths[kind] : 0;
}

/// The whole frame with a good checksum that begins at `at`; empty where there is none.
///
/// The checksum is Fletcher's with 8 bits, as in u-blox UBX, over the frame without the checksum's
/// own bytes 2 and 3.
std::string_view frame_at(std::string_view bytes, std::size_t at) {
    const std::size_t length = announced_length(bytes, at);
    if (length == 0 || bytes.size() - at < length) return {};
    const std::string_view frame = bytes.substr(at, length);
    std::uint32_t first = 0, second = 0;
    const auto take = [&](char byte) { second += first += static_cast<unsigned char>(byte); };
    take(frame[0]);
    take(frame[1]);
    for (std::size_t i = 4; i < length; ++i)
        take(frame[i]);
    const bool good = (first & 0xFF) == static_cast<unsigned char>(frame[2]) &&
                      (second & 0xFF) == static_cast<unsigned char>(frame[3]);
    return good ? frame : std::string_view();
}

/// Where the next whole frame with a good checksum begins, at `from` or after; the end of `bytes`
/// where there is none.
std::size_t find_frame(std::string_view bytes, std::size_t from) {
    for (std::size_t second = bytes.find(second_byte, from + 1); second != std::string_view::npos;
         second = bytes.find(second_byte, second + 1))
        if (!frame_at(bytes, second - 1).empty()) return second - 1;
    return bytes.size();
}

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
class Reader {
  public:
    explicit Reader(const RecordingBytes& recording)
        : recording_(recording),
          bytes_(recording.bytes),
          timed_(recording, {CoordinateUnit::degree, 1e-7, 1e-3}) {}

    Observations read() {
        std::size_t at = 0;
        while (at < bytes_.size()) {
            const std::string_view frame = frame_at(bytes_, at);
            if (frame.empty()) {
                at = pass_damage(at);
                continue;
            }
            read_frame(frame, at);
            at += frame.size();
        }
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

    /// So much is looked through before what was found is counted: where a file holds nothing but
    /// beginnings of frames, looking for one takes long.
    static constexpr std::size_t longest_search = std::size_t{4} * 1024 * 1024;

    /// Counts what stands before the next frame as so many records as would fit there. Returns
    /// where that frame begins, or where to go on looking.
    std::size_t pass_damage(std::size_t from) {
        const std::size_t next = find_frame(bytes_.substr(0, from + longest_search), from + 1);
        const Failure why(place_in(recording_, RecordPlace(from)), what_is_wrong(from, next),
                          "Take the recording as the logger wrote it");
        timed_.count_bad(RecordPlace(from), why);
        const std::size_t length = announced_length(bytes_, from);
        for (std::size_t at = from + (length > 0 ? length : epoch_length); at < next;
             at += epoch_length)
            timed_.count_bad(RecordPlace(at), why);
        return next;
    }

    std::string what_is_wrong(std::size_t from, std::size_t next) const {
        const std::size_t length = announced_length(bytes_, from);
        if (length > 0 && next - from == length)
            return "the checksum of the record does not match its bytes";
        if (length > 0 && bytes_.size() - from < length)
            return fmt::format("the file ends within a record: {} bytes of {} are there",
                               bytes_.size() - from, length);
        return fmt::format("{} bytes hold no record with a good checksum", next - from);
    }

    const RecordingBytes& recording_;
    std::string_view bytes_;
    std::int64_t other_frames_ = 0;
    Observations observations_ = empty_observations("oao", "geodetic", "utc");
    RowCollector timed_;
};

bool recognises(std::string_view bytes) {
    if (!frame_at(bytes, 0).empty()) return true;
    // A damaged header before sound epochs.
    const std::size_t length = announced_length(bytes, 0);
    return length > 0 && bytes.size() > length && !frame_at(bytes, length).empty();
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = Reader(recording).read();
    observations.notes.emplace_back(note_heights_above_sea_level);
    apply_attempt(observations, receiver);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "oao",
    .what = "Motion OAO",
    .place = 20,
    .of_satellites = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::oao
