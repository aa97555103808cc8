#include "stages/import/osnma/osnma.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/failure.h"
#include "core/satellite.h"
#include "core/statistics.h"
#include "stages/import/bits.h"

namespace runcert::osnma {
namespace {

constexpr int gps_week_of_galileo = 1024;
constexpr std::size_t pages_in_subframe = 15;
constexpr std::size_t block_bytes = 13;
/// A page's header bits, the number of its block, and then the block's bytes.
constexpr std::size_t first_block_page = 2;
constexpr std::size_t pattern_at = 7, root_key_at = 13;
/// Two seconds after its beginning a page is there; a receiver may be late by this much, and its
/// epochs some seconds apart.
constexpr double page_s = 2.0, latest_s = 5.0;

GpsTime gps_time(GalileoSeconds time) {
    return GpsTime::from_week(static_cast<int>(time / galileo_week_s) + gps_week_of_galileo,
                              time % galileo_week_s * GpsTime::nanoseconds_per_second);
}

std::uint32_t type_of(const InavPage& page) {
    return Bits(page.word, 0).whole(6);
}

/// The time of its beginning that a page states: words 5 and 0 do ([GAL-ICD] 4.3.5).
std::optional<GalileoSeconds> stated_time(const InavPage& page) {
    const std::uint32_t type = type_of(page);
    const bool has_time = type == 5 || (type == 0 && Bits(page.word, 6).whole(2) == 0b10);
    if (!has_time) return std::nullopt;
    Bits time(page.word, type == 5 ? 73 : 96);
    const GalileoSeconds week = time.whole(12);
    return week * galileo_week_s + time.whole(20);
}

/// Stops where nothing more can be verified, and says why.
struct Stop {
    NavigationAuthenticity result;
    std::string reason;
};

[[noreturn]] void contradicted(std::string reason) {
    throw Stop{NavigationAuthenticity::contradicted, std::move(reason)};
}

[[noreturn]] void incomplete(std::string reason) {
    throw Stop{NavigationAuthenticity::incomplete, std::move(reason)};
}

}  // namespace

std::vector<PublicKey> public_keys(const Receiver& receiver) {
    std::vector<PublicKey> keys = known_public_keys();
    for (const GalileoKey& given : receiver.galileo_keys) {
        const auto point = point_of_pem(given.pem);
        if (!point)
            throw Failure(given.place, "this is no public key on the curve P-256 in PEM",
                          "Copy the key's file as it is, with its first and its last line");
        if (std::ranges::find(keys, given.number, &PublicKey::number) != keys.end())
            throw Failure(given.place, fmt::format("key {} is known already", given.number),
                          "Remove it");
        keys.push_back(
            {.number = static_cast<int>(given.number), .is_given = true, .point = *point});
    }
    return keys;
}

class Verification {
  public:
    Verification(const PageCollector& collected, const std::vector<PublicKey>& keys)
        : collected_(collected), public_keys_(keys) {
        found_.damaged_pages = collected.damaged_;
    }

    SignedNavigation run() {
        try {
            place_pages();
            put_root_message_together();
            collect_keys();
            complete_root_message();
            require_one_chain();
            compare_tags();
            require_signature();
            conclude();
        } catch (const Stop& stop) {
            found_.result = stop.result;
            found_.reason = stop.reason;
        }
        return std::move(found_);
    }

  private:
    struct Subframe {
        std::array<std::optional<InavPage>, pages_in_subframe> pages;
        bool is_signed = false;

        /// The bits of tags and key, with zeros for lost pages.
        std::array<std::uint8_t, 60> tag_section() const {
            std::array<std::uint8_t, 60> bytes{};
            for (std::size_t i = 0; i < bytes.size(); ++i)
                if (const auto& page = pages[i / 4])
                    bytes[i] = static_cast<std::uint8_t>(page->tag_bits >> (24 - 8 * (i % 4)));
            return bytes;
        }
        bool has_bits(std::size_t from, std::size_t to) const {
            for (std::size_t page = from / 32; page <= (to - 1) / 32; ++page)
                if (!pages[page]) return false;
            return true;
        }
    };
    using Subframes = std::map<GalileoSeconds, Subframe>;

    /// Gives each page its place: the receiver's delay is that of the pages that state their time.
    void place_pages() {
        std::vector<double> delays_s;
        const auto since_galileo_s = [](GpsTime time) {
            return time.seconds_since(GpsTime::from_week(gps_week_of_galileo, 0));
        };
        for (const auto& [satellite, page, near] : collected_.pages_)
            if (const auto time = stated_time(page))
                delays_s.push_back(since_galileo_s(near) - static_cast<double>(*time));
        if (delays_s.empty()) incomplete("no page that states its time was received");
        const double delay_s = median(std::move(delays_s));
        if (std::abs(delay_s - page_s) > latest_s)
            contradicted(fmt::format(
                "the recording's time stamps are {:.0f} s from the time that the messages state",
                delay_s - page_s));
        for (const auto& [satellite, page, near] : collected_.pages_) {
            // Pages on E1-B begin at odd seconds.
            const double begin_s = since_galileo_s(near) - delay_s;
            const auto begin = stated_time(page).value_or(
                2 * static_cast<GalileoSeconds>(std::floor(begin_s / 2.0)) + 1);
            Subframe& subframe = of_[satellite][begin - begin % subframe_s];
            subframe.pages[static_cast<std::size_t>(begin % subframe_s / 2)] = page;
            subframe.is_signed |= page.root_bits != 0 || page.tag_bits != 0;
        }
    }

    template <class Visit>
    void for_signed(const Visit& visit) const {
        for (const auto& [satellite, subframes] : of_)
            for (const auto& [time, subframe] : subframes)
                if (subframe.is_signed) visit(satellite, time, subframe);
    }

    /// Puts the blocks of the root key's message together from all satellites. Each sends one block
    /// a subframe, in order, so that a number that was lost follows from the satellite's others.
    void put_root_message_together() {
        std::map<std::uint8_t, int> headers;
        std::map<unsigned, std::optional<std::uint8_t>> beginnings;  // of messages by their ids
        for_signed([&](std::uint8_t, GalileoSeconds, const Subframe& subframe) {
            if (const auto& page = subframe.pages[0]) ++headers[page->root_bits];
            const auto &numbers = subframe.pages[1], &first = subframe.pages[first_block_page];
            constexpr unsigned other_messages = 12;
            if (numbers && first && numbers->root_bits % 16U == 0 &&
                numbers->root_bits / 16U < other_messages)
                beginnings[numbers->root_bits / 16U] = first->root_bits;
        });
        if (headers.empty() || beginnings.empty())
            incomplete("the beginning of the root key's message was not received");
        header_ = std::ranges::max_element(headers, {}, [](const auto& one) {
                      return one.second;
                  })->first;
        found_.test = header_ >> 6U == 1;
        const auto id = beginnings.rbegin()->first;
        const std::size_t blocks = *beginnings.rbegin()->second / 16U + 6;
        message_.resize(block_bytes * blocks);
        is_known_.resize(message_.size());
        for (const bool stated : {true, false})
            for_signed([&](std::uint8_t satellite, GalileoSeconds time, const Subframe& subframe) {
                if (const auto block = block_of(satellite, time, id, blocks, stated))
                    take_block(*block, subframe, stated);
            });
        std::array<std::uint8_t, 7> begin{};
        std::ranges::copy_n(message_.begin(), begin.size(), begin.begin());
        if (std::ranges::find(is_known_.begin(), is_known_.begin() + begin.size(), false) !=
            is_known_.begin() + begin.size())
            incomplete("the beginning of the root key's message was not received");
        found_.public_key = begin[0] % 16;
        parameters_ = chain_parameters(begin);
        if (!parameters_) incomplete("the chain of keys is of a kind that is not known here");
        found_.root_time = gps_time(parameters_->root_time);
    }

    /// The number of the block that a satellite sends in a subframe: as stated there, or counted
    /// from the nearest subframe that states it.
    std::optional<std::size_t> block_of(std::uint8_t satellite, GalileoSeconds time, unsigned id,
                                        std::size_t blocks, bool stated) const {
        std::optional<std::size_t> block;
        GalileoSeconds nearest = 0;
        for (const auto& [other, subframe] : of_.at(satellite)) {
            const auto& numbers = subframe.pages[1];
            if (!numbers || numbers->root_bits / 16U != id || (stated && other != time)) continue;
            if (block && std::abs(other - time) >= nearest) continue;
            nearest = std::abs(other - time);
            const auto count = static_cast<GalileoSeconds>(blocks);
            const GalileoSeconds number = numbers->root_bits % 16 + (time - other) / subframe_s;
            block = static_cast<std::size_t>((number % count + count) % count);
        }
        return block;
    }

    void take_block(std::size_t block, const Subframe& subframe, bool stated) {
        for (std::size_t i = 0; i < block_bytes; ++i) {
            const auto& page = subframe.pages[first_block_page + i];
            const std::size_t at = block_bytes * block + i;
            if (!page || at >= message_.size()) continue;
            if (stated && is_known_[at] && message_[at] != page->root_bits)
                contradicted("the satellites' copies of the root key's message differ");
            if (is_known_[at]) continue;
            message_[at] = page->root_bits;
            is_known_[at] = true;
        }
    }

    void collect_keys() {
        const std::size_t from = parameters_->key_at(), to = from + 8 * parameters_->key_bytes;
        for_signed([&](std::uint8_t, GalileoSeconds time, const Subframe& subframe) {
            if (!subframe.has_bits(from, to)) return;
            const auto section = subframe.tag_section();
            Bits bits(section, from);
            Bytes key(parameters_->key_bytes);
            for (std::uint8_t& byte : key)
                byte = static_cast<std::uint8_t>(bits.whole(8));
            const auto [at, is_new] = keys_.emplace(time, key);
            if (!is_new && at->second != key)
                contradicted(
                    fmt::format("satellites sent different keys at {}", to_iso(gps_time(time))));
        });
        if (keys_.empty()) incomplete("no whole key was received");
    }

    /// Where bytes are lost, those of the random pattern follow from two keys, those of the root
    /// key from the chain, and those of the signature from its padding.
    void complete_root_message() {
        const auto missing = [&](std::size_t from, std::size_t to) {
            std::vector<std::uint8_t*> bytes;
            for (std::size_t i = from; i < to; ++i)
                if (!is_known_[i]) bytes.push_back(&message_[i]);
            return bytes;
        };
        const auto pair = std::ranges::adjacent_find(
            keys_, [](const auto& a, const auto& b) { return b.first == a.first + subframe_s; });
        const auto pattern = missing(pattern_at, root_key_at);
        const auto alpha = [&] {
            KeyChain::Pattern bytes{};
            std::ranges::copy_n(message_.begin() + pattern_at, bytes.size(), bytes.begin());
            return bytes;
        };
        if (!pattern.empty() &&
            (pair == keys_.end() || !find_missing(pattern, [&] {
                 const auto& [time, key] = *std::next(pair);
                 return KeyChain(*parameters_, alpha()).key_before(key, time, pair->first) ==
                        pair->second;
             })))
            incomplete("too much of the root key's message was lost");
        chain_.emplace(*parameters_, alpha());
        const auto& [first, key] = *keys_.begin();
        constexpr GalileoSeconds longest_s = 400 * 86'400;
        if (first <= parameters_->root_time || first > parameters_->root_time + longest_s)
            incomplete(fmt::format("the root key is of {}", to_iso(*found_.root_time)));
        const Bytes root = chain_->key_before(key, first, parameters_->root_time);
        for (std::size_t i = 0; i < root.size(); ++i) {
            std::uint8_t& byte = message_[root_key_at + i];
            if (is_known_[root_key_at + i] && byte != root[i])
                contradicted("the keys do not lead to the root key");
            byte = root[i];
        }
        const std::size_t signature = root_key_at + root.size(), padding = signature + 64;
        const auto lost = missing(signature, padding);
        const bool has_padding = missing(padding, message_.size()).empty();
        const auto padding_fits = [&] {
            Bytes of = signed_message();
            of.insert(of.end(), message_.begin() + static_cast<std::ptrdiff_t>(signature),
                      message_.begin() + static_cast<std::ptrdiff_t>(padding));
            const auto hash = sha256(of);
            return std::equal(message_.begin() + static_cast<std::ptrdiff_t>(padding),
                              message_.end(), hash.begin());
        };
        is_whole_ = lost.empty() || (has_padding && find_missing(lost, padding_fits));
        if (is_whole_) found_.found_bytes = std::ssize(pattern) + std::ssize(lost);
    }

    /// What is signed: the header, the message from its second byte on, and the root key.
    Bytes signed_message() const {
        Bytes bytes{header_};
        bytes.insert(
            bytes.end(), message_.begin() + 1,
            message_.begin() + static_cast<std::ptrdiff_t>(root_key_at + parameters_->key_bytes));
        return bytes;
    }

    void require_one_chain() {
        for (auto at = keys_.begin(); at != keys_.end(); ++at) {
            if (at != keys_.begin() &&
                chain_->key_before(at->second, at->first, std::prev(at)->first) !=
                    std::prev(at)->second)
                contradicted(
                    fmt::format("the key at {} is of another chain", to_iso(gps_time(at->first))));
            ++found_.keys;
        }
    }

    /// The bits of words 1 to 5 that a tag is over ([OSNMA-ICD] table 23), of a satellite in a
    /// subframe; false where a word is lost, or its issue is another.
    bool put_orbit(BitWriter& to, std::uint8_t satellite, GalileoSeconds time) const {
        const auto subframes = of_.find(satellite);
        if (subframes == of_.end()) return false;
        const auto at = subframes->second.find(time);
        if (at == subframes->second.end()) return false;
        std::array<const InavPage*, 6> words{};
        for (const auto& page : at->second.pages)
            if (const std::uint32_t type = page ? type_of(*page) : 0; type >= 1 && type <= 5)
                words[type] = &*page;
        constexpr std::array<std::size_t, 6> bits{0, 120, 120, 122, 120, 67};
        for (std::size_t type = 1; type <= 5; ++type) {
            if (!words[type]) return false;
            if (type < 5 &&
                Bits(words[type]->word, 6).whole(10) != Bits(words[1]->word, 6).whole(10))
                return false;
            Bits word(words[type]->word, 6);
            for (std::size_t i = 0; i < bits[type]; ++i)
                to.put(word.whole(1), 1);
        }
        return true;
    }

    /// Tags are over the words of the subframe before, by the key of the one after.
    void compare_tags() {
        std::set<std::uint8_t> satellites;
        for_signed([&](std::uint8_t sender, GalileoSeconds time, const Subframe& subframe) {
            const auto key = keys_.find(time + subframe_s);
            if (key == keys_.end()) return;
            const auto section = subframe.tag_section();
            const std::size_t size = parameters_->tag_bits + 16;
            for (std::size_t i = 0; i < parameters_->tags(); ++i) {
                if (!subframe.has_bits(i * size, (i + 1) * size)) continue;
                Bits bits(section, i * size);
                BitWriter sent;
                for (std::size_t bit = 0; bit < parameters_->tag_bits; ++bit)
                    sent.put(bits.whole(1), 1);
                const std::uint32_t about = bits.whole(16);
                const auto of = i == 0 ? sender : static_cast<std::uint8_t>(about >> 8U);
                const bool of_orbit = i == 0 || (about >> 4U & 15U) == 0;
                // A tag over no subframe stands for one that is not sent.
                if (!of_orbit || (about & 15U) == 0) continue;
                BitWriter message;
                if (i > 0) message.put(of, 8);
                message.put(sender, 8);
                for (const std::uint8_t byte : subframe_time(time))
                    message.put(byte, 8);
                message.put(static_cast<std::uint32_t>(i + 1), 8);
                message.put(header_ >> 6U, 2);
                if (!put_orbit(message, of, time - subframe_s)) continue;
                if (chain_->tag(key->second, std::move(message).take()) != std::move(sent).take()) {
                    ++found_.other_tags;
                    continue;
                }
                ++found_.tags;
                satellites.insert(of);
                const GpsTime begin = gps_time(time - subframe_s);
                found_.first = std::min(found_.first.value_or(begin), begin);
                found_.last = std::max(found_.last.value_or(begin), begin);
            }
        });
        for (const std::uint8_t number : satellites)
            found_.satellites.push_back(to_text(Satellite{SatelliteSystem::galileo, number}));
    }

    void require_signature() {
        if (!is_whole_) incomplete("too much of the root key's signature was lost");
        const auto key =
            std::ranges::find(public_keys_, parameters_->public_key, &PublicKey::number);
        if (key == public_keys_.end())
            throw Stop{NavigationAuthenticity::unknown_key,
                       fmt::format("key {} is not known here", parameters_->public_key)};
        std::array<std::uint8_t, 64> signature{};
        std::ranges::copy_n(
            message_.begin() + static_cast<std::ptrdiff_t>(root_key_at + parameters_->key_bytes),
            signature.size(), signature.begin());
        found_.key_given = key->is_given;
        if (!verify_signature(*key, signed_message(), signature))
            contradicted(
                fmt::format("the root key's signature is not that of key {}", key->number));
    }

    void conclude() {
        if (found_.other_tags > 0)
            contradicted(fmt::format("{} of {} tags are not those of the words received",
                                     found_.other_tags, found_.tags + found_.other_tags));
        if (found_.tags == 0)
            incomplete("no tag could be compared: its words or its key were lost");
        found_.result = NavigationAuthenticity::authentic;
    }

    const PageCollector& collected_;
    const std::vector<PublicKey>& public_keys_;
    SignedNavigation found_{};
    std::map<std::uint8_t, Subframes> of_;
    std::uint8_t header_ = 0;
    Bytes message_;
    std::vector<bool> is_known_;
    bool is_whole_ = false;
    std::optional<ChainParameters> parameters_;
    std::optional<KeyChain> chain_;
    std::map<GalileoSeconds, Bytes> keys_;
};

void PageCollector::add(std::uint8_t satellite, const std::optional<InavPage>& page,
                        std::optional<GpsTime> near) {
    if (!page)
        ++damaged_;
    else if (near && satellite > 0)
        pages_.push_back({satellite, *page, *near});
}

std::optional<SignedNavigation> PageCollector::verify(const std::vector<PublicKey>& keys) const {
    const bool is_signed = std::ranges::any_of(pages_, [](const Received& one) {
        return one.page.root_bits != 0 || one.page.tag_bits != 0;
    });
    if (!is_signed) return std::nullopt;
    return Verification(*this, keys).run();
}

}  // namespace runcert::osnma
