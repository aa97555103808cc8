#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "schemas/attempt/attempt.h"
#include "stages/import/row_collector.h"

namespace runcert {

/// A geoid above the WGS 84 ellipsoid, by PROJ and a grid of it.
class Geoid {
  public:
    /// Failure where PROJ does not find the grid.
    explicit Geoid(GeoidModel model);
    ~Geoid();
    Geoid(const Geoid&) = delete;
    Geoid& operator=(const Geoid&) = delete;

    /// Its height at a place in degrees, in metres: linear between the grid's points.
    double height_m(double latitude_deg, double longitude_deg) const;
    const std::filesystem::path& grid() const { return grid_; }

  private:
    struct Handles;
    std::unique_ptr<Handles> handles_;
    std::filesystem::path grid_;
};

/// Makes heights above mean sea level ellipsoidal, where the receiver says above which geoid they
/// are; a note says by how much, and the grid is named with its hash. Failure where the recording
/// has no place on the Earth.
void raise_heights(StreamedRecording& recording, const Receiver& receiver);

}  // namespace runcert
