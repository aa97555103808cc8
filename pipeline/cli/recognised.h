#pragma once

#include <optional>
#include <string>

#include "schemas/recognition/declared.h"
#include "store/process.h"

namespace runcert {

/// What import says of a file, which its own program reads: all that it found, also where a part
/// cannot be read.
struct Recognised {
    Recognition is{};
    ProcessResult said{};  ///< its exit status, and what is wrong where that is not 0
};

/// `keys`: those of a receiver, as JSON, that it is to be read by. `navigation`: that raw
/// measurements are described, too, by the orbits of that file, or where it is empty of one beside
/// them.
Recognised recognise(const std::string& file, const std::string& keys = "{}",
                     const std::optional<std::string>& navigation = std::nullopt);

}  // namespace runcert
