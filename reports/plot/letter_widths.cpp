#include <array>
#include <cstdint>

#include "reports/plot/plot.h"

namespace runcert {
namespace {

constexpr double units_of_an_em = 2048.0;

/// Advance widths of DejaVu Sans 2.37: of U+0020 to U+007E, and of U+00A0 to U+00FF.
constexpr std::array<std::int16_t, 95> basic_latin{
    651,  821,  942,  1716, 1303, 1946, 1597, 563,  799,  799,  1024, 1716, 651,  739,  651,  690,
    1303, 1303, 1303, 1303, 1303, 1303, 1303, 1303, 1303, 1303, 690,  690,  1716, 1716, 1716, 1087,
    2048, 1401, 1405, 1430, 1577, 1294, 1178, 1587, 1540, 604,  604,  1343, 1141, 1767, 1532, 1612,
    1235, 1612, 1423, 1300, 1251, 1499, 1401, 2025, 1403, 1251, 1403, 799,  690,  799,  1716, 1024,
    1024, 1255, 1300, 1126, 1300, 1260, 721,  1300, 1298, 569,  569,  1186, 569,  1995, 1298, 1253,
    1300, 1300, 842,  1067, 803,  1298, 1212, 1675, 1212, 1212, 1075, 1303, 690,  1303, 1716};
constexpr std::array<std::int16_t, 96> latin_1{
    651,  821,  1303, 1303, 1303, 1303, 690,  1024, 1024, 2048, 965,  1253, 1716, 739,  2048, 1024,
    1024, 1716, 821,  821,  1024, 1303, 1303, 651,  1024, 821,  965,  1253, 1985, 1985, 1985, 1087,
    1401, 1401, 1401, 1401, 1401, 1401, 1995, 1430, 1294, 1294, 1294, 1294, 604,  604,  604,  604,
    1587, 1532, 1612, 1612, 1612, 1612, 1612, 1716, 1612, 1499, 1499, 1499, 1499, 1251, 1239, 1290,
    1255, 1255, 1255, 1255, 1255, 1255, 2011, 1126, 1260, 1260, 1260, 1260, 569,  569,  569,  569,
    1253, 1298, 1253, 1253, 1253, 1253, 1253, 1716, 1253, 1298, 1298, 1298, 1298, 1212, 1300, 1212};

double units_of(std::uint32_t letter) {
    if (letter >= 0x20 && letter <= 0x7e) return basic_latin[letter - 0x20];
    if (letter >= 0xa0 && letter <= 0xff) return latin_1[letter - 0xa0];
    return units_of_an_em;
}

}  // namespace

double text_width(const std::string& text) {
    double units = 0.0;
    std::uint32_t letter = 0;
    const auto end_letter = [&] {
        if (letter != 0) units += units_of(letter);
    };
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xC0U) == 0x80U) {  // goes on with a letter of UTF-8
            letter = letter << 6U | (byte & 0x3FU);
            continue;
        }
        end_letter();
        letter = byte < 0x80U   ? byte
                 : byte < 0xE0U ? byte & 0x1FU
                 : byte < 0xF0U ? byte & 0x0FU
                                : byte & 0x07U;
    }
    end_letter();
    return units / units_of_an_em;
}

}  // namespace runcert
