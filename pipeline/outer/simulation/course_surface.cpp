#include "simulation/course_surface.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "core/text.h"
#include "simulation/craft_motion.h"

namespace runcert {
namespace {

/// A point of the course: where the run's point is, which way it goes and how the ground leans.
struct Station {
    Eigen::Vector3d place_m;
    Eigen::Vector3d ahead;  ///< of unit length, level
    double bank_rad = 0.0;  ///< to the left
};

Station moved(Station station, double by_m) {
    station.place_m += by_m * station.ahead;
    return station;
}

/// Stations `spacing_m` apart, two of them before the run and two after it.
std::vector<Station> stations_of(const SimulationSpec& spec) {
    const SimulatedCraft& craft = spec.craft.value();
    const bool oval = craft.course == CraftCourse::oval;
    const double spacing_m = spec.surface->spacing_m;
    std::vector<Station> stations;
    double way_m = 0.0;
    Eigen::Vector3d before_m = Eigen::Vector3d::Zero();
    Station last;
    for (const InertialTruth& truth : course_of(spec)) {
        const Eigen::Vector3d& place_m = truth.imu.position_m;
        if (!stations.empty()) way_m += (place_m - before_m).norm();
        before_m = place_m;
        const Eigen::Vector3d& v = truth.imu.velocity_m_s;
        last = {place_m, Eigen::Vector3d(v.x(), v.y(), 0.0).normalized(),
                oval ? oval_bank(craft.start_on_oval_m + way_m) : 0.0};
        if (oval && way_m > oval_lap_m - 5.0 * spacing_m) break;  // the strip's ends stay apart
        if (stations.empty()) stations = {moved(last, -2.0 * spacing_m), moved(last, -spacing_m)};
        if (way_m >= (static_cast<double>(stations.size()) - 2.0) * spacing_m)
            stations.push_back(last);
    }
    for (int i = 1; i <= 2; ++i)
        stations.push_back(moved(last, i * spacing_m));
    return stations;
}

/// Vertices across the course at a station, from left to right.
void add_row(const Station& station, const SimulatedSurface& spec, int steps,
             RandomGenerator& random, std::vector<Eigen::Vector3d>& vertices_m) {
    const Eigen::Vector3d aside(station.ahead.y(), -station.ahead.x(), 0.0);
    const Eigen::Vector3d right =
        std::cos(station.bank_rad) * aside + std::sin(station.bank_rad) * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d normal = right.cross(station.ahead);
    for (int k = 0; k <= steps; ++k) {
        const double off_m = spec.width_m * (static_cast<double>(k) / steps - 0.5);
        Eigen::Vector3d vertex_m = station.place_m - spec.below_m * normal + off_m * right;
        vertex_m.z() += spec.vertical_sd_m * random.normal();
        vertices_m.push_back(vertex_m);
    }
}

}  // namespace

CourseSurface simulate_surface(const SimulationSpec& spec) {
    const SimulatedSurface& surface = spec.surface.value();
    const int steps =
        std::max(1, static_cast<int>(std::lround(surface.width_m / surface.spacing_m)));
    const auto across = static_cast<std::size_t>(steps) + 1;
    // Another sequence than those of positions, IMU and wheel.
    RandomGenerator random(static_cast<std::uint64_t>(spec.seed) + 4'000'003);
    CourseSurface found;
    for (const Station& station : stations_of(spec))
        add_row(station, surface, steps, random, found.vertices_m);
    for (std::size_t row = 0; (row + 2) * across <= found.vertices_m.size(); ++row)
        for (std::size_t k = 0; k + 1 < across; ++k) {
            const std::size_t left = row * across + k, ahead = left + across;
            found.triangles.push_back({left, left + 1, ahead + 1});
            found.triangles.push_back({left, ahead + 1, ahead});
        }
    return found;
}

std::string landxml_text(const CourseSurface& surface, GpsTime date) {
    const std::string time = to_iso(date, 0);
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
        "<!-- runcert simulate (no surveyor: this survey is simulated) -->\n"
        "<LandXML xmlns=\"http://www.landxml.org/schema/LandXML-1.2\" version=\"1.2\" "
        "date=\"{}\" time=\"{}\">\n"
        "  <Units><Metric areaUnit=\"squareMeter\" linearUnit=\"meter\" "
        "volumeUnit=\"cubicMeter\" temperatureUnit=\"celsius\" "
        "pressureUnit=\"milliBars\"/></Units>\n"
        "  <Surfaces><Surface name=\"course\"><Definition surfType=\"TIN\">\n    <Pnts>\n",
        time.substr(0, 10), time.substr(11, 8));
    for (std::size_t i = 0; i < surface.vertices_m.size(); ++i) {
        const Eigen::Vector3d& vertex_m = surface.vertices_m[i];
        text +=
            fmt::format("      <P id=\"{}\">{} {} {}</P>\n", i + 1, format_fixed(vertex_m.y(), 4),
                        format_fixed(vertex_m.x(), 4), format_fixed(vertex_m.z(), 4));
    }
    text += "    </Pnts>\n    <Faces>\n";
    for (const auto& [a, b, c] : surface.triangles)
        text += fmt::format("      <F>{} {} {}</F>\n", a + 1, b + 1, c + 1);
    return text + "    </Faces>\n  </Definition></Surface></Surfaces>\n</LandXML>\n";
}

}  // namespace runcert
