#include "reports/explain/words.h"

#include <fmt/format.h>

#include "core/text.h"

namespace runcert {
namespace {

constexpr std::size_t label_columns = 20;

}  // namespace

std::string labelled(std::string_view label, std::string_view text) {
    return fmt::format("  {:<{}}{}", label, label_columns - 2,
                       wrapped(text, label_columns, label_columns));
}

std::string heading(std::string_view outcome, std::string_view text) {
    const std::string word = upper_case(outcome);
    return fmt::format("{}  {}", word, wrapped(text, word.size() + 2, word.size() + 2));
}

}  // namespace runcert
