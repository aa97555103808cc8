#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/optional_number.h"

namespace runcert {

/// A recording in memory. `bytes` belongs to the caller.
struct RecordingBytes {
    std::string name;  ///< of the file, for messages
    std::string_view bytes;
    /// Called now and then with how many of the bytes a reader has gone through: their memory may
    /// be released.
    std::function<void(std::size_t bytes)> passed = {};
};

/// One line of a recording, without its line end (LF or CR LF).
struct SourceLine {
    std::string_view text;
    std::int64_t number = 0;  ///< counted from 1
    std::int64_t byte = 0;    ///< offset of its first byte in the file, counted from 0
    bool ended = true;        ///< false for a last line without a line end
};

/// How much of a recording `recognises` of a format is given to look at.
inline constexpr std::size_t recognised_by = std::size_t{64} * 1024;

/// Where a record of a recording begins.
struct RecordPlace {
    OptionalInteger line;   ///< counted from 1; empty in binary formats
    std::int64_t byte = 0;  ///< offset in the file, counted from 0

    RecordPlace(const SourceLine& source) : line(source.number), byte(source.byte) {}
    explicit RecordPlace(std::size_t offset) : byte(static_cast<std::int64_t>(offset)) {}
};

/// "file:line" or "file:byte N" of a record.
std::string place_in(const RecordingBytes& recording, const RecordPlace& place);

/// Goes through a recording line by line. A UTF-8 byte order mark is passed over: it belongs to
/// no line, but counts in the offsets.
class LineReader {
  public:
    /// No line of any format is longer, in bytes.
    static constexpr std::size_t longest_line = std::size_t{1024} * 1024;

    explicit LineReader(const RecordingBytes& recording);
    /// Without a name for messages: for those who only look.
    explicit LineReader(std::string_view bytes);

    /// The next line; nothing at the end. Failure for one that is longer than `longest_line`,
    /// found without reading on.
    std::optional<SourceLine> next();

    /// Whether every line has been given.
    bool at_end() const { return offset_ >= bytes_.size(); }

    bool has_byte_order_mark() const { return has_byte_order_mark_; }

  private:
    RecordingBytes recording_;
    std::string_view bytes_;
    std::size_t offset_ = 0;
    std::size_t passed_ = 0;
    std::int64_t line_ = 0;
    bool has_byte_order_mark_ = false;
};

/// Failure, in words of its own, for a recording that is empty, or of a kind that no format begins
/// as (an archive, a film, UTF-32 text: see NotRead): none is even tried on these. It looks at
/// the beginning alone.
void require_readable(const RecordingBytes& recording);

/// The same, and Failure where the beginning holds NUL bytes: no text.
void require_text(const RecordingBytes& recording);

/// A kind of file that is recognised and not read, and what its owner can do.
struct NotRead {
    std::string_view name;  ///< "a ZIP archive"
    /// How it is recognised: these bytes at that offset, or anywhere in the beginning of a file of
    /// the kind above; or, of texts, the beginning of one of the first lines.
    std::string_view bytes;
    std::string_view remedy;
    /// Whether it is refused whatever the attempt says: no format that is read begins so.
    bool never_read = false;
    std::size_t offset = 0;
    bool is_line = false;
};

/// All kinds; of those that begin alike the more special first.
std::span<const NotRead> kinds_not_read();

/// Failure for a recording of a kind that is recognised and not read; of all of them, or of those
/// that no format begins as.
void refuse_not_read(const RecordingBytes& recording, bool only_never_read);

/// Whether the bytes begin as UTF-16 text: with its byte order mark, or with every second byte NUL
/// as of letters that ASCII has, too.
bool is_utf16(std::string_view bytes);

/// A UTF-16 recording as UTF-8 (Unicode 15, section 3.9), without its byte order mark. Failure,
/// with the byte, for a surrogate that stands alone and for half a code unit at the end.
std::string utf8_of_utf16(const RecordingBytes& recording);

}  // namespace runcert
