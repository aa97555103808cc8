#include "store/program.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "store/sha256.h"

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
