#include <algorithm>
#include <iterator>

#include "core/text.h"
#include "schemas/document/document.h"

namespace runcert {

Block paragraph(std::string text, std::string look) {
    return {.look = std::move(look), .text = std::move(text)};
}

Block heading(std::string text) {
    return {.kind = BlockKind::heading, .text = std::move(text)};
}

Block list_of(std::vector<std::string> items, std::string look) {
    return {.kind = BlockKind::items, .look = std::move(look), .items = std::move(items)};
}

Block titled_list(std::string title, std::vector<std::string> items) {
    Block list = list_of(std::move(items));
    list.text = std::move(title);
    return list;
}

Block facts(std::vector<Fact> facts, std::string title, std::string look) {
    return {.kind = BlockKind::facts,
            .look = std::move(look),
            .text = std::move(title),
            .facts = std::move(facts)};
}

Block code(const std::string& text) {
    return {.kind = BlockKind::code, .items = lines_of(text)};
}

Block plot(std::size_t index, std::string title, std::string caption) {
    return {.kind = BlockKind::plots,
            .plots = {{.plot = static_cast<std::int64_t>(index),
                       .plot_title = std::move(title),
                       .caption = std::move(caption)}}};
}

Block table(const std::vector<std::string>& heads, std::string title, std::string look) {
    Block block{.kind = BlockKind::table, .look = std::move(look), .text = std::move(title)};
    for (const std::string& head : heads) {
        const bool numbers = head.starts_with('>');
        const std::size_t bar = std::min(head.find('|'), head.size());
        TableColumn column{.head = head.substr(numbers ? 1 : 0, bar - (numbers ? 1 : 0)),
                           .numbers = numbers};
        if (bar < head.size()) column.width = parse_integer(head.substr(bar + 1));
        block.columns.push_back(std::move(column));
    }
    return block;
}

void add(Section& section, Block block) {
    section.blocks.push_back(std::move(block));
}

void add(Section& section, std::vector<Block> blocks) {
    add(section.blocks, std::move(blocks));
}

void add(std::vector<Block>& blocks, std::vector<Block> further) {
    std::ranges::move(further, std::back_inserter(blocks));
}

void add_fact(Block& facts, std::string name, std::string value, std::string link) {
    if (value.empty()) return;
    facts.facts.push_back(
        {.name = std::move(name), .value = std::move(value), .link = std::move(link)});
}

TableRow& add_row(Block& table, std::vector<std::string> cells, std::string mark) {
    return table.rows.emplace_back(TableRow{.cells = std::move(cells), .mark = std::move(mark)});
}

}  // namespace runcert
