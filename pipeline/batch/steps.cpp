#include "batch/steps.h"

#include <algorithm>
#include <array>

#include "run/evidence.h"
#include "run/stage_run.h"

namespace runcert {
namespace {

using Names = std::vector<std::string>;

void add_products(Names& names, const Attempt& attempt, std::string_view stem,
                  std::string_view extension = "ecsv") {
    for (const Receiver& receiver : attempt.receivers)
        names.push_back(product_file(attempt, receiver, stem, extension));
}

Names claim_files(const Attempt& attempt) {
    Names names;
    for (const std::string& claimed : attempt.profiles)
        names.push_back(evidence_profile_file(claimed));
    for (const EvidenceFile& file : flow_files(attempt))
        names.push_back(file.name);
    names.emplace_back(evidence_attempt_file);
    return names;
}

Names import_files(const Attempt& attempt) {
    Names names;
    for (const Receiver& receiver : attempt.receivers) {
        for (const EvidenceFile& file : evidence_files(receiver))
            names.push_back(file.name);
        for (const EvidenceFile& file : solution_files(receiver))
            names.push_back(file.name);
    }
    add_products(names, attempt, "1-observations");
    return names;
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

Names inputs_of_step(std::string_view step, const Attempt& attempt) {
    Names names;
    if (step == "enu") add_products(names, attempt, "1-observations");
    if (step == "screen") add_products(names, attempt, "2-enu");
    if (step == "smooth" || step == "window") add_products(names, attempt, "3-screened");
    if (step == "window") add_products(names, attempt, "4-trajectory");
    if (step == "check" || step == "report") {
        names = claim_files(attempt);
        append(names, import_files(attempt));
        for (const char* stem : {"2-enu", "3-screened", "4-trajectory"})
            add_products(names, attempt, stem);
        add_products(names, attempt, "5-windows", "yaml");
    }
    if (step == "report") names.emplace_back("6-verdict.yaml");
    if (step == "sign" || step == "render") names = {"report.json"};
    return names;
}

Names outputs_of_step(std::string_view step, const Attempt& attempt, const ReportChoice& choice) {
    Names names;
    if (step == "claim") return claim_files(attempt);
    if (step == "import") return import_files(attempt);
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

}  // namespace runcert
