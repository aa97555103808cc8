#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/profile/profile.h"
#include "store/atomic_file.h"
#include "store/measured_series.h"

namespace runcert {

/// The attempt's name in a run folder.
inline constexpr std::string_view attempt_copy_name = "attempt.yaml";

/// A file that a receiver's recording consists of.
struct AttemptFile {
    std::string role;      ///< "recording", "base", "navigation", "phase", "imu", "surface", ...
    std::string original;  ///< as the attempt names it
    /// In a run folder: "ROLE.ID", the number where there are several of the role, and the
    /// original's own extension ("recording.primary.pos", "recording.primary.2.nmea").
    std::string name;
    std::string place = {};  ///< "file:line:column" of a series in the attempt, for messages
};

/// All of a receiver's files: its recordings in order, then base, navigation, raw phases.
std::vector<AttemptFile> files_of_receiver(const Receiver& receiver);

/// What RTKLIB makes of a RINEX receiver's files, in the run folder too: its configuration, the
/// forward and the backward solution, with the roles "configuration", "forward", "backward" and no
/// originals. None for other receivers.
std::vector<AttemptFile> solution_files(const Receiver& receiver);

/// A claimed profile in a run folder: "profile.NAME.yaml".
std::string profile_copy_name(const std::string& claimed);

/// Where an attempt was read, and where what it names is.
struct AttemptSource {
    std::filesystem::path file;
    /// What the attempt names is relative to this folder, and must be inside it. Empty for the
    /// current one.
    std::filesystem::path folder = file.parent_path();
    /// A run folder made earlier whose copies are taken instead.
    std::optional<std::filesystem::path> earlier_run = std::nullopt;
};

/// What the attempt names, found where it says or in the run folder made earlier.
///
/// A missing file is a Failure that names the place in the attempt; so is one outside of the
/// attempt's folder, by its path or by a symbolic link: whoever sends an attempt must not find out
/// what else is on the machine, nor have it published in a run folder.
FileView open_attempt_file(const AttemptFile& file, const Receiver& receiver,
                           const AttemptSource& source);
/// Of a profile that extends another, the resolved text.
std::string find_profile(const std::string& claimed, const AttemptSource& source);

/// The series that the attempt names, as its fields declare them (`series`), with their keys as
/// roles and the names "wind.csv" and so on in a run folder.
std::vector<AttemptFile> series_files(const Attempt& attempt);
/// Reads one of them as its field declares it.
MeasuredSeries read_series_of(const AttemptFile& file, std::string_view text,
                              const std::optional<GpsTime>& first_epoch);

/// The text of one of them, found and refused as above.
std::string find_series(const AttemptFile& file, const AttemptSource& source);

/// Brings what is neither a recording nor made of one into a run folder: the series that
/// it names, the claimed profiles, and the attempt itself, whose `text` is given. Failure where one
/// cannot be found, where a series cannot be read, where a profile needs a course that the attempt
/// does not give, and where another rule was in force on the attempt's date. An earlier run is
/// taken as it is: the rule that was in force when it was made is the rule that it is verified by.
void bring_in_claim(const Attempt& attempt, std::string_view text, const AttemptSource& source,
                    const std::filesystem::path& run_dir);

/// The profile with the figures that the attempt puts in place of its own. Failure at their place
/// in the attempt as `override_figure`.
Profile with_replaced_figures(Profile profile, const Attempt& attempt);

/// A claimed profile as the run folder holds it, with these figures. Failure where its id is not
/// its file's name, or that of a rule that comes with the program and has another text.
Profile read_claimed_profile(const std::filesystem::path& run_dir, const std::string& claimed,
                             const Attempt& attempt);

/// The rules that an attempt is judged by, as the run folder holds them: all that it claims and
/// that measure something, each with the clauses of those that are evidence behind its own. Failure
/// where nothing is left to measure by, and where a rule and evidence have a clause of the same id.
std::vector<Profile> read_claimed_rules(const std::filesystem::path& run_dir,
                                        const Attempt& attempt);
/// The same of profiles that were read.
std::vector<Profile> with_evidence(std::vector<Profile> claimed, const std::string& where);

}  // namespace runcert
