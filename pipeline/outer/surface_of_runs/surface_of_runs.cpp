#include "surface_of_runs/surface_of_runs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "surface/height_grid.h"

namespace runcert {
namespace {

constexpr double least_speed_m_s = 2.0;
constexpr double usual_sigma_up_m = 0.02;
constexpr double least_vertical_sd_m = 0.01;

void require_comparable(std::span<const EarlierRun> runs) {
    if (runs.empty())
        throw Failure("surface", "no run is named", "Name the folders of earlier runs");
    std::set<std::string> recordings;
    const bool georeferenced = runs.front().positions->facts.georeferenced;
    for (const EarlierRun& run : runs) {
        if (run.positions->facts.georeferenced != georeferenced)
            throw Failure("surface",
                          fmt::format("the runs {} and {} are not in one coordinate system",
                                      runs.front().id, run.id),
                          "Name runs on the Earth alone, or of one engineering CRS");
        if (!run.positions->facts.vertical_measured)
            throw Failure("surface", fmt::format("the run {} has no heights", run.id),
                          "Name runs whose receiver records heights");
        for (const std::string& recording : run.recordings)
            if (!recordings.insert(recording).second)
                throw Failure(
                    "surface",
                    fmt::format("the recording of the run {} is that of another run, too", run.id),
                    "Name each recording once: it says what it says no better twice");
    }
}

/// East, north and up of a run's position in the frame of the first run.
class CommonFrame {
  public:
    CommonFrame(const std::optional<FrameOrigin>& common, const std::optional<FrameOrigin>& own) {
        if (!common || !own) return;
        common_.emplace(common->position);
        own_.emplace(*own);
    }
    Eigen::Vector3d operator()(const ScreenedEpoch& row) const {
        const Eigen::Vector3d enu(*row.east_m, *row.north_m, *row.up_m);
        return common_ ? common_->enu_from_ecef(own_->ecef(row.time, enu)).m : enu;
    }

  private:
    std::optional<LocalFrame> common_;
    std::optional<PlaceFrames> own_;
};

/// Adds the positions of a run where it moves. Returns how many.
std::int64_t add_positions(const EarlierRun& run, const std::optional<FrameOrigin>& common,
                           std::vector<AntennaPosition>& positions) {
    const CommonFrame place(common, run.positions->origin);
    std::int64_t added = 0;
    std::optional<Eigen::Vector3d> before;
    ElapsedTime time_before;
    OptionalInteger arc_before;
    for (const ScreenedEpoch& row : run.positions->rows) {
        if (!row.usable || !row.arc || !row.east_m || !row.north_m || !row.up_m) continue;
        const Eigen::Vector3d here = place(row);
        if (before && arc_before == row.arc) {
            const Eigen::Vector2d moved = (here - *before).head<2>();
            const double step_s = row.time.seconds() - time_before.seconds();
            if (moved.norm() >= least_speed_m_s * step_s && moved.norm() > 0.0) {
                positions.push_back(
                    {.enu_m = here,
                     .direction = moved,
                     .sigma_up_m = std::max(1e-3, row.sigma_up_m.value_or(usual_sigma_up_m)),
                     .antenna_height_m = run.antenna_height_m});
                ++added;
            }
        }
        before = here;
        time_before = row.time;
        arc_before = row.arc;
    }
    return added;
}

void add_rows(const SurfaceMesh& mesh, const std::optional<FrameOrigin>& origin,
              SurfaceTable& table) {
    std::optional<LocalFrame> frame;
    if (origin) frame.emplace(origin->position);
    for (const Eigen::Vector3d& vertex : mesh.vertices) {
        SurfaceRow& row = table.rows.emplace_back();
        row.element = SurfaceElement::vertex;
        row.number = std::ssize(table.rows);
        if (!frame) {
            row.east_m = vertex.x();
            row.north_m = vertex.y();
            row.up_m = vertex.z();
            continue;
        }
        const Geodetic place = frame->geodetic_from_enu({vertex});
        row.latitude_deg = place.latitude.degrees();
        row.longitude_deg = place.longitude.degrees();
        row.height_m = place.height_m;
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        SurfaceRow& row = table.rows.emplace_back();
        row.element = SurfaceElement::triangle;
        row.number = static_cast<std::int64_t>(i) + 1;
        row.corner_1 = mesh.triangles[i][0] + std::int64_t{1};
        row.corner_2 = mesh.triangles[i][1] + std::int64_t{1};
        row.corner_3 = mesh.triangles[i][2] + std::int64_t{1};
    }
}

}  // namespace

SurfaceTable surface_of_runs(std::span<const EarlierRun> runs) {
    require_comparable(runs);
    const std::optional<FrameOrigin>& origin = runs.front().positions->origin;
    SurfaceTable table;
    std::vector<AntennaPosition> positions;
    std::vector<std::string> names;
    for (const EarlierRun& run : runs) {
        names.push_back(run.id);
        table.made_from.push_back({.id = run.id,
                                   .recordings = run.recordings,
                                   .positions = add_positions(run, origin, positions)});
    }
    const HeightGrid grid = fit_height_grid(positions);
    const SurfaceMesh mesh = supported_part(grid);
    if (mesh.triangles.empty())
        throw Failure("surface",
                      "no part of the course has positions on both sides of it, so that the ground "
                      "across is not determined",
                      "Name more runs, beside one another: five that cover the width suffice");
    double twice_area_m2 = 0.0;
    for (const Corners& corners : mesh.triangles)
        twice_area_m2 += twice_area_in_plan(mesh, corners);
    table.format = "runcert";
    table.georeferenced = origin.has_value();
    table.frame = origin ? "geodetic" : "local_plane";
    table.vertical_sd_m = std::max(least_vertical_sd_m, grid.residual_m);
    table.source = fmt::format("made from the runs {}", fmt::join(names, ", "));
    table.found = {.vertices = std::ssize(mesh.vertices),
                   .triangles = std::ssize(mesh.triangles),
                   .edge_m = median_edge_m(mesh),
                   .area_m2 = twice_area_m2 / 2.0};
    table.notes.push_back(
        fmt::format("{} of {} triangles without positions on both sides are left out.",
                    std::ranges::count(grid.supported, false), grid.supported.size()));
    add_rows(mesh, origin, table);
    return table;
}

}  // namespace runcert
