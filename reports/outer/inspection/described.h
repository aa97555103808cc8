#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "schemas/document/document.h"
#include "schemas/recognition/declared.h"

namespace runcert {

/// The lines of an attempt that describe a file of that name beside its recording, or the recording
/// itself: what it suggests, and ... for what it does not say and nothing can be certified without.
/// Empty where neither is there.
std::string receiver_lines(const Recognition& is, const std::string& name);

/// How a file is read, and why so: the lines of an attempt, each column with its meaning, unit and
/// reason, the first rows, and why it cannot be read. Without blocks where there is nothing of
/// that.
Section description_section(const Recognition& is, const std::string& name);

/// What a file is, for a person: how it is read, what it holds, what an attempt must say of it, and
/// what an official should look at.
Document description_of(const Recognition& is, const std::string& name);

/// Such a document, and below it the recording drawn: speed, height, track, stated uncertainty and
/// the steps between epochs, gaps shaded. `track` is what `runcert-import --track` prints. HTML in
/// one file.
std::string inspection_page(Document document, nlohmann::ordered_json track);

}  // namespace runcert
