#include "stages/import/sbn/frame.h"

#include <cstdint>

#include "stages/import/byte_order.h"

namespace runcert::sbn {
namespace {

constexpr std::string_view frame_start = "\xa0\xa2";
constexpr std::string_view frame_end = "\xb0\xb3";
constexpr std::size_t before_payload = 4;
constexpr std::size_t after_payload = 4;
/// A SiRF payload is shorter than 1 KiB; with the limit a damaged length costs little.
constexpr std::size_t longest_payload = 1023;

unsigned checksum(std::string_view payload) {
    unsigned sum = 0;
    for (const char c : payload)
        sum += static_cast<unsigned char>(c);
    return sum & 0x7fff;
}

bool never_written(std::string_view bytes) {
    return bytes.find_first_not_of('\xff') == std::string_view::npos ||
           bytes.find_first_not_of('\0') == std::string_view::npos;
}

}  // namespace

Frame FrameReader::bad(std::size_t start, std::string_view what) const {
    return {.offset = start,
            .payload = {},
            .failure = Failure(place_in(recording_, RecordPlace(start)), std::string(what),
                               "Take the recording as the receiver wrote it")};
}

Frame FrameReader::read_frame(std::size_t start) {
    const std::string_view rest = recording_.bytes.substr(start);
    at_ = start + frame_start.size();  // where to look on, unless this is a frame
    in_bad_stretch_ = true;
    if (rest.size() < before_payload + after_payload)
        return bad(start, "the message is cut off by the end of the file");
    const std::size_t length = big_endian<std::uint16_t>(rest, 2);
    if (length == 0 || length > longest_payload)
        return bad(start, "the message has an impossible length");
    if (before_payload + length + after_payload > rest.size())
        return bad(start, "the message is cut off by the end of the file, or its length is wrong");
    if (rest.substr(before_payload + length + 2, 2) != frame_end)
        return bad(start, "the message does not end in 0xB0B3 where its length says");
    const std::string_view payload = rest.substr(before_payload, length);
    if (checksum(payload) != big_endian<std::uint16_t>(rest, before_payload + length))
        return bad(start, "the message has a wrong checksum");
    at_ = start + before_payload + length + after_payload;
    in_bad_stretch_ = false;
    return {.offset = start, .payload = payload, .failure = {}};
}

std::optional<Frame> FrameReader::next() {
    const std::string_view bytes = recording_.bytes;
    if (at_ >= bytes.size()) return std::nullopt;
    const std::size_t found = bytes.find(frame_start, at_);
    const std::size_t start = found == std::string_view::npos ? bytes.size() : found;
    if (start == at_) return read_frame(start);
    const std::size_t before = at_;
    const bool known =
        in_bad_stretch_ || (start == bytes.size() && never_written(bytes.substr(before)));
    at_ = start;
    in_bad_stretch_ = true;
    if (!known) return bad(before, "bytes that belong to no message");
    if (start < bytes.size()) return read_frame(start);
    return std::nullopt;
}

}  // namespace runcert::sbn
