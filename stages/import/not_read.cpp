#include "stages/import/not_read.h"

#include <fmt/format.h>

#include <array>

#include "core/failure.h"
#include "stages/import/cell.h"

namespace runcert {
namespace {

using namespace std::string_view_literals;

constexpr std::int64_t lines_looked_at = 30;

constexpr std::string_view unpack = "Unpack it, and name the recording inside it";
constexpr std::string_view save_as_utf8 =
    "Save as UTF-8, in the program that wrote it or an editor";
constexpr std::string_view save_as_csv =
    "Save the sheet as CSV in the program that wrote it, and describe its columns";
constexpr std::string_view no_recording = "Give the recording as the receiver or logger wrote it";
constexpr std::array kinds{
    NotRead{"UTF-32 text", "\xff\xfe\0\0"sv, 0, false, save_as_utf8, true},
    NotRead{"UTF-32 text", "\0\0\xfe\xff"sv, 0, false, save_as_utf8, true},
    NotRead{"an Excel workbook", "PK\x03\x04\x14\0\x06\0\x08\0\0\0!\0"sv, 0, false, save_as_csv,
            true},
    NotRead{"an OpenDocument sheet", "mimetypeapplication/vnd.oasis.opendocument.spreadsheet"sv, 30,
            false, save_as_csv, true},
    NotRead{"an old Excel workbook", "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv, 0, false, save_as_csv,
            true},
    NotRead{"a ZIP archive, a folder packed into a file", "PK\x03\x04"sv, 0, false, unpack, true},
    NotRead{"a gzip archive", "\x1f\x8b"sv, 0, false, unpack, true},
    NotRead{"a 7z archive", "7z\xbc\xaf\x27\x1c"sv, 0, false, unpack, true},
    NotRead{"a bzip2 archive", "BZh"sv, 0, false, unpack, true},
    NotRead{"an xz archive",
            "\xfd"
            "7zXZ"sv,
            0, false, unpack, true},
    NotRead{"a RAR archive", "Rar!\x1a\x07"sv, 0, false, unpack, true},
    NotRead{"a tar archive, a folder packed into a file", "ustar"sv, 257, false, unpack, true},
    NotRead{"an MP4 or MOV film", "ftyp"sv, 4, false,
            "Take the camera's positions out of it: exiftool -ee -p gpx.fmt FILM > run.gpx", true},
    NotRead{"an SQLite database", "SQLite format 3\0"sv, 0, false,
            "Export the recording from the program that keeps it, as GPX, CSV or FIT", true},
    NotRead{"a PDF document", "%PDF-"sv, 0, false, no_recording, true},
    NotRead{"a PNG picture", "\x89PNG\r\n"sv, 0, false, no_recording, true},
    NotRead{"a JPEG picture", "\xff\xd8\xff"sv, 0, false, no_recording, true},
    NotRead{"compact RINEX (Hatanaka)", "COMPACT RINEX FORMAT"sv, 20, false,
            "Expand it with CRX2RNX (Y. Hatanaka's RNXCMP), and give the RINEX file that it writes",
            true},
    NotRead{"SkyTraq binary", "\xa0\xa1\0"sv, 0, false,
            "Record NMEA instead, or convert its raw signals to RINEX (RTKLIB: convbin -r stq)"},
    NotRead{"SiRF binary without geodetic positions", "\xa0\xa2"sv, 0, false,
            "Record with message 41 (geodetic navigation data), or as NMEA"},
    NotRead{"JAVAD or Topcon GREIS", "JP055"sv, 0, false,
            "Convert it to RINEX (RTKLIB: convbin -r javad), and give base and navigation"},
    NotRead{"JAVAD or Topcon GREIS", "RE00"sv, 0, false,
            "Convert it to RINEX (RTKLIB: convbin -r javad), and give base and navigation"},
    NotRead{"Septentrio SBF", "$@"sv, 0, false,
            "Convert it: sbf2asc -g for its solution as text, or sbf2rin for RINEX"},
    NotRead{"NovAtel binary", "\xaa\x44\x12"sv, 0, false,
            "Convert it to ASCII logs (BESTPOSA, BESTVELA) with NovAtel Convert, or to RINEX"},
    NotRead{"NovAtel binary", "\xaa\x44\x13"sv, 0, false,
            "Convert it to ASCII logs (BESTPOSA, BESTVELA) with NovAtel Convert, or to RINEX"},
    NotRead{"RTCM 3, corrections or raw signals", "\xd3\0"sv, 0, false,
            "Convert it to RINEX, and give base and navigation; or export its solution as NMEA"},
    NotRead{"a telephone's raw log (GnssLogger)", "# Raw,"sv, 0, true,
            "It holds raw signals: convert it to RINEX, and give base and navigation; or give its "
            "NMEA file"},
    NotRead{"a telephone's raw log (GnssLogger)", "Raw,"sv, 0, true,
            "It holds raw signals: convert it to RINEX, and give base and navigation; or give its "
            "NMEA file"},
    NotRead{"a web page", "<html"sv, 0, true, no_recording},
    NotRead{"a web page", "<!DOCTYPE html"sv, 0, true, no_recording},
    NotRead{"XML of another kind than GPX", "<?xml"sv, 0, true,
            "Export the recording as GPX, in the program that wrote it"},
};

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

}  // namespace runcert
