#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "core/failure.h"
#include "trust/signature.h"

namespace runcert::RUNCERT_FILE {
namespace {

const std::string message("{\"speed_m_s\": 56.36}\n\0\xFF", 23);

/// The lines of a text, each with its line break.
std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> lines(1);
    for (const char letter : text) {
        lines.back() += letter;
        if (letter == '\n') lines.emplace_back();
    }
    lines.pop_back();
    return lines;
}

std::string join(const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines)
        text += line;
    return text;
}

/// The text with one of its lines replaced.
std::string with_line(const std::string& text, std::size_t index, const std::string& line) {
    std::vector<std::string> lines = split(text);
    lines.at(index) = line;
    return join(lines);
}

std::string problem_of(const std::function<void()>& call) {
    try {
        call();
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.where().empty());
        EXPECT_FALSE(failure.remedy().empty());
        return failure.what();
    }
    return "";
}

TEST(Signature, SignsAndChecks) {
    const KeyPair pair = generate_key_pair();
    const std::string text = sign(message, pair.secret_key, "the run of Nagoya, Müller\t2");
    const SignatureCheck check = check_signature(message, text, pair.public_key, "f.minisig");
    EXPECT_TRUE(check.valid) << check.reason;
    EXPECT_EQ(check.trusted_comment, "the run of Nagoya, Müller\t2");
    EXPECT_EQ(check.key_id, key_id_text(pair.public_key));
    EXPECT_EQ(check.reason, "");
    EXPECT_EQ(split(text).size(), 4U);
    EXPECT_EQ(split(text)[0], "untrusted comment: signature from runcert secret key\n");
    EXPECT_EQ(sign(message, pair.secret_key, "x"), sign(message, pair.secret_key, "x"));
    EXPECT_TRUE(check_signature("", sign("", pair.secret_key, ""), pair.public_key, "f").valid);
}

// The example of minisign's README: https://github.com/jedisct1/minisign, and py-minisign's.
TEST(Signature, PublishedLegacySignatureIsRefusedWithAReason) {
    const PublicKey key = parse_public_key(
        "RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3", "published key");
    const SignatureCheck check = check_signature(
        "test",
        "untrusted comment: signature from minisign secret key\n"
        "RWQf6LRCGA9i59SLOFxz6NxvASXDJeRtuZykwQepbDEGt87ig1BNpWaVWuNrm73YiIiJbq71Wi+"
        "dP9eKL8OC351vwIasSSbXxwA=\n"
        "trusted comment: timestamp:1555779966\tfile:test\n"
        "QtKMXWyYcwdpZAlPF7tE2ENJkRd1ujvKjlj1m9RtHTBnZPa5WKU5uWRs5GoP5M/"
        "VqE81QFuMKI5k/SfNQUaOAA==\n",
        key, "published signature");
    EXPECT_EQ(key_id_text(key), "E7620F1842B4E81F");
    EXPECT_EQ(check.key_id, "E7620F1842B4E81F");
    EXPECT_FALSE(check.valid);
    EXPECT_NE(check.reason.find("legacy"), std::string::npos) << check.reason;
}

TEST(Signature, EveryChangeIsRefusedWithAReason) {
    const KeyPair pair = generate_key_pair();
    const std::string text = sign(message, pair.secret_key, "as measured");
    const auto reason = [&](const std::string& file, const std::string& signature,
                            const PublicKey& key) {
        const SignatureCheck check = check_signature(file, signature, key, "f.minisig");
        EXPECT_FALSE(check.valid);
        EXPECT_EQ(check.trusted_comment, "");
        return check.reason;
    };
    for (std::size_t i = 0; i < message.size(); ++i) {
        std::string changed = message;
        changed[i] = static_cast<char>(changed[i] ^ 1);
        EXPECT_NE(reason(changed, text, pair.public_key).find("signed file"), std::string::npos);
    }
    EXPECT_NE(reason(message + " ", text, pair.public_key), "");
    EXPECT_NE(reason(message, with_line(text, 2, "trusted comment: as Measured\n"), pair.public_key)
                  .find("trusted comment"),
              std::string::npos);
    const PublicKey other = generate_key_pair().public_key;
    EXPECT_NE(reason(message, text, other).find(key_id_text(other)), std::string::npos);
    PublicKey same_id = other;
    same_id.key_id = pair.public_key.key_id;
    EXPECT_NE(reason(message, text, same_id), "");
    const std::string moved = sign("another message", pair.secret_key, "as measured");
    EXPECT_NE(reason(message, with_line(text, 3, split(moved)[3]), pair.public_key), "");
}

// Nobody signs these, and yet there is one way of writing them, so that no byte means nothing.
TEST(Signature, OtherLineEndsAndUntrustedCommentsAreRefused) {
    const KeyPair pair = generate_key_pair();
    const std::string text = sign(message, pair.secret_key, "c");
    std::string windows;
    for (const char letter : text)
        windows += letter == '\n' ? std::string("\r\n") : std::string(1, letter);
    for (const std::string& variant : {windows, text.substr(0, text.size() - 1), text + "\n",
                                       with_line(text, 0, "untrusted comment: \n")})
        EXPECT_THROW((void)check_signature(message, variant, pair.public_key, "f"), Failure)
            << variant;
    for (const std::string program : {"runcert", "minisign", "rsign"})
        EXPECT_TRUE(check_signature(
                        message,
                        with_line(text, 0,
                                  "untrusted comment: signature from " + program + " secret key\n"),
                        pair.public_key, "f")
                        .valid);
}

TEST(Signature, MalformedSignatureFilesAreFailures) {
    const KeyPair pair = generate_key_pair();
    const std::string text = sign(message, pair.secret_key, "c");
    const std::vector<std::string> lines = split(text);
    const std::string long_line(8'000'000, 'A');
    for (const std::string& malformed :
         {std::string(), std::string("\n\n\n\n"), std::string("hello"), text + "more\n",
          lines[0] + lines[1] + lines[2], with_line(text, 0, "comment\n"), with_line(text, 1, "\n"),
          with_line(text, 1, "RUQ=\n"), with_line(text, 1, "!" + lines[1]),
          with_line(text, 1, " " + lines[1]), with_line(text, 1, "QUJ" + lines[1].substr(3)),
          with_line(text, 1, long_line + "\n"), with_line(text, 2, "comment: c\n"),
          with_line(text, 2, "trusted comment: \xFF\n"),
          with_line(text, 2, "trusted comment: \x1B[2J\n"), with_line(text, 3, "QUJD\n")})
        EXPECT_NE(problem_of([&] {
                      check_signature(message, malformed, pair.public_key, "f.minisig");
                  }).find("f.minisig"),
                  std::string::npos)
            << malformed.substr(0, 200);
}

// No text, however cut or changed, does anything but fail or be found not valid.
TEST(Signature, DamagedFilesNeverPass) {
    const KeyPair pair = generate_key_pair();
    const std::string text = sign(message, pair.secret_key, "c");
    const std::size_t signed_part = split(text)[0].size();
    const auto passes = [&](const std::string& damaged) {
        try {
            return check_signature(message, damaged, pair.public_key, "f").valid;
        } catch (const Failure&) {
            return false;
        }
    };
    for (std::size_t end = 0; end < text.size(); ++end)
        EXPECT_FALSE(passes(text.substr(0, end))) << end;
    for (std::size_t i = signed_part; i < text.size(); ++i) {
        std::string damaged = text;
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        EXPECT_FALSE(passes(damaged)) << i;
    }
}

TEST(Signature, CommentsMustBeOnePrintableLine) {
    const KeyPair pair = generate_key_pair();
    for (const std::string& comment :
         {std::string("two\nlines"), std::string("cr\r"), std::string("zero\0", 5),
          std::string("\x1B[2J"), std::string("\x7F"), std::string("latin \xFC"),
          std::string("overlong \xC0\xAF"), std::string("surrogate \xED\xA0\x80"),
          std::string("cut \xE2\x82"), std::string("C1 \xC2\x85"),
          std::string("line separator \xE2\x80\xA8"), std::string("override \xE2\x80\xAE"),
          std::string("beyond \xF4\x90\x80\x80"), std::string(8001, 'x')}) {
        EXPECT_THROW(sign(message, pair.secret_key, comment), Failure) << comment;
    }
    EXPECT_NO_THROW(sign(message, pair.secret_key, "東京 \xF0\x9F\x9A\x97 ±0.3 m/s"));
}

TEST(SignatureKeys, FilesReadBack) {
    const KeyPair pair = generate_key_pair();
    EXPECT_EQ(public_key_of(pair.secret_key), pair.public_key);
    EXPECT_EQ(parse_public_key(public_key_file(pair.public_key), "k.pub"), pair.public_key);
    EXPECT_EQ(parse_public_key(split(public_key_file(pair.public_key))[1], "k"), pair.public_key);
    const std::string text = secret_key_file(pair, std::nullopt);
    EXPECT_FALSE(secret_key_is_encrypted(text));
    const SecretKey read = parse_secret_key(text, std::nullopt, "k.key");
    EXPECT_EQ(read.bytes(), pair.secret_key.bytes());
    EXPECT_EQ(read.key_id(), pair.secret_key.key_id());
    EXPECT_NE(generate_key_pair().public_key, pair.public_key);
}

TEST(SignatureKeys, IdIsPrintedMostSignificantByteFirst) {
    PublicKey key;
    key.key_id = {0xF0, 0x02, 0x03, 0x04, 0x05, 0x06, 0x07, 0x0E};
    EXPECT_EQ(key_id_text(key), "0E070605040302F0");
}

TEST(SignatureKeys, PasswordIsNeededAndMustBeRight) {
    const KeyPair pair = generate_key_pair();
    const std::string text = secret_key_file(pair, "läuft schnell");
    EXPECT_TRUE(secret_key_is_encrypted(text));
    EXPECT_EQ(parse_secret_key(text, "läuft schnell", "k.key").bytes(), pair.secret_key.bytes());
    EXPECT_NE(problem_of([&] {
                  parse_secret_key(text, "lauft schnell", "k.key");
              }).find("password is wrong"),
              std::string::npos);
    EXPECT_NE(problem_of([&] {
                  parse_secret_key(text, std::nullopt, "k.key");
              }).find("no password was given"),
              std::string::npos);
    EXPECT_THROW(secret_key_file(pair, ""), Failure);
    EXPECT_THROW(secret_key_file(pair, "two\nlines"), Failure);
    EXPECT_THROW(secret_key_file(pair, std::string(1001, 'x')), Failure);
}

TEST(SignatureKeys, MalformedKeyFilesAreFailures) {
    const KeyPair pair = generate_key_pair();
    const std::string public_text = public_key_file(pair.public_key);
    const std::string secret_text = secret_key_file(pair, std::nullopt);
    const std::string signature = sign(message, pair.secret_key, "c");
    for (const std::string& text :
         {std::string(), std::string("hello"), secret_text, signature, public_text + "more\n",
          with_line(public_text, 0, "comment\n"), with_line(public_text, 1, "RWQ=\n"),
          with_line(public_text, 1, "A" + split(public_text)[1].substr(1))})
        EXPECT_THROW(parse_public_key(text, "k.pub"), Failure) << text;
    std::string damaged = secret_text;
    damaged[split(secret_text)[0].size() + 100] ^= 1;  // in the key
    std::string greedy = secret_text;                  // scrypt with a limit of 2^56 operations
    greedy.replace(split(secret_text)[0].size(), 8, "RWRTY0Iy");
    greedy.replace(split(secret_text)[0].size() + 56, 4, "////");
    for (const std::string& text :
         {std::string(), public_text, signature, damaged, greedy, secret_text + "more\n",
          secret_text.substr(0, secret_text.size() - 9)})
        EXPECT_NE(problem_of([&] { parse_secret_key(text, "password", "k.key"); }).find("k.key"),
                  std::string::npos)
            << text;
    EXPECT_TRUE(secret_key_is_encrypted(greedy));
    EXPECT_FALSE(secret_key_is_encrypted(public_text));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
