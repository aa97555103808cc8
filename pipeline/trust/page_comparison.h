#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace runcert {

/// What comparing a page with the one that was rendered again gave.
struct PageComparison {
    bool same = false;  ///< whether it shows just what was rendered
    std::string words{};
};

/// Why a PDF does not carry this report.json and no other file, in words; nothing where it does.
/// Failure where it cannot be read, or poppler-utils is missing.
std::optional<std::string> fault_of_attachment(const std::filesystem::path& pdf,
                                               const std::string& report_text);

/// Byte for byte.
PageComparison compare_bytes(const std::filesystem::path& page, const std::filesystem::path& own);

/// Byte for byte; a PDF that a seal was put on must carry the same report and nothing else, run no
/// script, hold the same text and show the same pictures, page by page (poppler, 100 dots per
/// inch), and its seal must hold for every byte. Where one is not the same, the words say in what,
/// and that another renderer made it where one did.
PageComparison compare_pdf(const std::filesystem::path& pdf, const std::filesystem::path& own,
                           const std::string& report_text);

}  // namespace runcert
