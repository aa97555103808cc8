#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "core/failure.h"
#include "trust/attestation.h"

// The envelopes of attestations, and the statements in them.

namespace runcert::RUNCERT_FILE {
namespace {

/// The key whose seed is the bytes 0 to 31, with an id of as many zeros as it takes.
SecretKey known_key() {
    const std::string public_half =
        "\x03\xa1\x07\xbf\xf3\xce\x10\xbe\x1d\x70\xdd\x18\xe7\x4b\xc0\x99"
        "\x67\xe4\xd6\x30\x9b\xa5\x0d\x5f\x1d\xdc\x86\x64\x12\x55\x31\xb8";
    SecretKey::Bytes bytes{};
    for (std::size_t i = 0; i < 32; ++i) {
        bytes.at(i) = static_cast<unsigned char>(i);
        bytes.at(32 + i) = static_cast<unsigned char>(public_half[i]);
    }
    return {{}, bytes};
}

// By openssl 3.0, the payload type and payload put together by hand:
//   printf 'DSSEv1 28 application/vnd.in-toto+json 43 {"_type":"https://in-toto.io/Statement/v1"}'
//   openssl pkeyutl -sign -rawin -inkey KEY.pem -in BYTES | base64
const std::string payload = R"({"_type":"https://in-toto.io/Statement/v1"})";
const std::string by_openssl =
    R"({"payloadType":"application/vnd.in-toto+json","payload":"eyJfdHlwZSI6Imh0dHBzOi8vaW4tdG90by5pby9TdGF0ZW1lbnQvdjEifQ==","signatures":[{"keyid":"0000000000000000","sig":"Fo6jOXP9gw1yxFFqcxT3OROGg9MHJ9G2Ps2yCG4lrdJS8Yli9xdH78rzsGRdX7vN0BvZnteNGPg9F79CG51UDQ=="}]})"
    "\n";

TEST(Envelope, IsTheOneThatOpensslSigns) {
    EXPECT_EQ(dsse_bytes(statement_payload_type, payload),
              "DSSEv1 28 application/vnd.in-toto+json 43 " + payload);
    // The protocol's own example.
    EXPECT_EQ(dsse_bytes("http://example.com/HelloWorld", "hello world"),
              "DSSEv1 29 http://example.com/HelloWorld 11 hello world");
    EXPECT_EQ(sign_envelope(payload, known_key()), by_openssl);
    const Envelope read = read_envelope(by_openssl, "e");
    EXPECT_EQ(read.payload, payload);
    EXPECT_TRUE(envelope_holds(read, public_key_of(known_key())));
    EXPECT_FALSE(envelope_holds(read, generate_key_pair().public_key));
}

TEST(Envelope, NoChangeOfAByteGoesUnseen) {
    for (std::size_t i = 0; i < by_openssl.size(); ++i)
        for (const char other : {' ', 'A', '0', static_cast<char>(by_openssl[i] ^ 1)}) {
            if (other == by_openssl[i]) continue;
            std::string changed = by_openssl;
            changed[i] = other;
            bool seen = false;
            try {
                const Envelope read = read_envelope(changed, "e");
                seen = !envelope_holds(read, public_key_of(known_key())) ||
                       read.key_id != "0000000000000000";
            } catch (const Failure&) {
                seen = true;
            }
            EXPECT_TRUE(seen) << changed;
        }
    for (const std::string& other :
         {by_openssl + " ", by_openssl.substr(0, by_openssl.size() - 1), "\n" + by_openssl,
          std::string(), std::string("{}"), std::string("[]"), std::string(2000, '[')})
        EXPECT_THROW(read_envelope(other, "e"), Failure) << other;
}

Attestation answers() {
    return {.report_sha256 = std::string(64, 'a'),
            .role = "judge",
            .key = "RWx",
            .time = "2026-11-26T20:12:03Z",
            .report_id = "0123456789abcdef",
            .attempt_id = "land-yacht",
            .answers = {{"nalsa", "observers", "They are named.", "Nothing was computed.", "yes"},
                        {"nalsa", "own-start", "“By itself”", "0.1 m/s", "no"}},
            .statement = "I was there.",
            .evidence = {{"list.pdf", std::string(64, 'b')}},
            .on_paper = EvidenceFile{"scan.pdf", std::string(64, 'c')},
            .after = {{"RWy", std::string(64, 'd')}}};
}

TEST(Attestation, IsReadAsItIsWritten) {
    EXPECT_EQ(read_statement(statement_text(answers()), "s"), answers());
    Attestation recomputed = answers();
    recomputed.answers.clear();
    recomputed.on_paper.reset();
    recomputed.policies = {{"profile.nalsa.yaml", std::string(64, 'e')}};
    const std::string text = statement_text(recomputed);
    EXPECT_EQ(read_statement(text, "s"), recomputed);
    // What readers of simple verification results look for.
    for (const char* part :
         {R"("predicateType":"https://in-toto.io/attestation/svr/v0.2")",
          R"("verifier":{"id":"urn:runcert:role:judge","policies":[{"name":"profile.nalsa.yaml")",
          R"("timeCreated":"2026-11-26T20:12:03Z")",
          R"("properties":["RUNCERT_RECOMPUTED_AND_AGREED"])"})
        EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
}

TEST(Attestation, ThatClosesARunNamesFilesAndNothingElse) {
    Attestation closing = answers();
    closing.answers.clear();
    closing.closes = {{"report.json.minisig", std::string(64, 'f')}};
    const std::string text = statement_text(closing);
    EXPECT_EQ(read_statement(text, "s"), closing);
    EXPECT_TRUE(closing.is_closing() && !closing.is_recomputed());
    EXPECT_NE(text.find(R"("predicateType":"urn:runcert:closing:1.0")"), std::string::npos);
    for (const auto& [from, to] : {std::pair<std::string, std::string>{
                                       R"("closes":[{"name")", R"("closes":[],"x":[{"name")"},
                                   {"closing:1.0", "attestation:1.0"},
                                   {R"("closes":)", R"("answers":[],"closes":)"}}) {
        std::string changed = text;
        changed.replace(changed.find(from), from.size(), to);
        EXPECT_THROW(read_statement(changed, "s"), Failure) << changed;
    }
}

TEST(Attestation, HoldsNothingThatIsNotRead) {
    const std::string text = statement_text(answers());
    const auto refused = [&](const std::string& from, const std::string& to) {
        std::string changed = text;
        const std::size_t at = changed.find(from);
        ASSERT_NE(at, std::string::npos) << from;
        changed.replace(at, from.size(), to);
        EXPECT_THROW(read_statement(changed, "s"), Failure) << changed;
    };
    refused(R"("answer":"no")", R"("answer":"perhaps")");
    refused(R"("answer":"no")", R"("answer":"no","answer":"yes")");
    refused(R"("role":)", R"("more":1,"role":)");
    refused(R"("subject":[)", R"("subject":[{"name":"report.json"},)");
    refused("report.json", "another.json");
    refused("urn:runcert:attestation:1.0", "urn:runcert:attestation:1.1");
    refused("Statement/v1", "Statement/v0.1");
    refused(R"("statement":"I was there.")", R"("statement": "I was there.")");
    EXPECT_THROW(read_statement("", "s"), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
