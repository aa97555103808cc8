#include "reports/document/document_html.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "store/base64.h"
#include "store/sha256.h"

namespace runcert {

std::string_view document_part(std::string_view name);

using Json = nlohmann::ordered_json;

namespace {

/// What stands before and after each piece of a very long word, so that a line may end there. A
/// browser takes <wbr> and does not copy it. WeasyPrint 57 passes many of them over, but not a
/// zero-width space, which the PDF does not hold; it is faster with each piece in an element.
struct WordPieces {
    std::string_view before, after;
};
constexpr WordPieces on_screen{"", "<wbr/>"}, on_paper{"<span>", "\u200B</span>"};
constexpr std::size_t long_word = 400;

/// Escaped for HTML, and very long words with places where a line may end: WeasyPrint takes minutes
/// over a word of ten thousand letters. Shorter ones stay whole, since letters that belong together
/// (Thai, emoji) must not be parted.
std::string escaped(const std::string& text, const WordPieces& pieces) {
    constexpr std::size_t piece_bytes = 50;
    std::string out;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find_first_of(" \n\t", begin), text.size());
        for (std::size_t piece = begin; piece < end;) {
            std::size_t next = end - begin > long_word ? std::min(piece + piece_bytes, end) : end;
            while (next < end && (static_cast<unsigned char>(text[next]) & 0xC0) == 0x80)
                ++next;
            const bool last = next == end;
            if (!last) out += pieces.before;
            out += kainjow::mustache::html_escape(text.substr(piece, next - piece));
            if (!last) out += pieces.after;
            piece = next;
        }
        if (end < text.size()) out += text[end];
        begin = end + 1;
    }
    return out;
}

/// Makes a link of the file that a fact or a row names.
void make_link(Json& of) {
    if (of.contains("link")) of["link"] = link_to(of.at("link").get<std::string>());
}

/// The cells of a row, each with what its column says of it: its head where that can stand in an
/// attribute, which takes no pieces of a long word.
Json shown_cells(const Json& row, const Json& columns) {
    Json cells = Json::array();
    const Json& texts = row.at("cells");
    for (std::size_t i = 0; i < texts.size() && i < columns.size(); ++i) {
        Json cell{{"cell", texts[i]}, {"first", i == 0}, {"number", columns[i].at("numbers")}};
        const std::string head = columns[i].value("head", "");
        cell["head"] = head.size() > long_word ? "" : head;
        cell["share"] = i + 1 == texts.size() && row.contains("share") ? row.at("share") : Json("");
        cells.push_back(std::move(cell));
    }
    return cells;
}

Json shown_block(Json block) {
    block["is_" + block.at("kind").get<std::string>()] = true;
    if (block.contains("facts"))
        for (Json& fact : block["facts"]) {
            make_link(fact);
            fact["long"] = fact.at("value").get_ref<const std::string&>().size() > long_word;
        }
    if (!block.contains("rows")) return block;
    const Json columns = block.value("columns", Json::array());
    block["has_heads"] =
        std::ranges::any_of(columns, [](const Json& column) { return column.contains("head"); });
    for (Json& row : block["rows"]) {
        make_link(row);
        row["cells"] = shown_cells(row, columns);
        row["span"] = std::to_string(columns.size());
    }
    return block;
}

/// An anchor and a title for each section that has one.
Json contents_of(const Json& document) {
    Json contents = Json::array();
    for (const Json& section : document.at("sections"))
        if (section.contains("title"))
            contents.push_back(
                {{"entry", section.at("anchor")}, {"entry_title", section.at("title")}});
    return contents;
}

/// As a script of HTML and of XML.
std::string script_text(const std::string& script) {
    return "//<![CDATA[\n" + script + "//]]>";
}

}  // namespace

std::string link_to(std::string_view file) {
    std::string link;
    for (const char c : file) {
        const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || is_digit(c) ||
                           std::string_view("-._~/").find(c) != std::string_view::npos;
        link += plain
                    ? std::string(1, c)
                    : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    }
    return link.starts_with('/') || link.size() > long_word ? std::string() : link;
}

TemplateData template_data(const Json& value) {
    if (value.is_object()) {
        TemplateData data{TemplateData::type::object};
        for (const auto& [key, member] : value.items()) {
            data.set(key, template_data(member));
            if (member.is_array()) data.set("has_" + key, TemplateData(!member.empty()));
        }
        return data;
    }
    if (value.is_array()) {
        TemplateData data{TemplateData::type::list};
        for (const Json& item : value)
            data.push_back(template_data(item));
        return data;
    }
    if (value.is_boolean()) return TemplateData(value.get<bool>());
    if (!value.is_string()) return TemplateData(value.dump());
    if (value.get_ref<const std::string&>().empty()) return TemplateData(false);
    return TemplateData(plain_text(value.get<std::string>()));
}

std::string rendered(std::string_view text, const TemplateData& data, Medium medium) {
    kainjow::mustache::mustache page{std::string(text)};
    const WordPieces& pieces = medium == Medium::screen ? on_screen : on_paper;
    page.set_custom_escape([&](const std::string& word) { return escaped(word, pieces); });
    std::string html = page.render(data);
    if (!page.is_valid())
        throw Failure("a template of a page", page.error_message(),
                      "This is a fault of the program; please report it");
    return html;
}

Json shown_sections(const Json& document) {
    Json sections = Json::array();
    for (const Json& section : document.at("sections")) {
        Json shown = section;
        shown.erase("title");
        if (section.contains("title")) shown["section_title"] = section.at("title");
        shown["blocks"] = Json::array();
        for (const Json& block : section.at("blocks"))
            shown["blocks"].push_back(shown_block(block));
        sections.push_back(std::move(shown));
    }
    if (!sections.empty() && sections[0].value("layout", "") == "first_page")
        sections[0]["contents"] = contents_of(document);
    return sections;
}

std::string sections_html(const Json& document, const Json& beside, Medium medium) {
    Json data = beside.is_null() ? Json::object() : beside;
    data["sections"] = shown_sections(document);
    return rendered(sections_template(), template_data(data), medium);
}

std::string_view sections_template() {
    return document_part("template/sections.html");
}

std::string_view document_style() {
    return document_part("template/document.css");
}

std::string document_page(const Document& document, const PageParts& parts) {
    Json json = members_json(document);
    draw_plots(json, parts.plots, true);
    Json data{{"page_title", document.title}, {"subtitle", document.subtitle}};
    data["contents"] = contents_of(json);
    TemplateData shown = template_data(data);
    shown.set("style", std::string(document_style()) + parts.style);
    if (!parts.script.empty()) {
        const std::string script = script_text(parts.script);
        shown.set("script_hash", base64_of_hex(sha256_hex(script)));
        shown.set("script", script);
    }
    shown.set("content", sections_html(json));
    return rendered(document_part("template/page.html"), shown);
}

}  // namespace runcert
