#include "stages/import/gpsbabel/convert.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/process.h"
#include "stages/import/cell.h"

namespace runcert::gpsbabel {
namespace {

constexpr int timed_out = 124;  ///< timeout(1)
constexpr std::string_view seconds = "120";
constexpr std::string_view bytes = "2147483648";

/// Words of gpsbabel, or of the C library, that are the same whatever the user's language.
const std::vector<std::pair<std::string, std::string>> environment{{"LC_ALL", "C.UTF-8"}};

std::string read_version() {
    try {
        const std::string output =
            run_process({"gpsbabel", "-V"}, {.environment = environment}).output;
        const std::size_t digit = output.find_first_of("0123456789");
        if (digit == std::string::npos) return "of an unknown version";
        return output.substr(digit, output.find_first_not_of("0123456789.", digit) - digit);
    } catch (const Failure&) {
        throw Failure("gpsbabel", "the program is not installed",
                      "Install the Debian package gpsbabel: apt-get install gpsbabel");
    }
}

[[noreturn]] void refuse(const ProcessResult& result, const std::string& type,
                         const RecordingBytes& recording) {
    const std::string where = place_in(recording, 1, 1);
    if (result.exit_status == timed_out)
        throw Failure(where, fmt::format("gpsbabel did not read it within {} s", seconds),
                      "Cut the recording, or convert it to GPX");
    throw Failure(where,
                  fmt::format("gpsbabel cannot read it as {}: {}", type,
                              escape_for_message(trim(result.errors), 200)),
                  "Is the recording whole, and gpsbabel_type right?");
}

}  // namespace

Converted convert(const std::string& type, const RecordingBytes& recording) {
    Converted converted;
    converted.version = read_version();
    const TemporaryFolder folder;
    const std::string from = folder.path() / "recording";
    const std::string to = folder.path() / "track.gpx";
    write_file_atomically(from, recording.bytes);
    const ProcessResult result =
        run_process({"timeout", "--kill-after=5", std::string(seconds), "prlimit",
                     fmt::format("--as={}", bytes), fmt::format("--fsize={}", bytes), "gpsbabel",
                     "-p", "", "-t", "-i", type, "-f", from, "-o", "gpx,gpxver=1.0", "-F", to},
                    {.environment = environment});
    if (result.exit_status != 0) refuse(result, type, recording);
    converted.gpx = read_file(to);
    return converted;
}

}  // namespace runcert::gpsbabel
