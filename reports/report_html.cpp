#include "reports/report_html.h"

#include <algorithm>
#include <kainjow/mustache.hpp>

#include "core/failure.h"
#include "files/signature.h"
#include "files/signature_text.h"

namespace runcert {

std::string_view report_text(std::string_view name);

using Json = nlohmann::ordered_json;
using TemplateData = kainjow::mustache::data;

namespace {

/// Control characters have no place in a page; line ends and tabs do.
std::string printable(const std::string& text) {
    std::string out;
    for (const char c : text) {
        const bool control = (c >= 0 && c < ' ' && c != '\n' && c != '\t') || c == '\x7f';
        out += control ? "\xEF\xBF\xBD" : std::string(1, c);
    }
    return out;
}

/// Escaped for HTML, and very long words with places where a line may end: WeasyPrint takes minutes
/// over a word of ten thousand letters. Nothing of that is seen or copied.
std::string escaped(const std::string& text) {
    constexpr std::size_t long_word = 100;  // longer than any hash
    std::string out;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find_first_of(" \n\t", begin), text.size());
        for (std::size_t piece = begin; piece < end;) {
            std::size_t next = end - begin > long_word ? std::min(piece + long_word / 2, end) : end;
            while (next < end && (static_cast<unsigned char>(text[next]) & 0xC0) == 0x80)
                ++next;
            out += kainjow::mustache::html_escape(text.substr(piece, next - piece));
            if (next < end) out += "<wbr>";
            piece = next;
        }
        if (end < text.size()) out += text[end];
        begin = end + 1;
    }
    return out;
}

/// With `has_NAME` beside each list.
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
    return TemplateData(printable(value.is_string() ? value.get<std::string>() : value.dump()));
}

}  // namespace

ReportSigner read_signer(std::string_view signature_file_text, const std::string& where) {
    const auto lines = signature_text::lines_of(signature_file_text);
    constexpr std::string_view mark = "trusted comment: ";
    if (lines.size() != 4 || !lines[2].starts_with(mark))
        throw Failure(where, "this is not a signature file",
                      "Give the file that `runcert certify --key` or `minisign -S` made");
    // Algorithm (2 bytes), key id (8), signature (64).
    const std::string bytes = signature_text::bytes_of_base64(lines[1], 74, "signature", where);
    PublicKey key;
    std::copy_n(bytes.begin() + 2, key.key_id.size(), key.key_id.begin());
    return {.key_id = key_id_text(key),
            .trusted_comment = std::string(lines[2].substr(mark.size()))};
}

std::string report_html(const Json& report, const std::vector<DrawnFigure>& figures,
                        const std::vector<ReportSigner>& signers) {
    TemplateData data = template_data(report["predicate"]);
    TemplateData drawn{TemplateData::type::list};
    for (const DrawnFigure& figure : figures) {
        TemplateData entry{TemplateData::type::object};
        entry.set("figure_title", printable(figure.title));
        entry.set("caption", printable(figure.caption));
        entry.set("svg", figure.svg);
        drawn.push_back(entry);
    }
    TemplateData keys{TemplateData::type::list};
    for (const ReportSigner& signer : signers) {
        TemplateData entry{TemplateData::type::object};
        entry.set("key_id", printable(signer.key_id));
        entry.set("trusted_comment", printable(signer.trusted_comment));
        keys.push_back(entry);
    }
    data.set("signed", TemplateData(!signers.empty()));
    data.set("signers", keys);
    data.set("has_figures", TemplateData(!figures.empty()));
    data.set("drawn", drawn);
    data.set("two_receivers", TemplateData(report["predicate"]["receivers"].size() > 1));
    data.set("style", std::string(report_text("template/report.css")));
    kainjow::mustache::mustache page(std::string(report_text("template/report.html")));
    if (!page.is_valid())
        throw Failure("template/report.html", page.error_message(),
                      "This is a fault of the program; please report it");
    page.set_custom_escape(escaped);
    return page.render(data);
}

}  // namespace runcert
