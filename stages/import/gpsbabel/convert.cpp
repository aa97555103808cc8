#include <fmt/format.h>

#include "core/failure.h"
#include "stages/import/cell.h"
#include "stages/import/gpsbabel/gpsbabel.h"
#include "store/atomic_file.h"
#include "store/external_program.h"

namespace runcert::gpsbabel {
namespace {

constexpr const char* program = "gpsbabel";

CalledProgram called_program() {
    CalledProgram called{.name = program, .version = {}, .sha256 = {}};
    const std::string output = run_external({.command = {program, "-V"}}).output;
    const std::size_t digit = output.find_first_of("0123456789");
    if (digit != std::string::npos)
        called.version =
            output.substr(digit, output.find_first_not_of("0123456789.", digit) - digit);
    called.sha256 = external_program_sha256(program);
    called.isolation = isolation_word();
    return called;
}

}  // namespace

Converted convert(const std::string& type, const RecordingBytes& recording) {
    Converted converted{.gpx = {}, .program = called_program()};
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "recording", recording.bytes);
    const ExternalCall call{.command = {program, "-p", "", "-t", "-i", type, "-f", "recording",
                                        "-o", "gpx,gpxver=1.0", "-F", "track.gpx"},
                            .folder = folder.path(),
                            .limits = {.file_bytes = std::uint64_t{2} << 30}};
    const ProcessResult result = run_external(call);
    if (result.exit_status != 0)
        throw Failure(
            place_in(recording, 1, 1),
            fmt::format("gpsbabel cannot read it as {}: {}", type, external_problem(call, result)),
            "Is the recording whole, gpsbabel_type right, and the format one that the gpsbabel "
            "here reads (gpsbabel -^3 lists them)? If so, convert it to GPX");
    converted.gpx = read_file(folder.path() / "track.gpx");
    return converted;
}

}  // namespace runcert::gpsbabel
