#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/failure.h"
#include "reports/diff/run_difference.h"
#include "reports/diff/table_comparison.h"
#include "run/attempt_files.h"
#include "run/stage_run.h"
#include "run/steps.h"
#include "schemas/common/header.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::string maker_of(const Json& header) {
    const Json& stage = header.at("stage");
    return fmt::format("runcert {}, source {}", stage.value("version", "unknown"),
                       stage.value("source_revision", "unknown"));
}

std::vector<Change> as_changes(const std::vector<ValueDifference>& values) {
    std::vector<Change> changes;
    for (const ValueDifference& value : values)
        changes.push_back({value.path, value.a, value.b});
    return changes;
}

void add_makers(RunCauses& causes, const std::string& product, const Json& header_a,
                const Json& header_b) {
    const Change change{product, maker_of(header_a), maker_of(header_b)};
    if (change.a == change.b) return;
    for (Change& known : causes.programs)
        if (known.a == change.a && known.b == change.b) {
            known.what += ", " + product;
            return;
        }
    causes.programs.push_back(change);
}

void add_parameters(RunCauses& causes, const Json& header_a, const Json& header_b) {
    for (Change& change :
         as_changes(value_differences(header_a.value("parameters", Json::object()),
                                      header_b.value("parameters", Json::object())))) {
        change.what = fmt::format("{}.{}", header_a.at("stage").value("name", ""), change.what);
        if (std::ranges::find(causes.parameters, change) == causes.parameters.end())
            causes.parameters.push_back(std::move(change));
    }
}

/// The lines of a product that hold its header, which comes first: up to the first other member.
std::string header_text(std::string_view product, bool is_table) {
    constexpr std::array<std::string_view, 5> members{"schema", "stage", "inputs", "parameters",
                                                      "attempt"};
    const std::size_t margin = is_table ? 4 : 0;  // "#   schema: ..."
    std::string text;
    if (is_table) {
        constexpr std::string_view begins = "\n# meta:\n";
        const std::size_t meta = product.find(begins);
        product.remove_prefix(meta == std::string_view::npos ? product.size()
                                                             : meta + begins.size());
    }
    while (product.size() > margin) {
        const std::size_t end = std::min(product.find('\n'), product.size());
        const std::string_view line = product.substr(0, end).substr(std::min(margin, end));
        const bool is_key = !line.empty() && line.front() != ' ' && line.front() != '-';
        if (is_key && std::ranges::find(members, line.substr(0, line.find(':'))) == members.end())
            break;
        text.append(line) += '\n';
        product.remove_prefix(std::min(end + 1, product.size()));
    }
    return text;
}

/// The header alone: parsing all that a table says of its columns takes ten times as long.
Json header_in(const RunFolder& run, const std::string& product) {
    const fs::path file = run.folder / product;
    const FileView view(file);
    const std::string text = header_text(view.bytes(), product.ends_with(".ecsv"));
    if (text.empty()) return header_of(view.bytes(), file.string());
    return json_from_yaml(YamlValue(parse_yaml(text, file.string()), file.string()));
}

void add_claims(HashesByName& claims, const Json& header) {
    for (const Json& input : header.value("inputs", Json::array())) {
        const std::string file = input.value("file", "");
        // The attempt is compared key by key, and products are no causes.
        if (file != attempt_copy_name && !is_product_name(file))
            claims[file] = input.value("sha256", "");
    }
}

}  // namespace

RunFolder read_run_folder(const fs::path& folder) {
    const fs::path attempt_file = folder / attempt_copy_name;
    if (!fs::is_directory(folder) || !fs::exists(attempt_file))
        throw Failure(folder.string(), "this is not the folder of a run",
                      "Name two folders that `runcert certify` wrote");
    const std::string text = read_handwritten(attempt_file);
    RunFolder run{.folder = folder,
                  .attempt = read_attempt(text, attempt_file.string()),
                  .attempt_document = json_from_yaml(
                      YamlValue(parse_yaml(text, attempt_file.string()), attempt_file.string()))};
    run.attempt_document.erase("parameters");
    for (const std::string& name : product_files(run.attempt))
        if (fs::exists(folder / name)) run.products.push_back(name);
    if (run.products.empty())
        throw Failure(folder.string(), "the folder holds no file of any stage",
                      "Name two folders that `runcert certify` wrote");
    return run;
}

std::vector<Change> attempt_changes(const RunFolder& a, const RunFolder& b) {
    return as_changes(value_differences(a.attempt_document, b.attempt_document));
}

std::vector<Change> hash_changes(const HashesByName& a, const HashesByName& b, const char* absent) {
    const auto hash = [absent](const HashesByName& hashes, const std::string& name) {
        const auto found = hashes.find(name);
        return found == hashes.end() ? absent : found->second;
    };
    HashesByName names = a;
    names.insert(b.begin(), b.end());
    std::vector<Change> changes;
    for (const auto& [name, unused] : names)
        if (hash(a, name) != hash(b, name)) changes.push_back({name, hash(a, name), hash(b, name)});
    return changes;
}

void add_header_changes(RunCauses& causes, const std::string& product, const Json& header_a,
                        const Json& header_b) {
    add_makers(causes, product, header_a, header_b);
    add_parameters(causes, header_a, header_b);
}

RunCauses causes_between(const fs::path& folder_a, const fs::path& folder_b) {
    const RunFolder a = read_run_folder(folder_a);
    const RunFolder b = read_run_folder(folder_b);
    std::map<std::string, Json> headers_a, headers_b;
    HashesByName claims_a, claims_b;
    for (const std::string& product : a.products)
        add_claims(claims_a, headers_a[product] = header_in(a, product));
    for (const std::string& product : b.products)
        add_claims(claims_b, headers_b[product] = header_in(b, product));
    RunCauses causes;
    causes.inputs = hash_changes(claims_a, claims_b, "not used");
    causes.attempt = attempt_changes(a, b);
    for (const auto& [product, header] : headers_a)
        if (const auto other = headers_b.find(product); other != headers_b.end())
            add_header_changes(causes, product, header, other->second);
    return causes;
}

}  // namespace runcert
