#include "trust/signature_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "files/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view signed_file = "report.json";
constexpr std::string_view minisign_end = ".minisig";
constexpr std::string_view ssh_end = ".sig";
constexpr std::string_view time_stamp_end = ".tsr";
constexpr std::string_view query_end = ".tsq";

std::vector<std::string> signature_names(const fs::path& run_dir) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(run_dir))
        if (belongs_to_signatures(entry.path().filename().string()))
            names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
}

/// A file in `folder`'s folder of what was superseded that neither it nor `other`'s has.
fs::path free_place(const fs::path& folder, const fs::path& other, const std::string& name) {
    refuse_link(folder / superseded_folder);
    make_directory(folder / superseded_folder);
    const auto is_free = [&](const std::string& free) {
        return !fs::exists(fs::symlink_status(folder / superseded_folder / free)) &&
               !fs::exists(fs::symlink_status(other / superseded_folder / free));
    };
    std::string free = name;
    for (int number = 2; !is_free(free); ++number)
        free = fmt::format("{}.{}", name, number);
    return folder / superseded_folder / free;
}

}  // namespace

bool is_signature_name(std::string_view name) {
    return name.starts_with(std::string(signed_file) + ".") &&
           (name.ends_with(minisign_end) || name.ends_with(ssh_end));
}

std::string time_stamp_name(std::string_view signature) {
    return std::string(signature).append(time_stamp_end);
}

std::string time_stamp_query_name(std::string_view signature) {
    return std::string(signature).append(query_end);
}

bool belongs_to_signatures(std::string_view name) {
    for (const std::string_view end : {time_stamp_end, query_end})
        if (name.ends_with(end)) return is_signature_name(name.substr(0, name.size() - end.size()));
    return is_signature_name(name);
}

std::vector<SignatureFile> signature_files(const fs::path& run_dir) {
    std::vector<SignatureFile> files;
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (!is_signature_name(name) || !fs::is_regular_file(entry.symlink_status())) continue;
        files.push_back(
            {.name = name,
             .kind = name.ends_with(minisign_end) ? SignatureKind::minisign : SignatureKind::ssh,
             .text = read_handwritten(entry.path())});
    }
    const auto order = [](const SignatureFile& file) {
        return std::pair(file.name != "report.json.minisig", std::string_view(file.name));
    };
    std::ranges::sort(files, {}, order);
    return files;
}

void keep_superseded(const fs::path& run_dir, const std::string& name) {
    if (fs::is_regular_file(fs::symlink_status(run_dir / name)))
        write_file_atomically(free_place(run_dir, run_dir, name), read_file(run_dir / name));
}

void supersede_signatures(const fs::path& run_dir) {
    for (const std::string& name : signature_names(run_dir)) {
        keep_superseded(run_dir, name);
        std::error_code error;
        fs::remove(run_dir / name, error);
        if (error)
            throw Failure(
                (run_dir / name).string(),
                "the signature of an earlier report cannot be moved away: " + error.message(),
                "Check that the folder can be written, and run again");
    }
}

void carry_signatures(const fs::path& run_dir, const fs::path& made) {
    const fs::path report = run_dir / "report.json";
    if (!fs::is_regular_file(fs::symlink_status(report))) return;
    const bool unchanged = read_file(report) == read_file(made / "report.json");
    for (const std::string& name : signature_names(run_dir)) {
        if (!fs::is_regular_file(fs::symlink_status(run_dir / name))) continue;
        write_file_atomically(unchanged ? made / name : free_place(made, run_dir, name),
                              read_file(run_dir / name));
    }
}

}  // namespace runcert
