#include "reports/certificate/report_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_json.h"
#include "store/base64.h"
#include "store/sha256.h"
#include "trust/signature.h"
#include "trust/ssh_signature.h"

namespace runcert {

std::string_view report_text(std::string_view name);

using Json = nlohmann::ordered_json;
using TemplateData = kainjow::mustache::data;

namespace {

/// Libraries first; last `page.js`, which starts the page.
constexpr std::string_view page_scripts[] = {
    "mustache.min.js", "noble-hashes.min.js", "uPlot.iife.min.js", "signatures.js",
    "shown_text.js",   "self_check.js",       "elements.js",       "tables.js",
    "chart_data.js",   "chart_parts.js",      "chart_drawing.js",  "charts.js",
    "page.js"};

/// What stands before and after each piece of a very long word, so that a line may end there. A
/// browser takes <wbr> and does not copy it. WeasyPrint 57 passes many of them over, but not a
/// zero-width space, which the PDF does not hold; it is faster with each piece in an element.
struct WordPieces {
    std::string_view before, after;
};
constexpr WordPieces on_screen{"", "<wbr>"}, on_paper{"<span>", "\u200B</span>"};

/// Escaped for HTML, and very long words with places where a line may end: WeasyPrint takes minutes
/// over a word of ten thousand letters. Shorter ones stay whole, since letters that belong together
/// (Thai, emoji) must not be parted.
std::string escaped(const std::string& text, const WordPieces& pieces) {
    constexpr std::size_t long_word = 400, piece_bytes = 50;
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
    if (!value.is_string()) return TemplateData(value.dump());
    // As in the page's own script, an empty text is nothing.
    if (value.get_ref<const std::string&>().empty()) return TemplateData(false);
    return TemplateData(plain_text(value.get<std::string>()));
}

std::string rendered(std::string_view name, const TemplateData& data,
                     const WordPieces& pieces = on_screen) {
    kainjow::mustache::mustache page{std::string(report_text(name))};
    if (!page.is_valid())
        throw Failure(std::string(name), page.error_message(),
                      "This is a fault of the program; please report it");
    page.set_custom_escape([&pieces](const std::string& text) { return escaped(text, pieces); });
    return page.render(data);
}

Json signers_json(const std::vector<SignatureText>& signatures) {
    Json list = Json::array();
    for (const SignatureText& signature : signatures) {
        const ReportSigner signer = read_signer(signature);
        list.push_back({{"file", signer.file},
                        {"key_id", signer.key_id},
                        {"role", signer.role},
                        {"trusted_comment", signer.trusted_comment}});
    }
    return list;
}

/// For each role that the report needs, how many keys more must sign in it.
Json missing_signatures_json(const Json& predicate, const Json& signers) {
    Json missing = Json::array();
    for (const Json& needed : predicate.value("signatures_required", Json::array())) {
        std::set<std::string> keys;
        for (const Json& signer : signers)
            if (signer["role"] == needed["role"]) keys.insert(signer["key_id"]);
        const auto short_of =
            needed["count"].get<std::int64_t>() - static_cast<std::int64_t>(keys.size());
        if (short_of > 0)
            missing.push_back({{"missing_role", needed["role"]}, {"missing_count", short_of}});
    }
    return missing;
}

std::string image_source(const std::string& svg) {
    return "data:image/svg+xml;base64," + base64(svg);
}

/// The inside of the page's <main>: what stands in the report, and its drawings.
std::string content_of(const Json& report, const std::vector<std::string>& drawings,
                       const std::vector<SignatureText>& signatures, const std::string& standing,
                       const WordPieces& pieces) {
    Json shown = with_standing(report["predicate"], Json::parse(standing));
    shown["signed"] = !signatures.empty();
    shown["signers"] = signers_json(signatures);
    shown["missing_signatures"] = missing_signatures_json(shown, shown["signers"]);
    shown["two_receivers"] = shown["receivers"].size() > 1;
    for (std::size_t i = 0; i < shown["figures"].size(); ++i) {
        Json& figure = shown["figures"][i];
        for (const char* points : {"curves", "spans", "levels", "marks", "segments"})
            figure.erase(points);
        if (!drawings.at(i).empty())
            figure["image"] = fmt::format(
                "<img src=\"{}\" alt=\"{}\">", image_source(drawings.at(i)),
                kainjow::mustache::html_escape(figure["figure_title"].get<std::string>()));
    }
    return rendered("template/report.html", template_data(shown), pieces);
}

/// What the head of every page holds.
TemplateData page_data(const Json& report, bool is_signed) {
    const Json& predicate = report["predicate"];
    const std::string id = predicate["report_id"].get<std::string>();
    TemplateData data{TemplateData::type::object};
    data.set("version", plain_text(predicate["program"]["version"].get<std::string>()));
    data.set("title", plain_text("Measurement report " + id + ": " +
                                 predicate["attempt"]["id"].get<std::string>()));
    data.set("report_id", plain_text(id));
    data.set("signed", TemplateData(is_signed));
    return data;
}

std::string page_style() {
    return std::string(report_text("template/report.css")) +
           std::string(report_text("uPlot.min.css")) + std::string(report_text("page.css"));
}

/// What runs in the reader's browser: what the page is made of, so that it can make itself again;
/// libraries; then the page's own script.
std::string page_script() {
    const Json parts{{"page", report_text("template/page.html")},
                     {"content", report_text("template/report.html")},
                     {"style", page_style()}};
    std::string script = "\"use strict\";\nconst pageParts = " + report_text_of(parts) + ";\n";
    for (const std::string_view name : page_scripts)
        script += std::string(report_text(name)) + "\n";
    return script;
}

}  // namespace

ReportSigner read_signer(const SignatureText& signature) {
    if (signature.text.starts_with("-----BEGIN SSH SIGNATURE-----")) {
        const SshSignature ssh = parse_ssh_signature(signature.text, signature.file);
        constexpr std::string_view of_runcert = "@runcert";
        const bool ours = ssh.name_space.ends_with(of_runcert);
        return {
            .file = signature.file,
            .key_id = ssh_fingerprint(ssh.key),
            .role = ours ? ssh.name_space.substr(0, ssh.name_space.size() - of_runcert.size()) : "",
            .trusted_comment = ""};
    }
    const SignatureClaims claims = read_signature_claims(signature.text, signature.file);
    return {.file = signature.file,
            .key_id = key_id_text({.key_id = claims.key_id}),
            .role = parse_trusted_comment(claims.trusted_comment).role,
            .trusted_comment = claims.trusted_comment};
}

Json page_parts_json() {
    return {{"template_sha256", sha256_hex(std::string(report_text("template/page.html")) +
                                           std::string(report_text("template/report.html")))},
            {"style_sha256", sha256_hex(page_style())},
            {"script_sha256", sha256_hex(page_script())}};
}

std::string report_page(const std::string& report_text_bytes, const Json& report,
                        const std::vector<std::string>& drawings,
                        const std::vector<SignatureText>& signatures, const std::string& standing) {
    Json files = Json::array();
    for (const SignatureText& signature : signatures)
        files.push_back({{"file", signature.file}, {"text", signature.text}});
    const std::string script = page_script();
    TemplateData data = page_data(report, !signatures.empty());
    data.set("style", page_style());
    data.set("content", content_of(report, drawings, signatures, standing, on_screen));
    data.set("report_json", report_text_bytes);
    data.set("signature_files", report_text_of(files));
    data.set("standing", standing);
    data.set("script", script);
    data.set("script_hash", base64_of_hex(sha256_hex(script)));
    return rendered("template/page.html", data);
}

std::string report_print_page(const Json& report, const std::vector<std::string>& drawings,
                              const std::vector<SignatureText>& signatures,
                              const std::string& standing) {
    TemplateData data = page_data(report, !signatures.empty());
    data.set("style", std::string(report_text("template/report.css")));
    data.set("content", content_of(report, drawings, signatures, standing, on_paper));
    return rendered("template/page.html", data);
}

}  // namespace runcert
