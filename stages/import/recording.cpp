#include "stages/import/recording.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "stages/import/not_read.h"

namespace runcert {
namespace {

/// Bytes between two calls of `passed`.
constexpr std::size_t passed_by = std::size_t{16} << 20;

constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";

[[noreturn]] void fail(const RecordingBytes& recording, std::string_view what,
                       std::string_view remedy) {
    throw Failure(recording.name + ":1:1", std::string(what), std::string(remedy));
}

void refuse_nul(const RecordingBytes& recording, std::size_t at) {
    const std::string_view before = recording.bytes.substr(0, at);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is 0
    throw Failure(
        fmt::format("{}:{}:{}", recording.name, line, at - line_start + 1),
        fmt::format("byte {} is NUL: the file is binary, or damaged", at),
        "Export the recording as text, or hand in the logger's own file: after a crash its "
        "program can save what is whole");
}

}  // namespace

std::string place_in(const RecordingBytes& recording, const RecordPlace& place) {
    if (place.line) return fmt::format("{}:{}", recording.name, *place.line);
    return fmt::format("{}:byte {}", recording.name, place.byte);
}

LineReader::LineReader(std::string_view bytes) : LineReader(RecordingBytes{{}, bytes}) {}

LineReader::LineReader(const RecordingBytes& recording)
    : recording_(recording),
      bytes_(recording.bytes),
      has_byte_order_mark_(bytes_.starts_with(byte_order_mark)) {
    if (has_byte_order_mark_) offset_ = byte_order_mark.size();
}

std::optional<SourceLine> LineReader::next() {
    if (at_end()) return std::nullopt;
    const std::string_view ahead = bytes_.substr(offset_, longest_line + 1);
    const std::size_t length = ahead.find('\n');
    if (length == std::string_view::npos && ahead.size() > longest_line)
        throw Failure(fmt::format("{}:{}:1", recording_.name, line_ + 1),
                      fmt::format("the line is longer than {} bytes, and so no line of a recording",
                                  longest_line),
                      "Take the recording as the receiver wrote it");
    const std::size_t end = length == std::string_view::npos ? length : offset_ + length;
    SourceLine line{.text = bytes_.substr(offset_, end - offset_),
                    .number = ++line_,
                    .byte = static_cast<std::int64_t>(offset_),
                    .ended = end != std::string_view::npos};
    if (line.text.ends_with('\r')) line.text.remove_suffix(1);
    offset_ = line.ended ? end + 1 : bytes_.size();
    if (recording_.passed && offset_ - passed_ >= passed_by) {
        // What came before the line: its own text is still to be looked at.
        passed_ = static_cast<std::size_t>(line.byte);
        recording_.passed(passed_);
    }
    return line;
}

void require_readable(const RecordingBytes& recording) {
    const std::string_view bytes = recording.bytes;
    if (bytes.empty())
        fail(recording, "the recording is empty, 0 bytes", "Copy it again from the receiver");
    refuse_not_read(recording, true);
    const std::string_view start = bytes.substr(0, recognised_by);
    if (start.size() == bytes.size() &&
        start.find_first_not_of(" \t\r\n", bytes.starts_with(byte_order_mark) ? 3 : 0) ==
            std::string_view::npos)
        fail(recording, "the recording holds nothing but blanks",
             "Copy it again from the receiver");
}

void require_text(const RecordingBytes& recording) {
    require_readable(recording);
    if (const std::size_t nul = recording.bytes.substr(0, recognised_by).find('\0');
        nul != std::string_view::npos)
        refuse_nul(recording, nul);
}

}  // namespace runcert
