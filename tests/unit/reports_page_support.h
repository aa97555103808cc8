#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "reports/certificate/report_html.h"
#include "reports/certificate/report_json.h"

namespace runcert {

/// The page for paper.
inline std::string print_page(const nlohmann::ordered_json& report,
                              const std::vector<SignatureFile>& signatures = {}) {
    return report_print_page(report_text_of(report), report, signatures);
}

/// Where a reader of a report looks: in a section, under a title or a heading of it if one is
/// named, and at what is of one rule if one is.
struct Place {
    std::string section;
    std::string title{};
    std::string rule{};
};

/// A section of a report's document.
inline const nlohmann::ordered_json& section_at(const nlohmann::ordered_json& report,
                                                const std::string& anchor) {
    std::vector<std::string> anchors;
    for (const auto& section : report.at("predicate").at("document").at("sections")) {
        if (section.at("anchor") == anchor) return section;
        anchors.push_back(section.at("anchor"));
    }
    throw std::runtime_error(
        fmt::format("no section {}, but {}", anchor, fmt::join(anchors, ", ")));
}

/// The blocks of a place, in order; none where nothing of that title stands there.
inline std::vector<nlohmann::ordered_json> blocks_at(const nlohmann::ordered_json& report,
                                                     const Place& place) {
    const auto is_titled = [&](const std::string& text) {
        return text == place.title || text.starts_with(place.title + ": rule “");
    };
    std::vector<nlohmann::ordered_json> blocks;
    std::string heading, rule;
    for (const auto& block : section_at(report, place.section).at("blocks")) {
        const std::string text = block.value("text", "");
        const bool titles = block.at("kind") != "paragraph" && block.at("kind") != "headline";
        if (const std::size_t at = text.find("ule “"); titles && at != std::string::npos)
            rule = text.substr(at + 7, text.find("”", at) - at - 7);
        if (block.at("kind") == "heading") heading = text;
        const bool titled =
            place.title.empty() || (titles && is_titled(text)) || is_titled(heading);
        if (titled && (place.rule.empty() || place.rule == rule)) blocks.push_back(block);
    }
    return blocks;
}

/// What a name is said to be; what is there instead where it is not found.
inline std::string fact_at(const nlohmann::ordered_json& report, const Place& place,
                           const std::string& name) {
    std::vector<std::string> names;
    for (const auto& block : blocks_at(report, place))
        for (const auto& fact : block.value("facts", nlohmann::ordered_json::array())) {
            if (fact.at("name") == name) return fact.at("value");
            names.push_back(fact.at("name"));
        }
    return fmt::format("no fact “{}”, but {}", name, fmt::join(names, ", "));
}

inline bool has_fact(const nlohmann::ordered_json& report, const Place& place,
                     const std::string& name) {
    return !fact_at(report, place, name).starts_with("no fact “");
}

/// The first cells of all rows of a place's tables.
inline std::vector<std::string> row_names(const nlohmann::ordered_json& report,
                                          const Place& place) {
    std::vector<std::string> names;
    for (const auto& block : blocks_at(report, place))
        for (const auto& row : block.value("rows", nlohmann::ordered_json::array()))
            names.push_back(row.at("cells").at(0));
    return names;
}

/// The row of that first cell.
inline nlohmann::ordered_json row_at(const nlohmann::ordered_json& report, const Place& place,
                                     const std::string& first_cell) {
    for (const auto& block : blocks_at(report, place))
        for (const auto& row : block.value("rows", nlohmann::ordered_json::array()))
            if (row.at("cells").at(0) == first_cell) return row;
    throw std::runtime_error(fmt::format("no row “{}” in {}, but {}", first_cell, place.section,
                                         fmt::join(row_names(report, place), ", ")));
}

/// The cell of that row under that head; what there is instead where there is none.
inline std::string cell_at(const nlohmann::ordered_json& report, const Place& place,
                           const std::string& first_cell, const std::string& head) {
    for (const auto& block : blocks_at(report, place))
        for (const auto& row : block.value("rows", nlohmann::ordered_json::array())) {
            if (row.at("cells").at(0) != first_cell) continue;
            for (std::size_t i = 0; i < block.at("columns").size(); ++i)
                if (block["columns"][i].value("head", "") == head) return row["cells"].at(i);
        }
    return fmt::format("no row “{}” with a cell under “{}”, but {}", first_cell, head,
                       fmt::join(row_names(report, place), ", "));
}

/// The sentences of a place: paragraphs, headlines and lists, a line each.
inline std::string sentences_at(const nlohmann::ordered_json& report, const Place& place) {
    std::string lines;
    for (const auto& block : blocks_at(report, place)) {
        if (block.at("kind") == "paragraph" || block.at("kind") == "headline")
            lines += block.at("text").get<std::string>() + "\n";
        for (const auto& item : block.value("items", nlohmann::ordered_json::array()))
            lines += item.get<std::string>() + "\n";
    }
    return lines;
}

/// The block of a slot; null where there is none.
inline nlohmann::ordered_json slot_at(const nlohmann::ordered_json& report,
                                      const std::string& slot) {
    for (const auto& section : report.at("predicate").at("document").at("sections"))
        for (const auto& block : section.at("blocks"))
            if (block.value("slot", "") == slot) return block;
    return nullptr;
}

/// What stands in a page from a section's begin to its end.
inline std::string section_html(const std::string& html, const std::string& anchor) {
    const std::size_t begin = html.find(fmt::format("<section id=\"{}\"", anchor));
    if (begin == std::string::npos) return {};
    return html.substr(begin, html.find("</section>", begin) - begin);
}

}  // namespace runcert
