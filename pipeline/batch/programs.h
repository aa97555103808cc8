#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace runcert {

/// The programs that a step of a run rests on, by name, with the SHA-256 of each: the stage's own,
/// and those of others that it calls; "none" for one that is not installed.
using StepPrograms = std::map<std::string, std::string>;

/// Those of every step (`steps`), from the folder of the stages and from those of the system. Each
/// program is read once. Failure where a stage's own is missing.
std::map<std::string, StepPrograms> programs_of_steps(const std::filesystem::path& folder);

/// The SHA-256 of a program: of the file of that path or, where it holds no slash, of the first of
/// that name in the folders of the system (`external_program_file`); "none" where there is none.
std::string program_hash(const std::string& program);

}  // namespace runcert
