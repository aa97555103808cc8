#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/surface/declared.h"
#include "stages/import/recording.h"
#include "stages/import/surface/surface.h"
#include "surface/triangulation.h"

namespace runcert::surface {

/// More of either are refused.
inline constexpr std::size_t most_elements = 4'000'000;

/// No file numbers its vertices higher: whole numbers up to here are exact as coordinates are read.
inline constexpr std::int64_t largest_number = 1'000'000'000'000'000;

/// A surface as its file has it, but for its axes: coordinates x, y, z are east, north, up, or
/// longitude and latitude in degrees.
struct RawSurface {
    std::string format;                           ///< "landxml", "csv"
    bool north_first = false;                     ///< the format's own order is northing, easting
    std::optional<double> unit_m = std::nullopt;  ///< where the file says it
    std::string unit_name = {};                   ///< as it says it
    SurfaceMesh mesh = {};
    std::vector<std::int64_t> vertex_lines = {}, triangle_lines = {};  ///< counted from 1
    std::int64_t invisible = 0;

    void add_vertex(const Eigen::Vector3d& vertex, const SourceLine& line,
                    const RecordingBytes& file);
    void add_triangle(const Corners& corners, const SourceLine& line, const RecordingBytes& file);
};

/// The vertices of a file by the number that it gives them.
class VertexNumbers {
  public:
    /// Failure at the place where there is one of that number.
    void add(std::int64_t number, std::uint32_t vertex, const std::string& place);
    /// Failure at the place where there is none.
    std::uint32_t of(std::int64_t number, const std::string& place) const;

  private:
    std::unordered_map<std::int64_t, std::uint32_t> vertices_;
};

/// LandXML 1.2: the one surface of type TIN that it holds. A point P is northing, easting,
/// elevation; a face with i="1" is invisible.
bool is_landxml(std::string_view bytes);
RawSurface read_landxml(const RecordingBytes& file);

/// Two tables: vertex, x, y, z (or east, north, up; longitude, latitude, height); and vertex_1,
/// vertex_2, vertex_3.
RawSurface read_tables(const RecordingBytes& vertices, const RecordingBytes& triangles);

/// Whether the first line names the columns of one of these tables.
bool is_vertex_table(std::string_view bytes);
bool is_triangle_table(std::string_view bytes);

/// The vertices alone, and the triangles alone: how many.
RawSurface read_vertex_table(const RecordingBytes& file);
std::int64_t count_triangles(const RecordingBytes& file);

}  // namespace runcert::surface
