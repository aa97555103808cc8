#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/text.h"
#include "files/archive.h"
#include "files/atomic_file.h"
#include "files/sha256.h"
#include "trust/bundle.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t hash_digits = 64;

struct Sums {
    std::map<std::string, std::string> sha256_of;
    std::vector<SumProblem> problems = {};
};

/// A line must be as `sums_line` writes it, so that no change of a byte goes unseen; what stands in
/// a problem's text is never a file name from the line unless it is plain.
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

}  // namespace runcert
