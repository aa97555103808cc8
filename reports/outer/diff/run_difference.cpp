#include "reports/diff/run_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/failure.h"
#include "reports/comparison/table_comparison.h"
#include "run/attempt_files.h"
#include "run/steps.h"
#include "schemas/common/header.h"
#include "schemas/products/products.h"
#include "store/atomic_file.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct RunFolder {
    fs::path folder;
    Attempt attempt;
    Json claims;                                     ///< the attempt, but for its parameters
    std::map<std::string, ProductParts> products{};  ///< those that are there
};

RunFolder read_run_folder(const fs::path& folder) {
    const fs::path file = folder / attempt_copy_name;
    if (!fs::is_directory(folder) || !fs::exists(file))
        throw Failure(folder.string(), "this is not the folder of a run",
                      "Name two folders that `runcert certify` wrote");
    const std::string text = read_handwritten(file);
    RunFolder run{
        .folder = folder,
        .attempt = read_attempt(text, file.string()),
        .claims = json_from_yaml(YamlValue(parse_yaml(text, file.string()), file.string()))};
    run.claims.erase("parameters");
    for (const std::string& name : product_files(run.attempt))
        if (const fs::path product = folder / name; fs::exists(product))
            run.products[name] = parts_of(FileView(product).bytes(), product.string());
    if (run.products.empty())
        throw Failure(folder.string(), "the folder holds no file of any stage",
                      "Name two folders that `runcert certify` wrote");
    return run;
}

/// Whether a file was handed in: the attempt is compared key by key, and products are no causes.
bool is_input(const std::string& file) {
    return file != attempt_copy_name && !is_product_name(file);
}

/// SHA-256 of the inputs by their names, as the headers claim them.
Json claimed_hashes(const RunFolder& run) {
    Json hashes = Json::object();
    for (const auto& [name, product] : run.products)
        for (const Json& input : product.header.value("inputs", Json::array()))
            if (const std::string file = text_in(&input, "file"); is_input(file))
                hashes[file] = text_in(&input, "sha256");
    return hashes;
}

/// Of the files in the folder.
Json file_hashes(const RunFolder& run) {
    Json hashes = Json::object();
    for (const std::string& name : inventory_of(run.attempt).files)
        if (const fs::path file = run.folder / name; is_input(name))
            hashes[name] = fs::exists(file) ? digest_file(file).sha256 : "missing";
    return hashes;
}

std::vector<Change> hash_changes(const Json& a, const Json& b, const std::string& absent) {
    const auto hash = [&](const Json* value) {
        return value == nullptr ? absent : value->get<std::string>();
    };
    std::vector<Change> changes;
    for (const TreeDifference& file : tree_differences(a, b))
        changes.push_back({file.path, hash(file.a), hash(file.b)});
    std::ranges::sort(changes, {}, &Change::what);
    return changes;
}

std::vector<Change> as_changes(const std::string& of, const Json& a, const Json& b) {
    std::vector<Change> changes;
    for (const ValueDifference& value : value_differences(a, b))
        changes.push_back({of + value.path, value.a, value.b});
    return changes;
}

/// Adds what the headers of a product say of its programs and parameters. Files of the same two
/// programs stand together; what the files of all receivers say stands once.
void add_header_changes(RunCauses& causes, const std::string& product, const Json& a,
                        const Json& b) {
    if (const Change made{product, maker_of(a), maker_of(b)}; made.a != made.b) {
        const auto known = std::ranges::find_if(causes.programs, [&](const Change& change) {
            return change.a == made.a && change.b == made.b;
        });
        if (known == causes.programs.end())
            causes.programs.push_back(made);
        else
            known->what += ", " + product;
    }
    for (Change& change :
         as_changes(text_in(member_of(&a, "stage"), "name") + ".",
                    a.value("parameters", Json::object()), b.value("parameters", Json::object())))
        if (std::ranges::find(causes.parameters, change) == causes.parameters.end())
            causes.parameters.push_back(std::move(change));
}

RunCauses causes_of(const RunFolder& a, const RunFolder& b, std::vector<Change> inputs) {
    RunCauses causes{.inputs = std::move(inputs), .attempt = as_changes("", a.claims, b.claims)};
    for (const auto& [name, product] : a.products)
        if (const auto other = b.products.find(name); other != b.products.end())
            add_header_changes(causes, name, product.header, other->second.header);
    return causes;
}

/// What became of the epoch at hand.
std::string epoch_state(const EcsvReader& table) {
    const std::size_t reason = column_of(table, "reason");
    const std::size_t before = column_of(table, "break_before");
    return (table.boolean(column_of(table, "usable")) ? "used"
                                                      : "left out: " + table.text(reason)) +
           (table.is_missing(before) ? "" : fmt::format("; {} before it", table.text(before)));
}

/// Compares a table that both runs have; of a screened one its epochs, too.
TableComparison table_difference(RunDifference& difference, const std::string& name,
                                 const RunFolder& a, const RunFolder& b) {
    const fs::path file_a = a.folder / name, file_b = b.folder / name;
    EpochDifference epochs{.receiver = text_in(&a.products.at(name).results, "receiver")};
    const bool screened = name.starts_with(products::screened.stem);
    const DifferentRow note = [&](const JoinedRow& row, const EcsvReader& in_a,
                                  const EcsvReader& in_b) {
        if (!screened) return;
        if (std::string one = epoch_state(in_a), other = epoch_state(in_b); one != other)
            epochs.changes.push_back({row, std::move(one), std::move(other)});
    };
    TableComparison table =
        compare_tables(FileView(file_a).bytes(), FileView(file_b).bytes(), file_a.string(),
                       file_b.string(), {.declared = &product_fields(name)}, note);
    epochs.rows_a = table.rows_a;
    epochs.rows_b = table.rows_b;
    epochs.joined = table.joined;
    if (screened) difference.epochs.push_back(std::move(epochs));
    return table;
}

/// The same of a document: its values, and what people ask of it first.
std::vector<ValueDifference> document_difference(RunDifference& difference, const std::string& name,
                                                 const Json& a, const Json& b) {
    if (name == products::verdict_file) {
        difference.verdicts = verdict_changes(a, b);
    } else {
        const bool of_first = name == products::windows_file;
        std::ranges::move(
            window_changes(a, b, of_first ? "" : " of receiver " + text_in(&a, "receiver")),
            std::back_inserter(difference.windows));
    }
    return value_differences(a, b, {.declared = &product_fields(name)});
}

}  // namespace

std::map<std::string, std::int64_t> EpochDifference::counts() const {
    std::map<std::string, std::int64_t> counted;
    for (const EpochChange& change : changes)
        ++counted[fmt::format("{} -> {}", change.a, change.b)];
    return counted;
}

bool EpochDifference::equal() const {
    return changes.empty() && joined == rows_a && joined == rows_b;
}

bool ProductDifference::equal() const {
    return missing_in.empty() && values.empty() && (!table || table->equal());
}

bool RunCauses::none() const {
    return *this == RunCauses();
}

bool RunDifference::equal() const {
    return causes.none() && windows.empty() && verdicts.empty() &&
           std::ranges::all_of(epochs, &EpochDifference::equal) &&
           std::ranges::all_of(products, &ProductDifference::equal);
}

RunCauses causes_between(const fs::path& folder_a, const fs::path& folder_b) {
    const RunFolder a = read_run_folder(folder_a), b = read_run_folder(folder_b);
    return causes_of(a, b, hash_changes(claimed_hashes(a), claimed_hashes(b), "not used"));
}

RunDifference difference_of_runs(const fs::path& folder_a, const fs::path& folder_b) {
    const RunFolder a = read_run_folder(folder_a), b = read_run_folder(folder_b);
    RunDifference difference{
        .causes = causes_of(a, b, hash_changes(file_hashes(a), file_hashes(b), "not named"))};
    std::map<std::string, ProductParts> in_either = a.products;
    in_either.insert(b.products.begin(), b.products.end());
    for (const auto& [name, product] : in_either) {
        ProductDifference& found =
            difference.products.emplace_back(ProductDifference{.file = name});
        if (!a.products.contains(name) || !b.products.contains(name))
            found.missing_in = a.products.contains(name) ? "b" : "a";
        else if (name.ends_with(".ecsv"))
            found.table = table_difference(difference, name, a, b);
        else
            found.values =
                document_difference(difference, name, product.results, b.products.at(name).results);
    }
    return difference;
}

Json difference_json(const RunDifference& difference) {
    Json json{{"schema", "run-difference/1.0"}};
    json.update(members_json(difference));
    return json;
}

}  // namespace runcert
