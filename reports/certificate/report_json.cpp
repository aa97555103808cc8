#include "reports/certificate/report_json.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/certificate_document.h"
#include "reports/certificate/json_parts.h"
#include "reports/certificate/report_html.h"
#include "reports/certificate/report_run.h"
#include "schemas/common/document.h"
#include "schemas/common/product_files.h"
#include "schemas/products/products.h"
#include "store/sha256.h"
#include "store/yaml_output.h"
#include "trust/attestation.h"

namespace runcert {
namespace {

constexpr const char* predicate_type = "urn:runcert:measurement-report:1.0";

Json files_json(const std::vector<InputFile>& subjects) {
    Json json = Json::array();
    for (const InputFile& subject : subjects) {
        Json entry{{"file_role", subject.role},
                   {"file", subject.file},
                   {"sha256", subject.sha256},
                   {"bytes", subject.bytes}};
        if (!subject.original.empty() && subject.original != subject.file)
            entry["original"] = subject.original;
        json.push_back(std::move(entry));
    }
    return json;
}

void check_inputs(const ReportInputs& inputs) {
    const auto refuse = [](const std::string& what) {
        throw Failure("report", what, "Run all stages of the attempt again, into an empty folder");
    };
    if (inputs.receivers.empty() || inputs.receivers.size() != inputs.attempt.receivers.size())
        refuse(fmt::format("the run has results of {}, the attempt names {}",
                           inputs.receivers.size(), inputs.attempt.receivers.size()));
    if (inputs.verdict.attempt != inputs.attempt.id)
        refuse(fmt::format("the verdict is on the attempt \"{}\", not on \"{}\"",
                           inputs.verdict.attempt, inputs.attempt.id));
    if (inputs.profiles.size() != inputs.verdict.profiles.size())
        refuse(fmt::format("the verdict is by {} rules, {} were given",
                           inputs.verdict.profiles.size(), inputs.profiles.size()));
    for (std::size_t i = 0; i < inputs.profiles.size(); ++i)
        if (inputs.profiles[i].id != inputs.verdict.profiles[i].profile)
            refuse(fmt::format("the verdict is by the rule \"{}\" where \"{}\" was given",
                               inputs.verdict.profiles[i].profile, inputs.profiles[i].id));
}

/// By a field table, as the stages' products. Three points of a curve stand for all of them.
void check_predicate(Json predicate, const std::string& where) {
    for (Json& figure : predicate["figures"])
        for (Json& curve : figure["curves"])
            for (const char* values : {"x", "y", "lower", "upper"})
                if (curve.contains(values) && curve[values].size() > 3)
                    curve[values].erase(curve[values].begin() + 3, curve[values].end());
    check_document(YamlValue(yaml_node_of(predicate), where), report_field_table());
}

constexpr std::size_t indentation = 2;

bool is_list_of_numbers(const Json& json) {
    return json.is_array() && !json.empty() &&
           std::all_of(json.begin(), json.end(),
                       [](const Json& item) { return item.is_number() || item.is_null(); });
}

std::string one_line(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string out;
    out.reserve(text.size());
    for (const char c : text)
        if (c == '<')
            out += "\\u003c";
        else if (c == '>')
            out += "\\u003e";
        else if (c == '&')
            out += "\\u0026";
        else
            out += c;
    return out;
}

void append(std::string& out, const Json& json, std::size_t depth) {
    if (!json.is_structured() || json.empty() || is_list_of_numbers(json)) {
        out += one_line(json);
        return;
    }
    const std::string indent(indentation * (depth + 1), ' ');
    const bool object = json.is_object();
    out += object ? "{\n" : "[\n";
    bool first = true;
    for (const auto& [key, value] : json.items()) {
        if (!first) out += ",\n";
        first = false;
        out += indent;
        if (object) out += one_line(Json(key)) + ": ";
        append(out, value, depth + 1);
    }
    out += '\n' + std::string(indentation * depth, ' ') + (object ? '}' : ']');
}

}  // namespace

std::string report_id(const std::vector<InputFile>& subjects) {
    std::string lines;
    for (const InputFile& subject : subjects)
        lines += fmt::format("{}  {}\n", subject.sha256, subject.file);
    return sha256_hex(lines).substr(0, 16);
}

Json report_json(ReportInputs inputs) {
    check_inputs(inputs);
    Json predicate;
    predicate["schema"] = {{"name", report_field_table().name()},
                           {"version", report_field_table().version()}};
    predicate["report_id"] = report_id(inputs.files);
    predicate["program"] = {{"name", "runcert"},
                            {"version", program_version()},
                            {"source_revision", source_revision()},
                            {"arithmetic", arithmetic_fingerprint()}};
    Json& files = predicate["program"]["files"] = Json::array();
    for (const ProgramFile& program : program_files())
        files.push_back({{"name", program.name}, {"sha256", program.sha256}});
    if (const std::string home = program_home(); !home.empty()) predicate["program"]["home"] = home;
    predicate["signatures_required"] = signatures_required_json(inputs);
    predicate["certificate"] = certificate_json(inputs, predicate["report_id"].get<std::string>());
    if (Json amends = amends_json(inputs.attempt); !amends.is_null())
        predicate["amends"] = std::move(amends);
    predicate["attempt"] = {{"id", inputs.attempt.id},
                            {"craft_name", inputs.attempt.craft.name},
                            {"craft_class", inputs.attempt.craft.kind}};
    predicate["verdict"] =
        body_of(inputs.verdict_text.empty() ? write_verdict(inputs.verdict) : inputs.verdict_text,
                std::string(products::verdict_file));
    round_to_table(predicate, report_field_table());
    predicate["figures"] = Json::array();
    const auto document = [&] {
        return members_json(certificate_document(inputs, predicate["report_id"].get<std::string>(),
                                                 predicate["figures"]));
    };
    predicate["document"] = document();
    // What second files change is shown in another document.
    if (!inputs.verdict.with_files.empty()) {
        inputs.exchange_with_files();
        predicate["with_files"]["document"] = document();
    }
    predicate["page"] = page_parts_json();
    predicate["files"] = files_json(inputs.files);
    check_predicate(predicate, "report");

    Json statement{{"_type", statement_type}, {"subject", Json::array()}};
    for (const InputFile& subject : inputs.files)
        statement["subject"].push_back(
            {{"name", subject.file}, {"digest", {{"sha256", subject.sha256}}}});
    statement["predicateType"] = predicate_type;
    statement["predicate"] = std::move(predicate);
    return statement;
}

Json parse_report(const std::string& text, const std::string& where) {
    Json report = Json::parse(text, nullptr, false);
    if (!report.is_object() || !report.contains("predicate") ||
        !report.at("predicate").is_object() ||
        report.value("predicateType", Json()) != Json(predicate_type))
        throw Failure(where, "this is not a measurement report of this program's version",
                      "Give the report.json of a run folder, or certify the recording again");
    check_predicate(report.at("predicate"), where);
    return report;
}

std::string report_text_of(const Json& report) {
    std::string out;
    append(out, report, 0);
    return out + '\n';
}

}  // namespace runcert
