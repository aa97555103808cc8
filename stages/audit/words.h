#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/screened/screened.h"

// The words that the parts of an audit share.

namespace runcert {

inline constexpr std::size_t audit_columns = 100;

/// The text as lines of at most `audit_columns`, broken at blanks; every line but the first begins
/// with `indent` blanks. A word longer than a line is cut. Ends with a line end.
std::string wrapped(std::string_view text, std::size_t indent = 4);

/// 1587 as "1,587".
std::string counted(std::int64_t count);
/// "1 epoch", "1,587 epochs".
std::string counted(std::int64_t count, std::string_view noun);
/// "a, b and c"; empty for none.
std::string listed(const std::vector<std::string>& items);

/// How often something of that probability happens: "once in 590 million".
std::string once_in(double probability);

/// The sentence with a capital.
std::string sentence(std::string text);

/// An error towards two directions, or upwards, with its standard uncertainties: "0.174 m east,
/// 0.057 m south, each +- 0.020 m". Empty where nothing was estimated.
std::string components(const EstimatedError& error);
/// Its length, m; nothing where it was not estimated. The same of a ramp, m/s.
std::optional<double> size_of(const EstimatedError& error);
std::optional<double> rate_of(const EstimatedError& error);
/// A ramp towards two directions, or upwards.
std::string rate_components(const EstimatedError& error);

std::string_view words_of(FixKind fix);
std::string_view words_of(Hypothesis hypothesis);
/// Why rows are left out, short: "ambiguities not fixed".
std::string_view words_of(Reason reason);

}  // namespace runcert
