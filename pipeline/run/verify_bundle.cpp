#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/sha256.h"
#include "run/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view list_name = "SHA256SUMS";
constexpr std::size_t hash_digits = 64;

struct ListedHash {
    std::string sha256;
    std::string file;
};

/// "HASH  NAME", as sha256sum prints it; nothing for any other line.
std::optional<ListedHash> read_listed(std::string_view line) {
    if (line.size() < hash_digits + 3 || line.substr(hash_digits, 2) != "  ") return std::nullopt;
    const std::string_view hash = line.substr(0, hash_digits);
    const std::string_view file = line.substr(hash_digits + 2);
    const bool is_hash = std::ranges::all_of(
        hash, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
    const fs::path path(file);
    // As the folder's own files are named below: nothing that leads out of it, or is written in
    // two ways.
    if (!is_hash || path.is_absolute() || path.lexically_normal().string() != file ||
        file.starts_with("..") || file == list_name)
        return std::nullopt;
    return ListedHash{std::string(hash), std::string(file)};
}

std::string fault_of(const fs::path& file, const std::string& sha256) {
    const fs::file_status status = fs::symlink_status(file);
    if (!fs::exists(status)) return "missing";
    if (fs::is_symlink(status)) return "a symbolic link";
    if (!fs::is_regular_file(status)) return "not a file";
    return digest_file(file).sha256 == sha256 ? "" : "changed, its bytes are not those listed";
}

/// Every name in the folder and in the folders inside that is not a folder.
std::set<std::string> names_in(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (!fs::is_directory(entry.symlink_status()))
            names.insert(entry.path().lexically_relative(folder).generic_string());
    return names;
}

}  // namespace

std::optional<VerificationStep> verify_bundle(const fs::path& run_dir) {
    const fs::path list = run_dir / list_name;
    if (!fs::exists(fs::symlink_status(list))) return std::nullopt;
    VerificationStep step{.passed = true, .what = "bundle", .finding = {}, .details = {}};
    const auto fail = [&step](const std::string& name, const std::string& what) {
        step.passed = false;
        step.details.push_back(escape_for_message(name, 120) + ": " + what);
    };
    std::set<std::string> unlisted = names_in(run_dir);
    unlisted.erase(std::string(list_name));
    const std::string text = read_handwritten(list);
    if (!text.ends_with('\n'))
        fail(std::string(list_name), "it is cut off: no line end at its end");
    std::size_t number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string line = text.substr(begin, end - begin);
        begin = end + 1;
        ++number;
        const auto listed = read_listed(line);
        if (!listed) {
            fail(fmt::format("{}, line {}", list_name, number),
                 "it is not \"HASH  NAME\" as sha256sum prints it");
            continue;
        }
        if (const std::string fault = fault_of(run_dir / listed->file, listed->sha256);
            !fault.empty())
            fail(listed->file, fault);
        else if (!unlisted.contains(listed->file))
            fail(listed->file, "listed twice");
        unlisted.erase(listed->file);
    }
    for (const std::string& name : unlisted)
        fail(name, fmt::format("not listed in {}: move it away", list_name));
    step.finding =
        step.passed
            ? fmt::format("all {} files are as the bundle's {} lists them", number, list_name)
            : fmt::format("the files are not those that the bundle's {} lists", list_name);
    return step;
}

}  // namespace runcert
