#include "reports/diff/run_difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "reports/diff/table_comparison.h"
#include "run/attempt_files.h"
#include "run/stage_run.h"
#include "store/atomic_file.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<std::string> attempt_file_names(const Attempt& attempt) {
    std::vector<std::string> names;
    for (const Receiver& receiver : attempt.receivers) {
        for (const AttemptFile& file : files_of_receiver(receiver))
            names.push_back(file.name);
        for (const AttemptFile& file : solution_files(receiver))
            names.push_back(file.name);
    }
    for (const AttemptFile& file : series_files(attempt))
        names.push_back(file.name);
    for (const std::string& claimed : attempt.profiles)
        names.push_back(profile_copy_name(claimed));
    return names;
}

HashesByName hashes_of(const RunFolder& run) {
    HashesByName hashes;
    for (const std::string& name : attempt_file_names(run.attempt))
        hashes[name] =
            fs::exists(run.folder / name) ? digest_file(run.folder / name).sha256 : "missing";
    return hashes;
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

/// One product in both runs.
class ProductPair {
  public:
    ProductPair(const RunFolder& a, const RunFolder& b, const std::string& name)
        : name_(name),
          where_a_((a.folder / name).string()),
          where_b_((b.folder / name).string()),
          text_a_(read_file(where_a_)),
          text_b_(read_file(where_b_)),
          header_a_(header_of(text_a_, where_a_)),
          header_b_(header_of(text_b_, where_b_)) {}

    void add_to(RunDifference& difference) const {
        add_header_changes(difference.causes, name_, header_a_, header_b_);
        add_results(difference);
    }

  private:
    std::string stage() const { return header_a_.at("stage").value("name", ""); }

    void add_results(RunDifference& difference) const {
        ProductDifference product{.file = name_};
        if (name_.ends_with(".ecsv")) {
            product.table = compare_tables(text_a_, text_b_, where_a_, where_b_);
            if (stage() == "screen")
                difference.epochs
                    .emplace_back(epoch_difference(text_a_, text_b_, where_a_, where_b_))
                    .receiver = receiver();
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

RunDifference difference_of_runs(const fs::path& folder_a, const fs::path& folder_b) {
    const RunFolder a = read_run_folder(folder_a);
    const RunFolder b = read_run_folder(folder_b);
    RunDifference difference;
    difference.causes.inputs = hash_changes(hashes_of(a), hashes_of(b), "not named");
    difference.causes.attempt = attempt_changes(a, b);
    for (const std::string& name : in_either(a.products, b.products)) {
        if (holds(a.products, name) && holds(b.products, name)) {
            ProductPair(a, b, name).add_to(difference);
            continue;
        }
        difference.products.push_back(
            {.file = name, .missing_in = holds(a.products, name) ? "b" : "a"});
    }
    return difference;
}

}  // namespace runcert
