#include "sbom.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "components.h"
#include "store/external_program.h"
#include "store/program.h"
#include "store/sha256.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* unknown = "NOASSERTION";

std::string identifier(std::string_view name) {
    std::string id = "SPDXRef-";
    for (const char c : name)
        id += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' ? c : '-';
    return id;
}

/// Adds a package, and how it relates to the project's.
class Packages {
  public:
    explicit Packages(Json& document) : document_(document) {}

    void add(std::string_view name, const std::string& version, std::string_view licence,
             std::string_view home, const std::string& sha256, const char* relation) {
        Json package{{"name", name},
                     {"SPDXID", identifier(name)},
                     {"downloadLocation", home.empty() ? unknown : home},
                     {"filesAnalyzed", false},
                     {"licenseConcluded", licence},
                     {"licenseDeclared", licence},
                     {"copyrightText", unknown}};
        if (!version.empty()) package["versionInfo"] = version;
        if (!sha256.empty())
            package["checksums"] = {{{"algorithm", "SHA256"}, {"checksumValue", sha256}}};
        document_["packages"].push_back(std::move(package));
        const bool outside = relation == std::string_view("RUNTIME_DEPENDENCY_OF");
        const std::string one = identifier(name), project = identifier("runcert-sources");
        document_["relationships"].push_back({{"spdxElementId", outside ? one : project},
                                              {"relationshipType", relation},
                                              {"relatedSpdxElement", outside ? project : one}});
    }

  private:
    Json& document_;
};

}  // namespace

std::string sbom_text() {
    Json document{{"spdxVersion", "SPDX-2.3"},
                  {"dataLicense", "CC0-1.0"},
                  {"SPDXID", "SPDXRef-DOCUMENT"},
                  {"name", fmt::format("runcert {}", program_version())},
                  {"documentNamespace", ""},
                  {"creationInfo",
                   {{"created", source_time()},
                    {"creators", {fmt::format("Tool: runcert-{}", program_version())}},
                    {"comment", "created is the time of the sources' last change"}}},
                  {"packages", Json::array()},
                  {"relationships", Json::array()}};
    Packages packages(document);
    const std::string version = fmt::format("{} {}", program_version(), source_revision());
    packages.add("runcert-sources", version, "Apache-2.0", program_home(), "", "DESCRIBES");
    document["relationships"][0]["spdxElementId"] = "SPDXRef-DOCUMENT";
    for (const ProgramFile& program : program_files())
        packages.add(program.name, version, "Apache-2.0", "", program.sha256, "GENERATES");
    for (const Component& one : components)
        packages.add(one.name, std::string(one.version), one.licence, one.home, "", "DEPENDS_ON");
    for (const ExternalProgram& one : external_programs())
        if (const std::string sha256 = external_program_sha256(one.name); !sha256.empty())
            packages.add(one.name, "", unknown, "", sha256, "RUNTIME_DEPENDENCY_OF");
    // Names the contents, without a clock.
    document["documentNamespace"] = "urn:sha256:" + sha256_hex(document.dump());
    return document.dump(2) + "\n";
}

}  // namespace runcert
