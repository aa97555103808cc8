#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "surface/triangulation.h"

namespace runcert {

/// Where an antenna was on an earlier run, at a stated height above the ground.
struct AntennaPosition {
    Eigen::Vector3d enu_m = Eigen::Vector3d::Zero();
    Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< of travel; of any length but zero
    double sigma_up_m = 0.01;
    double antenna_height_m = 0.0;  ///< along the normal of the ground
};

/// How a height grid is fitted.
struct HeightGridSettings {
    /// In a turn that is banked the ground's normal turns along the course, and a flat triangle has
    /// one: over 10 m of a bank of 14 degrees at a radius of 320 m that is 0.16 degrees, root mean
    /// square, over 5 m half of it.
    double spacing_m = 5.0;
    /// Standard deviations (m) of a second difference of three heights 10 m apart, along the
    /// direction of travel and across it: how little the ground bends. They grow with the distance
    /// to the power of 1.5, as where the slope walks at random.
    double bend_along_m = 0.03;
    double bend_across_m = 0.05;
};

/// Heights on a square grid in plan, as triangles.
struct HeightGrid {
    SurfaceMesh mesh;
    /// Of each triangle, whether there are positions on both sides of it, across the direction of
    /// travel: elsewhere its heights are extrapolated.
    std::vector<bool> supported;
    double residual_m = 0.0;  ///< robust standard deviation of the positions about it, upwards
};

/// Fits the ground under the positions of earlier runs: least squares for the heights of a grid's
/// vertices, each position by the barycentric weights of the triangle that holds it, with the
/// second differences of neighbouring heights as weak observations of zero. The grid lies along the
/// mean direction of travel. Positions are brought down by the antenna's height along the normal of
/// a first fit.
///
/// "On both sides": within 10 m along the direction of travel, and 15 m across.
///
/// Failure (at "surface") where there are too few positions, or they lie so far apart that the
/// grid would have more than four million vertices.
HeightGrid fit_height_grid(std::span<const AntennaPosition> positions,
                           const HeightGridSettings& settings = {});

/// The triangles that are supported, and the vertices of these.
SurfaceMesh supported_part(const HeightGrid& grid);

}  // namespace runcert
