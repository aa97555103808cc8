#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "schemas/day_results/day_results.h"
#include "schemas/difference/declared.h"
#include "schemas/document/document.h"

namespace runcert {

/// A speed has moved where it differs by more than this part of the smaller standard uncertainty,
/// an uncertainty where it differs by more than this part of itself.
inline constexpr double moved_fraction_of_uncertainty = 0.1;

/// Compares two days' folders by their day.yaml; causes come from the run folders of those attempts
/// whose results changed. Failure where a folder holds no day.yaml, or one that cannot be read.
DayComparison compare_days(const std::filesystem::path& old_out,
                           const std::filesystem::path& new_out);

/// The results alone, without causes.
DayComparison compare_results(const DayResults& old_day, const DayResults& new_day);

/// For people: what is the same, then every difference and why. Lists are cut at 20 unless `all`;
/// attempts that changed for the same reasons stand together.
Document comparison_document(const DayComparison& comparison, const std::filesystem::path& old_out,
                             const std::filesystem::path& new_out, bool all = false);

/// For machines, complete.
nlohmann::ordered_json comparison_json(const DayComparison& comparison);

}  // namespace runcert
