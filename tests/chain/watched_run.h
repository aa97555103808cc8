#pragma once

#include <gtest/gtest.h>

#include <set>

#include "chain_support.h"
#include "store/sha256.h"

namespace runcert::chain {

inline bool is_evidence(const std::string& name) {
    return name.starts_with("report.json.") &&
           (name.ends_with(".minisig") || name.ends_with(".tsr"));
}

/// What must be true of a run folder at every moment, and the evidence that it once held.
class Watched {
  public:
    explicit Watched(fs::path run) : run_(std::move(run)) {}

    /// Takes note of the signatures and time stamps that there are, none of which may ever go.
    void note() {
        for (const auto& [name, bytes] : contents_of(run_))
            if (is_evidence(name)) evidence_.insert(bytes);
    }

    /// `beside`: what else is in the folder.
    void expect_whole(const std::set<std::string>& beside = {}) {
        const auto files = contents_of(run_);
        ASSERT_TRUE(files.contains("report.json"));
        const auto report = nlohmann::json::parse(files.at("report.json"));
        std::set<std::string> named{"report.json", "run.yaml", "report.html", "certificate.pdf",
                                    "report.pdf"};
        for (const auto& subject : report.at("subject")) {
            const std::string name = subject.at("name");
            ASSERT_TRUE(files.contains(name)) << name;
            const auto hash = subject.at("digest").at("sha256").get<std::string>();
            EXPECT_EQ(sha256_hex(files.at(name)), hash) << name;
            named.insert(name);
        }
        for (const auto& [name, bytes] : files) {
            const bool known = named.contains(name) || beside.contains(name) ||
                               name.starts_with("report.json.") ||
                               name.starts_with("superseded/") || name.starts_with(".runcert-");
            EXPECT_TRUE(known) << name;
        }
        expect_evidence();
    }

    void expect_evidence() const {
        std::set<std::string> kept;
        for (const auto& [name, bytes] : contents_of(run_))
            kept.insert(bytes);
        for (const std::string& each : evidence_)
            EXPECT_TRUE(kept.contains(each)) << "a signature or time stamp is lost: " << each;
    }

  private:
    fs::path run_;
    std::set<std::string> evidence_;
};

}  // namespace runcert::chain
