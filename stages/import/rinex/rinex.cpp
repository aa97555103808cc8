#include "stages/import/rinex/rinex.h"

namespace runcert::rinex {

bool recognises(std::string_view bytes) {
    return bytes.substr(0, 81).find("RINEX VERSION") != std::string_view::npos;
}

bool is_chosen(const Receiver& receiver, const RecordingBytes& recording) {
    const bool any = receiver.format.empty() || receiver.format == "auto";
    return receiver.format == "rinex" || (any && recognises(recording.bytes));
}

}  // namespace runcert::rinex
