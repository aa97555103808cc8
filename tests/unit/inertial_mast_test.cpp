#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/parallel.h"
#include "draws.h"
#include "inertial_test_support.h"

// By how much an antenna on a swinging mast is faster than the craft, over 3 s at 60 m/s on a lake,
// and what is left of it once an IMU has told the craft's motion. The figures to reproduce are of
// another simulator, 20 runs each. It is not said how often its craft pitched, nor how its leeway
// varied below 2.5 degrees: 0.69 Hz and 1.6 degrees in the mean were chosen by the RMS of the
// chords. The rest follows.
namespace runcert::RUNCERT_FILE {
namespace {

/// Over the runs, in mm/s.
struct Spread {
    double mean = 0.0, sigma = 0.0;
};

/// Antenna less reference point, in mm/s: windows that begin and end at full speed, and the fastest
/// window of each.
struct MastErrors {
    double chord_rms = 0.0, chord_largest = 0.0;
    double path_mean = 0.0, path_largest = 0.0;
    Spread best_chord, best_path;
};

struct MastCase {
    double height_m, roll_deg, roll_hz, pitch_deg;
    MastErrors published;
};

const std::vector<MastCase> cases{
    {2, 5, 0.5, 1, {4.8, 12, 0.9, 12, {0.9, 4.0}, {1.6, 4.0}}},
    {5, 10, 0.5, 0, {9.0, 21, 22, 45, {5.5, 6.7}, {27, 6.7}}},
    {5, 10, 0.5, 2, {23.8, 58, 22, 82, {21, 12}, {45, 13}}},
    {5, 10, 1.0, 5, {55.6, 126, 86, 201, {63, 20}, {147, 21}}},
    {10, 20, 0.3, 2, {51.5, 163, 126, 294, {60, 17}, {195, 37}}},
    {10, 20, 0.5, 2, {58.4, 166, 347, 583, {88, 23}, {489, 28}}},
    {10, 20, 1.0, 2, {50.7, 171, 1333, 1606, {66, 27}, {1416, 26}}},
};

InertialRunSpec spec_of(const MastCase& mast, int run) {
    InertialRunSpec spec = test::lake(ImuClass::mems, static_cast<std::uint64_t>(run + 1));
    spec.antenna_m = {0.0, 0.0, -mast.height_m};
    spec.roll_deg = mast.roll_deg;
    spec.roll_hz = mast.roll_hz;
    spec.pitch_deg = mast.pitch_deg;
    spec.pitch_hz = 0.69;
    spec.leeway_deg = 1.6;
    return spec;
}

constexpr std::size_t window = 30;
constexpr double mm_s = 1000.0 / 3.0;  // of metres in a window

/// Speeds (mm/s) of a point over every window: as a chord and as a path.
struct WindowSpeeds {
    std::vector<double> chords, paths;
};

WindowSpeeds speeds_of(const InertialRun& run, Eigen::Vector3d InertialTruth::*point) {
    std::vector<double> ways_m(1, 0.0);
    const auto between = [&](std::size_t from, std::size_t to) {
        return (run.truth[to].*point - run.truth[from].*point).head<2>().norm();
    };
    for (std::size_t i = 1; i < run.truth.size(); ++i)
        ways_m.push_back(ways_m.back() + between(i - 1, i));
    WindowSpeeds speeds;
    for (std::size_t s = 0; s + window < run.truth.size(); ++s) {
        speeds.chords.push_back(mm_s * between(s, s + window));
        speeds.paths.push_back(mm_s * (ways_m[s + window] - ways_m[s]));
    }
    return speeds;
}

Spread spread_of(const std::vector<double>& values) {
    return {mean(values), standard_deviation(values)};
}

MastErrors errors_of(const MastCase& mast, int runs) {
    std::vector<double> chords, paths, best_chords, best_paths;
    for (int i = 0; i < runs; ++i) {
        const InertialRun run = simulate_inertial(spec_of(mast, i));
        const WindowSpeeds antenna = speeds_of(run, &InertialTruth::antenna_m);
        const WindowSpeeds craft = speeds_of(run, &InertialTruth::reference_point_m);
        for (std::size_t s = 0; s < craft.chords.size(); ++s) {
            if (craft.chords[s] < 0.95 * 60'000.0) continue;
            chords.push_back(antenna.chords[s] - craft.chords[s]);
            paths.push_back(antenna.paths[s] - craft.paths[s]);
        }
        best_chords.push_back(std::ranges::max(antenna.chords) - std::ranges::max(craft.chords));
        best_paths.push_back(std::ranges::max(antenna.paths) - std::ranges::max(craft.paths));
    }
    const auto [low, high] = std::ranges::minmax(chords);
    return {.chord_rms = root_mean_square(chords),
            .chord_largest = std::max(-low, high),
            .path_mean = mean(paths),
            .path_largest = std::ranges::max(paths),
            .best_chord = spread_of(best_chords),
            .best_path = spread_of(best_paths)};
}

/// Whether two means agree by the spread of single runs. With 100 runs each does to one and a half
/// times that of both, the path of 10 m at 0.5 Hz, and to one all the others.
void expect_within_spread(const Spread& found, const Spread& published) {
    EXPECT_LE(std::abs(found.mean - published.mean),
              2.0 * std::hypot(found.sigma, published.sigma));
    EXPECT_LE(found.sigma, 2.0 * published.sigma);
    EXPECT_GE(found.sigma, 0.4 * published.sigma);
}

// Eight runs a row know a mean to a third of a run's spread, a hundred to a tenth.
TEST(InertialMast, MakesTheAntennaFasterThanTheCraft) {
    const int runs = draws({.daily = 8, .study = 100});
    for (const MastCase& mast : cases) {
        const MastErrors found = errors_of(mast, runs);
        const MastErrors& published = mast.published;
        SCOPED_TRACE(testing::Message() << mast.height_m << " m, " << mast.roll_deg << " degrees, "
                                        << mast.roll_hz << " Hz");
        EXPECT_NEAR(found.chord_rms / published.chord_rms, 1.0, 0.2);
        EXPECT_NEAR(found.path_mean, published.path_mean, 0.3 + 0.06 * published.path_mean);
        // The largest of 20 runs there.
        EXPECT_GT(found.chord_largest, 0.6 * published.chord_largest);
        EXPECT_LT(found.chord_largest, 1.6 * published.chord_largest);
        EXPECT_NEAR(found.path_largest / published.path_largest, 1.0, 0.3);
        expect_within_spread(found.best_chord, published.best_chord);
        expect_within_spread(found.best_path, published.best_path);
        std::printf(
            "%2.0f m, %2.0f deg, %.1f Hz, %.0f deg: chord RMS %.1f (%.1f), largest %.0f (%.0f); "
            "path "
            "mean %+.1f (%+.1f), largest %.0f (%.0f); best chord %+.1f +- %.1f (%+.1f +- %.1f), "
            "path %+.0f +- %.0f (%+.0f +- %.0f) mm/s\n",
            mast.height_m, mast.roll_deg, mast.roll_hz, mast.pitch_deg, found.chord_rms,
            published.chord_rms, found.chord_largest, published.chord_largest, found.path_mean,
            published.path_mean, found.path_largest, published.path_largest, found.best_chord.mean,
            found.best_chord.sigma, published.best_chord.mean, published.best_chord.sigma,
            found.best_path.mean, found.best_path.sigma, published.best_path.mean,
            published.best_path.sigma);
    }
}

// Published: RMS 1.6 mm/s whatever the mast, 1.7 at 1 Hz; best 3 s +0.2 +- 1.3. There the
// correlated error of the positions lasts 10 s; here it lasts 3, for which 1.8 is published.
TEST(InertialMast, LeavesLittleOnceTheImuHasBeenHeard) {
    const int runs = draws({.daily = 1, .study = 20});
    for (std::size_t k = 0; k < cases.size(); k += is_study() ? 1 : 3) {
        const MastCase& mast = cases[k];
        std::vector<double> squares(static_cast<std::size_t>(runs)), best(squares), nis(squares);
        for_each_run(runs, threads_allowed(), [&](std::int64_t i) {
            const InertialRunSpec spec = spec_of(mast, static_cast<int>(i));
            const InertialRun run = simulate_inertial(spec);
            const InertialSolution solution =
                smooth_inertial(run.samples, run.fixes, setup_of(spec));
            const test::SpeedErrors errors = test::speed_errors(run, solution, window, 3);
            const auto at = static_cast<std::size_t>(i);
            squares[at] = std::pow(root_mean_square(errors.errors_m_s), 2);
            best[at] = 1000.0 * errors.best_error_m_s;
            nis[at] = solution.consistency.nis;
        });
        const double rms = 1000.0 * std::sqrt(mean(squares));
        EXPECT_LE(rms, 2.5) << mast.height_m << " " << mast.roll_hz;
        EXPECT_GE(rms, 0.8) << mast.height_m << " " << mast.roll_hz;
        EXPECT_LE(std::abs(mean(best)), is_study() ? 1.0 : 4.5);
        EXPECT_NEAR(mean(nis), 1.0, is_study() ? 0.1 : 0.2);
        std::printf("%2.0f m, %2.0f deg, %.1f Hz: RMS %.2f, best %+.2f mm/s, NIS/3 %.2f\n",
                    mast.height_m, mast.roll_deg, mast.roll_hz, rms, mean(best), mean(nis));
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
