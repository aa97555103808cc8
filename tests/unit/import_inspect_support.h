#pragma once

#include <string>

#include "reports/document/document_text.h"
#include "reports/inspection/described.h"
#include "stages/import/inspect.h"
#include "stages/import/recognise.h"

namespace runcert::import_test {

/// What is said of a file, each paragraph and each value on one line.
inline std::string text_of(const Recognition& is, std::size_t columns = 10'000) {
    return document_text(description_of(is, "log.csv"), columns);
}

inline std::string inspection_text(const Observations& observations) {
    return text_of(recognition_of(observations, {}));
}

}  // namespace runcert::import_test
