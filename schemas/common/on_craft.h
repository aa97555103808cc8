#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "schemas/common/declared.h"

// Where things are on a craft, and how good an IMU on it is: in the attempt, and in the products
// that were made with it.
namespace runcert {

/// From one point of the craft to another (m): forward, right, down.
using LeverArm = std::array<double, 3>;
template <>
nlohmann::ordered_json members_json(const LeverArm& arm);
template <>
LeverArm read_members(const YamlValue& map);
Eigen::Vector3d vector_of(const LeverArm& arm);
LeverArm lever_arm_of(const Eigen::Vector3d& components_m);
/// "forward 0.1, right 0, down -1.205 m"; with standard uncertainties as "0.10 ± 0.02" and
/// "(k = 2)".
std::string arm_text(const LeverArm& arm, const std::optional<LeverArm>& sigma = std::nullopt);

/// How good an IMU is: the word of a class, or figures.
struct ImuGrade {
    std::string name;                                ///< "tactical", "mems", "consumer"; or empty
    std::optional<ImuErrors> errors = std::nullopt;  ///< where there is no name

    bool operator==(const ImuGrade&) const = default;
};
/// A text for the word of a class, a map for figures.
template <>
nlohmann::ordered_json members_json(const ImuGrade& grade);
/// Failure for a text that is no class.
template <>
ImuGrade read_members(const YamlValue& text_or_map);

}  // namespace runcert
