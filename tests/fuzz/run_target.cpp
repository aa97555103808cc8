#include <algorithm>

#include "core/failure.h"
#include "fuzz_target.h"

namespace runcert::fuzz {
namespace {

bool can_be_shown(const std::string& text) {
    return !text.empty() && std::none_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) < ' ' || c == '\x7f';
    });
}

}  // namespace

void run_target(std::string_view bytes) {
    try {
        read_input(bytes);
    } catch (const Failure& failure) {
        require(can_be_shown(failure.where()), "a failure says where, in printable text");
        require(can_be_shown(failure.problem()), "a failure says what, in printable text");
        require(can_be_shown(failure.remedy()), "a failure says what to do, in printable text");
    }
}

}  // namespace runcert::fuzz
