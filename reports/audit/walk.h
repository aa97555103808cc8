#pragma once

#include <string>
#include <variant>
#include <vector>

// What an auditor is shown, before it is text or a page: `walk_text` and `walk_html` print it.
// Strings are plain text, as long as they are, and may hold anything: the writers make it safe.

namespace runcert {

struct Paragraph {
    std::string text;

    bool operator==(const Paragraph&) const = default;
};

/// A list, one item after the other; a nested one belongs to the paragraph before it.
struct Entries {
    std::vector<std::string> items = {};
    bool nested = false;

    bool operator==(const Entries&) const = default;
};

struct Fact {
    std::string name;
    std::string value;

    bool operator==(const Fact&) const = default;
};

struct Facts {
    std::vector<Fact> facts = {};

    void add(std::string name, std::string value) {
        facts.push_back({std::move(name), std::move(value)});
    }
    bool operator==(const Facts&) const = default;
};

/// Every row has as many cells as there are heads; the first names the row.
struct FactTable {
    std::string caption = {};
    std::vector<std::string> heads = {};
    std::vector<std::vector<std::string>> rows = {};

    bool operator==(const FactTable&) const = default;
};

using Block = std::variant<Paragraph, Entries, Facts, FactTable>;

struct Section {
    std::string title;
    std::vector<Block> blocks = {};
    std::vector<Section> parts = {};  ///< these have none of their own

    void add(Block block) { blocks.push_back(std::move(block)); }
    void add(std::vector<Block> more) {
        for (Block& block : more)
            blocks.push_back(std::move(block));
    }
    void add_parts(std::vector<Section> more) {
        for (Section& part : more)
            parts.push_back(std::move(part));
    }
    bool operator==(const Section&) const = default;
};

/// A walk through a run: what it is, then stage by stage.
struct Walk {
    std::string title;
    std::vector<Section> sections = {};

    bool operator==(const Walk&) const = default;
};

/// The walk as text of at most 100 columns. Items of a list that is not nested begin at the first
/// column; what follows on their other lines is indented by four.
std::string walk_text(const Walk& walk);
/// One section, and its parts, likewise.
std::string section_text(const Section& section);

/// The walk as one page, HTML and well-formed XML: no script, nothing from elsewhere, all escaped.
std::string walk_html(const Walk& walk);

}  // namespace runcert
