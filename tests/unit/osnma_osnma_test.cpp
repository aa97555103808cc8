#include "stages/import/osnma/osnma.h"

#include <gtest/gtest.h>
#include <nettle/ecc-curve.h>
#include <nettle/ecdsa.h>
#include <nettle/sha2.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

#include "core/failure.h"
#include "stages/import/import.h"
#include "stages/import/ubx/frames.h"
#include "stages/import/ubx/raw.h"

namespace runcert::RUNCERT_FILE {

using namespace osnma;

struct Page {
    std::uint8_t satellite = 0;
    InavPage page;
    GpsTime near;
};
using Pages = std::vector<Page>;

SignedNavigation verified(const Pages& pages, const std::vector<PublicKey>& keys) {
    PageCollector collector;
    for (const Page& one : pages)
        collector.add(one.satellite, one.page, one.near);
    return collector.verify(keys).value_or(SignedNavigation{.reason = "nothing is signed"});
}

std::uint32_t type_of_word(const InavPage& page) {
    return page.word[0] >> 2U;
}

using BitList = std::vector<bool>;

void put(BitList& bits, std::uint64_t value, std::size_t count) {
    for (std::size_t i = count; i-- > 0;)
        bits.push_back((value >> i & 1U) != 0);
}

Bytes bytes_of(const BitList& bits) {
    Bytes bytes((bits.size() + 7) / 8);
    for (std::size_t i = 0; i < bits.size(); ++i)
        if (bits[i]) bytes[i / 8] = static_cast<std::uint8_t>(bytes[i / 8] | 0x80U >> i % 8);
    return bytes;
}

/// A Galileo of its own: chain, root key and signature by [OSNMA-ICD], made beside what is tested.
struct Service {
    struct Kind {
        int hash = 0, mac = 0, key_code = 4, tag_code = 9;
        std::size_t key_bytes = 16, tag_bits = 40;
        int status = 2;
        unsigned seed = 7;
    };
    static constexpr GalileoSeconds begin = 1400 * galileo_week_s + 7200 + 300;
    static constexpr int subframes = 10;
    static constexpr std::uint8_t public_key = 5;
    Kind kind;
    std::mt19937_64 random;
    PublicKey key{.number = public_key, .is_given = false, .point = {}};
    std::map<GalileoSeconds, Bytes> keys;
    Bytes message;

    explicit Service(const Kind& made) : kind(made), random(made.seed) {
        message = {static_cast<std::uint8_t>(blocks_code() << 4 | public_key),
                   static_cast<std::uint8_t>(kind.hash << 2 | kind.mac),
                   static_cast<std::uint8_t>(kind.key_code << 4 | kind.tag_code),
                   27,
                   1400 >> 8,
                   1400 & 255,
                   2};
        KeyChain::Pattern alpha{};
        for (auto& byte : alpha)
            message.push_back(byte = next_byte());
        const KeyChain chain(parameters(), alpha);
        const GalileoSeconds end = begin + subframes * subframe_s;
        Bytes last(kind.key_bytes);
        for (auto& byte : last)
            byte = next_byte();
        for (GalileoSeconds time = begin; time <= end; time += subframe_s)
            keys[time] = chain.key_before(last, end, time);
        const Bytes root = chain.key_before(last, end, parameters().root_time);
        message.insert(message.end(), root.begin(), root.end());
        sign();
    }

    std::uint8_t next_byte() { return static_cast<std::uint8_t>(random() & 0xffU); }
    std::uint8_t header() const { return static_cast<std::uint8_t>(kind.status << 6 | 1 << 4); }
    int blocks_code() const { return static_cast<int>((77 + kind.key_bytes + 12) / 13) - 6; }
    ChainParameters parameters() const {
        return {.blocks = static_cast<std::size_t>(blocks_code()) + 6,
                .public_key = public_key,
                .sha3 = kind.hash == 2,
                .cmac = kind.mac == 1,
                .key_bytes = kind.key_bytes,
                .tag_bits = kind.tag_bits,
                .root_time = 1400 * galileo_week_s + 7200 - subframe_s};
    }

    void sign() {
        Bytes what{header()};
        what.insert(what.end(), message.begin() + 1, message.end());
        const auto draw = [](void* from, std::size_t size, std::uint8_t* to) {
            for (std::size_t i = 0; i < size; ++i)
                to[i] = static_cast<Service*>(from)->next_byte();
        };
        ecc_scalar secret;
        ecc_point point;
        ecc_scalar_init(&secret, nettle_get_secp_256r1());
        ecc_point_init(&point, nettle_get_secp_256r1());
        ecdsa_generate_keypair(&point, &secret, this, draw);
        dsa_signature signature;
        dsa_signature_init(&signature);
        const auto hash = sha256(what);
        ecdsa_sign(&secret, this, draw, hash.size(), hash.data(), &signature);
        mpz_t x, y;
        mpz_inits(x, y, nullptr);
        ecc_point_get(&point, x, y);
        key.point[0] = static_cast<std::uint8_t>(2 + mpz_odd_p(y));
        const auto write = [](mpz_t number, std::uint8_t* to) {
            std::size_t size = 0;
            std::array<std::uint8_t, 32> bytes{};
            mpz_export(bytes.data(), &size, 1, 1, 1, 0, number);
            std::copy_n(bytes.begin(), size, to + 32 - size);
        };
        write(x, key.point.data() + 1);
        std::array<std::uint8_t, 64> both{};
        write(signature.r, both.data());
        write(signature.s, both.data() + 32);
        mpz_clears(x, y, nullptr);
        dsa_signature_clear(&signature);
        ecc_point_clear(&point);
        ecc_scalar_clear(&secret);
        message.insert(message.end(), both.begin(), both.end());
        what.insert(what.end(), both.begin(), both.end());
        const auto padding = sha256(what);
        for (std::size_t i = 0; message.size() % 13 != 0; ++i)
            message.push_back(padding[i]);
    }

    /// The page of a satellite that begins at a time: words with the layout of E1-B.
    InavPage word(std::uint8_t satellite, GalileoSeconds time) const {
        constexpr std::array<std::uint32_t, 15> types{2, 4, 6, 7, 8, 0, 0, 0, 0, 0, 1, 3, 5, 0, 0};
        const std::uint32_t type = types[static_cast<std::size_t>(time % subframe_s / 2)];
        BitList bits;
        put(bits, type, 6);
        std::mt19937_64 own(satellite * 100U + type);
        put(bits, type == 5 || type == 0 ? own() : 55, 10);
        while (bits.size() < 128)
            bits.push_back((own() & 1U) != 0);
        if (type == 0) bits[6] = bits[7] = false;  // no time
        if (type == 5) {
            BitList stamp;
            put(stamp, 1400, 12);
            put(stamp, static_cast<std::uint64_t>(time % galileo_week_s), 20);
            std::copy(stamp.begin(), stamp.end(), bits.begin() + 73);
        }
        InavPage page;
        std::ranges::copy(bytes_of(bits), page.word.begin());
        return page;
    }

    BitList orbit(std::uint8_t satellite, GalileoSeconds subframe) const {
        constexpr std::array<std::pair<int, std::size_t>, 5> words{
            {{10, 120}, {0, 120}, {11, 122}, {1, 120}, {12, 67}}};  // where 1 to 5 stand
        BitList bits;
        for (const auto& [index, count] : words) {
            const InavPage page = word(satellite, subframe + 2 * index + 1);
            for (std::size_t i = 6; i < 6 + count; ++i)
                bits.push_back((page.word[i / 8] >> (7 - i % 8) & 1U) != 0);
        }
        return bits;
    }

    /// All pages of two satellites that sign, and of two that they sign for.
    Pages pages() const {
        const KeyChain chain(parameters(), {message[7], message[8], message[9], message[10],
                                            message[11], message[12]});
        Pages all;
        for (int n = 0; n < subframes; ++n) {
            const GalileoSeconds time = begin + n * subframe_s;
            for (const std::uint8_t satellite : std::array<std::uint8_t, 4>{3, 11, 20, 30}) {
                BitList section;
                for (std::size_t i = 0; i < parameters().tags(); ++i) {
                    const auto of = static_cast<std::uint8_t>(i == 0           ? satellite
                                                              : satellite == 3 ? 20
                                                                               : 30);
                    BitList what;
                    if (i > 0) put(what, of, 8);
                    put(what, satellite, 8);
                    put(what, 1400, 12);
                    put(what, static_cast<std::uint64_t>(time % galileo_week_s), 20);
                    put(what, i + 1, 8);
                    put(what, static_cast<std::uint64_t>(kind.status), 2);
                    std::ranges::copy(orbit(of, time - subframe_s), std::back_inserter(what));
                    const Bytes tag = chain.tag(keys.at(time + subframe_s), bytes_of(what));
                    for (std::size_t bit = 0; bit < kind.tag_bits; ++bit)
                        section.push_back((tag[bit / 8] >> (7 - bit % 8) & 1U) != 0);
                    put(section, i == 0 ? 1U : std::uint64_t{of} << 8U | 1U, 16);
                }
                for (const std::uint8_t byte : keys.at(time))
                    put(section, byte, 8);
                section.resize(480);
                const Bytes tags = bytes_of(section);
                const std::size_t blocks = message.size() / 13;
                const std::size_t block = (static_cast<std::size_t>(n) + satellite) % blocks;
                for (std::size_t i = 0; i < 15; ++i) {
                    const GalileoSeconds at = time + static_cast<GalileoSeconds>(2 * i + 1);
                    Page one{.satellite = satellite,
                             .page = word(satellite, at),
                             .near = GpsTime::from_week(
                                 1400 + 1024, (at % galileo_week_s * 10 + 18) *
                                                  (GpsTime::nanoseconds_per_second / 10))};
                    if (satellite < 20) {
                        one.page.root_bits = i == 0   ? header()
                                             : i == 1 ? static_cast<std::uint8_t>(3 << 4 | block)
                                                      : message[13 * block + i - 2];
                        for (std::size_t b = 0; b < 4; ++b)
                            one.page.tag_bits = one.page.tag_bits << 8U | tags[4 * i + b];
                    }
                    all.push_back(one);
                }
            }
        }
        return all;
    }
};

TEST(Osnma, EveryKindOfChainIsVerified) {
    for (const Service::Kind& kind : std::vector<Service::Kind>{
             {},
             {.hash = 2},
             {.mac = 1},
             {.key_code = 0, .tag_code = 5, .key_bytes = 12, .tag_bits = 20},
             {.hash = 2, .key_code = 8, .tag_code = 7, .key_bytes = 32, .tag_bits = 28},
             {.status = 1}}) {
        const Service service(kind);
        const SignedNavigation found = verified(service.pages(), {service.key});
        EXPECT_EQ(found.result, NavigationAuthenticity::authentic) << found.text();
        EXPECT_EQ(found.satellites, (std::vector<std::string>{"E03", "E11", "E20", "E30"}));
        // The first subframe's tags are of words before it, the last one's of a key after it.
        EXPECT_EQ(found.tags, std::ssize(std::array{3, 11}) * (Service::subframes - 2) *
                                  static_cast<int>(service.parameters().tags()));
        EXPECT_EQ(found.keys, Service::subframes);
        EXPECT_EQ(found.test, kind.status == 1);
        EXPECT_EQ(found.found_bytes, 0);
    }
}

TEST(Osnma, KeysOfOthersSignNothing) {
    const Service service({}), other({.seed = 8});
    EXPECT_EQ(verified(service.pages(), {}).result, NavigationAuthenticity::unknown_key);
    EXPECT_EQ(verified(service.pages(), {other.key}).result, NavigationAuthenticity::contradicted);
    Pages silent = service.pages();
    std::erase_if(silent, [](const Page& one) { return one.satellite < 20; });
    EXPECT_EQ(verified(silent, {service.key}).reason, "nothing is signed");
}

TEST(Osnma, LostBytesAreFoundWithinABound) {
    const Service service({});
    // What a satellite sends at the n-th page of a block is lost, from all of them.
    const auto lost = [&](const std::vector<std::pair<std::size_t, std::size_t>>& bytes) {
        Pages pages = service.pages();
        std::erase_if(pages, [&](const Page& one) {
            const GalileoSeconds time =
                (one.near.nanoseconds() / GpsTime::nanoseconds_per_second - 1) -
                1024 * galileo_week_s;
            const auto n = static_cast<std::size_t>((time - Service::begin) / subframe_s);
            const std::size_t block = (n + one.satellite) % (service.message.size() / 13);
            const auto page = static_cast<std::size_t>(time % subframe_s / 2);
            return one.satellite < 20 &&
                   std::ranges::find(bytes, std::pair{block, page}) != bytes.end();
        });
        return verified(pages, {service.key});
    };
    const SignedNavigation found = lost({{0, 14}, {3, 4}, {5, 7}});
    EXPECT_EQ(found.result, NavigationAuthenticity::authentic) << found.text();
    EXPECT_EQ(found.found_bytes, 3);
    EXPECT_EQ(lost({{0, 3}}).result, NavigationAuthenticity::incomplete);
    EXPECT_EQ(lost({{3, 4}, {3, 5}, {3, 6}, {3, 7}}).result, NavigationAuthenticity::incomplete);
}

TEST(Osnma, EveryBitThatIsSignedCounts) {
    const Service service({});
    const Pages sent = service.pages();
    std::mt19937 random(3);
    std::map<NavigationAuthenticity, int> results;
    for (int n = 0; n < 200; ++n) {
        Pages pages = sent;
        Page& one = pages[random() % pages.size()];
        // Words of the last two subframes are under no tag that could be compared, and a word
        // beside 1 to 5 under none.
        const std::uint32_t type = type_of_word(one.page);
        const std::size_t subframe = static_cast<std::size_t>(&one - pages.data()) / 60;
        const int what = static_cast<int>(random() % 3);
        if (what == 0 && (type < 1 || type > 4 || subframe >= Service::subframes - 2)) continue;
        if (what != 0 && one.satellite >= 20) continue;
        if (what == 0)
            one.page.word[2 + random() % 13] ^= static_cast<std::uint8_t>(1U << random() % 8);
        else if (what == 1)
            one.page.root_bits ^= static_cast<std::uint8_t>(1U << random() % 8);
        else
            one.page.tag_bits ^= 1U << random() % 32;
        const SignedNavigation found = verified(pages, {service.key});
        EXPECT_TRUE(what != 0 || found.result == NavigationAuthenticity::contradicted)
            << "word " << type << " of " << int{one.satellite} << ": " << found.text();
        ++results[found.result];
    }
    EXPECT_GT(results[NavigationAuthenticity::contradicted], 60);
}

/// The pages of a UBX log, with the time of the last raw measurements before each.
Pages pages_of_log(const std::string& bytes) {
    Pages pages;
    std::optional<GpsTime> near;
    FrameReader frames({{}, bytes}, ubx::frame_kind);
    while (const auto frame = frames.next()) {
        if (!frame->good()) continue;
        const std::string_view payload = ubx::payload_of(*frame);
        if (ubx::id_of(frame->bytes) == 0x0215)
            near = GpsTime::from_week(
                little_endian<std::uint16_t>(payload, 8),
                std::llround(std::bit_cast<double>(little_endian<std::uint64_t>(payload, 0)) *
                             1e9));
        if (ubx::id_of(frame->bytes) != 0x0213 || !near) continue;
        if (const auto page = ubx::e1_page(payload); page && page->page)
            pages.push_back({page->satellite, *page->page, *near});
    }
    return pages;
}

TEST(Osnma, ARecordedWalkIsSignedByGalileo) {
    const char* folder = std::getenv("RUNCERT_DATA");
    if (!folder) GTEST_SKIP() << "RUNCERT_DATA is not set";
    std::ifstream in(std::string(folder) + "/ubx_walk/rover.ubx", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    Receiver receiver;
    receiver.id = "primary";
    receiver.format = "ubx";
    const Observations read = import_recording(receiver, {.name = "rover.ubx", .bytes = bytes});
    ASSERT_EQ(read.signed_navigation.size(), 1U);
    const SignedNavigation& found = read.signed_navigation.front();
    EXPECT_EQ(found.result, NavigationAuthenticity::authentic) << found.text();
    EXPECT_EQ(found.satellites, (std::vector<std::string>{"E07", "E26", "E29", "E33"}));
    EXPECT_EQ(found.public_key, 1);
    EXPECT_EQ(found.keys, 4);
    EXPECT_EQ(to_iso(*found.root_time, 0), "2025-08-28T16:59:30");

    const Pages pages = pages_of_log(bytes);
    EXPECT_EQ(verified(pages, known_public_keys()).tags, found.tags);
    // Another day, and another day's keys.
    Pages shifted = pages;
    for (Page& one : shifted)
        one.near = one.near.plus_nanoseconds(GpsTime::nanoseconds_per_day);
    EXPECT_EQ(verified(shifted, known_public_keys()).result, NavigationAuthenticity::contradicted);
    for (Page& one : shifted)
        if (type_of_word(one.page) == 5) {  // the stated second of the week is 86400 later
            const std::uint32_t shift = 86'400;
            std::uint64_t of_week = 0;
            for (std::size_t i = 85; i < 105; ++i)
                of_week = of_week << 1U | (one.page.word[i / 8] >> (7 - i % 8) & 1U);
            of_week += shift;
            for (std::size_t i = 105; i-- > 85; of_week >>= 1U) {
                auto& byte = one.page.word[i / 8];
                const auto mask = static_cast<std::uint8_t>(0x80U >> i % 8);
                byte = static_cast<std::uint8_t>((of_week & 1U) != 0 ? byte | mask : byte & ~mask);
            }
        }
    EXPECT_NE(verified(shifted, known_public_keys()).result, NavigationAuthenticity::authentic)
        << verified(shifted, known_public_keys()).text();
}

TEST(Osnma, KeysAreGivenInPem) {
    // The curve's base point (SEC 2, 2.4.2), whole and compressed, as OpenSSL writes both.
    constexpr const char* whole =
        "-----BEGIN PUBLIC KEY-----\n"
        "MFkwEwYHKoZIzj0CAQYIKoZIzj0DAQcDQgAEaxfR8uEsQkf4vOblY6RA8ncDfYEt\n"
        "6zOg9KE5RdiYwpZP40Li/hp/m47n60p8D54WK84zV2sxXs7LtkBoN79R9Q==\n"
        "-----END PUBLIC KEY-----\n";
    constexpr const char* compressed =
        "-----BEGIN PUBLIC KEY-----\n"
        "MDkwEwYHKoZIzj0CAQYIKoZIzj0DAQcDIgADaxfR8uEsQkf4vOblY6RA8ncDfYEt\n"
        "6zOg9KE5RdiYwpY=\n"
        "-----END PUBLIC KEY-----\n";
    ASSERT_TRUE(point_of_pem(whole));
    EXPECT_EQ(point_of_pem(whole), point_of_pem(compressed));
    EXPECT_EQ(point_of_pem(whole)->at(1), 0x6b);
    for (const std::string bad : {"", "key", "-----BEGIN PUBLIC KEY-----\n"})
        EXPECT_FALSE(point_of_pem(bad)) << bad;
    Receiver receiver;
    receiver.galileo_keys = {{.number = 1, .pem = whole, .place = "attempt.yaml:9:3"}};
    EXPECT_THROW((void)public_keys(receiver), Failure);
    receiver.galileo_keys.front().number = 2;
    EXPECT_EQ(public_keys(receiver).size(), 2U);
    receiver.galileo_keys.front().pem = "none";
    EXPECT_THROW((void)public_keys(receiver), Failure);
}

}  // namespace runcert::RUNCERT_FILE
