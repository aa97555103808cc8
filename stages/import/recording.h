#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// A recording in memory. `bytes` belongs to the caller.
struct RecordingBytes {
    std::string name;  ///< of the file, for messages
    std::string_view bytes;
};

/// One line of a recording, without its line end (LF or CR LF).
struct SourceLine {
    std::string_view text;
    std::int64_t number = 0;  ///< counted from 1
    std::int64_t byte = 0;    ///< offset of its first byte in the file, counted from 0
    bool ended = true;        ///< false for a last line without a line end
};

/// Goes through a recording line by line. A UTF-8 byte order mark is passed over: it belongs to
/// no line, but counts in the offsets.
class LineReader {
  public:
    explicit LineReader(std::string_view bytes);

    /// The next line; nothing at the end.
    std::optional<SourceLine> next();

    /// Whether every line has been given.
    bool at_end() const { return offset_ >= bytes_.size(); }

    bool has_byte_order_mark() const { return has_byte_order_mark_; }

  private:
    std::string_view bytes_;
    std::size_t offset_ = 0;
    std::int64_t line_ = 0;
    bool has_byte_order_mark_ = false;
};

/// Failure, in words of its own, for a recording that is empty, an archive, UTF-16 or -32 text or
/// binary: the formats of text are not even tried on these.
void require_text(const RecordingBytes& recording);

}  // namespace runcert
