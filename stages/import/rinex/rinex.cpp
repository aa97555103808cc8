#include "stages/import/rinex/rinex.h"

#include "stages/import/format.h"

namespace runcert::rinex {

bool recognises(std::string_view bytes) {
    return bytes.substr(0, 81).find("RINEX VERSION") != std::string_view::npos;
}

bool is_chosen(const Receiver& receiver, const RecordingBytes& recording) {
    const bool any = receiver.format.empty() || receiver.format == "auto";
    return receiver.format == "rinex" || (any && recognises(recording.bytes));
}

extern const Format format{
    .name = "rinex",
    .what = "RINEX with base and navigation files",
    .place = 110,
    .of_satellites = true,
    .time_origin = "GPS time of the receiver's measurements, as RTKLIB solved it",
};

}  // namespace runcert::rinex
