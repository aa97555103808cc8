#include "run/run_difference.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "files/atomic_file.h"
#include "files/sha256.h"
#include "run/evidence.h"
#include "run/stage_run.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A run folder, and what of it is compared.
struct Run {
    fs::path folder;
    Attempt attempt;
    Json attempt_document;
    std::map<std::string, std::string> evidence;  ///< file to SHA-256, or "missing"
    std::vector<std::string> products;            ///< those that are there
};

constexpr const char* missing = "missing";

std::vector<std::string> evidence_names(const Attempt& attempt) {
    std::vector<std::string> names;
    for (const Receiver& receiver : attempt.receivers) {
        for (const EvidenceFile& file : evidence_files(receiver))
            names.push_back(file.name);
        for (const EvidenceFile& file : solution_files(receiver))
            names.push_back(file.name);
    }
    for (const EvidenceFile& file : flow_files(attempt))
        names.push_back(file.name);
    for (const std::string& claimed : attempt.profiles)
        names.push_back(evidence_profile_file(claimed));
    return names;
}

std::vector<std::string> product_names(const Attempt& attempt) {
    std::vector<std::string> names;
    for (const auto& [stem, extension] :
         {std::pair("1-observations", "ecsv"), std::pair("2-enu", "ecsv"),
          std::pair("3-screened", "ecsv"), std::pair("4-trajectory", "ecsv"),
          std::pair("5-windows", "yaml")})
        for (const Receiver& receiver : attempt.receivers)
            names.push_back(product_file(attempt, receiver, stem, extension));
    names.emplace_back("6-verdict.yaml");
    return names;
}

Run read_run(const fs::path& folder) {
    const fs::path attempt_file = folder / evidence_attempt_file;
    if (!fs::is_directory(folder) || !fs::exists(attempt_file))
        throw Failure(folder.string(), "this is not the folder of a run",
                      "Name two folders that `runcert certify` wrote");
    const std::string text = read_handwritten(attempt_file);
    Run run{.folder = folder,
            .attempt = read_attempt(text, attempt_file.string()),
            .attempt_document = json_from_yaml(
                YamlValue(parse_yaml(text, attempt_file.string()), attempt_file.string())),
            .evidence = {},
            .products = {}};
    run.attempt_document.erase("parameters");
    for (const std::string& name : evidence_names(run.attempt))
        run.evidence[name] =
            fs::exists(folder / name) ? digest_file(folder / name).sha256 : missing;
    for (const std::string& name : product_names(run.attempt))
        if (fs::exists(folder / name)) run.products.push_back(name);
    if (run.products.empty())
        throw Failure(folder.string(), "the folder holds no file of any stage",
                      "Name two folders that `runcert certify` wrote");
    return run;
}

bool holds(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

std::vector<std::string> in_either(const std::vector<std::string>& a,
                                   const std::vector<std::string>& b) {
    std::vector<std::string> names = a;
    for (const std::string& name : b)
        if (!holds(names, name)) names.push_back(name);
    std::ranges::sort(names);
    return names;
}

std::vector<Change> input_changes(const Run& a, const Run& b) {
    std::vector<Change> changes;
    const auto hash = [](const Run& run, const std::string& name) {
        const auto found = run.evidence.find(name);
        return found == run.evidence.end() ? std::string("not named") : found->second;
    };
    auto names = a.evidence;
    names.insert(b.evidence.begin(), b.evidence.end());
    for (const auto& [name, unused] : names)
        if (hash(a, name) != hash(b, name)) changes.push_back({name, hash(a, name), hash(b, name)});
    return changes;
}

std::vector<Change> as_changes(const std::vector<ValueDifference>& values) {
    std::vector<Change> changes;
    for (const ValueDifference& value : values)
        changes.push_back({value.path, value.a, value.b});
    return changes;
}

std::string maker_of(const Json& header) {
    const Json& stage = header.at("stage");
    return fmt::format("runcert {}, source {}", stage.value("version", "unknown"),
                       stage.value("source_revision", "unknown"));
}

/// One product in both runs.
class ProductPair {
  public:
    ProductPair(const Run& a, const Run& b, const std::string& name)
        : name_(name),
          where_a_((a.folder / name).string()),
          where_b_((b.folder / name).string()),
          text_a_(read_file(where_a_)),
          text_b_(read_file(where_b_)),
          header_a_(header_of(text_a_, where_a_)),
          header_b_(header_of(text_b_, where_b_)) {}

    void add_to(RunDifference& difference) const {
        add_makers(difference);
        add_parameters(difference);
        add_results(difference);
    }

  private:
    std::string stage() const { return header_a_.at("stage").value("name", ""); }

    /// Files of the same two programs together.
    void add_makers(RunDifference& difference) const {
        const Change change{name_, maker_of(header_a_), maker_of(header_b_)};
        if (change.a == change.b) return;
        for (Change& known : difference.programs)
            if (known.a == change.a && known.b == change.b) {
                known.what += ", " + name_;
                return;
            }
        difference.programs.push_back(change);
    }

    void add_parameters(RunDifference& difference) const {
        for (Change& change :
             as_changes(value_differences(header_a_.value("parameters", Json::object()),
                                          header_b_.value("parameters", Json::object())))) {
            change.what = fmt::format("{}.{}", stage(), change.what);
            // All receivers' files of a stage hold the same.
            if (std::ranges::find(difference.parameters, change) == difference.parameters.end())
                difference.parameters.push_back(std::move(change));
        }
    }

    void add_results(RunDifference& difference) const {
        ProductDifference product{.file = name_, .stage = stage(), .table = {}, .values = {}};
        if (name_.ends_with(".ecsv")) {
            product.table = compare_tables(text_a_, text_b_, where_a_, where_b_);
            if (stage() == "screen") {
                difference.epochs.push_back(epoch_difference(text_a_, text_b_, where_a_, where_b_));
                difference.epochs.back().receiver = receiver();
            }
        } else {
            const Json a = results_of(text_a_, where_a_);
            const Json b = results_of(text_b_, where_b_);
            product.values = value_differences(a, b);
            const std::string of = " of receiver " + receiver();
            auto& changes = stage() == "window" ? difference.windows : difference.verdicts;
            for (Change& change : stage() == "window" ? window_changes(a, b, is_first() ? "" : of)
                                                      : verdict_changes(a, b))
                changes.push_back(std::move(change));
        }
        difference.products.push_back(std::move(product));
    }

    /// The products of the first receiver do not name it.
    bool is_first() const { return std::ranges::count(name_, '.') == 1; }
    std::string receiver() const {
        const Json results = results_of(text_a_, where_a_);
        return results.value("receiver", "");
    }

    std::string name_, where_a_, where_b_, text_a_, text_b_;
    Json header_a_, header_b_;
};

}  // namespace

std::map<std::string, std::int64_t> EpochDifference::counts() const {
    std::map<std::string, std::int64_t> counted;
    for (const EpochChange& change : changes)
        ++counted[fmt::format("{} -> {}", change.a, change.b)];
    return counted;
}

bool RunDifference::equal() const {
    return programs.empty() && inputs.empty() && parameters.empty() && attempt.empty() &&
           windows.empty() && verdicts.empty() &&
           std::ranges::all_of(epochs, &EpochDifference::equal) &&
           std::ranges::all_of(products, &ProductDifference::equal);
}

RunDifference difference_of_runs(const fs::path& folder_a, const fs::path& folder_b) {
    const Run a = read_run(folder_a);
    const Run b = read_run(folder_b);
    RunDifference difference;
    difference.inputs = input_changes(a, b);
    difference.attempt = as_changes(value_differences(a.attempt_document, b.attempt_document));
    for (const std::string& name : in_either(a.products, b.products)) {
        if (holds(a.products, name) && holds(b.products, name)) {
            ProductPair(a, b, name).add_to(difference);
            continue;
        }
        ProductDifference product{.file = name, .stage = {}, .table = {}, .values = {}};
        (holds(a.products, name) ? product.only_a : product.only_b) = true;
        difference.products.push_back(std::move(product));
    }
    return difference;
}

}  // namespace runcert
