#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/random.h"
#include "store/atomic_file.h"
#include "store/ecsv.h"
#include "store/process.h"
#include "store/sha256.h"

// Tables and files that are written and read piece by piece, against the same as a whole.

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<EcsvColumn> columns() {
    return {{.name = "count", .type = CellType::integer, .unit = {}, .description = {}},
            {.name = "speed", .unit = "m / s", .decimals = 3, .description = {}},
            {.name = "word", .type = CellType::text, .unit = {}, .description = {}}};
}

/// Some hundred thousand rows: many times the writer's own buffer.
void write_rows(EcsvWriter& out) {
    RandomGenerator random(20260325);
    for (std::int64_t row = 0; row < 200'000; ++row) {
        out.integer(row);
        random.next() % 4 == 0 ? out.missing() : out.real(1e4 * random.normal());
        out.text(random.next() % 50 == 0 ? "a, \"b\"" : "word");
    }
}

std::string whole_table() {
    EcsvWriter out(columns(), {{"k", 1}});
    write_rows(out);
    return std::move(out).take();
}

TEST(EcsvStreaming, PiecesMakeTheSameTable) {
    std::string pieced;
    std::size_t pieces = 0;
    EcsvWriter out(columns(), {{"k", 1}}, [&](std::string_view piece) {
        pieced += piece;
        ++pieces;
    });
    write_rows(out);
    out.finish();
    EXPECT_GT(pieces, 10U);
    EXPECT_TRUE(pieced == whole_table());
}

TEST(EcsvStreaming, ATableWithoutRowsIsWhole) {
    std::string pieced;
    EcsvWriter out(columns(), {}, [&](std::string_view piece) { pieced += piece; });
    out.finish();
    EXPECT_EQ(pieced, EcsvWriter(columns(), {}).take());
    EXPECT_TRUE(pieced.ends_with("count,speed,word\n")) << pieced;
}

TEST(EcsvStreaming, RowsInOnePassReadAsAnyOthers) {
    const std::string text = whole_table();
    // No row with CR LF is plain, so each is read by the code for any row.
    std::string other;
    for (const char c : text) {
        if (c == '\n') other += '\r';
        other += c;
    }
    EcsvReader a(text, "a"), b(other, "b");
    std::size_t rows = 0;
    while (a.next_row()) {
        ASSERT_TRUE(b.next_row());
        ++rows;
        ASSERT_EQ(a.line(), b.line());
        for (std::size_t i = 0; i < a.columns().size(); ++i) {
            ASSERT_EQ(a.is_missing(i), b.is_missing(i)) << a.line();
            ASSERT_TRUE(a.is_missing(i) || a.word(i) == b.word(i)) << a.line();
        }
        ASSERT_EQ(a.offset() + a.line(), b.offset());
    }
    EXPECT_FALSE(b.next_row());
    EXPECT_EQ(rows, 200'000U);
    EXPECT_EQ(a.offset(), text.size());
}

TEST(AtomicFilePieces, IsThereWhenItIsWhole) {
    const TemporaryFolder folder;
    const std::filesystem::path name = folder.path() / "f";
    const auto files = [&] {
        return std::distance(std::filesystem::directory_iterator(folder.path()), {});
    };
    {
        AtomicFile dropped(name);
        dropped.write("half");
        EXPECT_FALSE(std::filesystem::exists(name));
        EXPECT_EQ(files(), 1);
    }
    EXPECT_EQ(files(), 0);
    AtomicFile file(name);
    file.write("one, ");
    file.write("two");
    EXPECT_FALSE(std::filesystem::exists(name));
    file.commit();
    EXPECT_EQ(read_file(name), "one, two");
    EXPECT_EQ(files(), 1);
}

TEST(FileViewPieces, ReleasedMemoryIsReadAgain) {
    const TemporaryFolder folder;
    const std::filesystem::path name = folder.path() / "f";
    const std::string text = whole_table() + whole_table();
    ASSERT_GT(text.size(), std::size_t{6} << 20);  // more than a piece
    write_file_atomically(name, text);
    const FileView view(name);
    EXPECT_EQ(digest_of(view), digest_of(text));
    view.release(text.size() + 1);
    EXPECT_TRUE(view.bytes() == text);
    std::string pieced;
    std::size_t pieces = 0;
    view.for_each_piece([&](std::string_view piece) {
        pieced += piece;
        ++pieces;
    });
    EXPECT_GT(pieces, 1U);
    EXPECT_TRUE(pieced == text);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
