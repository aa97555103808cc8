#include <fmt/format.h>

#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/fit/decode.h"
#include "stages/import/format.h"

/// FIT, as watches and cycling computers write it (Garmin, FIT SDK: protocol and profile).
/// Positions are those of `record` messages, whose times are whole seconds; or of `gps_metadata`,
/// in milliseconds, where a camera or logger wrote more of them.
namespace runcert::fit {
namespace {

constexpr std::uint16_t file_id = 0, record = 20, device_info = 23, gps_metadata = 160;
constexpr double degrees_per_semicircle = 180.0 / 2147483648.0;
/// 1989-12-31 UTC.
constexpr std::int64_t unix_of_fit_epoch_s = 631'065'600;
/// Smaller time stamps count from when the device was switched on.
constexpr std::uint32_t least_absolute_s = 0x10000000;

/// Fields of the two messages that hold positions.
struct Fields {
    std::uint8_t latitude, longitude;
    std::uint8_t height, coarse_height;  ///< both (value / 5 - 500) m
    std::uint8_t speed, coarse_speed;    ///< both mm/s
    std::optional<std::uint8_t> milliseconds = {}, heading = {}, velocity = {};
};

constexpr Fields record_fields{.latitude = 0,
                               .longitude = 1,
                               .height = 78,
                               .coarse_height = 2,
                               .speed = 73,
                               .coarse_speed = 6};
constexpr Fields metadata_fields{.latitude = 1,
                                 .longitude = 2,
                                 .height = 3,
                                 .coarse_height = 3,
                                 .speed = 4,
                                 .coarse_speed = 4,
                                 .milliseconds = 0,
                                 .heading = 5,
                                 .velocity = 7};

const Fields& fields_of(std::uint16_t number) {
    return number == record ? record_fields : metadata_fields;
}

bool has_position(const Message& message) {
    const Fields& fields = fields_of(message.number);
    return message.whole(fields.latitude, true) && message.whole(fields.longitude, true);
}

GpsTime instant_of(const Message& message, const RecordingBytes& recording) {
    const RecordPlace place(message.byte);
    if (!message.timestamp)
        throw Failure(place_in(recording, place), "the FIT message has no time stamp",
                      "Take the recording as the device wrote it");
    if (*message.timestamp < least_absolute_s)
        throw Failure(
            place_in(recording, place),
            fmt::format("the time stamp {} s counts from when the device was switched on",
                        *message.timestamp),
            "Record after the device has found satellites, and knows the time; or export GPX by "
            "its maker's program");
    std::int64_t milliseconds = 0;
    if (const auto field = fields_of(message.number).milliseconds)
        milliseconds = message.whole(*field).value_or(0);
    const std::int64_t seconds = *message.timestamp + unix_of_fit_epoch_s;
    return instant_of_unix(seconds * GpsTime::nanoseconds_per_second + milliseconds * 1'000'000,
                           recording, place);
}

void read_velocity(const Message& message, const Fields& fields, RecordedVelocity& row) {
    if (fields.velocity) {
        // Towards east, north, up, in cm/s.
        const auto part = [&](std::size_t i) {
            return message.whole(*fields.velocity, true, i, 2);
        };
        if (part(0) && part(1)) {
            set_velocity(row, static_cast<double>(*part(0)) * 0.01,
                         static_cast<double>(*part(1)) * 0.01);
            if (part(2)) row.recorded_velocity_up_m_s = static_cast<double>(*part(2)) * 0.01;
            return;
        }
    }
    auto speed = message.whole(fields.speed);
    if (!speed) speed = message.whole(fields.coarse_speed);
    if (!speed) return;
    std::optional<double> course_deg;
    if (fields.heading)
        if (const auto heading = message.whole(*fields.heading))
            course_deg = static_cast<double>(*heading) * 0.01;
    set_speed(row, static_cast<double>(*speed) * 1e-3, course_of(course_deg));
}

TimedRow read_row(const Message& message, const RecordingBytes& recording) {
    const Fields& fields = fields_of(message.number);
    TimedRow row;
    row.instant = instant_of(message, recording);
    auto height = message.whole(fields.height);
    if (!height) height = message.whole(fields.coarse_height);
    const auto degrees = [&](std::uint8_t field) {
        return Angle::from_degrees(static_cast<double>(*message.whole(field, true)) *
                                   degrees_per_semicircle);
    };
    set_position(
        row.observation,
        checked_geodetic({.latitude = degrees(fields.latitude),
                          .longitude = degrees(fields.longitude),
                          .height_m = height ? static_cast<double>(*height) / 5.0 - 500.0 : 0.0},
                         recording, RecordPlace(message.byte)));
    if (!height) row.observation.height_m.reset();
    read_velocity(message, fields, row.observation);
    return row;
}

/// What the file says of itself, and its messages with a position.
struct Contents {
    std::vector<Message> records, metadata;
    std::size_t records_without_position = 0;
    std::optional<std::int64_t> manufacturer, product;
    Instrument instrument;
    Decoded decoded;

    bool uses_metadata() const { return metadata.size() > records.size(); }
};

/// Garmin's numbers of manufacturers (FIT SDK, profile: manufacturer), those that make watches and
/// loggers for sports.
std::string name_of_manufacturer(std::int64_t number) {
    for (const auto& [known, name] : {std::pair(1, "Garmin"), std::pair(23, "Suunto"),
                                      std::pair(32, "Wahoo Fitness"), std::pair(123, "Polar")})
        if (number == known) return name;
    return fmt::format("manufacturer {} by FIT's numbers", number);
}

std::string text_of(const Message& message, std::uint8_t field) {
    const std::string_view text = message.field(field);
    return instrument_part(text.substr(0, text.find('\0')));
}

/// Of the device that made the file: `file_id`, and the `device_info` of device 0, its creator.
void read_instrument(const Message& message, Instrument& instrument) {
    const bool is_file_id = message.number == file_id;
    if (!is_file_id && (message.number != device_info || message.whole(0) != 0)) return;
    const std::uint8_t manufacturer = is_file_id ? 1 : 2, product_name = is_file_id ? 8 : 27;
    constexpr std::uint8_t serial = 3, software = 5;
    const auto set = [](std::string& part, std::string said) {
        if (part.empty()) part = std::move(said);
    };
    if (const auto number = message.whole(manufacturer))
        set(instrument.make, name_of_manufacturer(*number));
    set(instrument.model, text_of(message, product_name));
    if (const auto number = message.whole(serial); number && *number != 0)
        set(instrument.serial, std::to_string(*number));
    if (const auto version = message.whole(software); !is_file_id && version)
        set(instrument.firmware, fmt::format("{}.{:02}", *version / 100, *version % 100));
}

Contents read_contents(const RecordingBytes& recording) {
    Contents contents;
    contents.decoded = decode(recording, [&](const Message& message) {
        if (message.number == file_id && !contents.manufacturer) {
            contents.manufacturer = message.whole(1);
            contents.product = message.whole(2);
        }
        read_instrument(message, contents.instrument);
        if (message.number != record && message.number != gps_metadata) return;
        const bool is_record = message.number == record;
        if (has_position(message))
            (is_record ? contents.records : contents.metadata).push_back(message);
        else if (is_record)
            ++contents.records_without_position;
    });
    return contents;
}

void note(Observations& observations, const Contents& contents) {
    observations.notes.push_back(
        contents.uses_metadata()
            ? "Positions are those of gps_metadata messages."
            : "Positions are those of record messages, whose times are whole seconds: what "
              "the device rounded off is not known.");
    observations.notes.emplace_back(note_heights_above_sea_level);
    if (contents.decoded.files > 1)
        observations.notes.push_back(fmt::format(
            "The recording holds {} FIT files, one after the other.", contents.decoded.files));
    if (contents.decoded.unfinished)
        observations.notes.push_back(
            "The device did not close the file: its size and checksum are not there, and nothing "
            "shows whether bytes were changed.");
    if (!contents.uses_metadata() && contents.records_without_position > 0)
        observations.notes.push_back(fmt::format("{} records have no position, and are no epochs.",
                                                 contents.records_without_position));
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    require_readable(recording);
    const Contents contents = read_contents(recording);
    const bool metadata = contents.uses_metadata();
    RowCollector timed(recording, WrittenResolution(CoordinateUnit::degree, degrees_per_semicircle,
                                                    metadata ? 1e-3 : 1.0));
    for (const Message& message : metadata ? contents.metadata : contents.records)
        timed.add_record(RecordPlace(message.byte), [&] { return read_row(message, recording); });
    Observations observations = empty_observations("fit", "geodetic", "utc");
    if (contents.manufacturer)
        observations.device = fmt::format("manufacturer {}, product {} by FIT's numbers",
                                          *contents.manufacturer, contents.product.value_or(0));
    Instrument instrument = contents.instrument;
    if (instrument.model.empty() && contents.product)
        instrument.model = fmt::format("product {} by FIT's numbers", *contents.product);
    set_instrument(observations, instrument);
    set_rows(observations, std::move(timed));
    note(observations, contents);
    apply_attempt(observations, receiver);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "fit",
    .what = "FIT",
    .place = 55,
    .time_origin = "the device's UTC, which it may set by the satellites",
    .recognises = is_fit,
    .read = read,
};

}  // namespace runcert::fit
