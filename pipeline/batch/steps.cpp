#include "batch/steps.h"

#include "run/run_inventory.h"
#include "run/stage_run.h"

namespace runcert {
namespace {

using Names = std::vector<std::string>;

void add_products(Names& names, const Attempt& attempt, std::string_view stem,
                  std::string_view extension = "ecsv") {
    for (const Receiver& receiver : attempt.receivers)
        names.push_back(product_file(attempt, receiver, stem, extension));
}

void append(Names& names, const Names& more) {
    names.insert(names.end(), more.begin(), more.end());
}

}  // namespace

const Names& step_names() {
    static const Names names{"claim",  "import", "enu",    "screen", "smooth",
                             "window", "check",  "report", "sign",   "render"};
    return names;
}

std::string program_of_step(std::string_view step) {
    if (step == "claim" || step == "sign") return {};
    return "runcert-" + std::string(step == "render" ? "report" : step);
}

bool is_step_of(std::string_view step, const ReportChoice& choice) {
    if (step == "sign") return !choice.signer.empty();
    return step != "render" || choice.render;
}

Names outputs_of_step(std::string_view step, const Attempt& attempt, const ReportChoice& choice) {
    const RunInventory inventory = inventory_of(attempt);
    Names names;
    if (step == "claim") return inventory.claim;
    if (step == "import")
        for (const Receiver& receiver : attempt.receivers) {
            const std::string observations =
                product_file(attempt, receiver, "1-observations", "ecsv");
            append(names, inventory.made_from.at(observations));
            names.push_back(observations);
        }
    if (step == "enu") add_products(names, attempt, "2-enu");
    if (step == "screen") add_products(names, attempt, "3-screened");
    if (step == "smooth") add_products(names, attempt, "4-trajectory");
    if (step == "window") add_products(names, attempt, "5-windows", "yaml");
    if (step == "check") names = {"6-verdict.yaml"};
    if (step == "report") names = {"report.json"};
    if (step == "render") names = {"report.html"};
    if (step == "render" && choice.pdf) names.emplace_back("report.pdf");
    return names;
}

Names inputs_of_step(std::string_view step, const Attempt& attempt) {
    if (step == "claim" || step == "import") return {};  // they read what is outside
    if (step == "sign" || step == "render") return {"report.json"};
    const RunInventory inventory = inventory_of(attempt);
    if (step == "report") return inventory.files;
    Names names;
    for (const std::string& output : outputs_of_step(step, attempt, {}))
        append(names, inventory.made_from.at(output));
    return names;
}

}  // namespace runcert
