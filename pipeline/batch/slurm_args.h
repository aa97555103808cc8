#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace runcert {

/// The words of what the user gave as --slurm-args, e.g. "--partition=lake --comment 'day 1'", as a
/// shell would see them: quotes, $VARIABLES, ~ and patterns of file names; no commands. Failure
/// where quotes do not end, a variable is not set, or the text holds a command or what steers one
/// (`...`, $(...), |, ;, and the like).
std::vector<std::string> split_slurm_args(std::string_view text);

/// Checks that words meant for sbatch leave to runcert what it must say itself: which tasks there
/// are, what they run, and that sbatch returns at once. Failure that names the word and what to use
/// instead; whatever else is wrong with the words, sbatch says.
void check_slurm_args(const std::vector<std::string>& words);

}  // namespace runcert
