#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_json.h"
#include "reports_page_support.h"
#include "reports_sample.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

ScreenedTable& screened_of(sample::Run& run) {
    return run.inputs.receivers[0].screened;
}

ScreeningBasis& basis_of(sample::Run& run) {
    return screened_of(run).basis;
}

CertifiableWindow& best_of(sample::Run& run) {
    return *run.inputs.receivers[0].windows.profiles[0].best;
}

Json best_json(const sample::Run& run) {
    return members_json(*run.inputs.receivers[0].windows.profiles[0].best);
}

std::string line(const sample::Run& run, const std::string& name) {
    return fact_at(report_json(run.inputs), {"screening"}, name);
}

bool has_line(const sample::Run& run, const std::string& name) {
    return has_fact(report_json(run.inputs), {"screening"}, name);
}

std::string page_of(const sample::Run& run) {
    return print_page(report_json(run.inputs));
}

const Place undetected{"uncertainty", "Undetected errors", "nalsa"};

/// The report's sentences on the worst undetected error and on the remaining risk.
std::string words(const sample::Run& run) {
    return sentences_at(report_json(run.inputs), undetected);
}

TEST(Screening, DecisionsAreCountedByHypothesis) {
    sample::Run run = sample::make_run();
    std::int64_t bursts = 0;
    for (ScreenedEpoch& row : screened_of(run).rows)
        bursts += row.reason == Reason::burst ? 1 : 0;
    ASSERT_GT(bursts, 1);
    screened_of(run).rows[200].break_before = ArcBreak::step;
    screened_of(run).rows[300].break_before = ArcBreak::step;
    ScreenedEpoch& wrong = screened_of(run).rows[50];
    wrong.usable = false;
    wrong.reason = Reason::outlier;
    wrong.hypothesis = Hypothesis::outlier;
    EXPECT_EQ(
        line(run, "Decided by the tests"),
        fmt::format("outlier of one epoch at 1 epoch; outlier of several epochs at {} epochs; "
                    "step of the positions at 2 epochs",
                    bursts));
    for (ScreenedEpoch& row : screened_of(run).rows)
        row.hypothesis.reset(), row.break_before.reset();
    EXPECT_EQ(line(run, "Decided by the tests"), "nothing");
}

TEST(Screening, IsSaidInPlainWords) {
    sample::Run run = sample::make_run();
    EXPECT_EQ(line(run, "Tests"),
              "30,668, the recording gone through 2 times; each raises a false alarm with a "
              "probability of "
              "3.3e-08");
    EXPECT_EQ(
        line(run, "False alarms"),
        "of 1,000 recordings without an outlier at most one would have anything marked, by all "
        "tests together");
    // 1.3 and 1.02 are the roots of 1.69 and 1.0404.
    EXPECT_EQ(
        line(run, "Errors between epochs, horizontal"),
        "carrier phase, ambiguities fixed: 1.3 times the stated standard deviation, the errors "
        "are larger than stated (420 epochs)");
    EXPECT_EQ(
        line(run, "Errors between epochs, vertical"),
        "carrier phase, ambiguities fixed: 1.0 times the stated standard deviation, as stated "
        "(420 epochs)");
    EXPECT_NE(page_of(run).find("ambiguities not fixed: too few epochs to decide (31 epochs)"),
              std::string::npos);
    EXPECT_EQ(line(run, "Recorded velocities"),
              "0.1024 s ± 0.0021 s behind the positions, which is allowed for; compared at 437 "
              "epochs, they differ by 0.031 m/s and contradict 0");
    EXPECT_EQ(line(run, "Noise assumed, horizontal"),
              "estimated from the recording: 0.95 times the stated standard deviations, jerk "
              "density 0.43 m s^-2.5, no time-correlated error");
    EXPECT_EQ(line(run, "Noise assumed, vertical"),
              "estimated from the recording: 0.95 times the stated standard deviations, jerk "
              "density 0.43 m s^-2.5, a time-correlated error of 0.0271 m over 10 s");
    EXPECT_FALSE(has_line(run, "Fault of time stamps"));
    EXPECT_FALSE(has_line(run, "Other receiver"));

    basis_of(run).velocity->delay_s = -0.2;
    EXPECT_NE(line(run, "Recorded velocities").find("0.2000 s ± 0.0021 s ahead of the positions"),
              std::string::npos);
    basis_of(run).velocity->delay_s.reset();
    EXPECT_NE(line(run, "Recorded velocities").find("does not determine their delay"),
              std::string::npos);
    basis_of(run).velocity->compared = 0;
    EXPECT_EQ(line(run, "Recorded velocities"),
              "too few could be compared with the motion, or they never change");
    basis_of(run).models[0].noise = NoiseBasis::too_few_epochs;
    EXPECT_TRUE(
        line(run, "Noise assumed, horizontal").starts_with("too few epochs to estimate it: 0.95"));
    const std::string shown = section_html(page_of(run), "screening");
    EXPECT_NE(shown.find("runcert audit RUN_FOLDER lists every decision"), std::string::npos);
    EXPECT_NE(shown.find("of 1,000 recordings"), std::string::npos);
}

TEST(Screening, TheFirstFaultsOfTheTimeStampsAreListed) {
    sample::Run run = sample::make_run();
    TimeStampSummary& time = basis_of(run).time;
    time.gaps = 30;
    for (std::int64_t i = 0; i < 30; ++i)
        time.faults.push_back({.epoch = 10 + i, .kind = TimeFaultKind::gap, .size_s = 0.4});
    time.faults[1] = {.epoch = 11, .kind = TimeFaultKind::whole_second_shift, .size_s = -18.0};
    EXPECT_EQ(line(run, "Fault of time stamps"), "epoch 10: 0.400 s missing");
    EXPECT_EQ(line(run, "Further faults of time stamps"), "27");
    EXPECT_NE(page_of(run).find("epoch 11: the clock jumps by 18.000 s while the positions go on"),
              std::string::npos);
    time = {.sessions = 1, .gaps = 0, .longest_gap_s = 0.0, .duplicates = 1, .faults = {}};
    time.faults.push_back({.epoch = 7, .kind = TimeFaultKind::duplicate, .size_s = 0.0});
    EXPECT_EQ(line(run, "Fault of time stamps"), "epoch 7: the time of the epoch before");
    EXPECT_FALSE(has_line(run, "Further faults of time stamps"));
}

TEST(Screening, TheMethodIsThatOfTheFiles) {
    const Json report = report_json(sample::make_run().inputs);
    const std::string text = sentences_at(report, {"method"});
    for (const char* said :
         {"Baarda 1968", "Teunissen 2018", "de Jong & Penzer 1998", "up to 20 outliers in a row"})
        EXPECT_NE(text.find(said), std::string::npos) << said;
}

TEST(Reliability, WhatIsTakenOfUndetectedErrorsIsSaid) {
    sample::Run run = sample::make_run();
    SpeedEvidence& evidence = best_of(run).evidence.emplace();
    evidence.fault_probability = 0.002;
    evidence.fault_m_s = 0.25;
    evidence.at_a_fifth_m_s = 0.02;
    evidence.at_five_times_m_s = 0.03;
    best_of(run).bias_limit_m_s = 0.0;
    const std::string page = section_html(page_of(run), "uncertainty");
    // Twice 0.02 m/s and 0.03 m/s, rounded up.
    for (const char* sentence :
         {"An error larger than the size below is found with a probability of more than 0.8.",
          "In one window of 500 the positions are taken to err unseen, by up to 0.900 km/h. The "
          "interval carries that risk on average (row d), and would not hold the speed of such "
          "a window. Taken a fifth as often, the expanded uncertainty would be 0.15 km/h; five "
          "times as often, 0.22 km/h."}) {
        EXPECT_NE(words(run).find(sentence), std::string::npos) << words(run);
        EXPECT_NE(page.find(sentence), std::string::npos) << sentence;
    }
}

TEST(Reliability, EveryHypothesisStandsInReportAndPage) {
    sample::Run run = sample::make_run();
    const Json best = best_json(run);
    const auto& errors = best_of(run).reliability;
    EXPECT_EQ(best["detection_power"], 0.8);
    ASSERT_EQ(best["reliability"].size(), errors.size());
    Json rows;
    for (const Json& block : blocks_at(report_json(run.inputs), undetected))
        if (block.contains("rows")) rows = block["rows"];
    ASSERT_EQ(rows.size(), errors.size());
    const std::string page = section_html(page_of(run), "uncertainty");
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const Json& entry = best["reliability"][i];
        EXPECT_EQ(entry["hypothesis"], to_text(errors[i].hypothesis));
        EXPECT_EQ(entry["epoch"], errors[i].epoch);
        EXPECT_EQ(entry["last_epoch"], errors[i].last_epoch);
        EXPECT_EQ(entry["size"], errors[i].size);
        EXPECT_EQ(entry["unit"], errors[i].unit);
        EXPECT_EQ(entry["speed_m_s"], errors[i].speed_m_s);
        std::size_t at = 0;
        for (const Json& cell : rows[i]["cells"]) {
            at = page.find(fmt::format("<bdi>{}</bdi>", cell.get<std::string>()), at);
            EXPECT_NE(at, std::string::npos) << to_text(errors[i].hypothesis) << " " << cell;
        }
    }
    EXPECT_EQ(rows[2]["cells"][1], "at epochs 401 to 409");
    EXPECT_EQ(rows[4]["cells"][2], "–");
    EXPECT_EQ(rows[4]["cells"][3], "0");
}

TEST(Reliability, ARowSaysWhereSizeAndChange) {
    sample::Run run = sample::make_run();
    auto& errors = best_of(run).reliability;
    const auto expect_row = [&](const UndetectedError& error, const Json& cells) {
        errors[1] = error;
        EXPECT_EQ(row_at(report_json(run.inputs), undetected, cells[0])["cells"], cells);
    };
    errors.resize(2);
    // 0.0341 m/s are 0.123 km/h, 0.000693 m/s 0.00249 km/h.
    expect_row({Hypothesis::burst, 812, 812, 0.1034, "m", 0.0341},
               {"outlier of several epochs", "at epoch 812", "0.10 m", "0.123"});
    expect_row({Hypothesis::time_shift, 812, 812, 0.0021, "s", 0.000693},
               {"jump of the time stamps", "before epoch 812", "0.0021 s", "0.00249"});
    expect_row({Hypothesis::step, 812, 812, 1e6, "m", 1e6},
               {"step of the positions", "before epoch 812", "any", "no limit"});
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
