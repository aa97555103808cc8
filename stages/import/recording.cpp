#include "stages/import/recording.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "stages/import/cell.h"

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

using namespace std::string_view_literals;

constexpr std::int64_t lines_looked_at = 30;

constexpr std::string_view unpack = "Unpack it, and name the recording inside it";
constexpr std::string_view save_as_utf8 =
    "Save as UTF-8, in the program that wrote it or an editor";
constexpr std::string_view save_as_csv =
    "Save the sheet as CSV in the program that wrote it, and describe its columns";
constexpr std::string_view no_recording = "Give the recording as the receiver or logger wrote it";
constexpr NotRead kinds[] = {
    {"UTF-32 text", "\xff\xfe\0\0"sv, save_as_utf8, true},
    {"UTF-32 text", "\0\0\xfe\xff"sv, save_as_utf8, true},
    {"an Excel workbook", "PK\x03\x04\x14\0\x06\0\x08\0\0\0!\0"sv, save_as_csv, true},
    {"an OpenDocument sheet", "mimetypeapplication/vnd.oasis.opendocument.spreadsheet"sv,
     save_as_csv, true, 30},
    {"an old Excel workbook", "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, save_as_csv, true},
    {"a ZIP archive, a folder packed into a file", "PK\x03\x04"sv, unpack, true},
    {"a gzip archive", "\x1f\x8b"sv, unpack, true},
    {"a 7z archive", "7z\xbc\xaf\x27\x1c"sv, unpack, true},
    {"a bzip2 archive", "BZh"sv, unpack, true},
    {"an xz archive",
     "\xfd"
     "7zXZ"sv,
     unpack, true},
    {"a RAR archive", "Rar!\x1a\x07"sv, unpack, true},
    {"a tar archive, a folder packed into a file", "ustar"sv, unpack, true, 257},
    {"an MP4 or MOV film", "ftyp"sv,
     "Take the camera's positions out of it: exiftool -ee -p gpx.fmt FILM > run.gpx", true, 4},
    {"an SQLite database", "SQLite format 3\0"sv,
     "Export the recording from the program that keeps it, as GPX, CSV or FIT", true},
    {"a PDF document", "%PDF-"sv, no_recording, true},
    {"a PNG picture", "\x89PNG\r\n"sv, no_recording, true},
    {"a JPEG picture", "\xff\xd8\xff"sv, no_recording, true},
    {"compact RINEX (Hatanaka)", "COMPACT RINEX FORMAT"sv,
     "Expand it with CRX2RNX (Y. Hatanaka's RNXCMP), and give the RINEX file that it writes", true,
     20},
    {"SkyTraq binary", "\xa0\xa1\0"sv,
     "Record NMEA instead, or convert its raw signals to RINEX (RTKLIB: convbin -r stq)"},
    {"SiRF binary without geodetic positions", "\xa0\xa2"sv,
     "Record with message 41 (geodetic navigation data), or as NMEA"},
    {"JAVAD or Topcon GREIS", "JP055"sv,
     "Convert it to RINEX (RTKLIB: convbin -r javad), and give base and navigation"},
    {"JAVAD or Topcon GREIS", "RE00"sv,
     "Convert it to RINEX (RTKLIB: convbin -r javad), and give base and navigation"},
    {"Septentrio SBF", "$@"sv,
     "Convert it: sbf2asc -g for its solution as text, or sbf2rin for RINEX"},
    {"NovAtel binary", "\xaa\x44\x12"sv,
     "Convert it to ASCII logs (BESTPOSA, BESTVELA) with NovAtel Convert, or to RINEX"},
    {"NovAtel binary", "\xaa\x44\x13"sv,
     "Convert it to ASCII logs (BESTPOSA, BESTVELA) with NovAtel Convert, or to RINEX"},
    {"RTCM 3, corrections or raw signals", "\xd3\0"sv,
     "Convert it to RINEX, and give base and navigation; or export its solution as NMEA"},
    {"a telephone's raw log (GnssLogger)", "# Raw,"sv,
     "It holds raw signals: convert it to RINEX, and give base and navigation; or give its "
     "NMEA file",
     false, 0, true},
    {"a telephone's raw log (GnssLogger)", "Raw,"sv,
     "It holds raw signals: convert it to RINEX, and give base and navigation; or give its "
     "NMEA file",
     false, 0, true},
    {"a web page", "<html"sv, no_recording, false, 0, true},
    {"a web page", "<!DOCTYPE html"sv, no_recording, false, 0, true},
    {"XML of another kind than GPX", "<?xml"sv,
     "Export the recording as GPX, in the program that wrote it", false, 0, true}};

bool has_line(std::string_view bytes, std::string_view beginning) {
    LineReader lines(bytes);
    for (auto line = lines.next(); line && line->number <= lines_looked_at; line = lines.next())
        if (line->text.starts_with(beginning)) return true;
    return false;
}

bool is_of(std::string_view head, const NotRead& kind) {
    if (kind.is_line) return has_line(head, kind.bytes);
    return head.size() >= kind.offset && head.substr(kind.offset).starts_with(kind.bytes);
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

std::span<const NotRead> kinds_not_read() {
    return kinds;
}

void refuse_not_read(const RecordingBytes& recording, bool only_never_read) {
    const std::string_view head = recording.bytes.substr(0, recognised_by);
    for (const NotRead& kind : kinds)
        if ((kind.never_read || !only_never_read) && is_of(head, kind))
            throw Failure(place_in(recording, 1, 1),
                          fmt::format("the file is {}, which is not read", kind.name),
                          std::string(kind.remedy));
}

namespace {

constexpr std::string_view little_endian_mark = "\xff\xfe";
constexpr std::string_view big_endian_mark = "\xfe\xff";

/// Which byte of each code unit of the beginning is NUL; nothing where that is not always the same.
std::optional<std::size_t> nul_byte(std::string_view bytes) {
    const std::string_view start = bytes.substr(0, 64);
    if (start.size() < 4) return std::nullopt;
    for (const std::size_t parity : {std::size_t{0}, std::size_t{1}}) {
        bool all = true;
        for (std::size_t i = 0; i < start.size(); ++i)
            all = all && (start[i] == '\0') == (i % 2 == parity);
        if (all) return parity;
    }
    return std::nullopt;
}

void append_utf8(char32_t code, std::string& text) {
    const auto put = [&](char32_t byte) { text.push_back(static_cast<char>(byte)); };
    if (code < 0x80) return put(code);
    if (code < 0x800) {
        put(0xC0 | code >> 6);
    } else {
        if (code < 0x10000) {
            put(0xE0 | code >> 12);
        } else {
            put(0xF0 | code >> 18);
            put(0x80 | (code >> 12 & 0x3F));
        }
        put(0x80 | (code >> 6 & 0x3F));
    }
    put(0x80 | (code & 0x3F));
}

/// The code units of a text, one after the other.
class CodeUnits {
  public:
    explicit CodeUnits(const RecordingBytes& recording)
        : recording_(recording),
          big_endian_(recording.bytes.starts_with(big_endian_mark) ||
                      nul_byte(recording.bytes) == std::size_t{0}) {
        if (recording.bytes.starts_with(big_endian_mark) ||
            recording.bytes.starts_with(little_endian_mark))
            at_ = 2;
    }

    bool at_end() const { return at_ >= recording_.bytes.size(); }

    char32_t next() {
        if (at_ + 2 > recording_.bytes.size()) fail(at_, "the UTF-16 text ends within a character");
        const auto byte = [&](std::size_t i) {
            return static_cast<char32_t>(static_cast<unsigned char>(recording_.bytes[at_ + i]));
        };
        const char32_t unit = byte(big_endian_ ? 0 : 1) << 8 | byte(big_endian_ ? 1 : 0);
        at_ += 2;
        return unit;
    }

    /// The character that begins with the next unit.
    char32_t character() {
        const std::size_t begin = at_;
        const char32_t high = next();
        if (high < 0xD800 || high > 0xDFFF) return high;
        const char32_t low = high < 0xDC00 && !at_end() ? next() : 0;
        if (low < 0xDC00 || low > 0xDFFF)
            fail(begin, "the UTF-16 text holds half a surrogate pair");
        return 0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00);
    }

  private:
    [[noreturn]] void fail(std::size_t byte, const char* what) const {
        throw Failure(place_in(recording_, RecordPlace(byte)), what,
                      "It is cut off or damaged; take the recording as the program wrote it");
    }

    const RecordingBytes& recording_;
    bool big_endian_;
    std::size_t at_ = 0;
};

}  // namespace

bool is_utf16(std::string_view bytes) {
    using namespace std::string_view_literals;
    if (bytes.starts_with("\xff\xfe\0\0"sv)) return false;  // UTF-32
    return bytes.starts_with(little_endian_mark) || bytes.starts_with(big_endian_mark) ||
           nul_byte(bytes).has_value();
}

std::string utf8_of_utf16(const RecordingBytes& recording) {
    std::string text;
    text.reserve(recording.bytes.size() / 2);
    CodeUnits units(recording);
    while (!units.at_end())
        append_utf8(units.character(), text);
    return text;
}

}  // namespace runcert
