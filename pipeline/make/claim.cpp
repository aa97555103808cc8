#include "make/claim.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "schemas/common/header.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "store/yaml_input.h"

namespace runcert {

Claim read_claim(const GivenAttempt& given) {
    Claim claim;
    // The text that a day file made has lines that are not the day file's.
    claim.source.file =
        given.file.empty() ? given.folder / (given.source + " as attempt.yaml") : given.file;
    claim.source.folder = given.folder;
    claim.text = given.file.empty() ? given.text : read_handwritten(given.file);
    const std::string where = claim.source.file.string();
    claim.attempt = read_attempt(claim.text, where);
    if (claim.attempt.id != given.id)
        throw Failure(where,
                      fmt::format("the id is \"{}\", and was \"{}\" when the day was listed",
                                  claim.attempt.id, given.id),
                      "Leave the attempt as it is while the batch runs, and run it again");
    for (const std::string& claimed : claim.attempt.profiles) {
        const std::string profile = find_profile(claimed, claim.source);
        claim.profiles.emplace_back(parse_yaml(profile, claimed), claimed);
        claim.files[profile_copy_name(claimed)] = sha256_hex(profile);
    }
    for (const AttemptFile& file : series_files(claim.attempt))
        claim.files[file.name] = sha256_hex(find_series(file, claim.source));
    claim.files[std::string(attempt_copy_name)] = sha256_hex(claim.text);
    return claim;
}

FileHashes recording_hashes(const Claim& claim) {
    FileHashes hashes;
    for (const Receiver& receiver : claim.attempt.receivers)
        for (const AttemptFile& file : files_of_receiver(receiver))
            hashes[file.name] = digest_of(open_attempt_file(file, receiver, claim.source)).sha256;
    return hashes;
}

OpaqueJson settings_of_step(std::string_view step, const Attempt& attempt,
                            const std::vector<YamlValue>& profiles, const ReportChoice& choice) {
    if (step == "sign") return nlohmann::ordered_json{{"signer", choice.signer}};
    if (step == "render") return nlohmann::ordered_json{{"pages", choice.pages}};
    if (!reads_part(step)) return OpaqueJson();
    OpaqueJson settings = part_of_stage(attempt, step).settings;
    if (settings->contains("profiles")) settings["profiles"] = profiles_of_stage(profiles, step);
    return settings;
}

}  // namespace runcert
