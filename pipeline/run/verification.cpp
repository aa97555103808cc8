#include "run/verification.h"

#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/ecsv.h"
#include "files/sha256.h"
#include "schemas/common/header.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

using Subjects = std::map<std::string, std::string>;  // file name to SHA-256

Subjects subjects_of(const fs::path& run_dir) {
    const fs::path file = run_dir / "report.json";
    const std::string text = read_file(file);
    try {
        Subjects subjects;
        const auto report = nlohmann::json::parse(text);
        for (const auto& subject : report.at("subject")) {
            const std::string name = subject.at("name").get<std::string>();
            if (name.empty() || name.find('/') != std::string::npos || name == "." || name == "..")
                throw Failure(file.string(),
                              fmt::format("the subject \"{}\" is not a file of the run folder",
                                          escape_for_message(name)),
                              "This is not a report of this program, or it was changed");
            subjects[name] = subject.at("digest").at("sha256").get<std::string>();
        }
        return subjects;
    } catch (const nlohmann::json::exception& error) {
        throw Failure(file.string(), fmt::format("not a report: {}", error.what()),
                      "The file was changed or cut off; take the original");
    }
}

/// The header of a stage file; nothing for evidence, which has none.
std::optional<Header> header_of(const fs::path& file) {
    const std::string name = file.filename().string();
    const bool product = name.size() > 2 && name[0] >= '1' && name[0] <= '9' && name[1] == '-';
    if (!product) return std::nullopt;
    const std::string text = read_file(file);
    if (file.extension() == ".ecsv")
        return read_header(YamlValue(EcsvReader(text, file.string()).meta(), file.string()));
    return read_header(YamlValue(parse_yaml(text, file.string()), file.string()));
}

}  // namespace

VerificationStep verify_files(const fs::path& run_dir) {
    const Subjects subjects = subjects_of(run_dir);
    VerificationStep step{.passed = true, .what = "files", .finding = {}, .details = {}};
    for (const auto& [name, sha256] : subjects) {
        if (!fs::exists(run_dir / name)) {
            step.passed = false;
            step.details.push_back(name + ": missing");
        } else if (digest_file(run_dir / name).sha256 != sha256) {
            step.passed = false;
            step.details.push_back(name + ": changed, its bytes are not those the report names");
        }
    }
    step.finding = step.passed
                       ? fmt::format("all {} files are those the report names", subjects.size())
                       : "not all files are those the report names";
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (name == "report.html" || name == "report.pdf")
            step.details.push_back(name + ": for reading; what is signed is report.json");
        else if (!subjects.contains(name) && !name.starts_with("report.json") && name != "run.yaml")
            step.details.push_back(name + ": not part of the report");
    }
    return step;
}

VerificationStep verify_chain(const fs::path& run_dir) {
    const Subjects subjects = subjects_of(run_dir);
    VerificationStep step{.passed = true, .what = "chain", .finding = {}, .details = {}};
    std::size_t products = 0;
    const auto fail = [&](std::string detail) {
        step.passed = false;
        step.details.push_back(std::move(detail));
    };
    for (const auto& [name, sha256] : subjects) {
        if (!fs::exists(run_dir / name)) continue;  // said by verify_files
        try {
            const auto header = header_of(run_dir / name);
            if (!header) continue;
            ++products;
            for (const InputFile& input : header->inputs) {
                const auto subject = subjects.find(input.file);
                if (subject == subjects.end())
                    fail(fmt::format("{}: made from {}, which the report does not name", name,
                                     input.file));
                else if (subject->second != input.sha256)
                    fail(fmt::format("{}: made from another {} than the report names", name,
                                     input.file));
            }
        } catch (const Failure& failure) {
            fail(fmt::format("{}: cannot be read: {}", name, failure.problem()));
        }
    }
    step.finding =
        step.passed ? fmt::format("each of {} stage files was made from the files named", products)
                    : "the stage files do not belong together";
    return step;
}

VerificationStep verify_signature(const fs::path& run_dir, const std::optional<PublicKey>& key) {
    VerificationStep step{.passed = false, .what = "signature", .finding = {}, .details = {}};
    const fs::path file = run_dir / "report.json.minisig";
    if (!fs::exists(file)) {
        step.finding = "the report is UNSIGNED: nobody answers for it";
        return step;
    }
    if (!key) {
        step.finding =
            "the report is signed, but no key was given to check the signature with "
            "(--pubkey)";
        return step;
    }
    try {
        const SignatureCheck check = check_signature(read_file(run_dir / "report.json"),
                                                     read_handwritten(file), *key, file.string());
        step.passed = check.valid;
        step.finding = check.valid
                           ? fmt::format("report.json was signed by the key {}", key_id_text(*key))
                           : "report.json: the signature does not hold: " + check.reason;
        if (check.valid) step.details.push_back(check.trusted_comment);
    } catch (const Failure& failure) {
        step.finding = "report.json.minisig: not a signature: " + failure.problem();
    }
    return step;
}

}  // namespace runcert
