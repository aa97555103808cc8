#include "run/evidence.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "files/atomic_file.h"

namespace runcert {

std::string evidence_recording_file(const Receiver& receiver) {
    std::string extension = std::filesystem::path(receiver.recording).extension().string();
    const bool plain =
        extension.size() > 1 && extension.size() <= 9 &&
        std::all_of(extension.begin() + 1, extension.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        });
    return fmt::format("recording.{}{}", receiver.id, plain ? extension : ".dat");
}

std::string evidence_profile_file(const std::string& claimed) {
    return fmt::format("profile.{}.yaml", profile_name(claimed));
}

std::string find_recording(const Receiver& receiver, const std::filesystem::path& attempt_file,
                           const std::optional<std::filesystem::path>& evidence) {
    const std::filesystem::path path = evidence ? *evidence / evidence_recording_file(receiver)
                                                : attempt_file.parent_path() / receiver.recording;
    if (!std::filesystem::exists(path))
        throw Failure(receiver.place,
                      fmt::format("the recording \"{}\" of receiver \"{}\" does not exist (looked "
                                  "for {})",
                                  receiver.recording, receiver.id, path.string()),
                      "Correct `recording:`, which is relative to the attempt's folder");
    return read_file(path);
}

std::string find_profile(const std::string& claimed, const std::filesystem::path& attempt_file,
                         const std::optional<std::filesystem::path>& evidence) {
    if (evidence) return read_file(*evidence / evidence_profile_file(claimed));
    if (const std::string_view text = builtin_profile(claimed); !text.empty())
        return std::string(text);
    const std::filesystem::path path = attempt_file.parent_path() / claimed;
    if (!claimed.ends_with(".yaml") || !std::filesystem::exists(path))
        throw Failure(attempt_file.string(), fmt::format("there is no profile \"{}\"", claimed),
                      "Use nalsa or fisly, or give the path of a profile file (.yaml) relative to "
                      "the attempt's folder");
    return read_file(path);
}

Profile read_claimed_profile(const std::filesystem::path& run_dir, const std::string& claimed) {
    const std::filesystem::path path = run_dir / evidence_profile_file(claimed);
    Profile profile = read_profile(read_file(path), path.string());
    if (profile.id != profile_name(claimed))
        throw Failure(path.string(),
                      fmt::format("the profile's id is \"{}\", its file is named \"{}\"",
                                  profile.id, profile_name(claimed)),
                      "Give the file the name of the id");
    return profile;
}

}  // namespace runcert
