#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "schemas/document/document.h"

namespace runcert {

/// What `inspect` says of a recording, and below it drawn: speed, height, track, stated uncertainty
/// and the steps between epochs, gaps shaded. `track` is what `runcert-import --track` prints.
/// HTML in one file. Needs gnuplot; Failure if it cannot draw.
std::string inspection_page(Document document, const nlohmann::ordered_json& track);

}  // namespace runcert
