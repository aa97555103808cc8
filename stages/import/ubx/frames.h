#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>

#include "stages/import/byte_order.h"
#include "stages/import/frame_reader.h"

/// Frames of u-blox receivers. Layout: u-blox "F9 HPG interface description" (UBX-22008968),
/// section 3.2: B5 62, class, number, length of the payload, payload, checksum.
namespace runcert::ubx {

/// Class and number of a message, NAV-PVT for one: 0x0107.
using MessageId = std::uint16_t;

inline constexpr std::size_t header_size = 6, checksum_size = 2;

inline MessageId id_of(std::string_view frame) {
    return frame.size() < header_size ? MessageId{0} : big_endian<MessageId>(frame, 2);
}

/// The payload of a good frame.
inline std::string_view payload_of(const Frame& frame) {
    return frame.bytes.substr(header_size, frame.bytes.size() - header_size - checksum_size);
}

inline constexpr FrameKind frame_kind{
    .size =
        [](std::string_view ahead) {
            if (ahead[0] != '\xb5' || (ahead.size() > 1 && ahead[1] != '\x62'))
                return std::size_t{0};
            return header_size + checksum_size +
                   (ahead.size() < header_size ? 0U : little_endian<std::uint16_t>(ahead, 4));
        },
    .is_good =
        [](std::string_view frame, std::size_t offset, RunningChecksum& sums) {
            const std::size_t checked = frame.size() - 2 - checksum_size;
            return sums.of(offset + 2, checked) == little_endian<std::uint16_t>(frame, 2 + checked);
        },
    .name =
        [](std::string_view frame) {
            return fmt::format("the UBX frame of class {:02X}, number {:02X}", id_of(frame) >> 8,
                               id_of(frame) & 0xff);
        },
    .is_likely =
        [](std::string_view frame) {
            // NAV, RXM, INF, ACK, CFG, UPD, MON, AID, TIM, ESF, MGA, LOG, SEC, HNR, NAV2, RTCM.
            constexpr std::array classes{0x01, 0x02, 0x04, 0x05, 0x06, 0x09, 0x0a, 0x0b,
                                         0x0d, 0x10, 0x13, 0x21, 0x27, 0x28, 0x29, 0xf5};
            return std::ranges::find(classes, id_of(frame) >> 8) != classes.end();
        },
    .among_others = true,
};

}  // namespace runcert::ubx
