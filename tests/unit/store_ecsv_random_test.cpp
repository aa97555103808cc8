#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>
#include <vector>

#include "core/random.h"
#include "core/text.h"
#include "store/ecsv.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Cell = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

std::string random_text(RandomGenerator& random) {
    static constexpr std::string_view favourites = ",\"#'\\ ;:~0";
    std::string text;
    for (std::uint64_t n = 1 + random.next() % 12; n > 0; --n)
        text += random.next() % 2 == 0 ? favourites[random.next() % favourites.size()]
                                       : static_cast<char>(' ' + random.next() % 95);
    text = trim(text);
    return text.empty() ? "x" : text;
}

Cell random_cell(const EcsvColumn& column, RandomGenerator& random) {
    if (random.next() % 5 == 0) return {};
    switch (column.type) {
        case CellType::boolean:
            return random.next() % 2 == 0;
        case CellType::integer:
            return static_cast<std::int64_t>(random.next() >> random.next() % 64);
        case CellType::real: {
            const double scale = std::pow(10.0, static_cast<double>(random.next() % 20));
            return parse_double(format_fixed(random.normal() * scale, column.decimals)).value();
        }
        case CellType::text:
            return random_text(random);
    }
    return {};
}

void write_cell(EcsvWriter& out, const Cell& cell) {
    if (std::holds_alternative<std::monostate>(cell)) out.missing();
    if (const auto* value = std::get_if<bool>(&cell)) out.boolean(*value);
    if (const auto* value = std::get_if<std::int64_t>(&cell)) out.integer(*value);
    if (const auto* value = std::get_if<double>(&cell)) out.real(*value);
    if (const auto* value = std::get_if<std::string>(&cell)) out.text(*value);
}

Cell read_cell(const EcsvReader& in, std::size_t column) {
    if (in.is_missing(column)) return {};
    switch (in.columns()[column].type) {
        case CellType::boolean:
            return in.boolean(column);
        case CellType::integer:
            return in.integer(column);
        case CellType::real:
            return in.real(column);
        case CellType::text:
            return in.text(column);
    }
    return {};
}

TEST(Ecsv, RandomTablesRoundTrip) {
    RandomGenerator random(20220318);
    for (int round = 0; round < 300; ++round) {
        std::vector<EcsvColumn> columns(1 + random.next() % 6);
        for (std::size_t i = 0; i < columns.size(); ++i)
            columns[i] = {.name = "c" + std::to_string(i),
                          .type = static_cast<CellType>(random.next() % 4),
                          .unit = random.next() % 2 == 0 ? "m / s2" : "",
                          .decimals = static_cast<int>(random.next() % 13),
                          .description = random_text(random)};
        nlohmann::ordered_json meta;
        meta[random_text(random)] = random_text(random);
        EcsvWriter out(columns, meta);
        std::vector<std::vector<Cell>> rows(random.next() % 8);
        for (auto& row : rows)
            for (const EcsvColumn& column : columns)
                write_cell(out, row.emplace_back(random_cell(column, random)));
        const std::string text = std::move(out).take();

        EcsvReader in(text, "random");
        ASSERT_EQ(in.columns().size(), columns.size());
        for (std::size_t i = 0; i < columns.size(); ++i)
            EXPECT_EQ(in.columns()[i].description, columns[i].description);
        EXPECT_EQ(in.meta()[meta.begin().key()].scalar(), meta.begin()->get<std::string>());
        for (const auto& row : rows) {
            ASSERT_TRUE(in.next_row()) << text;
            for (std::size_t i = 0; i < columns.size(); ++i)
                ASSERT_EQ(read_cell(in, i), row[i]) << text;
        }
        ASSERT_FALSE(in.next_row());
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
