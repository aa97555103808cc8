#include "trust/receipt.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/time_stamp.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using OrderedJson = nlohmann::ordered_json;

constexpr std::string_view receipt_type = "urn:runcert:receipt:1.0";

OrderedJson subject_of(const ReceivedFile& file) {
    return {{"name", file.name},
            {"digest", {{"sha256", file.sha256}}},
            {"annotations", {{"bytes", file.bytes}}}};
}

bool is_sha256(const std::string& text) {
    return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

ReceivedFile read_subject(const OrderedJson& json, std::size_t number, const std::string& where) {
    try {
        ReceivedFile file{.name = json.at("name").get<std::string>(),
                          .sha256 = json.at("digest").at("sha256").get<std::string>(),
                          .bytes = json.at("annotations").at("bytes").get<std::uint64_t>()};
        if (is_sha256(file.sha256) && subject_of(file) == json) return file;
    } catch (const nlohmann::json::exception&) {
        // Said below, as of any other form.
    }
    throw Failure(where, fmt::format("entry {} names no file with its hash and length", number),
                  "Ask for the receipt as it was signed");
}

/// The file in the run folder of a receiver's receipt, or of its time stamp; empty where there is
/// none.
fs::path file_in_role(const Receiver& receiver, std::string_view role, const fs::path& run_dir) {
    for (const AttemptFile& file : files_of_receiver(receiver))
        if (file.role == role) return run_dir / file.name;
    return {};
}

/// The receipt of a receiver, which names each of its recordings. Failure where it does not.
Receipt receipt_of(const Receiver& receiver, const fs::path& run_dir) {
    const fs::path path = file_in_role(receiver, "receipt", run_dir);
    Receipt receipt = read_receipt(read_handwritten(path), path.filename().string());
    for (const AttemptFile& file : files_of_receiver(receiver)) {
        if (file.role != "recording") continue;
        const FileDigest digest = digest_file(run_dir / file.name);
        const bool named = std::ranges::any_of(receipt.files, [&](const ReceivedFile& one) {
            return one.sha256 == digest.sha256 && one.bytes == digest.bytes;
        });
        if (!named)
            throw Failure(
                path.filename().string(),
                fmt::format("the receipt is of other files: it does not name the recording \"{}\" "
                            "(SHA-256 {})",
                            escape_for_message(file.original), digest.sha256),
                "Name the receipt that was written when this very recording was handed in, or "
                "none");
    }
    return receipt;
}

}  // namespace

std::string sign_receipt(const Receipt& receipt, const std::string& role, const SecretKey& key) {
    SignedStatement statement{.facts = {{"from", receipt.from}}, .role = role};
    for (const ReceivedFile& file : receipt.files)
        statement.subject.push_back(subject_of(file));
    return sign_statement(std::move(statement), receipt_type, key);
}

Receipt read_receipt(std::string_view text, const std::string& where) {
    Receipt receipt{.signed_by = read_statement_of(text, receipt_type, "receipt", where)};
    const SignedStatement& said = receipt.signed_by;
    if (said.facts.size() != 1 || !said.facts.value("from", OrderedJson()).is_string() ||
        !said.subject.is_array() || said.subject.empty())
        throw Failure(where, "it is no receipt as runcert writes one",
                      "Ask for the receipt as it was signed");
    receipt.from = said.facts["from"].get<std::string>();
    for (const OrderedJson& one : said.subject)
        receipt.files.push_back(read_subject(one, receipt.files.size() + 1, where));
    return receipt;
}

std::string receipt_text(const Receiver& receiver, const fs::path& run_dir) {
    if (!receiver.receipt) return {};
    const Receipt receipt = receipt_of(receiver, run_dir);
    return plain_text(fmt::format(
        "{}{}: {} signed so, with the key {} ({}). Whose key it is, runcert verify says; {}",
        receipt.signed_by.time, receipt.from.empty() ? "" : ", by " + receipt.from,
        receipt.signed_by.role, receipt.signed_by.key,
        file_in_role(receiver, "receipt", run_dir).filename().string(),
        receiver.receipt->time_stamp.empty() ? "the receipt has no time stamp"
                                             : "so it does of the time stamp"));
}

std::optional<VerificationStep> verify_receipts(const fs::path& run_dir, const ReportFacts& report,
                                                const SignatureRules& rules) {
    VerificationStep step{.what = "receipts", .answer = LayerAnswer::verified};
    std::int64_t count = 0;
    const std::string file = (run_dir / attempt_copy_name).string();
    std::vector<Receiver> receivers;
    try {
        receivers = read_attempt(read_handwritten(file), file).receivers;
    } catch (const Failure&) {
        return std::nullopt;  // an attempt that is missing or none is for other layers to find
    }
    for (const Receiver& receiver : receivers) {
        if (!receiver.receipt) continue;
        ++count;
        const std::string name = file_in_role(receiver, "receipt", run_dir).filename().string();
        try {
            const Receipt receipt = receipt_of(receiver, run_dir);
            std::optional<UtcSecond> stamped;
            const fs::path stamp = file_in_role(receiver, "receipt_stamp", run_dir);
            if (!stamp.empty() && !rules.time_stamp_cas.empty()) {
                const TimeStampCheck check =
                    check_time_stamp(run_dir / name, stamp, rules.time_stamp_cas);
                if (check.valid)
                    stamped = check.time;
                else
                    step.fail(fmt::format("{}: {}", stamp.filename().string(), check.reason));
            }
            const Signer signer = judge_statement(receipt.signed_by, name, stamped, rules);
            const auto stated = parse_iso_utc(receipt.signed_by.time);
            const bool too_early = report.recorded_until && stated &&
                                   *stated + clock_tolerance < *report.recorded_until;
            step.details.push_back(fmt::format(
                "{}: {}{}{}", name, signer_words(signer),
                stamped          ? "; time-stamped " + iso_text(*stamped)
                : !stamp.empty() ? "; its time stamp is checked with --tsa-ca"
                                 : "",
                too_early
                    ? "; that is BEFORE THE END OF THE RECORDING: one of these clocks is wrong"
                    : ""));
        } catch (const ComputerFailure&) {
            throw;
        } catch (const Failure& failure) {
            step.fail(fmt::format("{}: {}", name, failure.problem()));
        }
    }
    if (count == 0) return std::nullopt;
    step.finding = step.is(LayerAnswer::verified)
                       ? "each receipt names the recording that it belongs to"
                       : "not every receipt is one of its recording";
    return step;
}

}  // namespace runcert
