#include <fmt/format.h>

#include <kainjow/mustache.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/audit/walk.h"

namespace runcert {

std::string_view audit_page(std::string_view name);

namespace {

using TemplateData = kainjow::mustache::data;

/// Escaped; a very long word has places where a line may end, which are not seen or copied.
std::string escaped(const std::string& text) {
    constexpr std::size_t long_word = 40;
    std::string out;
    std::size_t word = 0;
    std::string character;
    const auto flush = [&] {
        out += kainjow::mustache::html_escape(character);
        character.clear();
    };
    for (const char c : text) {
        if ((static_cast<unsigned char>(c) & 0xC0U) != 0x80U) {
            flush();
            word = c == ' ' ? 0 : word + 1;
            if (word > long_word) {
                out += "<wbr/>";
                word = 1;
            }
        }
        character += c;
    }
    flush();
    return out;
}

TemplateData object() {
    return TemplateData{TemplateData::type::object};
}

TemplateData list() {
    return TemplateData{TemplateData::type::list};
}

TemplateData list_of(const std::vector<std::string>& texts) {
    TemplateData data = list();
    for (const std::string& text : texts) {
        TemplateData item = object();
        item.set("text", plain_text(text));
        data.push_back(item);
    }
    return data;
}

TemplateData data_of(const Paragraph& paragraph) {
    TemplateData data = object();
    data.set("is_paragraph", TemplateData(true));
    data.set("text", plain_text(paragraph.text));
    return data;
}

TemplateData data_of(const Entries& entries) {
    TemplateData data = object();
    data.set("has_items", TemplateData(!entries.items.empty()));
    data.set("items", list_of(entries.items));
    return data;
}

TemplateData data_of(const Facts& facts) {
    TemplateData data = object();
    TemplateData all = list();
    for (const Fact& fact : facts.facts) {
        TemplateData entry = object();
        entry.set("name", plain_text(fact.name));
        entry.set("value", plain_text(fact.value));
        all.push_back(entry);
    }
    data.set("has_facts", TemplateData(!facts.facts.empty()));
    data.set("facts", all);
    return data;
}

TemplateData data_of(const FactTable& table) {
    TemplateData data = object();
    TemplateData rows = list();
    for (const auto& row : table.rows) {
        TemplateData entry = object();
        entry.set("first", plain_text(row.front()));
        entry.set("cells", list_of({row.begin() + 1, row.end()}));
        rows.push_back(entry);
    }
    data.set("is_table", TemplateData(true));
    data.set("has_caption", TemplateData(!table.caption.empty()));
    data.set("caption", plain_text(table.caption));
    data.set("heads", list_of(table.heads));
    data.set("rows", rows);
    return data;
}

TemplateData blocks_of(const std::vector<Block>& blocks) {
    TemplateData data = list();
    for (const Block& block : blocks)
        data.push_back(std::visit([](const auto& each) { return data_of(each); }, block));
    return data;
}

TemplateData section_of(const Section& section, std::size_t number) {
    TemplateData data = object();
    data.set("id", fmt::format("section-{}", number));
    data.set("title", plain_text(section.title));
    data.set("blocks", blocks_of(section.blocks));
    TemplateData parts = list();
    for (const Section& part : section.parts) {
        TemplateData entry = object();
        entry.set("part_title", plain_text(part.title));
        entry.set("part_blocks", blocks_of(part.blocks));
        parts.push_back(entry);
    }
    data.set("parts", parts);
    return data;
}

}  // namespace

std::string walk_html(const Walk& walk) {
    TemplateData data = object();
    data.set("walk_title", plain_text(walk.title));
    data.set("style", std::string(audit_page("template/walk.css")));
    TemplateData sections = list();
    std::size_t number = 0;
    for (const Section& section : walk.sections)
        sections.push_back(section_of(section, ++number));
    data.set("sections", sections);
    kainjow::mustache::mustache page(std::string(audit_page("template/walk.html")));
    kainjow::mustache::partial blocks(
        [] { return std::string(audit_page("template/blocks.html")); });
    data.set("block", TemplateData(blocks));
    page.set_custom_escape(escaped);
    std::string html = page.render(data);
    if (!page.is_valid())
        throw Failure("template/walk.html", page.error_message(),
                      "This is a fault of the program; please report it");
    return html;
}

}  // namespace runcert
