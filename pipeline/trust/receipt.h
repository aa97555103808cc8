#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "trust/statement.h"

// That a recording was handed in: an official signs its hash and the time. It shows that the
// recording was made before; a time stamp of the receipt shows it by another clock.

namespace runcert {

struct ReceivedFile {
    std::string name{};    ///< as it was handed in
    std::string sha256{};  ///< 64 lower-case hexadecimal digits
    std::uint64_t bytes = 0;
};

struct Receipt {
    std::vector<ReceivedFile> files{};
    std::string from{};  ///< who handed them in, as the official says; may be empty
    SignedStatement signed_by{};
};

/// The text of a receipt of these files, signed.
std::string sign_receipt(const Receipt& receipt, const std::string& role, const SecretKey& key);

/// Reads one. Failure where it is none, was changed, or names a file in another form: its entry is
/// then named by its number.
Receipt read_receipt(std::string_view text, const std::string& where);

/// What the receipt of a receiver shows, in one sentence; empty where it has none. `run_dir` holds
/// the receipt and the recordings. Failure where the receipt does not name each recording, with its
/// length, or cannot be read.
std::string receipt_text(const Receiver& receiver, const std::filesystem::path& run_dir);

/// Whether the receipts that an attempt names hold, who signed them by the roster, and when they
/// were time-stamped. Nothing where it names none.
std::optional<VerificationStep> verify_receipts(const std::filesystem::path& run_dir,
                                                const ReportFacts& report,
                                                const SignatureRules& rules);

}  // namespace runcert
