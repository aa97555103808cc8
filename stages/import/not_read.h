#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "stages/import/recording.h"

namespace runcert {

/// A kind of file that is recognised and not read, and what its owner can do.
struct NotRead {
    std::string_view name;  ///< "a ZIP archive"
    /// How it is recognised: these bytes at that offset, or anywhere in the beginning of a file of
    /// the kind above; or, of texts, the beginning of one of the first lines.
    std::string_view bytes;
    std::size_t offset = 0;
    bool is_line = false;
    std::string_view remedy;
    /// Whether it is refused whatever the attempt says: no format that is read begins so.
    bool never_read = false;
};

/// All kinds; of those that begin alike the more special first.
std::span<const NotRead> kinds_not_read();

/// Failure for a recording of a kind that is recognised and not read; of all of them, or of those
/// that no format begins as.
void refuse_not_read(const RecordingBytes& recording, bool only_never_read);

}  // namespace runcert
