#include "golden_files.h"

// What attempt/1.5, profile/1.4 and verdict/1.2 added for the report and its signatures.

namespace runcert {
namespace {

using golden::text_of;

TEST(GoldenSignatures, Attempt) {
    const Attempt attempt = read_attempt(text_of("v1.5/attempt.yaml"), "f");
    EXPECT_EQ(attempt.signatures,
              (std::vector<NeededSignatures>{{"measurer", 1}, {"observer", 2}}));
    ASSERT_TRUE(attempt.amends);
    EXPECT_EQ(attempt.amends->report_id, "0123456789abcdef");
    EXPECT_EQ(attempt.amends->sha256,
              "0011223344556677889900aabbccddeeff0011223344556677889900aabbccdd");
    EXPECT_EQ(attempt.amends->reason, "the antenna's height was wrong");
}

TEST(GoldenSignatures, Profile) {
    const Profile profile = read_profile(text_of("v1.4/profile.yaml"), "f");
    EXPECT_EQ(profile.signatures,
              (std::vector<NeededSignatures>{{"measurer", 2}, {"timekeeper", 1}}));
}

TEST(GoldenSignatures, RiskOfTheDecision) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
    ASSERT_TRUE(verdict.profiles.at(0).decision);
    EXPECT_EQ(verdict.profiles[0].decision->risk, 1.25e-7);
}

TEST(GoldenSignatures, EarlierRevisionsHaveNoneOfIt) {
    const Attempt attempt = read_attempt(text_of("v1.4/attempt.yaml"), "f");
    EXPECT_TRUE(attempt.signatures.empty());
    EXPECT_FALSE(attempt.amends);
    EXPECT_TRUE(read_profile(text_of("v1.3/profile.yaml"), "f").signatures.empty());
}

}  // namespace
}  // namespace runcert
