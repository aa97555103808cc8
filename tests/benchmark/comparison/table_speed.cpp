#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "comparison_data.h"
#include "core/failure.h"
#include "stages/import/import.h"
#include "store/atomic_file.h"

// How fast the library reads a recording into rows, writes these rows as a table, and reads that
// table again: from memory to memory, so that no disk is measured.

namespace runcert::comparison {
namespace {

nlohmann::ordered_json measured(const std::filesystem::path& file) {
    const std::string text = read_file(file);
    Receiver receiver;
    receiver.id = "primary";
    receiver.format = "auto";
    Observations rows;
    const double read_pos_s = seconds_of(
        [&] { rows = import_recording(receiver, {.name = file.filename(), .bytes = text}); });
    std::string table;
    const double write_ecsv_s = seconds_of([&] { table = write_observations(rows); });
    const std::size_t count = rows.rows.size();
    const double read_ecsv_s = seconds_of([&] { rows = read_observations(table, "table"); });
    if (rows.rows.size() != count)
        throw Failure(file.string(), "the table read has other rows than the one written",
                      "Run the tests of the tables");
    return {{"epochs", count},
            {"pos_bytes", text.size()},
            {"ecsv_bytes", table.size()},
            {"read_pos_seconds", read_pos_s},
            {"write_ecsv_seconds", write_ecsv_s},
            {"read_ecsv_seconds", read_ecsv_s}};
}

int run(int argc, char** argv) {
    CLI::App app("Times reading a recording, and writing and reading its table.");
    std::filesystem::path recording;
    app.add_option("recording", recording, "a recording")->required();
    try {
        app.parse(argc, argv);
        fmt::print("{}\n", measured(recording).dump());
        return 0;
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : 2;
    } catch (const std::exception& error) {
        fmt::print(stderr, "runcert-comparison-tables: {}\n", error.what());
        return 2;
    }
}

}  // namespace
}  // namespace runcert::comparison

int main(int argc, char** argv) {
    return runcert::comparison::run(argc, argv);
}
