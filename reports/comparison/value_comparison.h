#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "schemas/comparison/declared.h"

namespace runcert {

class DocumentSchema;

/// The part of a stated uncertainty by which two computations of the same may differ: another
/// processor's sines do not make other results.
inline constexpr double tolerated_fraction_of_uncertainty = 1e-3;

/// Where an entry is in each of two lists; nothing where that list does not have it.
struct MatchedPlaces {
    std::optional<std::size_t> a = std::nullopt, b = std::nullopt;
};

/// Matches the entries of two lists by their keys, equal keys in their order. What the second alone
/// has comes last.
///
/// Matched entries stand in the same order in both lists: one that would lead back is left to its
/// own list. So lists in which every entry is matched have the same keys at the same places.
template <class Key>
std::vector<MatchedPlaces> match_by_key(const std::vector<Key>& a, const std::vector<Key>& b) {
    std::multimap<Key, std::size_t> places_in_b;
    for (std::size_t i = 0; i < b.size(); ++i)
        places_in_b.emplace(b[i], i);
    std::vector<MatchedPlaces> places;
    std::vector<bool> matched(b.size());
    std::size_t next = 0;  // in the second list
    for (std::size_t i = 0; i < a.size(); ++i) {
        MatchedPlaces& place = places.emplace_back(MatchedPlaces{.a = i});
        const auto found = places_in_b.lower_bound(a[i]);
        if (found == places_in_b.end() || found->first != a[i]) continue;
        const std::size_t at = found->second;
        places_in_b.erase(found);
        if (at < next) continue;
        place.b = at;
        matched[at] = true;
        next = at + 1;
    }
    for (std::size_t i = 0; i < b.size(); ++i)
        if (!matched[i]) places.push_back({.b = i});
    return places;
}

/// A place at which two documents differ: what stands there holds until they are gone.
struct TreeDifference {
    std::string path;      ///< "profiles.0.best.speed_m_s"
    std::string declared;  ///< the same as field tables have it: "profiles[].best.speed_m_s"
    std::vector<std::string> keys = {};         ///< of the list entries on the way: "nalsa"
    const nlohmann::ordered_json* a = nullptr;  ///< null where the document has nothing there
    const nlohmann::ordered_json* b = nullptr;
    /// The maps around it, the nearest last: of the first document all, of the second the nearest.
    std::vector<const nlohmann::ordered_json*> maps = {};
    const nlohmann::ordered_json* map_b = nullptr;
};

/// Every place at which two documents differ, in the order of the first; what only the second has
/// comes after. Entries of lists are matched by what names them (`profile`, `clause`, `symbol`),
/// others by their place. One that a document lacks is one difference.
std::vector<TreeDifference> tree_differences(const nlohmann::ordered_json& a,
                                             const nlohmann::ordered_json& b);

/// By what a value may differ from that of another computation.
struct ComparisonRules {
    /// Declares types and resolutions, so that no document has a say in how it is judged. Without
    /// it nothing may differ.
    const DocumentSchema* declared = nullptr;
    /// Whether these figures decide: then a millionth of the standard uncertainty, or 1e-9 of the
    /// value, is all that is tolerated.
    bool deciding = false;
};

/// The same differences, judged; the first document was computed here.
///
/// The uncertainty of a speed is that which its own map or the nearest above it states in m/s, that
/// of a `value` the one that stands beside it. Tolerated are, of numbers declared real: a
/// thousandth of it; of what is itself an uncertainty a thousandth of itself; of a probability what
/// a thousandth makes of one; of what the search for the noise found 1 %, because likelihoods are
/// flat; and one unit of the last digit declared. Texts, whole numbers, and what only one document
/// has, never.
std::vector<ValueDifference> value_differences(const nlohmann::ordered_json& a,
                                               const nlohmann::ordered_json& b,
                                               const ComparisonRules& rules = {});

/// What a map holds under that name; null where there is no such map or member.
const nlohmann::ordered_json* member_of(const nlohmann::ordered_json* map, const std::string& name);
std::optional<double> number_in(const nlohmann::ordered_json* map, const std::string& name);
/// "none" where there is no such text.
std::string text_in(const nlohmann::ordered_json* map, const std::string& name);

/// Who made a product, by its header: "runcert 1.0.0, source 1234abcd".
std::string maker_of(const nlohmann::ordered_json& header);

/// The tolerance of a number written with so many decimals.
double last_digit_tolerance(int decimals);

}  // namespace runcert
