#include "stages/import/ubx/frames.h"

#include <fmt/format.h>

#include <algorithm>

#include "stages/import/byte_order.h"

namespace runcert::ubx {
namespace {

constexpr std::size_t header_size = 6;  ///< sync characters, class, number, length
constexpr std::size_t checksum_size = 2;
constexpr char sync_1 = '\xb5';
constexpr char sync_2 = '\x62';
constexpr char rtcm_preamble = '\xd3';
constexpr std::size_t rtcm_header_size = 3;
constexpr std::size_t rtcm_checksum_size = 3;

/// NAV, RXM, INF, ACK, CFG, UPD, MON, AID, TIM, ESF, MGA, LOG, SEC, HNR, NAV2, RTCM.
bool is_class(MessageId id) {
    constexpr std::array<std::uint8_t, 16> classes{0x01, 0x02, 0x04, 0x05, 0x06, 0x09, 0x0a, 0x0b,
                                                   0x0d, 0x10, 0x13, 0x21, 0x27, 0x28, 0x29, 0xf5};
    return std::find(classes.begin(), classes.end(), id >> 8) != classes.end();
}

/// The 24-bit cyclic redundancy check of RTCM 10403.3, section 4.2 (generator 0x1864cfb).
constexpr std::array<std::uint32_t, 256> make_crc_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
        std::uint32_t crc = i << 16;
        for (int step = 0; step < 8; ++step)
            crc = (crc << 1) ^ ((crc & 0x800000) ? 0x1864cfb : 0);
        table[i] = crc & 0xffffff;
    }
    return table;
}

bool is_text(char c) {
    return (c >= ' ' && c <= '~') || c == '\r' || c == '\n' || c == '\t';
}

}  // namespace

std::uint32_t crc24q(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> table = make_crc_table();
    std::uint32_t crc = 0;
    for (const char c : bytes)
        crc = ((crc << 8) & 0xffffff) ^ table[(crc >> 16) ^ static_cast<unsigned char>(c)];
    return crc;
}

Failure failure_of(const Frame& frame, const RecordingBytes& recording) {
    const std::string where = place_in(recording, RecordPlace(frame.offset));
    const std::string what =
        fmt::format("the UBX frame of class {:02X}, number {:02X}", frame.id >> 8, frame.id & 0xff);
    if (frame.cut_off)
        return Failure(where, what + " ends behind the end of the recording",
                       "It is cut off, or its length is damaged; take the whole recording as the "
                       "receiver wrote it");
    return Failure(where, what + " has a checksum that is not that of its bytes",
                   "It was damaged in transmission or storage; take the recording as the receiver "
                   "wrote it");
}

void RunningChecksum::move_to(std::size_t begin) {
    const std::string_view window = bytes_.substr(begin, 2 * longest);
    sums_.resize(2 * longest + 1);
    sums_of_sums_.resize(2 * longest + 1);
    begin_ = begin;
    std::uint8_t sum = 0, sum_of_sums = 0;
    for (std::size_t i = 0; i < window.size(); ++i) {
        sum = static_cast<std::uint8_t>(sum + static_cast<unsigned char>(window[i]));
        sum_of_sums = static_cast<std::uint8_t>(sum_of_sums + sum);
        sums_[i + 1] = sum;
        sums_of_sums_[i + 1] = sum_of_sums;
    }
}

std::uint16_t RunningChecksum::of(std::size_t begin, std::size_t size) {
    if (sums_.empty() || begin < begin_ || begin + size > begin_ + 2 * longest) move_to(begin);
    const std::size_t from = begin - begin_, to = from + size;
    const unsigned first = static_cast<unsigned>(sums_[to]) - sums_[from];
    const unsigned second = static_cast<unsigned>(sums_of_sums_[to]) - sums_of_sums_[from] -
                            static_cast<unsigned>(size) * sums_[from];
    return static_cast<std::uint16_t>((first & 0xff) | (second & 0xff) << 8);
}

std::optional<Frame> FrameReader::frame_at(std::size_t offset) {
    const std::string_view ahead = bytes_.substr(offset);
    if (ahead[0] != sync_1 || (ahead.size() > 1 && ahead[1] != sync_2)) return std::nullopt;
    Frame frame;
    frame.offset = offset;
    frame.cut_off = true;
    if (ahead.size() < header_size) return after_message_ ? std::optional(frame) : std::nullopt;
    frame.id = big_endian<std::uint16_t>(ahead, 2);
    const auto size = std::size_t{little_endian<std::uint16_t>(ahead, 4)};
    if (header_size + size + checksum_size <= ahead.size()) {
        frame.cut_off = false;
        frame.good = checksum_.of(offset + 2, header_size - 2 + size) ==
                     little_endian<std::uint16_t>(ahead, header_size + size);
    }
    if (frame.good) frame.payload = ahead.substr(header_size, size);
    if (frame.good || after_message_ || is_class(frame.id)) return frame;
    return std::nullopt;
}

/// The size of the RTCM 3 message that begins here; 0 where none does. Failed attempts are given
/// up when they have cost one pass over the recording.
std::size_t FrameReader::rtcm_message_at(std::size_t offset) {
    const std::string_view ahead = bytes_.substr(offset);
    if (rtcm_budget_ == 0 || ahead.size() < rtcm_header_size || ahead[0] != rtcm_preamble ||
        (ahead[1] & '\xfc') != 0)
        return 0;
    const std::size_t checked = rtcm_header_size + (big_endian<std::uint16_t>(ahead, 1) & 0x3ffU);
    if (ahead.size() < checked + rtcm_checksum_size) return 0;
    const std::uint32_t written = std::uint32_t{big_endian<std::uint16_t>(ahead, checked)} << 8 |
                                  big_endian<std::uint8_t>(ahead, checked + 2);
    if (crc24q(ahead.substr(0, checked)) == written) return checked + rtcm_checksum_size;
    rtcm_budget_ -= std::min(rtcm_budget_, checked);
    return 0;
}

std::optional<Frame> FrameReader::next() {
    while (at_ < bytes_.size()) {
        if (const std::optional<Frame> frame = frame_at(at_)) {
            at_ += frame->good ? header_size + frame->payload.size() + checksum_size : 2;
            after_message_ = frame->good;
            return frame;
        }
        if (const std::size_t rtcm = rtcm_message_at(at_)) {
            at_ += rtcm;
            after_message_ = true;
            continue;
        }
        after_message_ = bytes_[at_] == '\n';
        if (!is_text(bytes_[at_])) ++junk_bytes_;
        ++at_;
    }
    return std::nullopt;
}

}  // namespace runcert::ubx
