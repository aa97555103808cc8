#include "batch/programs.h"

#include <unistd.h>

#include <vector>

#include "batch/steps.h"
#include "core/failure.h"
#include "files/process.h"
#include "files/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* not_installed = "none";

/// Programs of others that a step may call.
std::vector<std::string> called_by(const std::string& step) {
    if (step == "import") return {"gpsbabel", "rnx2rtkp"};
    if (step == "render") return {"gnuplot", "weasyprint"};
    return {};
}

}  // namespace

std::string program_hash(const std::string& program) {
    for (const std::string& file : program_candidates(program))
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
    for (const std::string& step : step_names()) {
        StepPrograms& programs = all[step];
        if (const std::string own = program_of_step(step); !own.empty()) {
            const std::string file = fs::absolute(folder / own).string();
            programs[own] = hash_of(file);
            if (programs[own] == not_installed)
                throw Failure(file, "the program of a stage is missing",
                              "Build or install the program again");
        }
        for (const std::string& other : called_by(step))
            programs[other] = hash_of(other);
    }
    return all;
}

}  // namespace runcert
