#include "stages/import/osnma/inav_page.h"

#include <algorithm>

#include "stages/import/bits.h"
#include "stages/import/frame_reader.h"

namespace runcert {

std::optional<InavPage> inav_page(std::span<const std::uint8_t, 32> halves) {
    const auto even = halves.first<16>(), odd = halves.last<16>();
    // Each half begins with its parity and the kind of page.
    if (Bits(even, 0).whole(2) != 0b00 || Bits(odd, 0).whole(2) != 0b10) return std::nullopt;
    const auto copy = [](BitWriter& to, Bits from, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i)
            to.put(from.whole(1), 1);
    };
    BitWriter checked;
    checked.put(0, 4);
    copy(checked, Bits(even, 0), 114);
    copy(checked, Bits(odd, 0), 82);
    if (crc24q(checked.text()) != Bits(odd, 82).whole(24)) return std::nullopt;
    BitWriter data;
    copy(data, Bits(even, 2), 112);
    copy(data, Bits(odd, 2), 16);
    InavPage page;
    std::ranges::copy(std::move(data).take(), page.word.begin());
    Bits reserved(odd, 18);
    page.root_bits = static_cast<std::uint8_t>(reserved.whole(8));
    page.tag_bits = reserved.whole(32);
    return page;
}

}  // namespace runcert
