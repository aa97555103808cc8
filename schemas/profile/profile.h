#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/speed_unit.h"
#include "schemas/profile/declared.h"
#include "store/document_schema.h"

namespace runcert {

/// What the attempt puts in place of a profile's figure.
struct FigureOverride {
    std::string profile;
    std::string figure;  ///< "margin.value", "clauses.flat-course.limit"
    double rule = 0.0;   ///< the profile's own figure; of an override not yet applied, zero
    double used = 0.0;
    std::string unit;    ///< of both; empty for a pure number
    std::string reason;  ///< empty where none is given
    std::string place;   ///< "file:line:column" of it in the attempt, for messages
};

/// A body's rule for one kind of record, `schemas/profile/v1.yaml`: as it is written, and what
/// follows from that.
struct Profile : ProfileDocument {
    std::string sha256 = {};  ///< of its resolved text
    RuleOrigin origin = RuleOrigin::own;
    std::optional<double> accuracy_limit_m_s = std::nullopt;
    double margin = 0.0;                         ///< m/s, a fraction, or s
    std::vector<FigureOverride> overrides = {};  ///< that were applied
    YamlValue written{YamlNode(), ""};           ///< the whole of its resolved text
};

/// What a computation compares with: whether the figure may be at most the clause's limit, and the
/// units that the limit may have; none where it takes no limit.
struct ClauseLimit {
    bool at_most = true;
    std::vector<std::string_view> units;
};
ClauseLimit limit_of(Computation computation);

/// "3 s", "500 m over the course": what the rule averages over.
std::string window_words(const Profile& profile);

/// The unit that the rule writes speeds in.
std::string rule_unit_name(const Profile& profile);

/// Puts a figure of the attempt in place of the profile's, and notes it. Failure, at the override's
/// place, for a figure that the profile does not have, or a value outside its range.
void override_figure(Profile& profile, FigureOverride figure);

const DocumentSchema& profile_schema();

/// Reads and checks a profile, and what it has from the rules that it extends; Failure with file,
/// line and column on any deviation.
Profile read_profile(std::string_view text, const std::string& where);

/// The text of a profile with all that it has from the rules that it extends written out, and
/// checked; one that extends none as it is. Failure as of `read_profile`.
std::string resolved_profile(std::string_view text, const std::string& where);

/// Failure where a profile of one's own has the id of a rule that comes with the program: a title
/// would then speak of a body's rule that is not the body's.
void require_own_id(const Profile& profile, const std::string& where);

/// The resolved text of the profile of that name that comes with the program ("nalsa", "fisly");
/// empty if there is none.
std::string_view builtin_profile(std::string_view name);

/// What the program itself asks under every rule, beside the rule's clauses.
const std::vector<Clause>& own_clauses();

/// The source of every clause that the program asks itself, in whatever rule it stands.
inline constexpr std::string_view own_source = "this program's own requirement";

/// The names of all of them, in alphabetical order.
std::vector<std::string> builtin_profiles();

}  // namespace runcert
