#include "stages/import/frame_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "stages/import/byte_order.h"

namespace runcert {
namespace {

constexpr std::size_t sync_size = 2;
constexpr char rtcm_preamble = '\xd3';
constexpr std::size_t rtcm_header_size = 3, rtcm_checksum_size = 3;

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

std::size_t end_without(std::string_view bytes, char blank) {
    return bytes.find_last_not_of(blank) + 1;  // 0 where there is nothing else
}

}  // namespace

std::uint32_t crc24q(std::string_view bytes) {
    static constexpr std::array<std::uint32_t, 256> table = make_crc_table();
    std::uint32_t crc = 0;
    for (const char c : bytes)
        crc = ((crc << 8) & 0xffffff) ^ table[(crc >> 16) ^ static_cast<unsigned char>(c)];
    return crc;
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

FrameReader::FrameReader(const RecordingBytes& recording, const FrameKind& kind)
    : recording_(recording),
      kind_(kind),
      bytes_(recording.bytes),
      checksum_(bytes_),
      written_end_(std::min(end_without(bytes_, '\0'), end_without(bytes_, '\xff'))),
      rtcm_budget_(bytes_.size()) {}

/// What begins at an offset: a frame, or stray bytes.
Frame FrameReader::frame_at(std::size_t offset) {
    const std::string_view ahead = bytes_.substr(offset);
    const std::size_t size = kind_.size(ahead);
    Frame frame{.offset = offset, .bytes = ahead.substr(0, size), .damage = Frame::Damage::stray};
    if (size == 0) return frame;
    if (size <= ahead.size() && kind_.is_good(frame.bytes, offset, checksum_))
        frame.damage = Frame::Damage::none;
    else if (after_message_ || !kind_.is_likely || kind_.is_likely(frame.bytes))
        frame.damage = size > ahead.size() ? Frame::Damage::cut_off : Frame::Damage::checksum;
    return frame;
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

/// Passes over an RTCM message, or over one byte.
void FrameReader::pass_other_bytes() {
    if (const std::size_t rtcm = rtcm_message_at(at_)) {
        at_ += rtcm;
        after_message_ = true;
        return;
    }
    after_message_ = bytes_[at_] == '\n';
    if (!is_text(bytes_[at_])) ++junk_bytes_;
    ++at_;
}

std::optional<Frame> FrameReader::next() {
    while (at_ < bytes_.size()) {
        const Frame frame = frame_at(at_);
        const bool stray = frame.damage == Frame::Damage::stray;
        if (stray && kind_.among_others) {
            pass_other_bytes();
            continue;
        }
        after_message_ = frame.good();
        at_ += frame.good() ? frame.bytes.size() : stray ? 1 : sync_size;
        if (frame.good()) {
            next_damage_ = at_;
            return frame;
        }
        const bool sized = kind_.record_size > 0;
        const bool known = frame.offset < next_damage_ && (stray || sized);
        if (known || (stray && frame.offset >= written_end_)) continue;
        next_damage_ = !sized  ? bytes_.size()
                       : stray ? frame.offset + kind_.record_size
                               : frame.offset + frame.bytes.size();
        return frame;
    }
    return std::nullopt;
}

Failure FrameReader::failure_of(const Frame& frame) const {
    const std::string where = place_in(recording_, RecordPlace(frame.offset));
    const std::string name = kind_.name ? kind_.name(frame.bytes) : "the record";
    if (frame.damage == Frame::Damage::cut_off)
        return Failure(
            where,
            fmt::format("{} ends behind the end of the recording: {} bytes of {} are "
                        "there",
                        name, frame.bytes.size(), kind_.size(bytes_.substr(frame.offset))),
            "It is cut off, or its length is damaged; take the whole recording as the "
            "receiver wrote it");
    const std::string what = frame.damage == Frame::Damage::stray
                                 ? "the bytes here belong to no record"
                                 : name + " has a checksum or length that is not that of its bytes";
    return Failure(where, what,
                   "It was damaged in transmission or storage; take the recording as the receiver "
                   "wrote it");
}

}  // namespace runcert
