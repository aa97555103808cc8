#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
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

constexpr std::array<std::string_view, 3> compared_members{"stage", "inputs", "parameters"};

/// The lines of a map in block style that hold these members, at the text's own margin. Lines of a
/// member are those below its key that stand deeper, or begin a list's item at its place.
class MemberLines {
  public:
    /// Takes the next line of the text; false where the map is at its end.
    bool take(std::string_view line) {
        const std::size_t indent = line.find_first_not_of(' ');
        if (indent == std::string_view::npos) return true;
        if (!margin_) margin_ = indent;
        if (indent < *margin_) return false;
        if (indent == *margin_ && line[indent] != '-') {
            const std::string_view key = line.substr(indent, line.find(':') - indent);
            wanted_ = std::ranges::find(compared_members, key) != compared_members.end();
            if (wanted_) ++found_;
        }
        if (wanted_) text_.append(line.substr(*margin_)) += '\n';
        return true;
    }
    /// The members, where each was found once.
    std::optional<std::string> text() const {
        return found_ == compared_members.size() ? std::optional(text_) : std::nullopt;
    }

  private:
    std::optional<std::size_t> margin_;
    bool wanted_ = false;
    std::size_t found_ = 0;
    std::string text_;
};

/// The header's members, cut out of a product; nothing where it is laid out otherwise.
std::optional<std::string> header_text(std::string_view product, bool is_table) {
    MemberLines members;
    bool inside = !is_table;
    while (!product.empty()) {
        const std::size_t end = product.find('\n');
        std::string_view line = product.substr(0, end);
        product.remove_prefix(end == std::string_view::npos ? product.size() : end + 1);
        if (is_table) {
            if (!line.starts_with("# ")) break;
            line.remove_prefix(2);
            if (!inside) {
                inside = line == "meta:";
                continue;
            }
        }
        if (!members.take(line)) break;
    }
    return members.text();
}

/// The header alone: parsing all that a table says of its columns takes ten times as long.
Json header_in(const RunFolder& run, const std::string& product) {
    const fs::path file = run.folder / product;
    const FileView view(file);
    const auto text = header_text(view.bytes(), product.ends_with(".ecsv"));
    if (!text) return header_of(view.bytes(), file.string());
    return json_from_yaml(YamlValue(parse_yaml(*text, file.string()), file.string()));
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
