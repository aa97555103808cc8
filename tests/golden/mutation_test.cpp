#include "core/random.h"
#include "golden_files.h"

// A damaged file is read, or refused with a Failure; nothing else comes out of a reader.

namespace runcert::RUNCERT_FILE {
namespace {

std::string mutated(std::string text, RandomGenerator& random) {
    static constexpr std::string_view pieces[] = {"\"",
                                                  "'",
                                                  ": ",
                                                  "- ",
                                                  "\n",
                                                  "\n- ",
                                                  "[",
                                                  "]",
                                                  "{",
                                                  "}",
                                                  ",",
                                                  "#",
                                                  "\n# ",
                                                  "---\n",
                                                  "...\n",
                                                  "&a ",
                                                  "*a ",
                                                  "!!omap ",
                                                  "!x ",
                                                  "|\n",
                                                  "? ",
                                                  "~",
                                                  "null",
                                                  "nan",
                                                  "1e999",
                                                  "-",
                                                  "0",
                                                  "True",
                                                  "\t",
                                                  "\r",
                                                  "9223372036854775808",
                                                  "\xc3",
                                                  "\xef\xbb\xbf",
                                                  "\x04",
                                                  "[]",
                                                  "{}",
                                                  "\\"};
    for (std::uint64_t n = 1 + random.next() % 4; n > 0 && !text.empty(); --n) {
        const std::size_t at = random.next() % text.size();
        const std::size_t length = random.next() % 40;
        switch (random.next() % 7) {
            case 0:
                text[at] = static_cast<char>(random.next() % 256);
                break;
            case 1:
                text[at] = static_cast<char>(text[at] ^ static_cast<char>(1U << random.next() % 8));
                break;
            case 2:
                text.erase(at, length);
                break;
            case 3:
                text.insert(at, text.substr(random.next() % text.size(), length));
                break;
            case 4:
                if (random.next() % 4 == 0) text.resize(at);
                break;
            default:
                text.insert(at, pieces[random.next() % std::size(pieces)]);
        }
    }
    return text;
}

TEST(Mutation, EveryReaderReadsOrFails) {
    RandomGenerator random(20261121);
    for (const golden::GoldenFile& file : golden::all_files()) {
        const std::string text = golden::text_of(file.path);
        int refused = 0;
        for (int i = 0; i < 600; ++i) {
            const std::string damaged = mutated(text, random);
            try {
                (void)file.kind.again(damaged, "damaged");
            } catch (const Failure& failure) {
                ++refused;
                // Never without a place, and a message that a terminal can show.
                EXPECT_FALSE(failure.where().empty() || failure.remedy().empty()) << damaged;
                for (const char c : failure.problem())
                    EXPECT_FALSE(static_cast<unsigned char>(c) < ' ' || c == '\x7f')
                        << failure.problem();
            } catch (const std::exception& error) {
                ADD_FAILURE() << file.path << " " << i << ": " << error.what() << "\n" << damaged;
            }
        }
        EXPECT_GT(refused, 200) << file.path;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
