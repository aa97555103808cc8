#include "stages/import/gpsbabel/gpsbabel.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/fit/decode.h"
#include "stages/import/format.h"
#include "stages/import/gpx/gpx.h"

namespace runcert::gpsbabel {
namespace {

/// Formats of files with tracks that `gpsbabel -^3` of version 1.8.0 lists as readable.
std::vector<std::string_view> readable_types() {
    std::string_view text =
        "v900|iblue747|iblue757|gpl|saroute|destinator_trl|energympro|f90g|igc|garmin_fit|"
        "garmin_g1000|glogbook|gdb|garmin_txt|gtrnctr|ggv_ovl|ggv_bin|ggv_log|geojson|kml|"
        "gnav_trl|land_air_sea|gtm|gpx|hiketech|m241-bin|humminbird_ht|humminbird|ignrando|igo8|"
        "kompass_tk|lowranceusr|magellanx|magellan|ik3d|mainnav|mapasia_tr7|mtk_locus|mmo|"
        "garmin_xt|mtk-bin|mynav|tpo2|tpo3|sbp|sbn|navitel_trk|nmea|ozi|qstarz_bl-1000|ricoh|"
        "skytraq-bin|wintec_tes|wbt-bin|itracku-bin|";
    std::vector<std::string_view> types;
    for (; !text.empty(); text.remove_prefix(text.find('|') + 1))
        types.push_back(text.substr(0, text.find('|')));
    return types;
}

/// gpsbabel's name of a well-known format; empty where it is none.
std::string_view recognised_type(std::string_view bytes) {
    if (fit::is_fit(bytes)) return "garmin_fit";
    const auto root = gpx::root_tag(bytes);
    if (!root || root->kind != gpx::Tag::Kind::start) return {};
    if (root->name == "TrainingCenterDatabase") return "gtrnctr";
    return root->name == "kml" ? "kml" : "";
}

}  // namespace

bool recognises(std::string_view bytes) {
    return !recognised_type(bytes).empty();
}

std::string type_of(const Receiver& receiver, const RecordingBytes& recording) {
    const std::string_view type = receiver.gpsbabel_type.empty()
                                      ? recognised_type(recording.bytes.substr(0, recognised_by))
                                      : std::string_view(receiver.gpsbabel_type);
    if (type.empty())
        throw Failure(place_in(recording, 1, 1),
                      "the recording is to be read through gpsbabel, and its format is not "
                      "recognised",
                      "Write gpsbabel_type in the receiver, gpsbabel's name of the format");
    if (const auto types = readable_types(); std::ranges::find(types, type) == types.end())
        throw Failure(receiver.place.empty() ? "receiver " + receiver.id : receiver.place,
                      fmt::format("\"{}\" is not a format of files that gpsbabel reads tracks from",
                                  escape_for_message(type)),
                      fmt::format("Did you mean {}? Options are not taken", nearest(type, types)));
    return std::string(type);
}

Observations read_converted(const Receiver& receiver, const RecordingBytes& recording,
                            const std::string& type, const Converted& converted) {
    const RecordingBytes gpx{.name = recording.name + " (as GPX made by gpsbabel)",
                             .bytes = converted.gpx};
    Observations observations = gpx::read(receiver, gpx);
    observations.format = "gpsbabel";
    observations.variant = type;
    observations.device.clear();
    for (Observation& row : observations.rows) {
        row.source_line.reset();
        row.source_byte.reset();
    }
    observations.notes.insert(
        observations.notes.begin(),
        fmt::format(
            "The recording was read through gpsbabel, as its format {}: no accuracy that it may "
            "state was passed on, and rows are not traced to its bytes.",
            type));
    observations.header.programs = {converted.program};
    if (observations.records.bad > 0)
        observations.notes.push_back(
            "Places of track points that could not be read are those in gpsbabel's GPX.");
    return observations;
}

extern const Format format{
    .name = "gpsbabel",
    .what = "what gpsbabel reads",
    .place = 130,
    .time_origin = "times as converted by gpsbabel, whose clock is not said",
};

}  // namespace runcert::gpsbabel
