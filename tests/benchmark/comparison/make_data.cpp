#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>

#include "comparison_data.h"
#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"
#include "store/atomic_file.h"

// Makes what tests/benchmark/run measures with: an attempt with a recording as RTKLIB writes it,
// the same positions for the smoothers, and an attempt with NMEA.

namespace runcert::comparison {
namespace {

constexpr double pi = std::numbers::pi;

/// Where the course is.
const Geodetic origin{Angle::from_degrees(-31.6), Angle::from_degrees(136.0), 110.0};

/// A steady Gauss-Markov error of each axis beside the white one, too small to be screened out.
constexpr double slow_sigma_m = 0.003;
constexpr double slow_time_s = 5.0;

/// Some terms of a motion that comes back for ever: it stays within 0.9 km of the origin and below
/// 70 m/s, and never repeats.
struct Swing {
    int axis;
    double amplitude_m, period_s;
};
constexpr std::array swings{Swing{0, 400.0, 97.0}, Swing{0, 150.0, 53.0}, Swing{1, 700.0, 131.0},
                            Swing{1, 100.0, 41.0}, Swing{2, 0.4, 211.0}};

/// A number as a recording has it.
double rounded(double value, double step) {
    return std::round(value / step) * step;
}

/// Positions with errors drawn from covariances that differ from epoch to epoch. The covariances
/// are what a recording can state: tenths of millimetres, and of their roots.
class Positions {
  public:
    explicit Positions(std::uint64_t seed) : random_(seed) {
        for (double& phase : phases_)
            phase = 2.0 * pi * random_.uniform();
        for (int axis = 0; axis < 3; ++axis)
            slow_(axis) = slow_sigma_m * random_.normal();
    }

    /// That of the next epoch.
    MeasuredPosition next() {
        const double time_s = static_cast<double>(epoch_++) * step_s;
        MeasuredPosition measured{.position = truth(time_s), .covariance = covariance(time_s)};
        const double kept = std::exp(-step_s / slow_time_s);
        for (int axis = 0; axis < 3; ++axis)
            slow_(axis) =
                kept * slow_(axis) + slow_sigma_m * std::sqrt(1.0 - kept * kept) * random_.normal();
        const Eigen::Matrix3d factor = measured.covariance.llt().matrixL();
        // One after the other: the order in which arguments are evaluated is the compiler's.
        Eigen::Vector3d white;
        for (double& one : white)
            one = random_.normal();
        measured.position += factor * white + slow_;
        return measured;
    }

  private:
    Eigen::Vector3d truth(double time_s) const {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < swings.size(); ++i)
            position(swings[i].axis) +=
                swings[i].amplitude_m *
                std::sin(2.0 * pi * time_s / swings[i].period_s + phases_[i]);
        return position;
    }

    Eigen::Matrix3d covariance(double time_s) {
        // As satellites rise and set (minutes), and from epoch to epoch.
        const double level = 1.0 + 0.3 * std::sin(2.0 * pi * time_s / 600.0);
        const Eigen::Vector3d usual_m(0.005, 0.006, 0.011);
        Eigen::Vector3d sigma;
        for (int axis = 0; axis < 3; ++axis)
            sigma(axis) = rounded(level * usual_m(axis) * (0.85 + 0.3 * random_.uniform()), 1e-4);
        Eigen::Matrix3d covariance = sigma.cwiseAbs2().asDiagonal();
        for (int row = 0; row < 3; ++row)
            for (int column = row + 1; column < 3; ++column) {
                const double correlation = 0.4 * std::sin(2.0 * pi * time_s / 400.0 + row) +
                                           0.1 * (random_.uniform() - 0.5);
                const double root =
                    rounded(std::sqrt(std::abs(correlation) * sigma(row) * sigma(column)), 1e-4);
                covariance(row, column) = covariance(column, row) =
                    std::copysign(root * root, correlation);
            }
        return covariance;
    }

    RandomGenerator random_;
    std::array<double, swings.size()> phases_{};
    Eigen::Vector3d slow_ = Eigen::Vector3d::Zero();
    std::int64_t epoch_ = 0;
};

std::string binary_of(std::int64_t epochs, std::uint64_t seed) {
    constexpr std::size_t bytes_per_epoch = doubles_per_epoch * sizeof(double);
    std::string bytes(static_cast<std::size_t>(epochs) * bytes_per_epoch, '\0');
    Positions positions(seed);
    for (std::size_t at = 0; at < bytes.size(); at += bytes_per_epoch) {
        const auto [p, c] = positions.next();
        const std::array<double, doubles_per_epoch> row{p(0),    p(1),    p(2),    c(0, 0), c(0, 1),
                                                        c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
        std::memcpy(bytes.data() + at, row.data(), bytes_per_epoch);
    }
    return bytes;
}

/// RTKLIB's sdne and the like: the root of a covariance with its sign.
double signed_root(double covariance) {
    return std::copysign(std::sqrt(std::abs(covariance)), covariance);
}

/// As RTKLIB 2.4.3 writes a solution file by default, but with 20 Hz.
std::string pos_of(std::int64_t epochs, std::uint64_t seed) {
    constexpr std::int64_t first_week = 2409, first_ms = 530'418'000, week_ms = 604'800'000;
    std::string text =
        "% program   : runcert-comparison-data (no receiver: this recording is simulated)\n"
        "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float,3:sbas,4:dgps,5:single,6:ppp,"
        "ns=# of satellites)\n"
        "%  GPST          latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   "
        "sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio\n";
    text.reserve(static_cast<std::size_t>(epochs) * 135);
    const LocalFrame frame(origin);
    Positions positions(seed);
    for (std::int64_t k = 0; k < epochs; ++k) {
        const auto [position, c] = positions.next();
        const Geodetic place = frame.geodetic_from_enu({position});
        const std::int64_t ms = first_ms + 50 * k;
        fmt::format_to(std::back_inserter(text),
                       "{:4d} {:6d}.{:03d} {:14.9f} {:14.9f} {:10.4f} {:3d} {:3d} {:8.4f} {:8.4f} "
                       "{:8.4f} {:8.4f} {:8.4f} {:8.4f} {:6.2f} {:6.1f}\n",
                       first_week + ms / week_ms, ms % week_ms / 1000, ms % 1000,
                       place.latitude.degrees(), place.longitude.degrees(), place.height_m, 1, 14,
                       std::sqrt(c(1, 1)), std::sqrt(c(0, 0)), std::sqrt(c(2, 2)),
                       signed_root(c(0, 1)), signed_root(c(0, 2)), signed_root(c(1, 2)), 0.05,
                       25.0);
    }
    return text;
}

std::string sentence(const std::string& body) {
    unsigned sum = 0;
    for (const char c : body)
        sum ^= static_cast<unsigned char>(c);
    return fmt::format("${}*{:02X}\r\n", body, sum);
}

/// Degrees and minutes of one coordinate, seven decimals (0.2 mm).
std::string degrees_minutes(double degrees, int width, char positive, char negative) {
    // In whole steps, so that no minute is written as 60.
    const auto steps = std::llround(std::abs(degrees) * 60.0 * 1e7);
    constexpr std::int64_t degree = 600'000'000;
    return fmt::format("{:0{}d}{:02d}.{:07d},{}", steps / degree, width,
                       steps % degree / 10'000'000, steps % 10'000'000,
                       degrees < 0.0 ? negative : positive);
}

/// GGA, RMC and GST for each epoch, from midnight on.
std::string nmea_of(std::int64_t epochs, std::uint64_t seed) {
    std::string text;
    const LocalFrame frame(origin);
    Positions positions(seed);
    for (std::int64_t k = 0; k < epochs; ++k) {
        const auto [position, c] = positions.next();
        const Geodetic at = frame.geodetic_from_enu({position});
        const std::int64_t ms = 50 * k;
        const std::string time = fmt::format("{:02d}{:02d}{:02d}.{:02d}", ms / 3'600'000,
                                             ms / 60'000 % 60, ms / 1000 % 60, ms % 1000 / 10);
        const std::string place = degrees_minutes(at.latitude.degrees(), 2, 'N', 'S') + "," +
                                  degrees_minutes(at.longitude.degrees(), 3, 'E', 'W');
        text += sentence(fmt::format("GNGGA,{},{},4,14,0.7,{:.4f},M,0.000,M,0.5,0001", time, place,
                                     at.height_m));
        text += sentence(fmt::format("GNRMC,{},A,{},48.512,271.33,140326,,,R", time, place));
        text += sentence(fmt::format("GNGST,{},4.2,{:.4f},{:.4f},33.1,{:.4f},{:.4f},{:.4f}", time,
                                     std::sqrt(c(1, 1)), std::sqrt(c(0, 0)), std::sqrt(c(1, 1)),
                                     std::sqrt(c(0, 0)), std::sqrt(c(2, 2))));
    }
    return text;
}

std::string attempt_of(const std::string& recording, const std::string& format) {
    return fmt::format(
        "# Made by runcert-comparison-data: the recording is simulated.\n"
        "schema: attempt/1.0\n"
        "id: comparison\n"
        "craft: {{name: simulated land yacht, class: land-yacht}}\n"
        "place: salt lake (simulated)\n"
        "date: \"2026-03-14\"\n"
        "officials: [{{role: measurer}}]\n"
        "receivers: [{{id: primary, recording: {}, format: {}}}]\n"
        "origin: {{latitude_deg: {}, longitude_deg: {}, height_m: {}}}\n"
        "record: {{speed: 222.43, unit: km/h, source: \"simulated\"}}\n"
        "profiles: [nalsa, fisly]\n",
        recording, format, origin.latitude.degrees(), origin.longitude.degrees(), origin.height_m);
}

struct Options {
    std::int64_t epochs = 451;
    std::uint64_t seed = 9;
    std::filesystem::path out;
    bool nmea = false;
};

/// Each file from its own pass over the same random numbers, so that one is in memory at a time.
void make(const Options& options) {
    std::filesystem::create_directories(options.out);
    write_file_atomically(options.out / "positions.bin", binary_of(options.epochs, options.seed));
    write_file_atomically(options.out / "recording.pos", pos_of(options.epochs, options.seed));
    write_file_atomically(options.out / "attempt.yaml", attempt_of("recording.pos", "rtklib-pos"));
    if (!options.nmea) return;
    constexpr std::int64_t day = 1'728'000;
    if (options.epochs > day)
        throw Failure("--nmea", fmt::format("{} epochs are more than a day", options.epochs),
                      fmt::format("Make at most {} of NMEA", day));
    write_file_atomically(options.out / "recording.nmea", nmea_of(options.epochs, options.seed));
    write_file_atomically(options.out / "nmea.yaml", attempt_of("recording.nmea", "nmea"));
}

int run(int argc, char** argv) {
    CLI::App app("Makes the data of tests/benchmark/run.");
    Options options;
    app.add_option("--epochs", options.epochs, "at 20 Hz (default: 451)")
        ->check(CLI::Range(4, 100'000'000));
    app.add_option("--seed", options.seed, "of the random numbers (default: 9)");
    app.add_option("--out", options.out, "the folder that they go to")->required();
    app.add_flag("--nmea", options.nmea, "as NMEA too");
    try {
        app.parse(argc, argv);
        make(options);
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "runcert-comparison-data: {}\n", error.what());
        return 2;
    }
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run(argc, argv);
}
