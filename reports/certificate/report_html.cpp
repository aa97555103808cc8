#include "reports/certificate/report_html.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <qrcodegen/qrcodegen.hpp>
#include <set>

#include "core/text.h"
#include "reports/certificate/report_json.h"
#include "reports/document/document_html.h"
#include "reports/plot/plot.h"
#include "store/base64.h"
#include "store/sha256.h"
#include "trust/signature.h"
#include "trust/ssh_signature.h"

namespace runcert {

std::string_view report_text(std::string_view name);

using Json = nlohmann::ordered_json;

namespace {

/// Libraries first; last `page.js`, which starts the page.
constexpr std::string_view page_scripts[] = {
    "noble-hashes.min.js", "uPlot.iife.min.js", "signatures.js", "self_check.js",
    "elements.js",         "tables.js",         "chart_data.js", "chart_parts.js",
    "chart_drawing.js",    "charts.js",         "page.js"};

Json signers_json(const std::vector<SignatureFile>& signatures) {
    Json list = Json::array();
    for (const SignatureFile& signature : signatures) {
        const ReportSigner signer = read_signer(signature);
        list.push_back({{"file", signer.file},
                        {"key_id", signer.key_id},
                        {"role", signer.role},
                        {"signed_at", signer.time}});
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

/// The code that leads from paper to report.json: its id and SHA-256, as squares of one path.
std::string code_image(const std::string& report_id, const std::string& report_sha256) {
    using qrcodegen::QrCode;
    const QrCode code = QrCode::encodeText(
        upper_case(fmt::format("RUNCERT {} {}", report_id, report_sha256)).c_str(),
        QrCode::Ecc::MEDIUM);
    constexpr int border = 4;  // light modules around it (ISO/IEC 18004)
    std::string path;
    for (int y = 0; y < code.getSize(); ++y)
        for (int x = 0; x < code.getSize(); ++x)
            if (code.getModule(x, y)) path += fmt::format("M{},{}h1v1h-1z", x + border, y + border);
    const int side = code.getSize() + 2 * border;
    return fmt::format(
        "<svg width=\"{0}\" height=\"{0}\" viewBox=\"0 0 {0} {0}\" role=\"img\" aria-label=\"Code "
        "of the report's "
        "id and hash\"><path d=\"{1}\" fill=\"#000000\"></path></svg>",
        side, path);
}

/// Puts what was answered since in its places.
void fill_slots(Json& document, const Json& slots) {
    for (Json& section : document["sections"])
        for (Json& block : section["blocks"])
            if (block.contains("slot"))
                if (const auto now = slots.find(block["slot"].get<std::string>());
                    now != slots.end())
                    block = *now;
}

/// Where the program that made the report is to be had, if that was said.
std::string program_words(const Json& program) {
    const std::string home = program.value("home", "");
    return home.empty() ? home
                        : fmt::format("The program is at {} (version {}, source {}).", home,
                                      program["version"].get<std::string>(),
                                      program["source_revision"].get<std::string>());
}

/// The inside of the page's <main>: what stands in the report, drawn.
std::string content_of(const std::string& report_text_bytes, const Json& report,
                       const std::vector<SignatureFile>& signatures, const std::string& standing,
                       Medium medium, bool first_page_alone = false) {
    const Json& predicate = report["predicate"];
    const Json answered = Json::parse(standing);
    const Json& shown = answered.value("with_files", false) ? predicate["with_files"] : predicate;
    Json document = shown["document"];
    if (first_page_alone)
        document["sections"].erase(document["sections"].begin() + 1, document["sections"].end());
    fill_slots(document, answered.value("slots", Json::object()));
    draw_plots(document, read_plots(predicate["figures"], "report.json"));
    const std::string sha256 = sha256_hex(report_text_bytes);
    Json beside{{"signed", !signatures.empty()}, {"signers", signers_json(signatures)}};
    beside["missing_signatures"] = missing_signatures_json(predicate, beside["signers"]);
    beside["report_sha256"] = sha256;
    beside["program_words"] = program_words(predicate["program"]);
    beside["code_image"] = code_image(predicate["report_id"].get<std::string>(), sha256);
    return sections_html(document, beside, medium);
}

/// What the head of every page holds.
TemplateData page_data(const Json& report, const std::vector<SignatureFile>& signatures) {
    const Json& predicate = report["predicate"];
    const std::string id = predicate["report_id"].get<std::string>();
    TemplateData data{TemplateData::type::object};
    data.set("version", plain_text(predicate["program"]["version"].get<std::string>()));
    data.set("title", plain_text("Measurement report " + id + ": " +
                                 predicate["attempt"]["id"].get<std::string>()));
    data.set("report_id", plain_text(id));
    data.set("subtitle", plain_text(predicate["document"].value("subtitle", "")));
    data.set("signed", TemplateData(!signatures.empty()));
    std::string issued;  // no clock enters: the earliest time that a signer states
    for (const SignatureFile& signature : signatures) {
        const std::string time = read_signer(signature).time;
        if (!time.empty() && (issued.empty() || time < issued)) issued = time;
    }
    data.set("issued", issued.empty() ? TemplateData(false) : TemplateData(plain_text(issued)));
    return data;
}

std::string page_style() {
    return std::string(document_style()) + std::string(report_text("uPlot.min.css")) +
           std::string(report_text("page.css"));
}

/// What runs in the reader's browser: libraries, then the page's own script.
std::string page_script() {
    std::string script = "\"use strict\";\n";
    for (const std::string_view name : page_scripts)
        script += std::string(report_text(name)) + "\n";
    return script;
}

}  // namespace

ReportSigner read_signer(const SignatureFile& signature) {
    if (signature.text.starts_with("-----BEGIN SSH SIGNATURE-----")) {
        const SshSignature ssh = parse_ssh_signature(signature.text, signature.name);
        constexpr std::string_view of_runcert = "@runcert";
        const bool ours = ssh.name_space.ends_with(of_runcert);
        return {
            .file = signature.name,
            .key_id = ssh_fingerprint(ssh.key),
            .role = ours ? ssh.name_space.substr(0, ssh.name_space.size() - of_runcert.size()) : "",
            .time = ""};
    }
    const SignatureClaims claims = read_signature_claims(signature.text, signature.name);
    return {.file = signature.name,
            .key_id = key_id_text({.key_id = claims.key_id}),
            .role = parse_trusted_comment(claims.trusted_comment).role,
            .time = parse_trusted_comment(claims.trusted_comment).signed_at};
}

Json page_parts_json() {
    return {{"drawing_sha256", drawing_fingerprint()},
            {"template_sha256", sha256_hex(std::string(report_text("template/page.html")) +
                                           std::string(sections_template()))},
            {"style_sha256", sha256_hex(page_style())},
            {"script_sha256", sha256_hex(page_script())}};
}

std::string report_page(const std::string& report_text_bytes, const Json& report,
                        const std::vector<SignatureFile>& signatures, const std::string& standing) {
    Json files = Json::array();
    for (const SignatureFile& signature : signatures)
        files.push_back({{"file", signature.name}, {"text", signature.text}});
    const std::string script = page_script();
    TemplateData data = page_data(report, signatures);
    data.set("style", page_style());
    data.set("content",
             content_of(report_text_bytes, report, signatures, standing, Medium::screen));
    data.set("report_json", report_text_bytes);
    data.set("signature_files", report_text_of(files));
    data.set("standing", standing);
    data.set("script", script);
    data.set("script_hash", base64_of_hex(sha256_hex(script)));
    return rendered(report_text("template/page.html"), data);
}

std::string report_print_page(const std::string& report_text_bytes, const Json& report,
                              const std::vector<SignatureFile>& signatures,
                              const std::string& standing, bool first_page_alone) {
    TemplateData data = page_data(report, signatures);
    data.set("style", std::string(document_style()));
    data.set("content", content_of(report_text_bytes, report, signatures, standing, Medium::paper,
                                   first_page_alone));
    return rendered(report_text("template/page.html"), data, Medium::paper);
}

}  // namespace runcert
