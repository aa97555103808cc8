#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "stages/import/format.h"
#include "stages/import/osnma/osnma.h"
#include "stages/import/ubx/epoch.h"
#include "stages/import/ubx/frames.h"
#include "stages/import/ubx/raw.h"

/// u-blox UBX logs: NAV-PVT, NAV-HPPOSLLH, NAV-COV and NAV-DOP frames, or those of older receivers,
/// between which other bytes may stand.
namespace runcert::ubx {
namespace {

constexpr MessageId raw_measurements = 0x0215;  ///< RXM-RAWX
constexpr MessageId navigation_bits = 0x0213;   ///< RXM-SFRBX
constexpr MessageId receiver_version = 0x0a04;  ///< MON-VER
constexpr MessageId chip_identity = 0x2703;     ///< SEC-UNIQID

/// A text of a fixed size, filled up with NUL; empty where it is not printable.
std::string_view text_at(std::string_view payload, std::size_t at, std::size_t size) {
    const std::string_view field = payload.substr(std::min(at, payload.size()), size);
    const std::string_view text = trim(field.substr(0, field.find('\0')));
    return is_printable_ascii(text) ? text : std::string_view();
}

/// Model and firmware of a MON-VER: those that its extensions name; else no model, which its
/// hardware version is not, and the version of its software.
Instrument instrument_of(std::string_view version) {
    constexpr std::size_t extensions_at = 40, extension_size = 30, software_size = 30;
    Instrument found{.make = "u-blox", .firmware = std::string(text_at(version, 0, software_size))};
    for (std::size_t at = extensions_at; at + extension_size <= version.size();
         at += extension_size) {
        const std::string_view extension = text_at(version, at, extension_size);
        if (extension.starts_with("MOD=")) found.model = extension.substr(4);
        if (extension.starts_with("FWVER=")) found.firmware = extension.substr(6);
    }
    return found;
}

/// "u-blox ZED-F9P, firmware HPG 1.13": the hardware version where no model is named.
std::string device_of(std::string_view version, const Instrument& instrument) {
    constexpr std::size_t hardware_at = 30, hardware_size = 10;
    return fmt::format("u-blox {}, firmware {}",
                       instrument.model.empty() ? text_at(version, hardware_at, hardware_size)
                                                : std::string_view(instrument.model),
                       instrument.firmware);
}

/// The identity of a SEC-UNIQID in hexadecimal: 5 bytes of version 1, 6 of version 2; empty of
/// another.
std::string identity_of(std::string_view payload) {
    constexpr std::size_t identity_at = 4;
    const std::size_t size = payload.empty() ? 0 : payload[0] == 1 ? 5 : payload[0] == 2 ? 6 : 0;
    if (size == 0 || payload.size() < identity_at + size) return {};
    std::string text;
    for (const char byte : payload.substr(identity_at, size))
        text += fmt::format("{:02X}", static_cast<unsigned char>(byte));
    return text;
}

/// Reads a recording frame by frame, and joins those of one navigation epoch.
class UbxReader {
  public:
    UbxReader(const Receiver& receiver, const RecordingBytes& recording)
        : receiver_(receiver),
          recording_(recording),
          frames_(recording, frame_kind),
          maker_(recording),
          timed_(recording, WrittenResolution(CoordinateUnit::degree, 1e-7, 1e-9)) {}

    Observations read() {
        while (const auto frame = frames_.next()) {
            if (frame->good())
                add_frame(*frame);
            else
                timed_.count_bad(RecordPlace(frame->offset), frames_.failure_of(*frame),
                                 epoch_ && epoch_->is_whole());
        }
        finish_epoch();
        require_rows();
        observations_.variant = variant();
        observations_.time_scale = maker_.tally().in_utc > 0 ? "utc" : "gps";
        set_instrument(observations_, instrument_);
        if (auto found = signed_pages_.verify(osnma::public_keys(receiver_))) {
            if (found->result == NavigationAuthenticity::contradicted)
                observations_.notes.push_back("The recorded navigation messages are not as "
                                              "Galileo signed them: " +
                                              found->reason + ".");
            observations_.signed_navigation.push_back(std::move(*found));
        }
        set_rows(observations_, std::move(timed_));
        set_resolution();
        add_notes();
        return std::move(observations_);
    }

  private:
    static unsigned bit_of(Part part) { return 1U << static_cast<unsigned>(part); }

    void add_frame(const Frame& frame) {
        timed_.count_good();
        const MessageId id = id_of(frame.bytes);
        const std::string_view payload = payload_of(frame);
        if (id == raw_measurements) ++raw_;
        if (id == navigation_bits)
            if (const auto page = e1_page(payload))
                signed_pages_.add(page->satellite, page->page, last_time_);
        if (id == receiver_version) {
            const std::string serial = std::move(instrument_.serial);
            instrument_ = instrument_of(payload);
            instrument_.serial = serial;
            observations_.device = device_of(payload, instrument_);
        }
        if (id == chip_identity) {
            instrument_.make = "u-blox";
            instrument_.serial = identity_of(payload);
        }
        const auto part = part_of(frame);
        if (!part) return;
        const std::uint32_t time_ms = time_of_week_ms(*part, payload);
        if (epoch_ && epoch_->time_of_week_ms != time_ms) finish_epoch();
        if (!epoch_) {
            epoch_.emplace();
            epoch_->time_of_week_ms = time_ms;
        }
        auto& place = epoch_->parts[static_cast<std::size_t>(*part)];
        if (place)
            ++repeated_;
        else
            place = frame;
        parts_ |= bit_of(*part);
    }

    void finish_epoch() {
        const std::optional<Epoch> epoch = std::exchange(epoch_, std::nullopt);
        if (!epoch || !(epoch->is_whole() || (epoch->has_position() && of_older_receivers())))
            return;
        try {
            if (const auto row = maker_.row(*epoch)) {
                last_time_ = row->instant;
                timed_.add(*row, epoch->place());
            }
        } catch (const Failure& failure) {
            // The frames were whole: what they say is counted as a record of its own.
            timed_.count_bad(epoch->place(), failure);
            if (!first_impossible_) first_impossible_ = failure;
        }
    }

    /// Whether dates come in messages of their own, which may be rarer than positions.
    bool of_older_receivers() const {
        return (parts_ & bit_of(Part::pvt)) == 0 && (parts_ & bit_of(Part::hpposllh)) != 0;
    }

    void require_rows() const {
        if (!timed_.empty() || timed_.records().total == 0 ||
            2 * timed_.records().bad > timed_.records().total)
            return;
        if (first_impossible_) throw *first_impossible_;
        const std::string where = place_in(recording_, RecordPlace(std::size_t{0}));
        if (maker_.tally().without_time > 0)
            throw Failure(where,
                          fmt::format("the receiver knew the time in none of the recording's {} "
                                      "navigation epochs",
                                      maker_.tally().without_time),
                          "Record again under open sky, until the receiver has a fix");
        if (parts_ & (bit_of(Part::posllh) | bit_of(Part::hpposllh)))
            throw Failure(where,
                          "the recording holds positions (NAV-POSLLH), and nothing that says their "
                          "date",
                          "Switch UBX-NAV-SOL on, too, or NAV-TIMEGPS, and record again");
        if (raw_ > 0)
            throw Failure(where,
                          fmt::format("the recording holds raw measurements ({} RXM-RAWX) and no "
                                      "NAV-PVT messages, and so no positions",
                                      raw_),
                          "Convert it to RINEX with RTKLIB's convbin, and give that to the "
                          "attempt with base and navigation files (format: rinex)");
        throw Failure(where,
                      fmt::format("none of the recording's {} UBX frames is a NAV-PVT message, and "
                                  "so there are no positions",
                                  timed_.records().total),
                      "Switch UBX-NAV-PVT on in the receiver (u-center: Messages view), and record "
                      "again");
    }

    /// "UBX with NAV-PVT, NAV-HPPOSLLH".
    std::string variant() const {
        std::string text = "UBX with";
        for (std::size_t i = 0; i < part_messages.size(); ++i)
            if ((parts_ >> i) & 1U)
                text += fmt::format("{} NAV-{}", text.ends_with("with") ? "" : ",",
                                    part_messages[i].name);
        return text;
    }

    /// Positions that are all of HPPOSLLH are finer than those of PVT.
    void set_resolution() {
        if (maker_.tally().high_precision == 0 || maker_.tally().standard_precision > 0) return;
        for (const Observation& row : observations_.rows) {
            if (!row.latitude_deg) continue;
            observations_.facts.position_resolution_m =
                WrittenResolution(CoordinateUnit::degree, 1e-9, 1e-9)
                    .position_m(Angle::from_degrees(*row.latitude_deg));
            return;
        }
    }

    void note(std::string_view what, std::int64_t count) {
        if (count > 0) observations_.notes.push_back(fmt::format("{}: {}.", what, count));
    }

    void add_notes() {
        const RowTally& tally = maker_.tally();
        note("Bytes between the frames that are neither NMEA nor RTCM, and were passed over",
             frames_.junk_bytes());
        note("Navigation epochs before the receiver knew the time, which were left out",
             tally.without_time);
        note("Messages that repeat one of the same kind and epoch, and were left out", repeated_);
        note(
            "Epochs whose UTC is whole seconds off the GPS time of week, because the receiver had "
            "yet to receive the leap seconds; the time of week counts",
            tally.other_second);
        note(
            "Epochs dated by a GPS week that is 1024 or 2048 too small, a rollover that the "
            "receiver does not know of. They are dated as many weeks later, to when there were as "
            "many leap "
            "seconds as it counts",
            tally.rolled_over);
        note("Epochs that are two-dimensional solutions, whose height was assumed and not measured",
             tally.in_plane);
        note(
            "Epochs in which satellites and dead reckoning are combined, which count as dead "
            "reckoning",
            tally.with_dead_reckoning);
        note(
            "Positions of NAV-SOL, in whole centimetres; with NAV-POSLLH recorded, too, they are "
            "finer",
            tally.of_solution);
        note("Epochs without a date, whose week is that of the NAV-TIMEGPS nearest to them",
             tally.by_week);
        if (parts_ & bit_of(Part::pvt)) return;
        observations_.notes.push_back(
            "The recording has no NAV-PVT messages; those of older receivers are used instead.");
    }

    const Receiver& receiver_;
    const RecordingBytes& recording_;
    FrameReader frames_;
    RowMaker maker_;
    RowCollector timed_;
    Observations observations_ = empty_observations("ubx", "geodetic", {});
    std::optional<Epoch> epoch_;
    std::optional<Failure> first_impossible_;  ///< of an epoch whose frames were whole
    unsigned parts_ = 0;                       ///< bit set of the Parts that were there
    std::int64_t raw_ = 0;
    Instrument instrument_;
    osnma::PageCollector signed_pages_;
    std::optional<GpsTime> last_time_;  ///< of the last epoch
    std::int64_t repeated_ = 0;
};

bool recognises(std::string_view bytes) {
    FrameReader frames({{}, bytes}, frame_kind);
    bool any = false;
    while (const auto frame = frames.next()) {
        if (!frame->good()) continue;
        any = true;
        const auto part = part_of(*frame);
        if (part == Part::pvt || part == Part::posllh || part == Part::sol ||
            part == Part::hpposllh)
            return true;
    }
    // Receivers can mix both, and then the positions may be in NMEA sentences alone.
    return any && !find_format("nmea")->recognises(bytes);
}

Observations read(const Receiver& receiver, const RecordingBytes& recording) {
    Observations observations = UbxReader(receiver, recording).read();
    apply_attempt(observations, receiver);
    return observations;
}

}  // namespace

extern const Format format{
    .name = "ubx",
    .what = "u-blox UBX",
    .place = 50,
    .stamps_satellite_time = true,
    .time_origin = "UTC of the receiver's navigation solutions",
    .recognises = recognises,
    .read = read,
};

}  // namespace runcert::ubx
