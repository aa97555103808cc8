#include "draft/fitting_rules.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "schemas/profile/profile.h"

namespace runcert {
namespace {

struct RulesOfClass {
    std::string_view craft_class;
    std::vector<std::string> rules;
};

/// No profile says which craft it is for: a body's rule may be claimed with any.
const std::array rules_of_classes{
    RulesOfClass{"land-yacht", {"nalsa", "fisly"}},
    RulesOfClass{"ice-yacht", {"gps-ice-sailing", "gps-ice-sailing-alpha-250"}},
    RulesOfClass{"sail-boat", {"wssrc-500m", "wssrc-nautical-mile"}},
    RulesOfClass{
        "board",
        {"gps-speed-sailing", "gps-speed-sailing-alpha-250", "wssrc-500m", "wssrc-nautical-mile"}},
    RulesOfClass{
        "skydiver",
        {"fai-speed-skydiving-2026", "fai-speed-skydiving-record", "fai-speed-skydiving"}}};

/// Whether a rule was in force on a day, and is not the one that another replaces on it.
bool is_of_day(const std::string& rule, const std::string& day) {
    const std::string_view text = builtin_profile(rule);
    if (text.empty()) return true;
    const Profile profile = read_profile(text, rule);
    return day >= profile.valid_from &&
           (profile.superseded_by.empty() || day < profile.superseded_from);
}

}  // namespace

std::vector<std::string> fitting_rules(const std::string& craft_class,
                                       const std::optional<GpsTime>& when) {
    const auto found = std::ranges::find(rules_of_classes, craft_class, &RulesOfClass::craft_class);
    if (found == rules_of_classes.end()) return {};
    std::vector<std::string> rules = found->rules;
    constexpr std::size_t date_length = 10;
    const std::string day = when ? to_utc_iso(*when, 0).substr(0, date_length) : "9999";
    std::erase_if(rules, [&](const std::string& rule) { return !is_of_day(rule, day); });
    return rules;
}

}  // namespace runcert
