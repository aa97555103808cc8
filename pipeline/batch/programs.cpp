#include "batch/programs.h"

#include <unistd.h>

#include <cstdlib>
#include <vector>

#include "batch/steps.h"
#include "core/failure.h"
#include "files/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// Programs of others that a step may call.
std::vector<std::string> called_by(const std::string& step) {
    if (step == "import") return {"gpsbabel", "rnx2rtkp"};
    if (step == "render") return {"gnuplot", "weasyprint"};
    return {};
}

fs::path in_path(const std::string& program) {
    const char* path = std::getenv("PATH");
    std::string rest = path ? path : "";
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(':'), rest.size());
        const fs::path candidate = fs::path(rest.substr(0, end)) / program;
        if (fs::is_regular_file(candidate) && access(candidate.c_str(), X_OK) == 0)
            return candidate;
        rest.erase(0, end + 1);
    }
    return {};
}

}  // namespace

std::string program_hash(const std::string& program) {
    const fs::path file =
        program.find('/') == std::string::npos ? in_path(program) : fs::path(program);
    return file.empty() || !fs::exists(file) ? "none" : digest_file(file).sha256;
}

std::map<std::string, StepPrograms> programs_of_steps(const fs::path& folder) {
    std::map<std::string, StepPrograms> all;
    for (const std::string& step : step_names()) {
        StepPrograms& programs = all[step];
        if (const std::string own = program_of_step(step); !own.empty()) {
            const fs::path file = folder / own;
            if (!fs::exists(file))
                throw Failure(file.string(), "the program of a stage is missing",
                              "Build or install the program again");
            programs[own] = digest_file(file).sha256;
        }
        for (const std::string& other : called_by(step))
            programs[other] = program_hash(other);
    }
    return all;
}

}  // namespace runcert
