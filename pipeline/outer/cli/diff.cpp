#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "outer_commands.h"
#include "reports/diff/run_difference.h"
#include "reports/document/document_text.h"
#include "trust/bundle.h"
#include "trust/verification.h"

namespace runcert {
namespace {

struct DiffOptions {
    std::string run_a;
    std::string run_b;
    bool json = false;
    bool all = false;
};

int diff(const DiffOptions& options) {
    const GivenRun a(options.run_a), b(options.run_b);
    require_known_versions(a.folder());
    require_known_versions(b.folder());
    const RunDifference difference = difference_of_runs(a.folder(), b.folder());
    if (options.json)
        fmt::print("{}\n",
                   difference_json(difference)
                       .dump(2, ' ', true, nlohmann::ordered_json::error_handler_t::replace));
    else
        fmt::print("{}", document_text(difference_document(difference, options.run_a, options.run_b,
                                                           options.all),
                                       terminal_columns()));
    return difference.equal() ? 0 : 1;
}

}  // namespace

void add_diff(CLI::App& app, Command& chosen) {
    auto [line, options] =
        add_command<DiffOptions>(app, chosen, "diff", "What differs between two run folders", diff);
    line.text("RUN_A", options.run_a, "folder that certify wrote, or a bundle of it",
              CommandLine::required);
    line.text("RUN_B", options.run_b, "another", CommandLine::required);
    line.flag("--all", options.all, "list every epoch and value, not the first 20");
    line.flag("--json", options.json, "one JSON document, complete, instead of text");
    line.footer(
        "Programs, inputs (by hash), parameters, attempt, epochs whose state changed, "
        "windows,\nverdicts, and the largest change in each column of each table against its "
        "standard\nuncertainty. Rows are matched by their time, rules, requirements and other "
        "entries of lists\nby what names them. One line says what is the same. Not compared: "
        "run.yaml, report, pages\nand signatures, which follow from the rest. Exit status: 0 "
        "nothing differs, 1 something\ndoes, 2 they could not be compared.");
}

}  // namespace runcert
