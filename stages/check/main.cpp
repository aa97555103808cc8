#include <fmt/format.h>

#include "run/evidence.h"
#include "run/stage_main.h"
#include "stages/check/check.h"

using namespace runcert;

namespace {

ReceiverEvidence gather(StageRun& run, const Receiver& receiver) {
    const auto file = [&](std::string_view stem, std::string_view extension) {
        return product_file(run.attempt(), receiver, stem, extension);
    };
    const auto observations =
        run.read("observations", file("1-observations", "ecsv"), read_observations);
    run.read("enu", file("2-enu", "ecsv"), read_enu);
    const auto screened = run.read("screened", file("3-screened", "ecsv"), read_screened);
    auto trajectory = run.read("trajectory", file("4-trajectory", "ecsv"), read_trajectory);
    std::vector<std::int64_t> bridged;
    for (const ScreenedEpoch& row : screened.rows)
        if (row.break_before == ArcBreak::bridged) bridged.push_back(row.epoch);
    return {.receiver = receiver.id,
            .facts = observations.facts,
            .accuracy_source = observations.accuracy_source,
            .records = observations.records,
            .screening = summarise(screened.rows),
            .tests = screened.evidence,
            .estimation = trajectory.estimation,
            .windows = run.read("windows", file("5-windows", "yaml"), read_windows),
            .origin = trajectory.origin,
            .trajectory = std::move(trajectory.rows),
            .bridged_epochs = std::move(bridged)};
}

void say_verdict(StageRun& run, const Verdict& verdict) {
    for (const ProfileVerdict& profile : verdict.profiles)
        run.say(fmt::format("{}: {}: {}", profile.profile, profile.outcome, profile.reason));
}

}  // namespace

int main(int argc, char** argv) {
    return stage_main(argc, argv, "check",
                      "Every requirement of each rule profile, and the outcome", [](StageRun& run) {
                          run.note_attempt();
                          std::vector<Profile> profiles;
                          for (const std::string& claimed : run.attempt().profiles) {
                              profiles.push_back(read_claimed_profile(run.run_dir(), claimed));
                              run.read_text("profile", evidence_profile_file(claimed));
                          }
                          std::vector<ReceiverEvidence> receivers;
                          for (const Receiver& receiver : run.attempt().receivers)
                              receivers.push_back(gather(run, receiver));
                          Verdict verdict =
                              check({.attempt = run.attempt(),
                                     .profiles = profiles,
                                     .judged = receivers.front(),
                                     .secondary = receivers.size() > 1 ? &receivers[1] : nullptr});
                          verdict.header = run.header();
                          run.write("6-verdict.yaml", write_verdict(verdict));
                          say_verdict(run, verdict);
                      });
}
