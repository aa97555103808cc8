#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "measured_call.h"

namespace runcert {

/// All that was measured.
struct BatchFigures {
    int attempts = 0, epochs = 0;  ///< of the day
    int calls = 1;                 ///< that a figure is the median of
    MeasuredCall one_job, two_jobs, nothing_changed, figure_changed;
    int rendered = 0;  ///< attempts of the day with pages and PDFs
    std::optional<MeasuredCall> with_pages = std::nullopt;
    int many = 0, many_epochs = 0;  ///< of the day that shows the memory
    std::optional<MeasuredCall> many_runs = std::nullopt, many_unchanged = std::nullopt;
    double load_before = 0.0, load_after = 0.0;
};

/// What is asked of a batch, and what was found.
struct Requirement {
    std::string what;
    double found = 0.0;
    bool at_least = false;  ///< else at most
    double limit = 0.0;
    std::string unit = {};

    bool is_met() const { return at_least ? found >= limit : found <= limit; }
};

std::vector<Requirement> requirements_of(const BatchFigures& figures);

/// The figures for people, and each requirement with what was found.
std::string table_of(const BatchFigures& figures);

nlohmann::ordered_json json_of(const BatchFigures& figures);

/// How many programs were at work on this computer in the last minute (the load average).
double load_average();

}  // namespace runcert
