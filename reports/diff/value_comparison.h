#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "schemas/difference/declared.h"

namespace runcert {

class DocumentSchema;

/// The part of a stated uncertainty by which two computations of the same may differ: another
/// processor's sines do not make other results.
inline constexpr double tolerated_fraction_of_uncertainty = 1e-3;

/// By what a value may differ from that of another computation.
struct ComparisonRules {
    /// Declares types and resolutions of the first document, which was computed here, so that the
    /// other has no say in how it is judged. Without it the values themselves show how they are
    /// written, as people compare two runs that they trust.
    const DocumentSchema* declared = nullptr;
    /// Whether these figures decide: then a millionth of the standard uncertainty, or 1e-9 of the
    /// value, is all that is tolerated.
    bool deciding = false;
};

/// Every value of two documents that differs, in the order of the first; what only the second has
/// comes after. Lists are compared place by place.
///
/// The uncertainty of a speed is that which its own map or the nearest above it states in m/s, that
/// of a `value` the one that stands beside it. Tolerated are: a thousandth of it; of what is itself
/// an uncertainty a thousandth of itself; of a probability what a thousandth makes of one; of what
/// the search for the noise found 1 %, because likelihoods are flat; and one unit of the last digit
/// written, in texts too. Other texts, whole numbers, and what only one document has, never. By
/// declared rules no text is tolerated, nor a number that is declared to be whole, and the last
/// digit is that of the declaration.
std::vector<ValueDifference> value_differences(const nlohmann::ordered_json& a,
                                               const nlohmann::ordered_json& b,
                                               const ComparisonRules& rules = {});

/// The number of that name in a map, where there is one.
std::optional<double> number_in(const nlohmann::ordered_json& map, const std::string& key);

/// The tolerance of a number written with so many decimals.
double last_digit_tolerance(int decimals);

}  // namespace runcert
