#include "trust/trusted_comment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace runcert {
namespace {

constexpr std::string_view mark = "runcert";

constexpr std::array<std::pair<std::string_view, std::string TrustedComment::*>, 6> fields{{
    {"report", &TrustedComment::report_id},
    {"attempt", &TrustedComment::attempt_id},
    {"role", &TrustedComment::role},
    {"key", &TrustedComment::key},
    {"signed", &TrustedComment::signed_at},
    {"recomputed", &TrustedComment::recomputed},
}};

}  // namespace

std::string trusted_comment_text(const TrustedComment& comment) {
    std::string text(mark);
    for (const auto& [name, member] : fields)
        if (member != &TrustedComment::recomputed || !comment.recomputed.empty())
            text += fmt::format(" {}={}", name, comment.*member);
    return text;
}

TrustedComment parse_trusted_comment(std::string_view text) {
    TrustedComment comment;
    std::set<std::string_view> seen;
    const auto take_word = [&text] {
        const std::string_view word = text.substr(0, text.find(' '));
        text.remove_prefix(std::min(word.size() + 1, text.size()));
        return word;
    };
    if (take_word() != mark) return comment;
    while (!text.empty()) {
        const std::string_view word = take_word();
        const std::size_t equals = std::min(word.find('='), word.size());
        for (const auto& [name, member] : fields)
            if (word.substr(0, equals) == name && equals < word.size()) {
                if (!seen.insert(name).second) comment.repeated = name;
                comment.*member = word.substr(equals + 1);
            }
    }
    return comment;
}

}  // namespace runcert
