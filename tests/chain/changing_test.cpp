#include <atomic>
#include <fstream>
#include <functional>
#include <thread>

#include "attestations_support.h"

// Files that change while `verify` reads them.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class Changing : public Attestations {
  protected:
    /// What `verify` says of the run while `change` happens to it over and over.
    nlohmann::json verified_while(const std::function<void()>& change,
                                  const std::vector<std::string>& more = {}) const {
        std::atomic<bool> done{false};
        std::thread writer([&] {
            while (!done)
                change();
        });
        std::vector<std::string> arguments{"verify", run().string(), "--roster", roster(),
                                           "--json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const ProcessResult result = runcert(arguments);
        done = true;
        writer.join();
        // A program that is killed by a file that shrinks under it has no status of its own.
        EXPECT_LE(result.exit_status, 2) << result.errors;
        const auto json = nlohmann::json::parse(result.output, nullptr, false);
        return json.is_object() ? json : nlohmann::json::object({{"verdict", "none"}});
    }
};

// A table that has its own bytes when it is hashed and others when it is read.
TEST_F(Changing, AFileThatIsNowOneThingNowAnotherIsJudgedAsItWasReadFirst) {
    complete();
    for (const char* name :
         {"1-observations.ecsv", "4-trajectory.ecsv", "6-verdict.yaml", "report.json",
          "attempt.yaml", "profile.nalsa.yaml", "report.json.minisig", "recording.primary.pos"}) {
        SCOPED_TRACE(name);
        const std::string bytes = read_file(run() / name);
        std::string other = bytes;
        other[other.size() / 2] ^= 1;
        std::size_t turn = 0;
        const auto found = verified_while(
            [&] { write_file_atomically(run() / name, ++turn % 2 == 0 ? bytes : other); });
        write_file_atomically(run() / name, bytes);
        // One of the two: all of it holds, or the layer of the file says no.
        if (found["verdict"] != "none" && found["exit_status"] == 0) continue;
        EXPECT_FALSE(says(found.value("standing", nlohmann::json()), "Record beaten")) << found;
    }
}

TEST_F(Changing, AFileThatShrinksUnderItEndsNothing) {
    complete();
    for (const char* name : {"1-observations.ecsv", "4-trajectory.ecsv", "recording.primary.pos"}) {
        SCOPED_TRACE(name);
        const std::string bytes = read_file(run() / name);
        verified_while([&] {
            std::ofstream(run() / name, std::ios::trunc).close();
            std::ofstream(run() / name, std::ios::binary) << bytes;
        });
        write_file_atomically(run() / name, bytes);
    }
}

TEST_F(Changing, WhatIsDeletedOrAddedMeanwhileIsNoPartOfIt) {
    complete();
    const std::vector<std::string> more{"--recompute"};
    std::size_t turn = 0;
    const std::string envelope = "attestations/" + envelope_files(run()).front().name;
    const std::string bytes = read_file(run() / envelope);
    const auto found = verified_while(
        [&] {
            if (++turn % 2 == 0)
                write_file_atomically(run() / envelope, bytes);
            else
                fs::remove(run() / envelope);
        },
        more);
    EXPECT_TRUE(found["verdict"] == "VERIFIED" || found["verdict"] == "NOT VERIFIED" ||
                found["verdict"] == "none")
        << found.dump(1);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
