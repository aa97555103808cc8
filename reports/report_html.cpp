#include "reports/report_html.h"

#include <kainjow/mustache.hpp>

#include "core/failure.h"

namespace runcert {

std::string_view report_text(std::string_view name);

using Json = nlohmann::ordered_json;
using TemplateData = kainjow::mustache::data;

namespace {

/// Control characters have no place in a page; line ends and tabs do.
std::string printable(std::string text) {
    std::string out;
    for (const char c : text) {
        const bool control = (c >= 0 && c < ' ' && c != '\n' && c != '\t') || c == '\x7f';
        out += control ? "\xEF\xBF\xBD" : std::string(1, c);
    }
    return out;
}

TemplateData template_data(const Json& value) {
    if (value.is_object()) {
        TemplateData data{TemplateData::type::object};
        for (const auto& [key, member] : value.items()) data.set(key, template_data(member));
        return data;
    }
    if (value.is_array()) {
        TemplateData data{TemplateData::type::list};
        for (const Json& item : value) data.push_back(template_data(item));
        return data;
    }
    if (value.is_boolean()) return TemplateData(value.get<bool>());
    return TemplateData(printable(value.is_string() ? value.get<std::string>() : value.dump()));
}

}  // namespace

std::string report_html(const Json& report, const std::vector<Figure>& figures) {
    TemplateData data = template_data(report["predicate"]);
    TemplateData drawn{TemplateData::type::list};
    for (const Figure& figure : figures) {
        TemplateData entry{TemplateData::type::object};
        entry.set("figure_title", printable(figure.title));
        entry.set("caption", printable(figure.caption));
        entry.set("svg", figure.svg);
        drawn.push_back(std::move(entry));
    }
    data.set("figures", std::move(drawn));
    data.set("style", std::string(report_text("template/report.css")));
    kainjow::mustache::mustache page(std::string(report_text("template/report.html")));
    if (!page.is_valid())
        throw Failure("template/report.html", page.error_message(),
                      "This is a fault of the program; please report it");
    return page.render(data);
}

}  // namespace runcert
