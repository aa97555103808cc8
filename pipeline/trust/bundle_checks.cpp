#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/product_files.h"
#include "schemas/products/products.h"
#include "store/archive.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/bundle.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t mebibyte = std::uint64_t{1} << 20;
constexpr std::uint64_t longest_table = 2048 * mebibyte;
constexpr std::uint64_t longest_recording = 2048 * mebibyte;
constexpr std::uint64_t longest_result = 16 * mebibyte;  // a text is many times that when parsed
constexpr std::uint64_t longest_page = longest_pdf;
constexpr std::uint64_t most_bytes = 4096 * mebibyte;
constexpr std::uint64_t most_files = 20000;
/// A table of figures is packed to a fifth; what is packed to less than that holds nothing.
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

constexpr std::size_t hash_digits = 64;

struct Sums {
    std::map<std::string, std::string> sha256_of;
    std::vector<SumProblem> problems = {};
};

/// A line must be as `sums_line` writes it, so that no changed byte goes unnoticed. A problem names
/// a file as the line has it only where the name is plain.
Sums parse_sums(std::string_view text) {
    Sums sums;
    std::string last;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = text.find('\n');
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        const bool whole = end != std::string_view::npos && line.size() > hash_digits + 2;
        const std::string hash(line.substr(0, whole ? hash_digits : 0));
        const std::string name(line.substr(whole ? hash_digits + 2 : line.size()));
        if (!whole || line.substr(hash_digits, 2) != "  " || !is_plain_name(name) ||
            hash.find_first_not_of("0123456789abcdef") != std::string::npos) {
            sums.problems.push_back(
                {bundle_sums_file,
                 fmt::format("line {} is not a hash of 64 digits, two blanks and a name: \"{}\"",
                             number, escape_for_message(line, 100))});
            continue;
        }
        if (name <= last)
            sums.problems.push_back(
                {bundle_sums_file, fmt::format("line {}: {} is there twice or out of order", number,
                                               escape_for_message(name, 100))});
        last = name;
        sums.sha256_of[name] = hash;
    }
    return sums;
}

/// Every file below a folder but SHA256SUMS; what is neither file nor folder is a problem.
std::set<std::string> files_below(const fs::path& folder, std::vector<SumProblem>& problems) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).generic_string();
        const fs::file_type type = entry.symlink_status().type();
        if (type == fs::file_type::directory || name == bundle_sums_file) continue;
        if (type == fs::file_type::regular)
            names.insert(name);
        else
            problems.push_back(
                {escape_for_message(name, 200), "is a link, pipe or device; none belongs here"});
    }
    return names;
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
    if (is_page_name(name)) return longest_page;
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

std::string sums_line(const std::string& sha256, const std::string& file) {
    return fmt::format("{}  {}\n", sha256, file);
}

std::vector<SumProblem> check_sums(const std::filesystem::path& folder) {
    if (!fs::is_regular_file(fs::symlink_status(folder / bundle_sums_file)))
        return {{bundle_sums_file, "is missing: there is nothing to compare the files with"}};
    Sums sums = parse_sums(read_file(folder / bundle_sums_file));
    std::vector<SumProblem> problems = std::move(sums.problems);
    const std::set<std::string> files = files_below(folder, problems);
    for (const auto& [name, sha256] : sums.sha256_of)
        if (!files.contains(name))
            problems.push_back(
                {name, fmt::format("is missing, and {} names it", bundle_sums_file)});
        else if (digest_file(folder / name).sha256 != sha256)
            problems.push_back({name, fmt::format("is not what {} says: one of the two was changed",
                                                  bundle_sums_file)});
    for (const std::string& name : files)
        if (!sums.sha256_of.contains(name))
            problems.push_back({escape_for_message(name, 200),
                                fmt::format("is not named in {}", bundle_sums_file)});
    std::stable_sort(problems.begin(), problems.end(),
                     [](const SumProblem& a, const SumProblem& b) { return a.file < b.file; });
    return problems;
}

std::optional<VerificationStep> verify_bundle(const std::filesystem::path& run_dir,
                                              bool is_bundle) {
    if (!is_bundle &&
        !std::filesystem::exists(std::filesystem::symlink_status(run_dir / bundle_sums_file)))
        return std::nullopt;
    VerificationStep step{.what = "bundle", .answer = LayerAnswer::verified};
    for (const SumProblem& one : check_sums(run_dir))
        step.fail(one.file + " " + one.problem);
    step.finding = fmt::format("the files are {}those that the bundle's {} lists",
                               step.is(LayerAnswer::verified) ? "" : "not ", bundle_sums_file);
    if (std::filesystem::exists(run_dir / bundle_keys_folder))
        step.details.emplace_back(
            "The keys in it are the sender's word: one counts where you give it yourself.");
    return step;
}

}  // namespace runcert
