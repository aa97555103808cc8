#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reports/diff/run_difference.h"
#include "schemas/day_results/day_results.h"

namespace runcert {

/// A speed has moved where it differs by more than this part of the smaller standard uncertainty,
/// an uncertainty where it differs by more than this part of itself.
inline constexpr double moved_fraction_of_uncertainty = 0.1;

/// An attempt that is processed in one of two days and not in the other, or fails otherwise.
struct StateChange {
    std::string id;
    std::string old_state, new_state;  ///< "done", "failed", "not_processed"
    std::optional<DayFailure> old_failure = {}, new_failure = {};
};

/// What one rule says of an attempt, now and then.
struct ResultChange {
    std::string id;
    std::string profile;
    /// Empty where the rule was, or is, not claimed.
    std::optional<DayResult> old_result = {}, new_result = {};
    bool outcome_changed = false;
    bool speed_moved = false;
    bool uncertainty_moved = false;
    /// New less old speed, as a part of the smaller standard uncertainty.
    std::optional<double> moved_by = {};
};

/// Why the results of an attempt changed.
struct ChangeCauses {
    std::string id;
    RunCauses causes = {};
    std::string unknown = {};  ///< why the causes could not be found out
};

/// How a day differs from the same day as it was processed before.
struct DayComparison {
    std::vector<std::string> only_old, only_new;
    std::vector<StateChange> states;
    std::vector<ResultChange> results;
    std::vector<ChangeCauses> causes;  ///< of every attempt in `results`, in the order of the day
    std::int64_t in_both = 0;
    std::int64_t unchanged = 0;  ///< of those, with neither a change of state nor of a result

    bool equal() const {
        return only_old.empty() && only_new.empty() && states.empty() && results.empty();
    }
};

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
