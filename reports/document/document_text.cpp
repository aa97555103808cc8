#include "reports/document/document_text.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

#include "core/prose.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::size_t between_columns = 2;
constexpr std::size_t least_last_column = 24;  // a narrower table becomes a list
constexpr std::size_t widest_name = 28;
constexpr std::size_t word_indent = 4;

std::size_t longest_word(std::string_view text) {
    std::size_t longest = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = std::min(text.find_first_of(" \n\t", begin), text.size());
        longest = std::max(longest, characters_in(text.substr(begin, end - begin)));
        begin = end + 1;
    }
    return longest;
}

/// Writes blocks as lines of at most so many columns.
class TextWriter {
  public:
    explicit TextWriter(std::size_t columns) : columns_(columns) {}

    std::string underlined(const std::string& title, char line) const {
        const std::string text = lines(title);
        return fmt::format("{}{}\n", text,
                           std::string(characters_in(text.substr(0, text.find('\n'))), line));
    }

    std::string blocks(const std::vector<Block>& blocks) const {
        std::string text;
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            if (i > 0 && are_parted(blocks[i - 1], blocks[i])) text += "\n";
            text += block(blocks[i]);
        }
        return text;
    }

  private:
    std::string lines(const std::string& text, std::size_t indent = 4, std::size_t used = 0) const {
        return wrapped(text, indent, used, columns_);
    }

    std::string block(const Block& block) const {
        switch (block.kind) {
            case BlockKind::facts:
                return facts(block);
            case BlockKind::table:
                return table(block);
            case BlockKind::items:
                return items(block);
            case BlockKind::code:
                return code(block);
            case BlockKind::plots:
                return plots(block);
            case BlockKind::headline:
                return lines(fmt::format("{} {}", block.text, block.beside), 0);
            case BlockKind::paragraph:
            case BlockKind::heading:
                return lines(block.text, 0);
            case BlockKind::signers:
            case BlockKind::check:
                break;  // only a page can say that
        }
        return {};
    }

    std::string items(const Block& block) const {
        const std::size_t indent = block.look == "apart" ? 4 : 2;
        std::string text = title(block);
        for (const std::string& item : block.items)
            text += fmt::format("{:{}}- {}", "", indent - 2, lines(item, indent, indent));
        return text;
    }

    /// Lines stay whole however long they are: who types them copies them from here.
    static std::string code(const Block& block) {
        std::string text;
        for (const std::string& line : block.items)
            text += fmt::format("    {}\n", plain_text(line));
        return text;
    }

    std::string plots(const Block& block) const {
        std::string text;
        for (const PlotPlace& plot : block.plots)
            text += lines(fmt::format("{}. {}", plot.plot_title, plot.caption), 2);
        return text;
    }

    std::string title(const Block& block) const {
        return block.text.empty() ? "" : lines(block.text + ":", 0);
    }

    std::string facts(const Block& block) const {
        const std::size_t most = std::min(widest_name, columns_ / 3);
        std::size_t names = 0;
        for (const Fact& fact : block.facts)
            names = std::max(names, std::min(characters_in(fact.name), most));
        const std::size_t values = names + between_columns;
        std::string text = title(block);
        for (const Fact& fact : block.facts) {
            const std::string name = plain_text(fact.name);
            // A hash is whole, on a line of its own where it must be.
            const std::size_t word = longest_word(fact.value);
            const bool beneath = values + word > columns_ && word_indent + word <= columns_;
            const std::size_t indent = beneath ? word_indent : values;
            if (fact.value.empty()) {
                text += lines(name, 2);
                continue;
            }
            const bool fits = characters_in(name) <= names && !beneath;
            text += (fits ? padded(name, values) : lines(name, 2) + std::string(indent, ' ')) +
                    lines(fact.value, indent, indent);
        }
        return text;
    }

    static std::vector<std::size_t> widths_of(const Block& table) {
        std::vector<std::size_t> widths;
        for (const TableColumn& column : table.columns)
            widths.push_back(characters_in(column.head));
        for (const TableRow& row : table.rows)
            for (std::size_t i = 0; i < row.cells.size() && i < widths.size(); ++i)
                widths[i] = std::max(widths[i], characters_in(plain_text(row.cells[i])));
        return widths;
    }

    std::string further(const TableRow& row) const {
        std::string text;
        for (const std::string& line : row.further)
            text += "    " + lines(line, 4, 4);
        return text;
    }

    /// "name: head value; head value".
    std::string as_list(const Block& table) const {
        std::string text;
        for (const TableRow& row : table.rows) {
            std::string item = row.cells.front();
            bool first = true;
            for (std::size_t i = 1; i < row.cells.size(); ++i) {
                if (row.cells[i].empty()) continue;
                const std::string& head = table.columns[i].head;
                item += fmt::format("{} {}{}{}", first ? ":" : ";", head, head.empty() ? "" : " ",
                                    row.cells[i]);
                first = false;
            }
            text += lines(item, 4) + further(row);
        }
        return text;
    }

    std::string table(const Block& table) const {
        const std::vector<std::size_t> widths = widths_of(table);
        std::size_t before_last = 0;
        for (std::size_t i = 0; i + 1 < widths.size(); ++i)
            before_last += widths[i] + between_columns;
        const std::size_t last = widths.empty() ? 0 : std::min(widths.back(), least_last_column);
        if (before_last + last > columns_) return title(table) + as_list(table);
        const auto line_of = [&](const std::vector<std::string>& cells) {
            std::string line;
            for (std::size_t i = 0; i + 1 < cells.size(); ++i)
                line += padded(plain_text(cells[i]), widths[i] + between_columns,
                               table.columns[i].numbers);
            const std::size_t own = characters_in(plain_text(cells.back()));
            if (table.columns.back().numbers && before_last + widths.back() <= columns_)
                line += std::string(widths.back() - own, ' ') + plain_text(cells.back());
            else
                line += lines(cells.back(), before_last, before_last);
            // No blanks at the end of a line whose last cell is empty.
            line.erase(line.find_last_not_of(" \n") + 1);
            return line + "\n";
        };
        std::vector<std::string> heads;
        for (const TableColumn& column : table.columns)
            heads.push_back(column.head);
        const bool headed =
            std::ranges::any_of(heads, [](const auto& head) { return !head.empty(); });
        std::string text = title(table) + (headed ? line_of(heads) : "");
        for (const TableRow& row : table.rows)
            text += line_of(row.cells) + further(row);
        return text;
    }

    static std::string padded(const std::string& text, std::size_t columns, bool right = false) {
        const std::size_t own = characters_in(text);
        const std::string blanks(columns > own ? columns - own : 0, ' ');
        if (!right || blanks.size() < between_columns) return text + blanks;
        return blanks.substr(between_columns) + text + std::string(between_columns, ' ');
    }

    /// Whether an empty line separates two blocks: around headings, tables, facts, code and lists
    /// with a title, except for a list that belongs to what stands before it.
    static bool are_parted(const Block& before, const Block& after) {
        if (after.kind == BlockKind::items && after.look == "apart") return false;
        if (before.kind == BlockKind::heading) return false;
        const auto stands_apart = [](const Block& block) {
            return block.kind == BlockKind::table || block.kind == BlockKind::facts ||
                   block.kind == BlockKind::code ||
                   (block.kind == BlockKind::items && !block.text.empty());
        };
        const bool titled = after.kind == BlockKind::items && !after.text.empty();
        return after.kind == BlockKind::heading || titled || stands_apart(before) ||
               stands_apart(after);
    }

    std::size_t columns_;
};

}  // namespace

std::size_t terminal_columns() {
    constexpr std::size_t without = 80, least = 40, most = 120;
    winsize size{};
    if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 ||
        size.ws_col == 0)
        return without;
    return std::clamp<std::size_t>(size.ws_col, least, most);
}

std::string section_text(const Section& section, std::size_t columns) {
    const TextWriter writer(columns);
    return (section.title.empty() ? "" : writer.underlined(section.title, '-')) +
           writer.blocks(section.blocks);
}

std::string document_text(const Document& document, std::size_t columns) {
    const TextWriter writer(columns);
    std::string text = document.title.empty() ? "" : writer.underlined(document.title, '=');
    if (!document.subtitle.empty()) text += wrapped(document.subtitle, 0, 0, columns);
    for (const Section& section : document.sections)
        text += (text.empty() ? "" : "\n") + section_text(section, columns);
    return text;
}

}  // namespace runcert
