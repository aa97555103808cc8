#include "recompute.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "files/atomic_file.h"
#include "files/ecsv.h"
#include "files/process.h"
#include "files/yaml_output.h"
#include "run/chain.h"
#include "schemas/common/header.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double fraction_of_uncertainty = 1e-3;

/// For each column of a table, the column that holds its standard uncertainty.
std::vector<std::optional<std::size_t>> sigma_columns(const std::vector<EcsvColumn>& columns) {
    std::vector<std::optional<std::size_t>> sigmas(columns.size());
    for (std::size_t i = 0; i < columns.size(); ++i)
        for (std::size_t j = 0; j < columns.size(); ++j) {
            // The speeds by other methods share the smoothed speed's uncertainty.
            const std::string name =
                columns[i].name.starts_with("speed_") ? "speed" : columns[i].name;
            if (columns[j].name == "sigma_" + name) sigmas[i] = j;
        }
    return sigmas;
}

std::optional<std::string> cell_difference(const EcsvReader& old_row, const EcsvReader& new_row,
                                           std::size_t i, std::optional<std::size_t> sigma) {
    const EcsvColumn& column = old_row.columns()[i];
    if (old_row.is_missing(i) || new_row.is_missing(i)) {
        if (old_row.is_missing(i) == new_row.is_missing(i)) return std::nullopt;
    } else if (column.type != CellType::real) {
        if (old_row.text(i) == new_row.text(i)) return std::nullopt;
    } else {
        double tolerance = 1.01 * std::pow(10.0, -column.decimals);
        if (sigma && !old_row.is_missing(*sigma))
            tolerance = std::max(tolerance, fraction_of_uncertainty * old_row.real(*sigma));
        if (std::abs(old_row.real(i) - new_row.real(i)) <= tolerance) return std::nullopt;
    }
    return fmt::format("line {}, column {}: {} in the folder, {} recomputed", old_row.line(),
                       column.name, old_row.is_missing(i) ? "empty" : old_row.text(i),
                       new_row.is_missing(i) ? "empty" : new_row.text(i));
}

std::optional<std::string> table_difference(const std::string& old_text,
                                            const std::string& new_text) {
    EcsvReader old_table(old_text, "folder");
    EcsvReader new_table(new_text, "recomputed");
    const auto& columns = old_table.columns();
    if (columns.size() != new_table.columns().size()) return "the columns are others";
    const auto sigmas = sigma_columns(columns);
    while (true) {
        const bool more = old_table.next_row();
        if (more != new_table.next_row()) return "the number of rows is another";
        if (!more) return std::nullopt;
        for (std::size_t i = 0; i < columns.size(); ++i)
            if (auto difference = cell_difference(old_table, new_table, i, sigmas[i]))
                return difference;
    }
}

std::optional<std::string> value_difference(const Json& a, const Json& b, const std::string& path,
                                            double tolerance) {
    if (a.is_number() && b.is_number()) {
        if (std::abs(a.get<double>() - b.get<double>()) <= tolerance) return std::nullopt;
    } else if (a.is_object() && b.is_object() && a.size() == b.size()) {
        if (a.contains("standard_uncertainty_m_s"))
            tolerance = std::max(
                tolerance, fraction_of_uncertainty * a["standard_uncertainty_m_s"].get<double>());
        for (const auto& [key, value] : a.items()) {
            if (!b.contains(key)) return path + key + ": missing when recomputed";
            if (auto difference = value_difference(value, b[key], path + key + ".", tolerance))
                return difference;
        }
        return std::nullopt;
    } else if (a.is_array() && b.is_array() && a.size() == b.size()) {
        for (std::size_t i = 0; i < a.size(); ++i)
            if (auto difference =
                    value_difference(a[i], b[i], fmt::format("{}{}.", path, i), tolerance))
                return difference;
        return std::nullopt;
    } else if (a == b) {
        return std::nullopt;
    }
    return fmt::format("{}: {} in the folder, {} recomputed", path.substr(0, path.size() - 1),
                       a.dump(), b.dump());
}

std::optional<std::string> document_difference(const std::string& old_text,
                                               const std::string& new_text) {
    Json documents[2];
    const std::string* texts[2] = {&old_text, &new_text};
    for (int i = 0; i < 2; ++i) {
        documents[i] = json_from_yaml(YamlValue(parse_yaml(*texts[i], "document"), "document"));
        // Who made it, and from which bytes, may differ where the numbers agree.
        documents[i].erase("stage");
        documents[i].erase("inputs");
    }
    return value_difference(documents[0], documents[1], "", 1.01e-4);
}

std::vector<std::string> products_of(const fs::path& run_dir) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        const std::string name = entry.path().filename().string();
        if (name.size() > 2 && name[0] >= '1' && name[0] <= '6' && name[1] == '-')
            names.push_back(name);
    }
    std::sort(names.begin(), names.end());
    return names;
}

}  // namespace

VerificationStep verify_recomputation(const fs::path& run_dir) {
    VerificationStep step{.passed = true, .what = "recompute", .finding = {}, .details = {}};
    const TemporaryFolder folder;
    try {
        run_stages(run_dir / "attempt.yaml", folder.path(), run_dir, [](const StageDone&) {});
    } catch (const StageFailed& failed) {
        step.passed = false;
        step.finding = "the stages cannot be run on the folder's files";
        step.details.push_back(failed.name + ": " + failed.errors);
        return step;
    }
    std::size_t identical = 0;
    const std::vector<std::string> names = products_of(folder.path());
    for (const std::string& name : names) {
        const std::string recomputed = read_file(folder.path() / name);
        const std::string original = fs::exists(run_dir / name) ? read_file(run_dir / name) : "";
        if (recomputed == original) {
            ++identical;
            continue;
        }
        const auto difference = original.empty() ? std::optional<std::string>("missing")
                                : name.ends_with(".ecsv")
                                    ? table_difference(original, recomputed)
                                    : document_difference(original, recomputed);
        if (!difference) continue;
        step.passed = false;
        step.details.push_back(name + ": " + *difference);
    }
    if (!step.passed)
        step.finding =
            "recomputation gives other results; the first differing stage is named first";
    else if (identical == names.size())
        step.finding = fmt::format("identical: all {} stage files, byte for byte", identical);
    else
        step.finding = fmt::format("equal within tolerance; {} of {} stage files byte for byte",
                                   identical, names.size());
    return step;
}

}  // namespace runcert
