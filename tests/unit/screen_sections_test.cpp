#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "motion/sections.h"
#include "stages/screen/screen.h"

namespace runcert::RUNCERT_FILE {
namespace {

ScreenConfig config() {
    const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
        "attempt");
    return screen_config(attempt);
}

std::vector<ArcEpoch<2>> epochs_of(std::size_t count) {
    std::vector<ArcEpoch<2>> epochs(count);
    for (std::size_t k = 0; k < count; ++k) {
        epochs[k].time_s = 0.1 * static_cast<double>(k);
        epochs[k].measurement.emplace();
    }
    return epochs;
}

TEST(Sections, AStretchOfLittleMoreThanOneIsOne) {
    const auto sections = sections_of<2>(epochs_of(1500), 1.0, 1000);
    ASSERT_EQ(sections.size(), 1U);
    EXPECT_EQ(sections[0].end, 1500U);
    EXPECT_EQ(sections[0].used_end, 1500U);
}

TEST(Sections, AnswerForEveryEpochOnceAndTakeInWhatCounts) {
    auto epochs = epochs_of(5321);
    for (const std::size_t hole : {600U, 601U, 2400U, 2401U})
        epochs[hole].measurement.reset();
    const double memory_s = 40.0;
    std::size_t next = 0;
    for (const ArcSection& section : sections_of<2>(epochs, memory_s, 1000)) {
        EXPECT_EQ(section.first, next);
        next = section.end;
        EXPECT_EQ(section.used_first % 10, 0U);
        EXPECT_TRUE(epochs[section.used_first].measurement);
        EXPECT_TRUE(epochs[section.used_end - 1].measurement);
        EXPECT_TRUE(section.used_first == 0 || section.first - section.used_first >= 400U);
        EXPECT_TRUE(section.used_end == epochs.size() || section.used_end - section.end >= 399U);
    }
    EXPECT_EQ(next, epochs.size());
}

/// A quarter of an hour with outliers, bursts, steps and a worse stretch, also where sections meet.
EnuTable wrong_run() {
    RandomGenerator random(5);
    EnuTable table;
    table.facts = {.receiver = "primary",
                   .first_epoch = std::nullopt,
                   .georeferenced = true,
                   .vertical_measured = true,
                   .nominal_interval_s = 0.1};
    double offset_m = 0.0;
    for (std::size_t k = 0; k < 9000; ++k) {
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
        const double worse = k > 6000 && k < 6500 ? 2.0 : 1.0;
        if (k == 3333 || k == 5101) offset_m += 0.8;
        const bool burst = k % 2000 >= 998 && k % 2000 < 1003;
        row.east_m = 3.0 * static_cast<double>(k) + 0.01 * worse * random.normal() +
                     (k % 499 == 250 ? 0.3 : 0.0);
        row.north_m = 0.01 * worse * random.normal() + offset_m + (burst ? 0.5 : 0.0);
        row.up_m = 0.02 * worse * random.normal() + (k % 700 == 699 ? 0.5 : 0.0);
        row.sigma_east_m = row.sigma_north_m = 0.01;
        row.sigma_up_m = 0.02;
        row.fix = FixType::fixed;
    }
    return table;
}

void expect_near(const std::optional<double>& a, const std::optional<double>& b, std::int64_t row) {
    ASSERT_EQ(a.has_value(), b.has_value()) << row;
    ASSERT_NEAR(a.value_or(0.0), b.value_or(0.0), 1e-8 * (1.0 + std::abs(b.value_or(0.0)))) << row;
}

TEST(Sections, WhatIsFoundDoesNotDependOnThem) {
    const EnuTable table = wrong_run();
    ScreenConfig in_sections = config();
    in_sections.section_epochs = 1000;
    const ScreenedTable whole = screen(table, config());
    const ScreenedTable cut = screen(table, in_sections);
    EXPECT_EQ(cut.basis.passes, whole.basis.passes);
    std::int64_t left_out = 0;
    std::int64_t breaks = 0;
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const ScreenedEpoch& a = cut.rows[i];
        const ScreenedEpoch& b = whole.rows[i];
        ASSERT_EQ(a.usable, b.usable) << b.epoch;
        ASSERT_EQ(a.reason, b.reason) << b.epoch;
        ASSERT_EQ(a.arc, b.arc) << b.epoch;
        ASSERT_EQ(a.break_before, b.break_before) << b.epoch;
        ASSERT_EQ(a.hypothesis, b.hypothesis) << b.epoch;
        expect_near(a.statistic, b.statistic, b.epoch);
        expect_near(a.local_variance_factor, b.local_variance_factor, b.epoch);
        expect_near(a.detectable.outlier_m, b.detectable.outlier_m, b.epoch);
        expect_near(a.detectable.step_m, b.detectable.step_m, b.epoch);
        expect_near(a.detectable.ramp_m_s, b.detectable.ramp_m_s, b.epoch);
        expect_near(a.detectable.step_up_m, b.detectable.step_up_m, b.epoch);
        expect_near(a.estimated.east_m, b.estimated.east_m, b.epoch);
        left_out += b.usable ? 0 : 1;
        breaks += b.break_before ? 1 : 0;
    }
    EXPECT_GT(left_out, 30);
    EXPECT_LT(left_out, 300);
    EXPECT_EQ(breaks, 3) << left_out << " left out";
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
