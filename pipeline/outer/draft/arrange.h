#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "schemas/recognition/declared.h"

namespace runcert {

/// A file that was handed in, and what import says of it.
struct HandedIn {
    std::string path;  ///< as the attempt names it
    Recognition is{};
};

/// A receiver of an attempt, by the places of its files among those handed in.
struct ArrangedReceiver {
    std::string id;
    std::vector<std::size_t> recordings{};  ///< in the order of time
    std::optional<std::size_t> base{}, phase{}, imu{}, surface{};
    std::optional<std::size_t> triangles{};  ///< of a surface whose file has vertices alone
    std::vector<std::size_t> navigation{};
};

/// What several files are to each other.
struct Arrangement {
    std::vector<ArrangedReceiver> receivers;
    /// By the key of the attempt that the series is of.
    std::map<std::string, std::size_t> series{};
    std::vector<std::string> said;  ///< why, a sentence for each file that is not the first
};

/// Decides by times and places what the files are to each other. Files of one format that follow
/// each other within a day are one recording; what was recorded at the same time and place is a
/// second receiver. An IMU's file is the primary receiver's, and so is that of a surface: of a
/// table of vertices with the table of its triangles. A log with raw signals beside a solution
/// holds the signals behind it. RINEX observations alone are a rover, and a base by its name.
/// Series are what their columns say. Failure if this cannot be determined, or if the files belong
/// to several attempts.
Arrangement arrange(const std::vector<HandedIn>& files);

}  // namespace runcert
