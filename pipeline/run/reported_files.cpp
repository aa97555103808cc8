#include "run/reported_files.h"

#include <nlohmann/json.hpp>

#include "core/failure.h"

namespace runcert {

using Json = nlohmann::ordered_json;

Header reported_files(std::string_view text, const std::string& where) {
    try {
        Header header;
        const Json report = Json::parse(text);
        for (const Json& subject : report.at("subject"))
            header.inputs.push_back({.role = "subject",
                                     .file = subject.at("name").get<std::string>(),
                                     .sha256 = subject.at("digest").at("sha256").get<std::string>(),
                                     .bytes = 0,
                                     .original = {}});
        return header;
    } catch (const Json::exception& fault) {
        throw Failure(where, std::string("this is not a measurement report: ") + fault.what(),
                      "Take the original report, or remove the file and go on without it");
    }
}

}  // namespace runcert
