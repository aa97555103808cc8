#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// What an official signs for: answers to requirements of a report, or that it was recomputed. The
/// payload of an envelope, an in-toto statement (https://in-toto.io/Statement/v1) whose subject is
/// report.json.
namespace runcert {

/// Types of what is said of the report: answers, and a board's "recomputed and agreed", which is
/// in-toto's simple verification result.
inline constexpr std::string_view answers_type = "urn:runcert:attestation:1.0";
inline constexpr std::string_view recomputed_type = "https://in-toto.io/attestation/svr/v0.2";

/// "yes", "no", and "withdrawn": the signer's earlier answers, of the envelopes that lay there, are
/// taken back.
inline constexpr std::string_view answer_yes = "yes";
inline constexpr std::string_view answer_no = "no";
inline constexpr std::string_view answer_withdrawn = "withdrawn";

struct Answer {
    std::string profile{};  ///< the rule
    std::string clause{};
    std::string text{};   ///< of the clause, as it was shown to whoever answers
    std::string shown{};  ///< its figures, as they were shown
    std::string answer{};

    bool operator==(const Answer&) const = default;
};

/// A file that lies beside the envelope.
struct EvidenceFile {
    std::string name{};    ///< as its owner called it
    std::string sha256{};  ///< 64 lower-case hexadecimal digits

    bool operator==(const EvidenceFile&) const = default;
};

struct Attestation {
    std::string report_sha256{};  ///< of the bytes of report.json
    std::string role{};
    std::string key{};   ///< the signer's, as `minisign -P` takes it
    std::string time{};  ///< by the signer's clock, "2026-11-21T20:41:50Z"
    std::string report_id{};
    std::string attempt_id{};
    std::vector<Answer> answers{};  ///< none of "recomputed and agreed"
    std::string statement{};        ///< in the signer's words; may be empty
    std::vector<EvidenceFile> evidence{};
    std::optional<EvidenceFile>
        on_paper{};                    ///< the sheet that was signed by hand, and is answered for
    std::vector<std::string> after{};  ///< ids of the envelopes that lay there when it was signed
    std::vector<EvidenceFile> policies{};  ///< of "recomputed and agreed" alone: the rules

    bool is_recomputed() const { return answers.empty(); }
    bool operator==(const Attestation&) const = default;
};

/// The payload: JSON, the same bytes for the same attestation.
std::string statement_text(const Attestation& attestation);

/// Reads a payload. Failure where it is anything but what statement_text writes, byte for byte: so
/// it holds nothing that is not read, and an answer is one of the three.
Attestation read_statement(std::string_view payload, const std::string& where);

/// What names a statement: the SHA-256 of its payload. That of the envelope would not do, since
/// anyone can wrap the same signed payload in other bytes.
std::string attestation_id(std::string_view payload);

}  // namespace runcert
