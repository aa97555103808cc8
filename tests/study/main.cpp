#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "coverage.h"
#include "selection_study.h"

using namespace runcert;

int main(int argc, char** argv) {
    CLI::App app{"Seeded studies of what the stated uncertainty is worth"};
    app.require_subcommand(1);
    CoverageOptions options;
    CLI::App* coverage =
        app.add_subcommand("coverage", "How often the 95 % intervals hold the true speed");
    coverage->add_option("--runs", options.runs, "recordings a cell, with fitted parameters")
        ->capture_default_str();
    coverage->add_option("--runs-known", options.runs_known, "the same with those known")
        ->capture_default_str();
    coverage->add_option("--seed", options.seed)->capture_default_str();
    std::int64_t runs = 500;
    std::uint64_t seed = 1;
    CLI::App* selection =
        app.add_subcommand("selection", "The bias of choosing the fastest of many windows");
    selection->add_option("--runs", runs)->capture_default_str();
    selection->add_option("--seed", seed)->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    if (coverage->parsed()) {
        std::vector<CoverageCell> cells;
        for (const double rate_hz : {10.0, 20.0})
            for (const CoverageCell& cell : coverage_cells(rate_hz)) {
                cells.push_back(study_coverage(cell, options));
                fmt::print(stderr, "{} of 14 cells\n", cells.size());
            }
        fmt::print("{}", coverage_table(cells));
    }
    if (selection->parsed())
        for (const double noise_m : {0.010, 0.030})
            fmt::print("{}", selection_line(study_selection(noise_m, runs, seed)));
}
