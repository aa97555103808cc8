#include <gtest/gtest.h>

#include "schemas/screened/screened.h"
#include "store_test_support.h"

// What the screened table says of its tests.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

ScreenedTable table_of(std::vector<ScreenedEpoch> rows) {
    ScreenedTable table;
    table.header.stage = "screen";
    table.header.program_version = "1.0.0";
    table.header.source_revision = "0123456789ab";
    table.facts.receiver = "primary";
    table.rows = std::move(rows);
    return table;
}

ScreenedEpoch decided(Reason reason, std::optional<Hypothesis> hypothesis,
                      std::optional<ArcBreak> arc_break = std::nullopt) {
    ScreenedEpoch row;
    row.usable = reason == Reason::none;
    row.reason = reason;
    row.hypothesis = hypothesis;
    row.break_before = arc_break;
    return row;
}

ScreeningBasis basis() {
    ScreeningBasis basis;
    basis.family_false_alarm_rate = 0.001;
    basis.tests = 10'000'000;
    basis.test_size = 1e-10;
    basis.power = 0.8;
    basis.burst_epochs_max = 20;
    basis.passes = 2;
    basis.models = {
        {.axes = TestedAxes::vertical, .noise = NoiseBasis::fitted, .jerk_density = 0.5}};
    basis.fix_types = {
        {.fix = FixType::single, .epochs = 7, .judgement = AccuracyJudgement::pessimistic}};
    return basis;
}

TEST(ScreenedWords, EveryValueHasOneOfItsOwn) {
    const auto check = [](auto last) {
        using Enum = decltype(last);
        std::set<std::string_view> words;
        for (int i = 0; i <= static_cast<int>(last); ++i) {
            const auto value = static_cast<Enum>(i);
            const std::string_view word = to_text(value);
            EXPECT_TRUE(!word.empty() && words.insert(word).second) << i;
            Enum back{};
            EXPECT_TRUE(from_text(word, back)) << word;
            EXPECT_EQ(back, value) << word;
        }
        Enum none{};
        EXPECT_FALSE(from_text("slip", none));
    };
    check(Reason::baseline);
    check(ArcBreak::time_shift);
    check(Hypothesis::baseline);
    check(TestedAxes::vertical);
}

TEST(Summarise, CountsDecisionsByHypothesis) {
    const ScreeningSummary summary = summarise(
        {decided(Reason::none, Hypothesis::outlier),  // the best supported, not accepted
         decided(Reason::short_arc, Hypothesis::jerk), decided(Reason::innovation, std::nullopt),
         decided(Reason::outlier, Hypothesis::outlier), decided(Reason::burst, Hypothesis::burst),
         decided(Reason::burst, Hypothesis::burst), decided(Reason::model, Hypothesis::model),
         decided(Reason::velocity, Hypothesis::velocity),
         decided(Reason::physical_limit, Hypothesis::jerk),
         decided(Reason::physical_limit, Hypothesis::vertical_rate),
         decided(Reason::baseline, Hypothesis::baseline),
         decided(Reason::none, Hypothesis::step, ArcBreak::step),
         decided(Reason::none, Hypothesis::outlier, ArcBreak::step),
         decided(Reason::outlier, Hypothesis::outlier, ArcBreak::ramp),
         decided(Reason::none, std::nullopt, ArcBreak::time_shift),
         decided(Reason::none, std::nullopt, ArcBreak::gap),
         decided(Reason::none, std::nullopt, ArcBreak::innovation)});
    EXPECT_EQ(summary.decisions, (std::map<Hypothesis, std::int64_t>{{Hypothesis::outlier, 2},
                                                                     {Hypothesis::burst, 2},
                                                                     {Hypothesis::step, 2},
                                                                     {Hypothesis::ramp, 1},
                                                                     {Hypothesis::time_shift, 1},
                                                                     {Hypothesis::model, 1},
                                                                     {Hypothesis::velocity, 1},
                                                                     {Hypothesis::jerk, 1},
                                                                     {Hypothesis::vertical_rate, 1},
                                                                     {Hypothesis::baseline, 1}}));
    EXPECT_EQ(summary.reasons.at(Reason::burst), 2);
}

TEST(ScreeningBasis, RoundTripsWithoutWhatWasNotThere) {
    ScreenedTable table = table_of({decided(Reason::outlier, Hypothesis::outlier)});
    table.basis = basis();
    const std::string text = write_screened(table);
    EXPECT_NE(text.find("#     test_size: 1.0e-10\n"), std::string::npos) << text;
    EXPECT_NE(text.find("#     decisions:\n#       outlier: 1\n"), std::string::npos) << text;
    const ScreeningBasis back = read_screened(text, "f").basis;
    EXPECT_EQ(back.test_size, 1e-10);
    EXPECT_EQ(back.tests, 10'000'000);
    EXPECT_EQ(back.models.at(0).axes, TestedAxes::vertical);
    EXPECT_EQ(back.fix_types.at(0).fix, FixType::single);
    EXPECT_FALSE(back.velocity || back.baseline);
    EXPECT_TRUE(back.time.faults.empty());
    table.basis.velocity = VelocityComparison{};
    const VelocityComparison velocity = *read_screened(write_screened(table), "f").basis.velocity;
    EXPECT_FALSE(velocity.delay_s || velocity.sigma_delay_s);
}

TEST(ScreeningBasis, UnknownWordsAreRefused) {
    ScreenedTable table = table_of({});
    table.basis = basis();
    const std::string text = write_screened(table);
    const struct {
        std::string from, to, said;
    } cases[] = {
        {"axes: vertical", "axes: both", "\"both\" is not one of horizontal, vertical"},
        {"fix: single", "fix: double", "\"double\" is not one of unknown, none, single"},
        {"judgement: pessimistic", "judgement: odd", "\"odd\" is not one of as_stated"},
        {"noise: fitted", "noise: guessed", "\"guessed\" is not one of fitted"},
        {"power: 0.8", "power: 1.8", "1.8 is above 1"},
        {"#     limits:\n", "#     limit:\n", "unknown key \"limit\""},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_screened(replaced(text, c.from, c.to), "f"); });
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem;
    }
}

TEST(ScreeningBasis, OfTheDeviceRoundTrips) {
    ScreenedTable table = table_of({});
    table.basis = basis();
    EXPECT_FALSE(read_screened(write_screened(table), "f").basis.device);
    table.basis.device =
        DeviceSigns{.moving = 1200, .held = 11, .interpolated = 7, .by_chance = 0.126};
    const std::string text = write_screened(table);
    const DeviceSigns back = read_screened(text, "f").basis.device.value();
    EXPECT_EQ(back.moving, 1200);
    EXPECT_EQ(back.held, 11);
    EXPECT_EQ(back.interpolated, 7);
    EXPECT_EQ(back.by_chance, 0.13);
    const struct {
        std::string from, to, said;
    } cases[] = {
        {"moving: 1200", "moving: -1", "-1 is below 0"},
        {"held: 11", "held: 1.5", "not a whole number"},
        {"interpolated: 7", "interpolated: some", "not a whole number"},
        {"by_chance: 0.13", "by_chance: -0.5", "-0.5 is below 0"},
        {"#       held: 11\n", "", "the key \"held\" is missing"},
        {"#       by_chance: 0.13\n", "", "the key \"by_chance\" is missing"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_screened(replaced(text, c.from, c.to), "f"); });
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem;
    }
}

TEST(ScreenedColumns, OfManoeuvresRoundTripEachByItself) {
    ScreenedEpoch level = decided(Reason::none, std::nullopt);
    level.manoeuvre_m_s2 = 2.0 / 3.0;
    ScreenedEpoch upwards = decided(Reason::none, std::nullopt);
    upwards.manoeuvre_up_m_s2 = 1.25;
    const auto rows = read_screened(write_screened(table_of({level, upwards})), "f").rows;
    EXPECT_EQ(rows.at(0).manoeuvre_m_s2, 0.666667);
    EXPECT_FALSE(rows.at(0).manoeuvre_up_m_s2 || rows.at(1).manoeuvre_m_s2);
    EXPECT_EQ(rows.at(1).manoeuvre_up_m_s2, 1.25);
}

TEST(ScreenedColumns, OfTheTestsAreWrittenToTheirDecimals) {
    ScreenedEpoch row = decided(Reason::none, Hypothesis::time_shift, ArcBreak::time_shift);
    row.estimated.time_s = 0.0123456789;
    row.estimated.correlation_east_north = 0.12345678;
    row.detectable.time_s = 1.0 / 3.0;
    row.detectable.step_up_m = 1.0 / 3.0;
    row.local_variance_factor = 4.0 / 3.0;
    const ScreenedEpoch back = read_screened(write_screened(table_of({row})), "f").rows.at(0);
    EXPECT_EQ(back.estimated.time_s, 0.012345679);
    EXPECT_EQ(back.estimated.correlation_east_north, 0.123457);
    EXPECT_EQ(back.detectable.time_s, 0.333333333);
    EXPECT_EQ(back.detectable.step_up_m, 0.333333);
    EXPECT_EQ(back.local_variance_factor, 1.3333);
    EXPECT_FALSE(back.estimated.east_m || back.detectable.outlier_m || back.tested_axes);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
