#include "trust/bundle_limits.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "schemas/products/products.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
constexpr std::uint64_t longest_table = 2048 * mebibyte;
constexpr std::uint64_t longest_recording = 2048 * mebibyte;
constexpr std::uint64_t longest_result = 16 * mebibyte;  // a text is many times that when parsed
constexpr std::uint64_t longest_page = longest_pdf;
constexpr std::uint64_t most_bytes = 4096 * mebibyte;
constexpr std::uint64_t most_files = 1000;
/// A table of figures is packed to a fifth; who packs to less than that has nothing in it.
constexpr std::uint64_t most_times_packed = 200;
constexpr std::uint64_t always_unpacked = 256 * mebibyte;

bool ends_with_any(std::string_view name, std::initializer_list<std::string_view> endings) {
    return std::ranges::any_of(endings, [&](auto ending) { return name.ends_with(ending); });
}

bool is_short(std::string_view name) {
    return name == "attempt.yaml" || name == "run.yaml" || name == "SHA256SUMS" ||
           name == "VERIFY.txt" || name.starts_with("profile.") || name.starts_with("keys/") ||
           name.starts_with("attestations/answer-") ||
           ends_with_any(name, {".minisig", ".sig", ".tsq", ".tsr", ".pub"});
}

}  // namespace

void require_readable_pdf(const std::filesystem::path& pdf) {
    if (fs::is_regular_file(pdf) && fs::file_size(pdf) > longest_pdf)
        throw Failure(
            pdf.string(),
            fmt::format("the PDF is longer than {} bytes, as none of a report is", longest_pdf),
            "Render the report again");
}

std::uint64_t most_bytes_of(std::string_view name) {
    if (is_short(name)) return longest_handwritten;
    if (name == "report.json") return longest_result;
    if (name.starts_with("report.")) return longest_page;
    if (is_product_name(name)) return name.ends_with(".ecsv") ? longest_table : longest_result;
    return longest_recording;
}

UnpackLimits bundle_limits(std::uint64_t bundle_bytes) {
    return {.bytes = std::min(
                most_bytes,
                std::max(always_unpacked, std::min(bundle_bytes, most_bytes) * most_times_packed)),
            .files = most_files,
            .bytes_of = [](std::string_view name) {
                return most_bytes_of(name.substr(name.find('/') + 1));
            }};
}

void require_within_limits(const std::filesystem::path& run_dir) {
    const auto refuse = [](const fs::path& where, const std::string& what) {
        throw Failure(
            where.string(), what,
            "Take the original, or certify with less of it; `runcert bundle --help` lists "
            "the limits");
    };
    std::uint64_t bytes = 0, files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(run_dir)) {
        if (++files > most_files)
            refuse(run_dir, fmt::format("the folder holds more than {} files", most_files));
        if (!entry.is_regular_file() || entry.is_symlink()) continue;
        const std::string name = entry.path().lexically_relative(run_dir).generic_string();
        const std::uint64_t size = entry.file_size();
        if (size > most_bytes_of(name))
            refuse(entry.path(), fmt::format("the file is longer than {} bytes, the most for one "
                                             "of its kind",
                                             most_bytes_of(name)));
        bytes += size;
    }
    if (bytes > most_bytes)
        refuse(run_dir, fmt::format("its files are longer than {} bytes together", most_bytes));
}

std::string bundle_limits_words() {
    return fmt::format(
        "Limits: {} MiB for a recording or a table of a stage; {} MiB for report.json and other\n"
        "results; {} MiB for a page or PDF; {} MiB for an attempt, rule, signature, time stamp or "
        "key.\n"
        "Together {} MiB and {} files, and of a bundle at most {} times its own length or {} MiB.",
        longest_table / mebibyte, longest_result / mebibyte, longest_page / mebibyte,
        longest_handwritten / mebibyte, most_bytes / mebibyte, most_files, most_times_packed,
        always_unpacked / mebibyte);
}

}  // namespace runcert
