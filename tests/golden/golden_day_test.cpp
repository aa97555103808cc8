#include "golden_files.h"

// A day of the schema day/1.0: what its entries are with the defaults.

namespace runcert {
namespace {

using golden::text_of;

TEST(GoldenDay, EntriesWithTheirDefaults) {
    const DayFile day = read_day_file(text_of("v1.0/day.yaml"), "f");
    EXPECT_EQ(day.id, "lake-day_1");
    ASSERT_EQ(day.entries.size(), 4U);
    for (const DayEntry& entry : day.entries)
        EXPECT_FALSE(entry.refused) << entry.refused->what();

    EXPECT_EQ(day.entries[0].attempt, "heats/run-1.yaml");
    EXPECT_TRUE(day.entries[0].keys.empty());
    EXPECT_EQ(day.entries[0].line, 14);

    const Attempt second = read_attempt(attempt_text(day.entries[1].keys, "second"), "f");
    EXPECT_EQ(second.id, "run-2");
    EXPECT_EQ(second.craft_name, "0042");
    EXPECT_EQ(second.craft_class, "land-yacht");
    EXPECT_FALSE(second.record);
    ASSERT_EQ(second.receivers.size(), 1U);
    EXPECT_EQ(second.receivers[0].id, "primary");
    EXPECT_EQ(second.receivers[0].format, "csv");
    EXPECT_EQ(second.receivers[0].columns.at("time"), "1");
    EXPECT_EQ(second.parameters.at("smooth").at("jerk_density"), 1.0);

    auto keys = day.entries[2].keys;
    keys["id"] = "third";
    const Attempt third = read_attempt(attempt_text(keys, "third"), "f");
    EXPECT_EQ(third.receivers.at(0).recordings,
              (std::vector<std::string>{"first.csv", "second run.csv"}));
    EXPECT_EQ(third.receivers[0].columns.size(), 4U);
    EXPECT_EQ(third.profiles, (std::vector<std::string>{"fisly"}));
    EXPECT_EQ(third.record->speed, 202.9);

    const auto& heats = day.entries[3].keys;
    EXPECT_EQ(heats["id"], "heat-*");
    EXPECT_EQ(heats["place"], "\xe5\x90\x8d\xe5\x8f\xa4\xe5\xb1\x8b");
    EXPECT_EQ(heats["receivers"][0]["id"], "secondary");
    EXPECT_EQ(heats["receivers"][0]["lever_arm_m"]["down"], -1.25);
    EXPECT_EQ(heats["receivers"][1]["recording"], "left/*.csv");
}

}  // namespace
}  // namespace runcert
