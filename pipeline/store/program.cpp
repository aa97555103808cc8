#include "store/program.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>

#include "store/process.h"
#include "store/sha256.h"
#include "store/user_state.h"

namespace runcert {
namespace {

#ifdef __FMA__
constexpr const char* compiler = __VERSION__ ", fused multiply-add";
#else
constexpr const char* compiler = __VERSION__;
#endif

void append_bits(std::string& bytes, double value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof raw);
}

}  // namespace

std::vector<ProgramFile> program_files() {
    std::vector<ProgramFile> programs;
    for (const auto& entry : std::filesystem::directory_iterator(program_folder()))
        if (const std::string name = entry.path().filename().string();
            (name == "runcert" || name.starts_with("runcert-")) && entry.is_regular_file())
            programs.push_back({name, remembered_sha256(entry.path())});
    std::ranges::sort(programs, {}, &ProgramFile::name);
    return programs;
}

std::string arithmetic_fingerprint() {
    static const std::string fingerprint = [] {
        constexpr int arguments = 4000;
        std::string bytes = compiler;
        for (int i = 1; i <= arguments; ++i) {
            // Irrational steps reach all binades of what the stages ask for.
            const volatile double step = 0.017453292519943295 * i;
            const double x = step;
            for (const double value :
                 {std::sin(x), std::cos(x), std::tan(x), std::atan2(x, 7.0), std::exp(-x),
                  std::log(x), std::log1p(x), std::pow(x, 1.3), std::erfc(0.1 * x), std::lgamma(x)})
                append_bits(bytes, value);
        }
        return sha256_hex(bytes).substr(0, 12);
    }();
    return fingerprint;
}

}  // namespace runcert
