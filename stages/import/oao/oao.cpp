#include "stages/import/oao/oao.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "stages/import/format.h"
#include "stages/import/oao/frame.h"
#include "stages/import/row_collector.h"

namespace runcert::oao {
namespace {

constexpr double coordinate_step_deg = 1e-7;
constexpr double time_step_s = 1e-3;
constexpr const char* remedy_for_damage = "Take the recording as the logger wrote it";

/// Goes through a recording frame by frame.
class Reader {
  public:
    explicit Reader(const RecordingBytes& recording)
        : recording_(recording),
          bytes_(recording.bytes),
          epochs_(recording),
          timed_(recording, {CoordinateUnit::degree, coordinate_step_deg, time_step_s}) {
        observations_.format = "oao";
        observations_.frame = "geodetic";
        observations_.time_scale = "utc";
    }

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
        switch (kind_of(frame)) {
            case FrameKind::epoch_on_the_second:
            case FrameKind::epoch_between_seconds: {
                const RecordPlace place(at);
                timed_.add_record(place, [&] { return epochs_.read(frame, place); });
                return;
            }
            case FrameKind::header:
                read_header(frame);
                break;
            default:
                ++other_frames_;
                break;
        }
        timed_.count_good();
    }

    void read_header(std::string_view frame) {
        if (!observations_.device.empty()) return;
        observations_.device = device_of(frame);
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
                          remedy_for_damage);
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
    EpochReader epochs_;
    std::int64_t other_frames_ = 0;
    Observations observations_;
    RowCollector timed_;
};

}  // namespace

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
