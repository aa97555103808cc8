#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "stages/import/cell.h"

namespace runcert::novatel {

/// One ASCII log: "#BESTPOSA,COM1,0,85.0,FINESTEERING,1984,450849.500,...;fields*crc", or the same
/// with a short header, "%INSPVASA,1984,450849.500;fields*crc".
struct Log {
    std::string_view name;         ///< "BESTPOSA"
    std::string_view time_status;  ///< "FINESTEERING"; empty in a short header
    Cell week, seconds;            ///< of its header
    bool in_milliseconds = false;  ///< the seconds, as Unicore's receivers write them
    std::vector<Cell> fields;      ///< after the semicolon
};

/// Whether a line begins a log of this name, with a long or a short header.
bool is_log(std::string_view line, std::string_view name);

/// The name of the log that begins on a line; empty where none does.
std::string_view log_name(std::string_view line);

/// NovAtel's CRC-32: polynomial EDB88320, reflected, beginning with 0, not inverted at the end.
std::uint32_t crc32(std::string_view bytes);

/// Reads a log. Failure where the checksum is not that of the line, or the header is cut.
Log read_log(const SourceLine& line, const RecordingBytes& recording);

}  // namespace runcert::novatel
