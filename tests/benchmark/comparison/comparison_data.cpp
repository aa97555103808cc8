#include "comparison_data.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "store/atomic_file.h"

namespace runcert::comparison {

std::vector<MeasuredPosition> read_positions(const std::filesystem::path& file) {
    constexpr std::size_t bytes_per_epoch = doubles_per_epoch * sizeof(double);
    const FileView view(file);
    const std::string_view bytes = view.bytes();
    if (bytes.empty() || bytes.size() % bytes_per_epoch != 0)
        throw Failure(file.string(),
                      fmt::format("its {} bytes are not whole epochs of {} bytes", bytes.size(),
                                  bytes_per_epoch),
                      "Make it again with runcert-comparison-data");
    std::vector<MeasuredPosition> positions(bytes.size() / bytes_per_epoch);
    for (std::size_t k = 0; k < positions.size(); ++k) {
        Eigen::Matrix<double, doubles_per_epoch, 1> v;
        std::memcpy(v.data(), bytes.data() + k * bytes_per_epoch, bytes_per_epoch);
        positions[k].position = v.head<3>();
        positions[k].covariance << v(3), v(4), v(5), v(4), v(6), v(7), v(5), v(7), v(8);
    }
    return positions;
}

void write_points(const std::filesystem::path& file, std::size_t epochs, std::size_t every,
                  const std::function<SmoothedPoint(std::size_t epoch)>& point_of) {
    std::vector<double> values;
    values.reserve(12 * (epochs / every + 1));
    for (std::size_t k = 0; k < epochs; k += every) {
        const SmoothedPoint point = point_of(k);
        values.insert(values.end(), point.mean.begin(), point.mean.end());
        values.insert(values.end(), point.sigma.begin(), point.sigma.end());
    }
    write_file_atomically(
        file, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)});
}

double seconds_of(const std::function<void()>& call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

int run_program(int argc, char** argv,
                const std::function<nlohmann::ordered_json(const Arguments&)>& program) {
    CLI::App app("One of the programs that tests/benchmark/run measures beside one another.");
    Arguments arguments;
    app.add_option("--data", arguments.data, "positions.bin of runcert-comparison-data")
        ->required();
    app.add_option("--result", arguments.result, "where the smoothed points go")->required();
    app.add_option("--every", arguments.every, "of which epochs (default: 1)")
        ->check(CLI::PositiveNumber);
    try {
        app.parse(argc, argv);
        fmt::print("{}\n", program(arguments).dump());
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}: {}\n", argv[0], error.what());
        return 2;
    }
}

}  // namespace runcert::comparison
