#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Geodetic at(double latitude_deg, double longitude_deg, double height_m) {
    return {Angle::from_degrees(latitude_deg), Angle::from_degrees(longitude_deg), height_m};
}

const Geodetic origins[] = {at(35.134709483, 136.977574275, 104.728),
                            at(-30.9, 136.5, 0.0),
                            at(51.5, -0.1, 50.0),
                            at(-54.8, -68.3, 10.0),
                            at(0.0, 0.0, 0.0),
                            at(78.2, 15.6, 500.0),
                            at(10.0, 179.99, -20.0)};

TEST(Geodesy, EcefOnTheAxesOfTheEllipsoid) {
    constexpr double a_m = 6378137.0;
    const double b_m = a_m * (1.0 - 1.0 / 298.257223563);
    EXPECT_TRUE(ecef_from_geodetic(at(0, 0, 0)).m.isApprox(Vector3d(a_m, 0, 0), 1e-15));
    EXPECT_TRUE(ecef_from_geodetic(at(0, 90, 10)).m.isApprox(Vector3d(0, a_m + 10, 0), 1e-15));
    EXPECT_TRUE(ecef_from_geodetic(at(-90, 0, 1)).m.isApprox(Vector3d(0, 0, -b_m - 1), 1e-15));
    EXPECT_TRUE(ecef_from_geodetic(at(90, 77, 0)).m.isApprox(Vector3d(0, 0, b_m), 1e-15));
}

TEST(Geodesy, EcefRoundTrips) {
    RandomGenerator random(21);
    for (int i = 0; i < 5000; ++i) {
        const Geodetic position = at(180 * random.uniform() - 90, 360 * random.uniform() - 180,
                                     1e4 * random.uniform() - 500);
        const Ecef ecef = ecef_from_geodetic(position);
        const Geodetic back = geodetic_from_ecef(ecef);
        EXPECT_NEAR(back.height_m, position.height_m, 5e-9);
        EXPECT_LT((ecef_from_geodetic(back).m - ecef.m).norm(), 5e-9);
    }
}

TEST(Geodesy, LocalRotationIsARotationWithEastNorthUpRows) {
    for (const Geodetic& o : origins) {
        const Matrix3d r = rotation_enu_from_ecef(o.latitude, o.longitude);
        EXPECT_LT((r * r.transpose() - Matrix3d::Identity()).norm(), 1e-15);
        EXPECT_NEAR(r.determinant(), 1.0, 1e-15);
        // Rows against steps of the position itself.
        const Vector3d here = ecef_from_geodetic(o).m;
        const Vector3d up =
            ecef_from_geodetic({o.latitude, o.longitude, o.height_m + 1000}).m - here;
        EXPECT_LT((r * up - Vector3d(0, 0, 1000)).norm(), 1e-8);
        const double step_deg = 1e-4;
        const double latitude_deg = o.latitude.degrees();
        const double longitude_deg = o.longitude.degrees();
        const Vector3d north =
            r * (ecef_from_geodetic(at(latitude_deg + step_deg, longitude_deg, o.height_m)).m -
                 ecef_from_geodetic(at(latitude_deg - step_deg, longitude_deg, o.height_m)).m);
        EXPECT_NEAR(north.normalized().y(), 1.0, 1e-9);
        const Vector3d east =
            r * (ecef_from_geodetic(at(latitude_deg, longitude_deg + step_deg, o.height_m)).m -
                 ecef_from_geodetic(at(latitude_deg, longitude_deg - step_deg, o.height_m)).m);
        EXPECT_NEAR(east.normalized().x(), 1.0, 1e-9);
    }
}

TEST(Geodesy, LocalFrameRoundTrips) {
    RandomGenerator random(22);
    for (const Geodetic& origin : origins) {
        const LocalFrame frame(origin);
        EXPECT_LT(frame.enu_from_geodetic(origin).m.norm(), 1e-12);
        for (int i = 0; i < 200; ++i) {
            const Enu enu{{4e4 * random.uniform() - 2e4, 4e4 * random.uniform() - 2e4,
                           1e3 * random.uniform() - 500}};
            const Geodetic position = frame.geodetic_from_enu(enu);
            EXPECT_LT((frame.enu_from_geodetic(position).m - enu.m).norm(), 1e-8);
            EXPECT_LT((frame.enu_from_ecef(ecef_from_geodetic(position)).m - enu.m).norm(), 1e-8);
        }
    }
}

TEST(Geodesy, TheFrameIsAPlaneAboveTheEllipsoid) {
    const LocalFrame frame(at(35.0, 137.0, 0.0));
    // 20 km north, on the ellipsoid: below by about d^2 / 2R = 31 m.
    const Enu far = frame.enu_from_geodetic(at(35.18, 137.0, 0.0));
    EXPECT_NEAR(far.m.z(), -far.m.y() * far.m.y() / (2 * 6356e3), 0.1);
}

TEST(Geodesy, RotationFromLocalTurnsVectorsAndKeepsCovariances) {
    const LocalFrame frame(origins[0]);
    EXPECT_LT((frame.rotation_from_local(origins[0].latitude, origins[0].longitude) -
               Matrix3d::Identity())
                  .norm(),
              1e-15);
    const Enu place{{12'000.0, -7'000.0, 300.0}};
    const Geodetic position = frame.geodetic_from_enu(place);
    const Matrix3d turn = frame.rotation_from_local(position.latitude, position.longitude);
    // A short step in the place's own east, north, up, seen from the frame.
    const LocalFrame there(position);
    const Vector3d step_m(1.0, 2.0, -0.5);
    const Vector3d seen = frame.enu_from_geodetic(there.geodetic_from_enu({step_m})).m - place.m;
    EXPECT_LT((turn * step_m - seen).norm(), 1e-8);
    const Matrix3d covariance = Vector3d(1e-4, 4e-4, 9e-4).asDiagonal().toDenseMatrix();
    EXPECT_NEAR((turn * covariance * turn.transpose()).trace(), covariance.trace(), 1e-18);
    // Turned by about 12 km / 6371 km.
    EXPECT_NEAR((turn - Matrix3d::Identity()).norm(), 0.0033, 0.001);
}

TEST(Geodesy, UtmRoundTripsAndHasItsScale) {
    // On the central meridian the scale is 0.9996 and grid north true north.
    const UtmGeometry centre = utm_geometry({55, false}, 500e3, 6'000'000.0);
    EXPECT_NEAR(centre.scale, 0.9996, 1e-14);
    EXPECT_NEAR(centre.convergence.degrees(), 0.0, 1e-13);
    RandomGenerator random(23);
    for (int i = 0; i < 500; ++i) {
        const UtmZone zone{1 + static_cast<int>(random.next() % 60), random.uniform() < 0.5};
        const double easting_m = 200e3 + 600e3 * random.uniform();
        const double northing_m = 1e6 + 8e6 * random.uniform();
        const Geodetic position = geodetic_from_utm(zone, easting_m, northing_m, 12.5);
        EXPECT_EQ(position.height_m, 12.5);
        EXPECT_EQ(position.latitude > Angle(), zone.northern);
        const UtmCoordinates back = utm_from_geodetic(zone, position);
        EXPECT_NEAR(back.easting_m, easting_m, 1e-8);
        EXPECT_NEAR(back.northing_m, northing_m, 1e-8);
    }
}

TEST(Geodesy, UtmGeometryIsTheDerivativeOfTheProjection) {
    const UtmZone zone{55, false};
    const double easting_m = 320'000.0;
    const double northing_m = 5'800'000.0;
    const UtmGeometry geometry = utm_geometry(zone, easting_m, northing_m);
    const Geodetic here = geodetic_from_utm(zone, easting_m, northing_m, 0.0);
    // 10 m of grid north, in true east, north, up.
    const Enu grid_north = LocalFrame(here).enu_from_geodetic(
        geodetic_from_utm(zone, easting_m, northing_m + 10.0, 0.0));
    const double length_m = std::hypot(grid_north.m.x(), grid_north.m.y());
    EXPECT_NEAR(10.0 / length_m, geometry.scale, 1e-8);
    EXPECT_NEAR(std::atan2(grid_north.m.x(), grid_north.m.y()), geometry.convergence.radians(),
                1e-6);
    EXPECT_GT(std::abs(geometry.convergence.degrees()), 0.5);
}

TEST(Geodesy, UtmCrossesTheEquator) {
    const Geodetic position = geodetic_from_utm({55, true}, 400'000.0, -5'000.0, 0.0);
    const UtmCoordinates southern = utm_from_geodetic({55, false}, position);
    EXPECT_NEAR(southern.northing_m, 9'995'000.0, 1e-8);
    EXPECT_LT(position.latitude.degrees(), 0.0);
}

TEST(Geodesy, RefusesWhatIsNoPosition) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    for (const Geodetic& bad :
         {at(90.0000001, 0, 0), at(-91, 0, 0), at(0, 360.1, 0), at(0, -400, 0), at(nan, 0, 0),
          at(0, nan, 0), at(0, 0, nan), at(0, 0, inf), at(inf, 0, 0), at(136.977, 35.135, 0)}) {
        EXPECT_THROW(ecef_from_geodetic(bad), Failure);
        EXPECT_THROW(LocalFrame{bad}, Failure);
        EXPECT_THROW(utm_from_geodetic({1, true}, bad), Failure);
    }
    EXPECT_NO_THROW(ecef_from_geodetic(at(90, -360, 0)));
    EXPECT_NO_THROW(ecef_from_geodetic({Angle::from_radians(std::numbers::pi / 2), Angle(), 0}));
    EXPECT_THROW(geodetic_from_ecef({{nan, 0, 0}}), Failure);
    EXPECT_THROW(rotation_enu_from_ecef(Angle::from_degrees(nan), Angle()), Failure);
    const LocalFrame frame(origins[0]);
    EXPECT_THROW(frame.enu_from_ecef({{0, inf, 0}}), Failure);
    EXPECT_THROW(frame.geodetic_from_enu({{0, 0, nan}}), Failure);
    for (const int zone : {0, 61, -1})
        EXPECT_THROW(geodetic_from_utm({zone}, 5e5, 1e6, 0), Failure);
    for (const double easting_m : {-1.0, 99e3, 901e3, 6.1e6, nan})
        EXPECT_THROW(geodetic_from_utm({55, false}, easting_m, 6.1e6, 0), Failure);
    for (const double northing_m : {-2e5, 9.7e6, nan})
        EXPECT_THROW(utm_geometry({55, true}, 5e5, northing_m), Failure);
    for (const double northing_m : {3e5, 1.02e7, nan})
        EXPECT_THROW(utm_geometry({55, false}, 5e5, northing_m), Failure);
    EXPECT_THROW(geodetic_from_utm({55, false}, 5e5, 6.1e6, nan), Failure);
    // Far outside the zone asked for.
    EXPECT_THROW(utm_from_geodetic({1, true}, at(35, 137, 0)), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
