#include "run/run_inventory.h"

#include "run/evidence.h"
#include "run/stage_run.h"

namespace runcert {
namespace {

/// A receiver's files, appended; the windows' name is the last.
void add_receiver(RunInventory& inventory, const Attempt& attempt, const Receiver& receiver) {
    const std::string observations = product_file(attempt, receiver, "1-observations", "ecsv");
    const std::string enu = product_file(attempt, receiver, "2-enu", "ecsv");
    const std::string screened = product_file(attempt, receiver, "3-screened", "ecsv");
    const std::string trajectory = product_file(attempt, receiver, "4-trajectory", "ecsv");
    const std::string windows = product_file(attempt, receiver, "5-windows", "yaml");
    auto& recorded = inventory.made_from[observations];
    for (const auto& files : {evidence_files(receiver), solution_files(receiver)})
        for (const EvidenceFile& file : files) {
            inventory.files.push_back(file.name);
            recorded.push_back(file.name);
        }
    inventory.made_from[enu] = {observations};
    inventory.made_from[screened] = {enu};
    inventory.made_from[trajectory] = {screened};
    inventory.made_from[windows] = {screened, trajectory};
    for (const std::string& file : {observations, enu, screened, trajectory, windows})
        inventory.files.push_back(file);
}

}  // namespace

RunInventory inventory_of(const Attempt& attempt) {
    const std::string verdict = "6-verdict.yaml";
    RunInventory inventory{.claim = {std::string(evidence_attempt_file)}};
    for (const std::string& claimed : attempt.profiles)
        inventory.claim.push_back(evidence_profile_file(claimed));
    for (const EvidenceFile& file : flow_files(attempt))
        inventory.claim.push_back(file.name);
    inventory.files = inventory.claim;
    std::vector<std::string> judged = inventory.claim;
    for (const Receiver& receiver : attempt.receivers) {
        add_receiver(inventory, attempt, receiver);
        for (const char* stem : {"1-observations", "2-enu", "3-screened", "4-trajectory"})
            judged.push_back(product_file(attempt, receiver, stem, "ecsv"));
        judged.push_back(product_file(attempt, receiver, "5-windows", "yaml"));
    }
    inventory.made_from[verdict] = std::move(judged);
    inventory.files.push_back(verdict);
    return inventory;
}

}  // namespace runcert
