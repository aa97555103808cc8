#pragma once

#include <string>
#include <vector>

#include "reports/document/document_text.h"
#include "stages/import/inspect.h"

namespace runcert::import_test {

/// What is said in sections, each paragraph and each value on one line.
inline std::string text_of(const std::vector<Section>& sections, std::size_t columns = 10'000) {
    return document_text({.title = "f", .sections = sections}, columns);
}

inline std::string inspection_text(const Inspection& inspection) {
    return text_of({positions_section(inspection)});
}

}  // namespace runcert::import_test
