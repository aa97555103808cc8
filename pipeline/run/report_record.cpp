#include "run/report_record.h"

#include <nlohmann/json.hpp>

#include "core/failure.h"

namespace runcert {

using Json = nlohmann::ordered_json;

ReportRecord read_report_record(std::string_view text, const std::string& where) {
    try {
        const Json report = Json::parse(text);
        const Json& predicate = report.at("predicate");
        ReportRecord record;
        record.id = predicate.at("report_id").get<std::string>();
        record.header.stage = "report";
        record.header.schema_name = "report";
        record.header.schema_version = predicate.at("schema").at("version").get<std::string>();
        record.header.program_version = predicate.at("program").at("version").get<std::string>();
        record.header.source_revision =
            predicate.at("program").at("source_revision").get<std::string>();
        for (const Json& subject : report.at("subject"))
            record.header.inputs.push_back(
                {.role = "subject",
                 .file = subject.at("name").get<std::string>(),
                 .sha256 = subject.at("digest").at("sha256").get<std::string>(),
                 .bytes = 0,
                 .original = {}});
        return record;
    } catch (const Json::exception& fault) {
        throw Failure(where, std::string("this is not a measurement report: ") + fault.what(),
                      "Take the original report, or remove the file and go on without it");
    }
}

}  // namespace runcert
