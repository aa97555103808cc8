#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "schemas/attempt/attempt.h"
#include "schemas/observations/observations.h"
#include "stages/import/recording.h"

/// GPX 1.0 and 1.1 tracks (Topografix, "GPX 1.1 Schema Documentation"), with any namespace prefix.
namespace runcert::gpx {

/// A tag of an XML text.
struct Tag {
    enum class Kind { start, end, empty, broken };
    Kind kind = Kind::start;
    bool closing = false;   ///< whether it begins with "</"
    std::string_view name;  ///< without its namespace prefix
    std::size_t begin = 0;  ///< offset of its '<'
    std::size_t end = 0;    ///< offset behind its '>'; of a broken one, where to read on
};

/// The first tag of an XML text; nothing where it is none.
std::optional<Tag> root_tag(std::string_view bytes);

/// A GPX as observations; the header is left for the caller. Each track point is an epoch. Records
/// that cannot be read are counted and listed. Failure where it holds no track point, none with a
/// time, or most of them cannot be read.
///
/// Speed (m/s) and course are those of GPX 1.0, or any extension's elements of these names. A GPX
/// states no accuracy: hdop is a geometry, not one.
Observations read(const Receiver& receiver, const RecordingBytes& recording);

}  // namespace runcert::gpx
