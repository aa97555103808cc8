#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/failure.h"

namespace runcert {

/// An attempt to be made a run of, on its own or one of a day.
struct GivenAttempt {
    /// Names the run folder. Where it could not be read, a label made of the file's name that no
    /// other attempt of the day has.
    std::string id;
    std::string source;                 ///< for people: "heats/run-1.yaml", "day.yaml:14"
    std::filesystem::path file = {};    ///< the attempt's own; empty if the day file made the text
    std::string text = {};              ///< the attempt, as `read_attempt` takes it
    std::filesystem::path folder = {};  ///< that its recordings are relative to
    std::optional<Failure> refused = {};
};

}  // namespace runcert
