#include "stages/import/fit/decode.h"

#include <fmt/format.h>

#include <array>

#include "core/failure.h"
#include "stages/import/byte_order.h"

namespace runcert::fit {
namespace {

constexpr std::size_t shortest_header = 12;
constexpr std::size_t definition_head = 5;  ///< reserved, architecture, number, count
constexpr std::size_t bytes_of_field = 3;

constexpr const char* take_whole = "Take the recording as the device wrote it";

[[noreturn]] void fail(const RecordingBytes& recording, std::size_t byte, const std::string& what) {
    throw Failure(place_in(recording, RecordPlace(byte)), what, take_whole);
}

/// What the messages of one local number look like.
struct Definition {
    bool known = false;
    bool big_endian = false;
    std::uint16_t number = 0;
    std::string_view fields;
    std::size_t size = 0;  ///< of a message's payload, with the fields of developers at its end
};

class FileDecoder {
  public:
    FileDecoder(const RecordingBytes& recording, std::size_t begin, std::size_t end,
                bool unfinished, const std::function<void(const Message&)>& take)
        : recording_(recording), take_(take), at_(begin), end_(end), unfinished_(unfinished) {}

    void run() {
        while (at_ < end_)
            if (!next()) return;
    }

  private:
    std::uint8_t byte(std::size_t at) const {
        return static_cast<std::uint8_t>(recording_.bytes[at]);
    }

    /// False where a record of an unfinished file is cut off.
    bool next() {
        start_ = at_;
        const std::uint8_t header = byte(at_++);
        const bool compressed = (header & 0x80) != 0;
        if (compressed) return take_data((header >> 5) & 3, header & 0x1f);
        if ((header & 0x40) != 0) return take_definition(header & 0x0f, (header & 0x20) != 0);
        return take_data(header & 0x0f, std::nullopt);
    }

    bool has(std::size_t count) const { return end_ - at_ >= count; }

    bool cut() const {
        if (unfinished_) return false;
        fail(recording_, start_, "a FIT record goes on beyond the end of its file");
    }

    bool take_definition(std::size_t local, bool of_developers) {
        if (!has(definition_head)) return cut();
        Definition definition;
        definition.known = true;
        definition.big_endian = byte(at_ + 1) == 1;
        if (byte(at_ + 1) > 1)
            fail(recording_, start_,
                 fmt::format("a FIT definition has the byte order {}", byte(at_ + 1)));
        const std::string_view bytes = recording_.bytes;
        definition.number = definition.big_endian ? big_endian<std::uint16_t>(bytes, at_ + 2)
                                                  : little_endian<std::uint16_t>(bytes, at_ + 2);
        const std::size_t fields = byte(at_ + 4);
        at_ += definition_head;
        if (!has(fields * bytes_of_field)) return cut();
        definition.fields = bytes.substr(at_, fields * bytes_of_field);
        definition.size = sizes_from(at_, fields);
        at_ += fields * bytes_of_field;
        if (of_developers) {
            if (!has(1)) return cut();
            const std::size_t more = byte(at_++);
            if (!has(more * bytes_of_field)) return cut();
            definition.size += sizes_from(at_, more);
            at_ += more * bytes_of_field;
        }
        definitions_[local] = definition;
        return true;
    }

    std::size_t sizes_from(std::size_t at, std::size_t fields) const {
        std::size_t size = 0;
        for (std::size_t i = 0; i < fields; ++i)
            size += byte(at + i * bytes_of_field + 1);
        return size;
    }

    bool take_data(std::size_t local, std::optional<std::uint8_t> offset) {
        const Definition& definition = definitions_[local];
        if (!definition.known)
            fail(recording_, start_,
                 fmt::format("FIT data of the local type {} come before its definition", local));
        if (!has(definition.size)) return cut();
        Message message{.number = definition.number,
                        .byte = start_,
                        .timestamp = std::nullopt,
                        .payload = recording_.bytes.substr(at_, definition.size),
                        .definition = definition.fields,
                        .big_endian = definition.big_endian};
        at_ += definition.size;
        if (const auto stamp = message.whole(timestamp_field))
            message.timestamp = static_cast<std::uint32_t>(*stamp);
        else if (offset && last_)
            message.timestamp = *last_ + ((*offset - *last_) & 0x1fU);
        if (message.timestamp) last_ = message.timestamp;
        take_(message);
        return true;
    }

    const RecordingBytes& recording_;
    const std::function<void(const Message&)>& take_;
    std::size_t at_, end_;
    std::size_t start_ = 0;
    bool unfinished_;
    std::array<Definition, 16> definitions_;
    std::optional<std::uint32_t> last_;  ///< time stamp, which compressed ones count on from
};

void require_checksum(const RecordingBytes& recording, std::size_t begin, std::size_t end) {
    const std::uint16_t computed = crc16(recording.bytes.substr(begin, end - begin));
    const auto written = little_endian<std::uint16_t>(recording.bytes, end);
    if (written != computed)
        fail(recording, end,
             fmt::format("the file's checksum is {:04x}, and it says {:04x}: some of its bytes "
                         "have changed",
                         computed, written));
}

}  // namespace

std::string_view Message::field(std::uint8_t wanted) const {
    std::size_t at = 0;
    for (std::size_t i = 0; i + bytes_of_field <= definition.size(); i += bytes_of_field) {
        const auto size = static_cast<std::uint8_t>(definition[i + 1]);
        if (static_cast<std::uint8_t>(definition[i]) == wanted) return payload.substr(at, size);
        at += size;
    }
    return {};
}

std::optional<std::int64_t> Message::whole(std::uint8_t wanted, bool is_signed, std::size_t element,
                                           std::size_t bytes) const {
    std::string_view text = field(wanted);
    if (bytes > 0)
        text = text.size() >= (element + 1) * bytes ? text.substr(element * bytes, bytes)
                                                    : std::string_view();
    if (text.empty() || text.size() > 4) return std::nullopt;
    std::int64_t value = 0;
    for (std::size_t i = 0; i < text.size(); ++i)
        value = value << 8 | static_cast<unsigned char>(text[big_endian ? i : text.size() - 1 - i]);
    const std::int64_t range = std::int64_t{1} << (8 * text.size());
    if (value == (is_signed ? range / 2 : range) - 1) return std::nullopt;
    return is_signed && value >= range / 2 ? value - range : value;
}

std::uint16_t crc16(std::string_view bytes) {
    unsigned value = 0;
    for (const char c : bytes) {
        value ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1U) != 0 ? (value >> 1) ^ 0xA001U : value >> 1;
    }
    return static_cast<std::uint16_t>(value);
}

bool is_fit(std::string_view bytes) {
    return bytes.size() >= shortest_header &&
           static_cast<std::uint8_t>(bytes[0]) >= shortest_header && bytes.substr(8, 4) == ".FIT";
}

Decoded decode(const RecordingBytes& recording, const std::function<void(const Message&)>& take) {
    Decoded decoded;
    const std::string_view bytes = recording.bytes;
    for (std::size_t at = 0; at < bytes.size();) {
        if (!is_fit(bytes.substr(at)))
            fail(recording, at, "there is no FIT header where a file should begin");
        const std::size_t header = static_cast<std::uint8_t>(bytes[at]);
        const std::size_t size = little_endian<std::uint32_t>(bytes, at + 4);
        decoded.unfinished = size == 0;
        const std::size_t begin = at + header;
        const std::size_t end = decoded.unfinished ? bytes.size() : begin + size;
        if (begin > bytes.size() || (!decoded.unfinished && end + 2 > bytes.size()))
            fail(recording, at,
                 fmt::format("the file is cut off: its header says {} bytes, and {} are there",
                             header + size + 2, bytes.size() - at));
        if (!decoded.unfinished) require_checksum(recording, at, end);
        FileDecoder(recording, begin, end, decoded.unfinished, take).run();
        ++decoded.files;
        at = decoded.unfinished ? end : end + 2;
    }
    return decoded;
}

}  // namespace runcert::fit
