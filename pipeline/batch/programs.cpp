#include "batch/programs.h"

#include <unistd.h>

#include <vector>

#include "core/failure.h"
#include "files/external_program.h"
#include "files/sha256.h"
#include "run/steps.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* not_installed = "none";

}  // namespace

std::string program_hash(const std::string& program) {
    const fs::path file =
        program.find('/') == std::string::npos ? external_program_file(program) : fs::path(program);
    if (fs::is_regular_file(file) && access(file.c_str(), X_OK) == 0)
        return digest_file(file).sha256;
    return not_installed;
}

std::map<std::string, StepPrograms> programs_of_steps(const fs::path& folder) {
    std::map<std::string, std::string> known;
    const auto hash_of = [&](const std::string& program) {
        const auto [entry, is_new] = known.try_emplace(program);
        if (is_new) entry->second = program_hash(program);
        return entry->second;
    };
    std::map<std::string, StepPrograms> all;
    for (const Step& step : steps()) {
        StepPrograms& programs = all[step.name];
        if (!step.program.empty()) {
            const std::string file = fs::absolute(folder / step.program).string();
            programs[step.program] = hash_of(file);
            if (programs[step.program] == not_installed)
                throw Failure(file, "the program of a stage is missing",
                              "Build or install the program again");
        }
        for (const std::string& other : step.calls)
            programs[other] = hash_of(other);
    }
    return all;
}

}  // namespace runcert
