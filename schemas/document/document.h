#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "schemas/document/declared.h"

// What a person is shown: blocks, made here in a line each. Texts are plain and may hold anything,
// since `reports/document` makes them safe.

namespace runcert {

Block paragraph(std::string text, std::string look = {});
Block heading(std::string text);
Block list_of(std::vector<std::string> items, std::string look = {});
Block titled_list(std::string title, std::vector<std::string> items);
Block facts(std::vector<Fact> facts, std::string title = {}, std::string look = {});
/// What a person types, line by line.
Block code(const std::string& text);
Block plot(std::size_t index, std::string title, std::string caption);

/// A head begins with `>` where its column holds figures, and ends with `|20` where it takes 20 %
/// of the width: {"Source", ">Contribution|12"}.
Block table(const std::vector<std::string>& heads, std::string title = {}, std::string look = {});

/// Appends a block, and further ones.
void add(Section& section, Block block);
void add(Section& section, std::vector<Block> blocks);
void add(std::vector<Block>& blocks, std::vector<Block> further);
/// Appends a name and what it is, unless that is empty.
void add_fact(Block& facts, std::string name, std::string value, std::string link = {});
/// Appends a row, and returns it.
TableRow& add_row(Block& table, std::vector<std::string> cells, std::string mark = {});

}  // namespace runcert
