#include <fmt/format.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"
#include "reports/audit/walk.h"

namespace runcert {
namespace {

constexpr std::size_t page_columns = 100;
constexpr std::size_t between_columns = 2;
constexpr std::size_t least_last_column = 24;  // narrower than that, a table is a list

/// Characters, not bytes.
std::size_t columns_of(std::string_view text) {
    return static_cast<std::size_t>(std::ranges::count_if(
        text, [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string padded(const std::string& text, std::size_t columns) {
    const std::size_t own = columns_of(text);
    return text + std::string(columns > own ? columns - own : 0, ' ');
}

std::string text_of(const Paragraph& paragraph) {
    return wrapped(plain_text(paragraph.text));
}

std::string text_of(const Entries& entries) {
    std::string text;
    for (const std::string& item : entries.items)
        text += entries.nested ? std::string(4, ' ').append(wrapped(plain_text(item), 8, 4))
                               : wrapped(plain_text(item));
    return text;
}

std::string text_of(const Facts& facts) {
    constexpr std::size_t longest_name = 28;
    std::size_t names = 0;
    for (const Fact& fact : facts.facts)
        names = std::max(names, std::min(columns_of(fact.name), longest_name));
    const std::size_t values = names + between_columns;
    std::string text;
    for (const Fact& fact : facts.facts) {
        const std::string name = padded(plain_text(fact.name), values);
        const bool fits = columns_of(name) <= values;
        text += (fits ? name : wrapped(name) + std::string(values, ' ')) +
                wrapped(plain_text(fact.value), values, values);
    }
    return text;
}

std::vector<std::size_t> widths_of(const FactTable& table) {
    std::vector<std::size_t> widths;
    for (const std::string& head : table.heads)
        widths.push_back(columns_of(head));
    for (const auto& row : table.rows)
        for (std::size_t i = 0; i < row.size() && i < widths.size(); ++i)
            widths[i] = std::max(widths[i], columns_of(plain_text(row[i])));
    return widths;
}

/// "name: head value; head value", where the columns do not fit beside each other.
std::string as_list(const FactTable& table) {
    std::string text;
    for (const auto& row : table.rows) {
        std::string item = row.front();
        for (std::size_t i = 1; i < row.size(); ++i)
            if (!row[i].empty())
                item += fmt::format("{} {} {}", i == 1 ? ":" : ";", table.heads[i], row[i]);
        text += wrapped(plain_text(item));
    }
    return text;
}

std::string text_of(const FactTable& table) {
    const std::string caption =
        table.caption.empty() ? "" : wrapped(fmt::format("{}:", plain_text(table.caption)));
    const std::vector<std::size_t> widths = widths_of(table);
    std::size_t before_last = 0;
    for (std::size_t i = 0; i + 1 < widths.size(); ++i)
        before_last += widths[i] + between_columns;
    const std::size_t last = widths.empty() ? 0 : std::min(widths.back(), least_last_column);
    if (before_last + last > page_columns) return caption + as_list(table);
    const auto line_of = [&](const std::vector<std::string>& cells) {
        std::string line;
        for (std::size_t i = 0; i + 1 < cells.size(); ++i)
            line += padded(plain_text(cells[i]), widths[i] + between_columns);
        const std::string end = wrapped(plain_text(cells.back()), before_last, before_last);
        line += end;
        // No blanks at the end of a line whose last cell is empty.
        line.erase(line.find_last_not_of(" \n") + 1);
        return line + "\n";
    };
    std::string text = caption + line_of(table.heads);
    for (const auto& row : table.rows)
        text += line_of(row);
    return text;
}

/// Whether an empty line parts two blocks: beside tables and facts, but for what belongs to a fact.
bool is_parted(const Block& before, const Block& after) {
    const Entries* entries = std::get_if<Entries>(&after);
    if (entries && entries->nested) return false;
    const auto stands_apart = [](const Block& block) {
        return std::holds_alternative<FactTable>(block) || std::holds_alternative<Facts>(block);
    };
    return stands_apart(before) || stands_apart(after);
}

std::string text_of(const std::vector<Block>& blocks) {
    std::string text;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        if (i > 0 && is_parted(blocks[i - 1], blocks[i])) text += "\n";
        text += std::visit([](const auto& block) { return text_of(block); }, blocks[i]);
    }
    return text;
}

std::string underlined(const std::string& title, char line) {
    const std::string text = wrapped(plain_text(title));
    const std::size_t first_line = columns_of(text.substr(0, text.find('\n')));
    return fmt::format("{}{}\n", text, std::string(first_line, line));
}

}  // namespace

std::string section_text(const Section& section) {
    std::string text = underlined(section.title, '-') + text_of(section.blocks);
    for (const Section& part : section.parts)
        text += fmt::format("\n{}{}", wrapped(plain_text(part.title)), text_of(part.blocks));
    return text;
}

std::string walk_text(const Walk& walk) {
    std::string text = underlined(walk.title, '=');
    for (const Section& section : walk.sections)
        text += fmt::format("\n{}", section_text(section));
    return text;
}

}  // namespace runcert
