#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/geodesy.h"
#include "core/statistics.h"
#include "core/text.h"
#include "stages/import/format.h"
#include "stages/import/rinex/rinex.h"
#include "store/atomic_file.h"
#include "store/external_program.h"

namespace runcert {

std::string_view rtklib_configuration(std::string_view name);

namespace rinex {
namespace {

constexpr const char* solver = "rnx2rtkp";
constexpr ExternalLimits solving{.time = std::chrono::minutes(20),
                                 .memory_bytes = std::uint64_t{4} << 30,
                                 .output_bytes = std::size_t{256} << 20};  // it says much

std::string configuration_of(const Receiver& receiver, std::string_view pass) {
    std::string text(rtklib_configuration("rinex/rtklib.conf"));
    text += fmt::format("pos1-soltype       ={}\n", pass);
    if (const auto& base = receiver.base_position)
        text += fmt::format(
            "ant2-postype       =llh\nant2-pos1          ={}\nant2-pos2          ={}\n"
            "ant2-pos3          ={}\n",
            format_fixed(base->latitude.degrees(), 11), format_fixed(base->longitude.degrees(), 11),
            format_fixed(base->height_m, 4));
    else
        text += "ant2-postype       =rinexhead\n";
    return text;
}

/// Of what RTKLIB writes.
const Format& pos_format() {
    return *find_format("rtklib-pos");
}

[[noreturn]] void refuse(const RecordingBytes& rover, const std::string& what,
                         const std::string& remedy) {
    throw Failure(rover.name, what, remedy);
}

/// Runs the program inside a folder, so that its output names no path of this machine.
std::string run(const std::filesystem::path& folder, const std::string& configuration,
                const std::vector<std::string>& inputs, const RecordingBytes& rover) {
    write_file_atomically(folder / "rtklib.conf", configuration);
    ExternalCall call{.command = {solver, "-k", "rtklib.conf", "-o", "solution.pos"},
                      .folder = folder,
                      .limits = solving};
    call.command.insert(call.command.end(), inputs.begin(), inputs.end());
    const ProcessResult result = run_external(call);
    const std::filesystem::path solution = folder / "solution.pos";
    if (result.exit_status != 0 || !std::filesystem::exists(solution))
        refuse(rover, fmt::format("rnx2rtkp found no solution: {}", external_problem(call, result)),
               "Check that rover, base and navigation are RINEX 2.11 or 3 of the same day");
    std::string text = read_file(solution);
    std::filesystem::remove(solution);
    if (!pos_format().recognises(text))
        refuse(rover, "rnx2rtkp found no position in it",
               "Check that rover, base and navigation are RINEX 2.11 or 3 of the same day");
    return text;
}

/// The line "% program   : ..." of a solution.
std::string program_of(const std::string& solution) {
    constexpr std::string_view mark = "% program   : ";
    const std::size_t at = solution.find(mark);
    if (at == std::string::npos) return "RTKLIB";
    const std::size_t from = at + mark.size();
    return std::string(
        trim(std::string_view(solution).substr(from, solution.find('\n', from) - from)));
}

Ecef place_of(const Observation& row) {
    return ecef_from_geodetic({.latitude = Angle::from_degrees(*row.latitude_deg),
                               .longitude = Angle::from_degrees(*row.longitude_deg),
                               .height_m = *row.height_m});
}

/// How far two passes differ at the epochs that both have; those fixed in both apart.
std::string difference_text(const Observations& chosen, const Observations& other,
                            std::string_view other_name) {
    // Time stamps carry the receiver's clock error, solved anew in each pass: to the millisecond.
    const auto millisecond = [](const Observations& all, const Observation& row) {
        return (all.facts.first_epoch->nanoseconds() + row.time.nanoseconds + 500'000) / 1'000'000;
    };
    std::map<std::int64_t, const Observation*> rows;
    for (const Observation& row : other.rows)
        if (row.latitude_deg) rows[millisecond(other, row)] = &row;
    std::vector<double> all_m, fixed_m;
    for (const Observation& row : chosen.rows) {
        const auto found = rows.find(millisecond(chosen, row));
        if (!row.latitude_deg || found == rows.end()) continue;
        const double apart_m = (place_of(row).m - place_of(*found->second).m).norm();
        all_m.push_back(apart_m);
        if (row.fix == FixType::fixed && found->second->fix == FixType::fixed)
            fixed_m.push_back(apart_m);
    }
    if (all_m.empty())
        return fmt::format("The {} solution has no epoch in common with it.", other_name);
    const auto figures = [](std::vector<double> values) {
        const double worst = *std::max_element(values.begin(), values.end());
        return fmt::format("{} m (median) and {} m (worst) at {} epochs",
                           format_fixed(median(values), 3), format_fixed(worst, 3), values.size());
    };
    return fmt::format(
        "The {} solution, kept beside it and not averaged with it, differs by {}; {}.", other_name,
        figures(all_m),
        fixed_m.empty() ? std::string("no epoch is fixed in both")
                        : "where both are fixed, by " + figures(fixed_m));
}

}  // namespace

Solution solve(const Receiver& receiver, const RecordingBytes& rover, const RecordingBytes& base,
               const std::vector<RecordingBytes>& navigation) {
    require_readable(rover);
    require_readable(base);
    for (const RecordingBytes& file : navigation)
        require_readable(file);
    const TemporaryFolder folder;
    std::vector<std::string> inputs{"rover.obs", "base.obs"};
    write_file_atomically(folder.path() / inputs[0], rover.bytes);
    write_file_atomically(folder.path() / inputs[1], base.bytes);
    for (std::size_t i = 0; i < navigation.size(); ++i) {
        inputs.push_back(fmt::format("navigation.{}.nav", i + 1));
        write_file_atomically(folder.path() / inputs.back(), navigation[i].bytes);
    }
    Solution solution;
    solution.configuration = configuration_of(receiver, "forward");
    solution.forward = run(folder.path(), solution.configuration, inputs, rover);
    solution.backward = run(folder.path(), configuration_of(receiver, "backward"), inputs, rover);
    solution.program = {.name = solver,
                        .version = program_of(solution.forward),
                        .sha256 = external_program_sha256(solver),
                        .isolation = isolation_word()};
    solution.instrument = instrument_of(rover.bytes);
    return solution;
}

Observations read(const Receiver& receiver, const Solution& solution,
                  const std::string& chosen_name) {
    const bool forward = receiver.solution_pass != "backward";
    const RecordingBytes chosen{.name = chosen_name,
                                .bytes = forward ? solution.forward : solution.backward};
    const RecordingBytes other{.name = "the other solution",
                               .bytes = forward ? solution.backward : solution.forward};
    Observations observations = pos_format().read(receiver, chosen);
    observations.header.programs = {solution.program};
    if (observations.processing) {
        // Not as they were called while they were solved.
        std::vector<std::string>& files = observations.processing->files;
        files = receiver.recordings;
        files.push_back(receiver.base);
        files.insert(files.end(), receiver.navigation.begin(), receiver.navigation.end());
        for (std::string& file : files)
            file.erase(0, file.find_last_of('/') + 1);
    }
    observations.format = "rinex";
    set_instrument(observations, solution.instrument);
    observations.variant = fmt::format("solved by {}, {}", program_of(solution.forward),
                                       forward ? "forward" : "backward");
    observations.notes.push_back(fmt::format(
        "The recording is raw observations, solved against the base station; the positions, and "
        "their lines, are those of {} in the run folder.",
        chosen.name));
    observations.notes.push_back(difference_text(observations, pos_format().read(receiver, other),
                                                 forward ? "backward" : "forward"));
    return observations;
}

}  // namespace rinex
}  // namespace runcert
