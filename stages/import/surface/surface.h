#pragma once

#include <functional>
#include <optional>

#include "schemas/attempt/attempt.h"
#include "schemas/recognition/declared.h"
#include "schemas/surface/declared.h"
#include "stages/import/recording.h"

/// Surfaces that craft run on: LandXML 1.2 (TIN), a table of vertices and one of triangles (CSV),
/// and what `runcert surface` wrote.
namespace runcert::surface {

/// The files of a surface.
struct SurfaceFiles {
    RecordingBytes file;
    std::optional<RecordingBytes> triangles = std::nullopt;  ///< beside a table of vertices
};

using TakeRow = std::function<void(const SurfaceRow& row)>;

/// A surface, whose rows are given one by one: vertices, then triangles.
struct StreamedSurface {
    SurfaceTable head;  ///< without the rows; the caller sets the header
    /// Gives them, as often as it is called. It owns what it needs.
    std::function<void(const TakeRow& take)> give;
};

/// Reads the files of a receiver's surface: vertices on the WGS 84 ellipsoid with heights above it,
/// or, in a local frame, in metres east, north and up of the run's origin; triangles
/// counter-clockwise seen from above. Triangles that are listed clockwise are turned: in plan no
/// other triangle lies over them, so that the order of their corners says nothing of the ground.
///
/// Failure, with place and remedy, where the file cannot be read, or is of no format of these; has
/// more than four million vertices or triangles; where unit, frame or heights are nowhere stated,
/// or stated twice and differently; where a triangle has no area in plan, or names a vertex that
/// there is not; and where two triangles lie over the same ground.
StreamedSurface import_surface(const Receiver& receiver, const SurfaceFiles& files);

/// What a file of a surface is, and what an attempt must say of it; nothing for any other file, or
/// one without vertices. Failure where it cannot be read.
std::optional<Recognition> recognise(const RecordingBytes& file);

/// Whether `runcert surface` wrote it.
bool is_own(std::string_view bytes);

/// Failure where the surface was made from one of these recordings (SHA-256 of their files), or
/// lies on the Earth and the recording does not.
void require_of_another_run(const Receiver& receiver, const SurfaceTable& surface,
                            const std::vector<std::string>& recordings, bool georeferenced);

}  // namespace runcert::surface
