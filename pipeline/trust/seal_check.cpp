#include <fmt/format.h>

#include <array>
#include <optional>
#include <regex>
#include <vector>

#include "core/text.h"
#include "trust/seal.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

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
constexpr int exit_no_signature = 2;

/// Limits for a program that reads a PDF: far more than any needs for one of ours.
constexpr ExternalLimits reading_pdf{.time = std::chrono::seconds(60),
                                     .memory_bytes = std::uint64_t{512} << 20,
                                     .file_bytes = longest_pdf,
                                     .output_bytes = std::size_t{1} << 20};

/// The nine lines of the one signature, without their labels; nothing where it is otherwise.
std::optional<std::array<std::string, line_count>> one_signature(
    const std::vector<std::string>& lines) {
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

std::string poppler(std::vector<std::string> command, const fs::path& pdf,
                    const std::vector<std::string>& more, const fs::path& folder) {
    const fs::path input = external_input(pdf);
    command.push_back(input.string());
    command.insert(command.end(), more.begin(), more.end());
    const ExternalCall call{
        .command = std::move(command), .folder = folder, .inputs = {input}, .limits = reading_pdf};
    const ProcessResult result = run_external(call);
    if (result.exit_status != 0)
        throw Failure(call.command.front(), external_problem(call, result),
                      "Render the page again from report.json");
    return result.output;
}

// `pdfdetach -list` says "1 embedded files", then "1: report.json" for each.
std::optional<std::string> fault_of_attachment(const fs::path& pdf, const std::string& report) {
    const std::string list = poppler({"pdfdetach", "-list"}, pdf);
    if (list != "1 embedded files\n1: report.json\n")
        return "it does not carry report.json and no other file";
    const TemporaryFolder folder;
    (void)poppler({"pdfdetach", "-save", "1", "-o", "report.json"}, pdf, {}, folder.path());
    if (read_file(folder.path() / "report.json") != report)
        return "the report attached to it is not report.json";
    return std::nullopt;
}

std::optional<std::string> fault_under_seal(std::string_view sealed, std::string_view own) {
    static const std::regex other(
        "stream|%%EOF\\s*[^\\s]|/(?!(AcroForm|Adobe\\.PPKLite|Annots?|BaseFont|BleedBox|ByteRange|"
        "Catalog|Contents|Creator|DA|DR|Dests|DisplayDocTitle|EmbeddedFiles|Encoding|FT?|Fields|"
        "Filter|FirstChar|Font|Ft[0-9]+|Helvetica|ID|Info|Lang|LastChar|M|MarkInfo|Marked|MediaBox|"
        "Metadata|ModDate|Names|Outlines|P|Pages?|Parent|Prev|Producer|Reason|Rect|Resources|Root|"
        "S(ig|igFlags|ize)?|StructParents|StructTreeRoot|Sub(Filter|ject|type)|T|Tabs|Title|"
        "TrimBox|"
        "Type1?|V|ViewerPreferences|Widget|Widths|WinAnsiEncoding|XYZ|adbe\\.pkcs7\\.detached)"
        "[/<>()\\[\\]\\s])[^/<>()\\[\\]\\s]*");
    if (!sealed.starts_with(own)) return "under its seal lies another PDF than is rendered";
    const std::string added(sealed.substr(own.size()));
    std::smatch found;
    if (!std::regex_search(added, found, other)) return std::nullopt;
    return fmt::format("its seal came with \"{}\"", escape_for_message(found.str(), 40));
}

SealCheck check_seal(const std::filesystem::path& pdf) {
    require_readable_pdf(pdf);
    const FileView view(pdf);
    if (!view.bytes().starts_with("%PDF-"))
        throw Failure(pdf.string(), "this is not a PDF", "Render the report again");
    const fs::path input = external_input(pdf);
    const ExternalCall call{.command = {"pdfsig", "-nocert", "-no-ocsp", input.string()},
                            .inputs = {input},
                            .limits = reading_pdf};
    const ProcessResult result = run_external(call);
    // The file's own name stands in the words: the last component of its path is no choice of
    // whoever made the PDF.
    if (result.exit_status == exit_no_signature &&
        result.output.ends_with("does not contain any signatures\n"))
        return {.words = "the PDF carries no seal"};
    if (result.exit_status != 0 && result.output.empty())
        throw Failure(
            pdf.string(),
            fmt::format("pdfsig cannot read this PDF: {}", external_problem(call, result)),
            "Render the report again");
    return seal_from_words(result.output, view.bytes().size());
}

SealCheck seal_from_words(std::string_view output, std::uint64_t file_bytes) {
    SealCheck check{.present = true};
    const auto lines = lines_of(std::string(output));
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
