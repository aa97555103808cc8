#include "schemas/common/on_craft.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/figures.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::array<std::string_view, 3> arm_keys{"forward", "right", "down"};

constexpr std::array<std::string_view, 3> grades{"tactical", "mems", "consumer"};

}  // namespace

Eigen::Vector3d vector_of(const LeverArm& arm) {
    return Eigen::Vector3d(arm.data());
}

LeverArm lever_arm_of(const Eigen::Vector3d& components_m) {
    return {components_m.x(), components_m.y(), components_m.z()};
}

std::string arm_text(const LeverArm& arm, const std::optional<LeverArm>& sigma) {
    const auto component = [&](std::size_t k) {
        return sigma ? format_fixed(arm[k], 2) + " ± " + format_fixed(2.0 * (*sigma)[k], 2)
                     : number_text(arm[k]);
    };
    return fmt::format("forward {}, right {}, down {} m{}", component(0), component(1),
                       component(2), sigma ? " (k = 2)" : "");
}

template <>
nlohmann::ordered_json members_json(const LeverArm& arm) {
    auto json = nlohmann::ordered_json::object();
    for (std::size_t i = 0; i < arm.size(); ++i)
        json[std::string(arm_keys[i])] = arm[i];
    return json;
}

template <>
LeverArm read_members(const YamlValue& map) {
    return {map["forward"].real(), map["right"].real(), map["down"].real()};
}

template <>
nlohmann::ordered_json members_json(const ImuGrade& grade) {
    if (!grade.errors) return grade.name;
    return members_json(*grade.errors);
}

template <>
ImuGrade read_members(const YamlValue& grade) {
    if (grade.is_map()) return {.name = {}, .errors = read_members<ImuErrors>(grade)};
    if (std::ranges::find(grades, grade.text()) == grades.end())
        grade.fail(fmt::format("\"{}\" is no grade of an IMU", escape_for_message(grade.text())),
                   "Write tactical, mems or consumer, or the figures of its data sheet: "
                   "{gyro_bias_deg_h: ..., angle_random_walk_deg_sqrt_h: ..., ...}");
    return {.name = grade.text(), .errors = std::nullopt};
}

}  // namespace runcert
