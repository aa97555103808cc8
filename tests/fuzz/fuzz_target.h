#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

#include "core/failure.h"

namespace runcert::fuzz {

/// The target that runs, of those that its program has: "nmea".
const std::string& target_name();

/// What a target does with one input. Every program of targets defines it. It may throw a Failure,
/// the answer to bad input; anything else that leaves it is a fault of the program.
void read_input(std::string_view bytes);

/// One execution of the target. A Failure is passed over if it says where, what and what to do in
/// text that a terminal can show; std::logic_error where it does not.
void run_target(std::string_view bytes);

/// An invariant of what was read; std::logic_error where it does not hold.
inline void require(bool holds, const char* what) {
    if (!holds) throw std::logic_error(std::string("does not hold: ") + what);
}

/// Reads a product, and what writing it makes of it.
template <class Read, class Write>
void read_and_write(std::string_view bytes, Read read, Write write) {
    const auto product = read(bytes, "input");
    std::string text;
    try {
        text = write(product);
    } catch (const Failure&) {
        return;  // figures that are read, but no program of ours writes
    }
    try {
        require(write(read(text, "input")) == text, "written, read and written again: equal");
    } catch (const Failure& failure) {
        throw std::logic_error(std::string("what was written is not read: ") + failure.what());
    }
}

}  // namespace runcert::fuzz
