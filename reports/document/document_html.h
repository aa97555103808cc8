#pragma once

#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "reports/plot/plot.h"
#include "schemas/document/document.h"

namespace runcert {

using TemplateData = kainjow::mustache::data;

/// Where a page is read: very long words get places where a line may end, each for its reader.
enum class Medium { screen, paper };

/// What a template gets for a value of JSON: objects have `has_NAME` beside each list; an empty
/// text is nothing; every other one is plain (plain_text).
TemplateData template_data(const nlohmann::ordered_json& value);

/// The text of a template with this data, escaped for HTML. Failure where it is no template.
std::string rendered(std::string_view text, const TemplateData& data,
                     Medium medium = Medium::screen);

/// A file's name as a relative link: every byte but letters, digits and - . _ ~ / as %NN. Empty
/// where it leads elsewhere, or is too long to stay whole.
std::string link_to(std::string_view file);

/// A document's JSON (members_json) as `template/sections.html` gets it: blocks have `is_KIND`, a
/// cell of a table knows the head of its column, and files that are named are links (`link_to`).
nlohmann::ordered_json shown_sections(const nlohmann::ordered_json& document);

/// The sections as HTML. `beside` is what else the template gets: `signers` and what a page fills
/// in when it is drawn; `image` of each plot is an element of HTML.
std::string sections_html(const nlohmann::ordered_json& document,
                          const nlohmann::ordered_json& beside = {},
                          Medium medium = Medium::screen);

/// The sections' template, and the style of all.
std::string_view sections_template();
std::string_view document_style();

/// What a page has beside its document.
struct PageParts {
    std::string style = {};   ///< after the style of all
    std::string script = {};  ///< the only one that runs
    Plots plots = {};         ///< by the numbers that the document names
};

/// A page for the screen and for paper, HTML and well-formed XML: nothing from elsewhere, all
/// escaped, with its contents.
std::string document_page(const Document& document, const PageParts& parts = {});

}  // namespace runcert
