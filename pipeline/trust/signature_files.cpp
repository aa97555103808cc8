#include "trust/signature_files.h"

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

void remove_signatures(const fs::path& run_dir) {
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(run_dir))
        if (belongs_to_signatures(entry.path().filename().string())) old.push_back(entry.path());
    for (const fs::path& file : old) {
        std::error_code error;
        fs::remove(file, error);
        if (error)
            throw Failure(
                file.string(),
                "the signature of an earlier report cannot be removed: " + error.message(),
                "Check that the folder can be written, and run again");
    }
}

}  // namespace runcert
