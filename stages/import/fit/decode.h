#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>

#include "stages/import/recording.h"

// The binary layout of Garmin's FIT: headers, definitions, data, checksums (Garmin, Flexible and
// Interoperable Data Transfer Protocol).

namespace runcert::fit {

inline constexpr std::uint8_t timestamp_field = 253;

/// A data message. Its bytes belong to the recording.
struct Message {
    std::uint16_t number = 0;  ///< global: 20 is a record
    std::size_t byte = 0;      ///< where it begins in the file
    /// Its own time stamp, or that of a compressed header: seconds since 1989-12-31 UTC. Empty
    /// where it has none.
    std::optional<std::uint32_t> timestamp;

    /// The bytes of a field, the least significant first where `big_endian` is not set; empty where
    /// it is not there.
    std::string_view field(std::uint8_t number) const;

    /// A field's whole number, of as many bytes as it has, 4 at most; nothing where it is not
    /// there, or holds what stands for no value: all bits, of a signed one all but the highest.
    std::optional<std::int64_t> whole(std::uint8_t number, bool is_signed = false,
                                      std::size_t element = 0, std::size_t bytes = 0) const;

    std::string_view payload;
    std::string_view definition;  ///< three bytes a field: number, size, base type
    bool big_endian = false;
};

/// What a file shows of itself.
struct Decoded {
    std::size_t files = 0;    ///< chained one after the other
    bool unfinished = false;  ///< without its size and checksum: the device did not close the file
};

/// The checksum of FIT: CRC-16, polynomial A001, reflected, beginning with 0.
std::uint16_t crc16(std::string_view bytes);

bool is_fit(std::string_view bytes);

/// Gives the data messages in order. Failure with the byte for a file that is cut, whose checksum
/// is not that of its bytes, that has data without definition, or whose fields do not fit.
Decoded decode(const RecordingBytes& recording, const std::function<void(const Message&)>& take);

}  // namespace runcert::fit
