#pragma once

#include <string>

#include "schemas/recognition/declared.h"
#include "store/process.h"

namespace runcert {

/// What import says of a file, which its own program reads; `keys`: those of a receiver, as JSON,
/// that it is to be read by.
struct Recognised {
    Recognition is{};
    ProcessResult said{};  ///< its exit status, and what is wrong where that is not 0
};

Recognised recognise(const std::string& file, const std::string& keys = "{}");

}  // namespace runcert
