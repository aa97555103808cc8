#include <fmt/format.h>

#include <array>
#include <optional>
#include <vector>

#include "core/text.h"
#include "trust/seal.h"

namespace runcert {
namespace {

/// The lines on a signature, in the order in which pdfsig 22.12 prints them.
enum Line : std::size_t {
    field_name,
    common_name,
    full_name,
    time,
    hash,
    type,
    ranges,
    total,
    validation,
    line_count
};

constexpr std::array<std::string_view, line_count> labels{"  - Signature Field Name: ",
                                                          "  - Signer Certificate Common Name: ",
                                                          "  - Signer full Distinguished Name: ",
                                                          "  - Signing Time: ",
                                                          "  - Signing Hash Algorithm: ",
                                                          "  - Signature Type: ",
                                                          "  - Signed Ranges: ",
                                                          "  - Total document signed",
                                                          "  - Signature Validation: "};
constexpr std::string_view not_total = "  - Not total document signed";
constexpr std::string_view first_line = "Digital Signature Info of: ";
constexpr std::size_t longest_name = 200;

std::vector<std::string_view> lines_of(std::string_view text) {
    std::vector<std::string_view> lines;
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        lines.push_back(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return lines;
}

/// The nine lines of the one signature, without their labels; nothing where it is otherwise.
std::optional<std::array<std::string, line_count>> one_signature(
    const std::vector<std::string_view>& lines) {
    if (lines.size() != 2 + line_count || !lines[0].starts_with(first_line) ||
        lines[1] != "Signature #1:")
        return std::nullopt;
    std::array<std::string, line_count> values;
    for (std::size_t i = 0; i < line_count; ++i) {
        const std::string_view line = lines[i + 2];
        if (i == total && line == not_total) {
            values[i] = "no";
        } else if (line.starts_with(labels[i])) {
            values[i] = i == total ? "yes" : std::string(line.substr(labels[i].size()));
        } else {
            return std::nullopt;
        }
    }
    return values;
}

SealCheck with_words(SealCheck check, const std::string& validation_text) {
    const std::string who = fmt::format("sealed in the name of \"{}\"", check.signer);
    if (!check.valid)
        check.words = fmt::format("{}, but the seal does not hold: {}", who, validation_text);
    else if (!check.whole_document)
        check.words = who + ", but bytes were added after the seal, which does not cover them";
    else
        check.words =
            who + ", and the seal holds for every byte; whose key it is, only its certificate says";
    return check;
}

}  // namespace

SealCheck seal_from_words(std::string_view output, std::uint64_t file_bytes) {
    SealCheck check{.present = true};
    const auto lines = lines_of(output);
    const auto values = one_signature(lines);
    if (!values) {
        const bool several = output.find("\nSignature #2:\n") != std::string_view::npos;
        check.words = several ? "it carries several signatures, and a report has one"
                              : "it carries something like a signature that pdfsig cannot make "
                                "out as one";
        return check;
    }
    check.signer = escape_for_message((*values)[common_name], longest_name);
    check.type = escape_for_message((*values)[type], longest_name);
    check.valid = (*values)[validation] == "Signature is Valid.";
    const std::string& covered = (*values)[ranges];
    check.whole_document = (*values)[total] == "yes" && covered.starts_with("[0 - ") &&
                           covered.ends_with(fmt::format(" - {}]", file_bytes));
    return with_words(std::move(check), escape_for_message((*values)[validation], longest_name));
}

}  // namespace runcert
