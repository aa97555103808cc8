#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/random.h"
#include "stages/screen/epoch_checks.h"
#include "stages/screen/time_check.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Rows = std::vector<ScreenedEpoch>;

constexpr std::int64_t second_ns = 1'000'000'000;

void number_epochs(Rows& rows) {
    for (std::size_t k = 0; k < rows.size(); ++k)
        rows[k].epoch = static_cast<std::int64_t>(k) + 1;
}

ScreenedEpoch epoch_at(std::int64_t time_ns, double east_m, double north_m,
                       RandomGenerator& noise) {
    ScreenedEpoch row;
    row.time.nanoseconds = time_ns;
    row.east_m = east_m + 0.01 * noise.normal();
    row.north_m = north_m + 0.01 * noise.normal();
    row.sigma_east_m = row.sigma_north_m = 0.01;
    row.fix = FixType::fixed;
    return row;
}

/// Laps of 500 m radius at `speed_m_s`, 10 mm noise, stamps in the nearest millisecond.
Rows recording(std::size_t epochs, double speed_m_s, double rate_hz = 10.0,
               std::uint64_t seed = 1) {
    RandomGenerator noise(seed);
    Rows rows;
    for (std::size_t k = 0; k < epochs; ++k) {
        const double time_s = static_cast<double>(k) / rate_hz;
        const double angle = speed_m_s * time_s / 500.0;
        rows.push_back(epoch_at(std::llround(time_s * 1e3) * 1'000'000, 500.0 * std::cos(angle),
                                500.0 * std::sin(angle), noise));
    }
    number_epochs(rows);
    return rows;
}

void set_clock(Rows& rows, std::size_t first, double by_s) {
    for (std::size_t k = first; k < rows.size(); ++k)
        rows[k].time.nanoseconds += std::llround(by_s * 1e9);
}

void lose(Rows& rows, std::size_t first, std::size_t count) {
    const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(first);
    rows.erase(begin, begin + static_cast<std::ptrdiff_t>(count));
}

void repeat(Rows& rows, std::size_t row) {
    const ScreenedEpoch copy = rows[row];
    rows.insert(rows.begin() + static_cast<std::ptrdiff_t>(row), copy);
}

void swap_rows(Rows& rows, std::size_t row) {
    std::swap(rows[row], rows[row + 1]);
}

/// The craft is elsewhere from here on.
void carry(Rows& rows, std::size_t first, double by_m) {
    for (std::size_t k = first; k < rows.size(); ++k)
        *rows[k].north_m += by_m;
}

TimeStampSummary examine(Rows rows, double nominal_s = 0.1) {
    number_epochs(rows);
    return examine_time({rows.begin(), rows.end()}, {.nominal_interval_s = nominal_s});
}

void expect_faults(const TimeStampSummary& found, const std::vector<TimeFault>& expected) {
    std::int64_t sessions = 1;
    ASSERT_EQ(found.faults.size(), expected.size());
    for (std::size_t k = 0; k < expected.size(); ++k) {
        SCOPED_TRACE(k);
        EXPECT_EQ(found.faults[k].kind, expected[k].kind);
        EXPECT_EQ(found.faults[k].epoch, expected[k].epoch);
        EXPECT_NEAR(found.faults[k].size_s, expected[k].size_s, 1e-9);
        sessions += expected[k].kind == TimeFaultKind::session ? 1 : 0;
    }
    EXPECT_EQ(found.sessions, sessions);
}

TEST(TimeCheck, ACleanRecordingHasNoFault) {
    for (const double speed_m_s : {0.0, 0.5, 5.0, 60.0})
        for (const double rate_hz : {1.0, 5.0, 10.0, 20.0, 100.0}) {
            const TimeStampSummary found =
                examine(recording(2000, speed_m_s, rate_hz), 1.0 / rate_hz);
            expect_faults(found, {});
            EXPECT_EQ(found.gaps + found.duplicates + found.backward, 0);
            EXPECT_EQ(found.longest_gap_s, 0.0);
            EXPECT_NEAR(found.rate_deviation, 0.0, 1e-15);
            EXPECT_NEAR(found.jitter_s, 0.0, 1e-12);
        }
}

TEST(TimeCheck, StampsOfThreeDecimalsAtThreeHertzAreNoFault) {
    const Rows rows = recording(3001, 30.0, 3.0);
    EXPECT_EQ(rows[1].time.nanoseconds, 333'000'000);
    EXPECT_EQ(rows[2].time.nanoseconds, 667'000'000);
    const TimeStampSummary found = examine(rows, 0.333);
    expect_faults(found, {});
    EXPECT_NEAR(found.rate_deviation, 0.0, 1e-12);
    // Of 0.333, 0.334, 0.333.
    EXPECT_NEAR(found.jitter_s, std::sqrt(2.0) / 3.0 * 1e-3, 1e-7);
}

using Damage = std::function<void(Rows&)>;

Damage clock_set(double by_s) {
    return [by_s](Rows& rows) { set_clock(rows, 500, by_s); };
}
Damage new_session(double by_s) {
    return [by_s](Rows& rows) { set_clock(rows, 500, by_s), carry(rows, 500, 80.0); };
}
Damage one_stamp(double by_s) {
    return [by_s](Rows& rows) { rows[500].time.nanoseconds += std::llround(by_s * 1e9); };
}
Damage lost(std::size_t count) {
    return [count](Rows& rows) { lose(rows, 500, count); };
}
void early_session_with_late_row(Rows& rows) {
    new_session(-3600)(rows);
    swap_rows(rows, 700);
}
void early_session_between_two(Rows& rows) {
    new_session(-3600)(rows);
    set_clock(rows, 700, 7200);
    carry(rows, 700, 80.0);
}
void write_again(Rows& rows) {
    const Rows copy(rows.begin() + 480, rows.begin() + 500);
    rows.insert(rows.begin() + 500, copy.begin(), copy.end());
}

struct FaultCase {
    const char* name;
    double speed_m_s;
    Damage damage;
    std::vector<TimeFault> faults;
    std::vector<std::int64_t> counts;  ///< gaps, duplicates, backward
};

TEST(TimeCheck, EachFaultAlone) {
    constexpr TimeFaultKind shift = TimeFaultKind::whole_second_shift;
    const FaultCase cases[] = {
        {"rows lost", 30, lost(4), {{501, TimeFaultKind::gap, 0.4}}, {1, 0, 0}},
        {"a whole second lost", 30, lost(10), {{501, TimeFaultKind::gap, 1}}, {1, 0, 0}},
        {"row twice",
         30,
         [](Rows& r) { repeat(r, 500); },
         {{502, TimeFaultKind::duplicate, 0}},
         {0, 1, 0}},
        {"late row",
         30,
         [](Rows& r) { swap_rows(r, 500); },
         {{501, TimeFaultKind::gap, 0.1}, {502, TimeFaultKind::backward, -0.2}},
         {1, 0, 1}},
        {"set back, caught up",
         0,
         clock_set(-100),
         {{501, TimeFaultKind::backward, -100}},
         {0, 0, 1}},
        {"no whole second",
         30,
         clock_set(-99.95),
         {{501, TimeFaultKind::backward, -99.95}},
         {0, 0, 1}},
        {"forward, parked", 0, clock_set(1), {{501, TimeFaultKind::gap, 1}}, {1, 0, 0}},
        {"leap seconds, parked", 0, clock_set(18), {{501, TimeFaultKind::gap, 18}}, {1, 0, 0}},
        {"one second forward", 30, clock_set(1), {{501, shift, 1}}, {1, 0, 0}},
        {"one second back", 30, clock_set(-1), {{501, shift, -1}}, {0, 0, 1}},
        {"leap seconds forward", 30, clock_set(18), {{501, shift, 18}}, {1, 0, 0}},
        {"leap seconds back", 30, clock_set(-18), {{501, shift, -18}}, {0, 0, 1}},
        {"another time zone", 30, clock_set(-3600), {{501, shift, -3600}}, {0, 0, 1}},
        {"second session", 30, new_session(300), {{501, TimeFaultKind::session, 300}}, {1, 0, 0}},
        {"early session",
         30,
         new_session(-3600),
         {{501, TimeFaultKind::session, -3600}},
         {0, 0, 1}},
        {"early session with a late row",
         30,
         early_session_with_late_row,
         {{501, TimeFaultKind::session, -3600},
          {701, TimeFaultKind::gap, 0.1},
          {702, TimeFaultKind::backward, -0.2}},
         {1, 0, 2}},
        {"early session between two",
         30,
         early_session_between_two,
         {{501, TimeFaultKind::session, -3600}, {701, TimeFaultKind::session, 3620}},
         {1, 0, 1}},
        {"one stamp far ahead",
         30,
         one_stamp(5000),
         {{501, TimeFaultKind::gap, 5000}, {502, TimeFaultKind::backward, -5000}},
         {1, 0, 1}},
        {"one stamp far back",
         30,
         one_stamp(-5000),
         {{501, TimeFaultKind::backward, -5000}, {502, TimeFaultKind::gap, 0.1}},
         {1, 0, 1}},
        {"rows written again", 30, write_again, {{501, TimeFaultKind::backward, -2}}, {0, 0, 1}}};
    for (const FaultCase& one : cases) {
        SCOPED_TRACE(one.name);
        Rows rows = recording(3000, one.speed_m_s);
        one.damage(rows);
        const TimeStampSummary found = examine(rows);
        expect_faults(found, one.faults);
        const std::vector<std::int64_t> counts{found.gaps, found.duplicates, found.backward};
        EXPECT_EQ(counts, one.counts);
        EXPECT_NEAR(found.rate_deviation, 0.0, 1e-12);
    }
}

TEST(TimeCheck, FaultsTogether) {
    Rows rows = recording(6000, 30.0);
    // From the last to the first, so that the numbers of the rows before stay.
    set_clock(rows, 5000, -18.0);
    set_clock(rows, 4500, 18.0);
    set_clock(rows, 4000, -7200.0), carry(rows, 4000, 55.0);
    repeat(rows, 3500), repeat(rows, 3500);
    lose(rows, 3000, 7);
    set_clock(rows, 2000, 600.0), carry(rows, 2000, 55.0);
    swap_rows(rows, 1500);
    set_clock(rows, 1000, -1.0);
    const TimeStampSummary found = examine(rows);
    expect_faults(found, {{1001, TimeFaultKind::whole_second_shift, -1.0},
                          {1501, TimeFaultKind::gap, 0.1},
                          {1502, TimeFaultKind::backward, -0.2},
                          {2001, TimeFaultKind::session, 600.0},
                          {3001, TimeFaultKind::gap, 0.7},
                          {3495, TimeFaultKind::duplicate, 0.0},
                          {3496, TimeFaultKind::duplicate, 0.0},
                          {3996, TimeFaultKind::session, -7200.0},
                          {4496, TimeFaultKind::whole_second_shift, 18.0},
                          {4996, TimeFaultKind::whole_second_shift, -18.0}});
    EXPECT_EQ(found.gaps, 4);
    EXPECT_EQ(found.duplicates, 2);
    EXPECT_EQ(found.backward, 4);
    EXPECT_NEAR(found.longest_gap_s, 600.1, 1e-9);
    EXPECT_NEAR(found.rate_deviation, 0.0, 1e-12);
}

TEST(TimeCheck, MarksOfOtherTestsChangeNothing) {
    Rows rows = recording(600, 30.0);
    set_clock(rows, 500, -18.0);
    for (ScreenedEpoch& row : rows)
        row.reason = Reason::backward_time;
    expect_faults(examine(rows), {{501, TimeFaultKind::whole_second_shift, -18.0}});
}

TEST(TimeCheck, AShiftIsToldOnlyWhereThePositionsCanTell) {
    Rows rows = recording(600, 30.0);
    set_clock(rows, 500, 18.0);
    for (const std::size_t missing : {497U, 499U, 500U, 502U}) {
        Rows without = rows;
        without[missing].east_m.reset();
        expect_faults(examine(without), {{501, TimeFaultKind::gap, 18.0}});
    }
    Rows inaccurate = rows;
    for (ScreenedEpoch& row : inaccurate)
        row.sigma_east_m = 10.0;
    expect_faults(examine(inaccurate), {{501, TimeFaultKind::gap, 18.0}});
    Rows at_the_end = rows;
    at_the_end.resize(502);
    expect_faults(examine(at_the_end), {{501, TimeFaultKind::gap, 18.0}});
    at_the_end.push_back(rows[502]);
    expect_faults(examine(at_the_end), {{501, TimeFaultKind::whole_second_shift, 18.0}});
    Rows displaced = rows;
    carry(displaced, 500, 0.5);
    expect_faults(examine(displaced), {{501, TimeFaultKind::gap, 18.0}});
    // A change of velocity by 8 m/s within three intervals, the displacement as its mean.
    Rows turned = rows;
    for (std::size_t k = 500; k < turned.size(); ++k)
        *turned[k].north_m += 0.8 * (static_cast<double>(k) - 499.5);
    expect_faults(examine(turned), {{501, TimeFaultKind::gap, 18.0}});
}

TEST(TimeCheck, StampsOfTwoDecimalsAtThreeHertzShowAShiftToo) {
    for (std::size_t first = 500; first < 503; ++first) {
        Rows rows = recording(1000, 30.0, 3.0);
        for (ScreenedEpoch& row : rows)
            row.time.nanoseconds = (row.time.nanoseconds + 5'000'000) / 10'000'000 * 10'000'000;
        set_clock(rows, first, 18.0);
        expect_faults(examine(rows, 0.33), {{static_cast<std::int64_t>(first) + 1,
                                             TimeFaultKind::whole_second_shift, 18.0}});
    }
}

/// A craft on a line whose acceleration changes at random within 8 m/s^2, and that stops often.
Rows stop_and_go(std::size_t epochs, double rate_hz, RandomGenerator& random) {
    Rows rows;
    double east_m = 0.0, speed_m_s = 10.0, acceleration_m_s2 = 0.0;
    const int parts = static_cast<int>(100.0 / rate_hz);
    for (std::size_t k = 0; k < epochs; ++k) {
        const double time_s = static_cast<double>(k) / rate_hz;
        rows.push_back(epoch_at(std::llround(time_s * 1e9), east_m, 0.0, random));
        for (int part = 0; part < parts; ++part) {
            if (random.uniform() < 0.01) acceleration_m_s2 = 16.0 * random.uniform() - 8.0;
            speed_m_s = std::clamp(speed_m_s + 0.01 * acceleration_m_s2, 0.0, 40.0);
            east_m += 0.01 * speed_m_s;
        }
    }
    return rows;
}

TEST(TimeCheck, LossesOfWholeSecondsAreNotTakenForShiftsOfTheClock) {
    RandomGenerator random(7);
    std::size_t gaps = 0;
    for (const double rate_hz : {1.0, 5.0, 10.0})
        for (int run = 0; run < 20; ++run) {
            Rows rows = stop_and_go(3000, rate_hz, random);
            for (std::size_t row = 2900; row > 100; row -= 50)
                lose(rows, row,
                     static_cast<std::size_t>(std::ceil(4.0 * random.uniform()) * rate_hz));
            const TimeStampSummary found = examine(rows, 1.0 / rate_hz);
            for (const TimeFault& fault : found.faults)
                EXPECT_EQ(fault.kind, TimeFaultKind::gap) << rate_hz << " " << fault.epoch;
            gaps += found.faults.size();
        }
    EXPECT_EQ(gaps, 3U * 20U * 56U);
}

TEST(TimeCheck, ShiftsOfTheClockAreFoundWhereTheCraftIsFast) {
    RandomGenerator random(8);
    std::size_t fast = 0;
    for (int run = 0; run < 200; ++run) {
        Rows rows = stop_and_go(1000, 10.0, random);
        const double before_m_s = (*rows[499].east_m - *rows[497].east_m) / 0.2;
        const double after_m_s = (*rows[502].east_m - *rows[500].east_m) / 0.2;
        if (std::min(before_m_s, after_m_s) < 4.0) continue;
        ++fast;
        const double size_s = std::ceil(random.uniform() * 18.0) * (run % 2 == 0 ? 1.0 : -1.0);
        set_clock(rows, 500, size_s);
        expect_faults(examine(rows), {{501, TimeFaultKind::whole_second_shift, size_s}});
    }
    EXPECT_GT(fast, 50U);
}

TEST(TimeCheck, ALoggersOwnClockShowsItsRate) {
    for (const double deviation : {50e-6, -50e-6, 1e-3}) {
        for (const double rate_hz : {0.5, 1.0, 3.0, 10.0, 25.0}) {
            Rows rows = recording(12001, 10.0, rate_hz);
            const double interval_ns = 1e9 / rate_hz * (1.0 + deviation);
            for (std::size_t k = 0; k < rows.size(); ++k)
                rows[k].time.nanoseconds =
                    std::llround(static_cast<double>(k) * interval_ns / 1e6) * 1'000'000;
            lose(rows, 6000, 5);
            repeat(rows, 3000);
            const TimeStampSummary found = examine(rows, 1.0 / rate_hz);
            // Each end of two stretches is within half a millisecond.
            EXPECT_NEAR(found.rate_deviation, deviation, 2e-3 / (12000.0 / rate_hz));
            EXPECT_EQ(found.faults.size(), 2U);
        }
    }
}

/// Rows whose stamps are so far apart, to the nanosecond.
Rows every(double interval_s, std::size_t epochs = 2001) {
    Rows rows = recording(epochs, 10.0);
    for (std::size_t k = 0; k < rows.size(); ++k)
        rows[k].time.nanoseconds = std::llround(static_cast<double>(k) * interval_s * 1e9);
    return rows;
}

TEST(TimeCheck, AnIntervalThatNoReceiverOffersIsItsOwnNominal) {
    EXPECT_NEAR(examine(every(0.120006), 0.12).rate_deviation, 5e-5, 1e-9);
    // 8 1/3 Hz is 4 % from 8 Hz, 1.5 s a quarter from 2 s, 15 s half from 10.
    for (const double interval_s : {0.12, 1.5, 2.6, 15.0, 0.0225})
        EXPECT_NEAR(examine(every(interval_s), interval_s).rate_deviation, 0.0, 1e-6) << interval_s;
    // Faster than a hundred a second none is usual.
    EXPECT_NEAR(examine(every(0.005), 0.005).rate_deviation, 0.0, 1e-6);
}

TEST(TimeCheck, StampsOfAClockThatRunsWrongAreFoundAgainstTheUsualInterval) {
    // What the importer has for the nominal interval is of the same stamps.
    for (const double deviation : {-0.0015, -0.002, -0.004, 0.004, -0.009})
        for (const double usual_s : {10.0, 2.0, 1.0, 0.5, 0.2, 0.1, 0.05, 0.04}) {
            const double interval_s = usual_s * (1.0 + deviation);
            for (const double nominal_s : {usual_s, interval_s, 0.0})
                EXPECT_NEAR(examine(every(interval_s), nominal_s).rate_deviation, deviation, 1e-6)
                    << usual_s << " " << deviation << " " << nominal_s;
        }
}

TEST(TimeCheck, StampsInWholeMillisecondsTellADeviationBelowAMillisecond) {
    // 99.85 ms is written as 99 or 100: the mean tells it.
    for (const double deviation : {-0.0015, -0.002, -0.004}) {
        Rows rows = every(0.1 * (1.0 + deviation));
        for (ScreenedEpoch& row : rows)
            row.time.nanoseconds = (row.time.nanoseconds + 500'000) / 1'000'000 * 1'000'000;
        EXPECT_NEAR(examine(rows, 0.1).rate_deviation, deviation, 1e-5) << deviation;
    }
}

TEST(TimeCheck, HowFarADeviationIsToldHangsOnTheNextUsualInterval) {
    // Within 2 %, and within a quarter of what is to the next rate: of 50 Hz that is 0.5 %.
    const auto told = [](double usual_s, double deviation) {
        const double interval_s = usual_s * (1.0 + deviation);
        return examine(every(interval_s), interval_s).rate_deviation;
    };
    for (const auto& [usual_s, limit] : {std::pair(1.0, 0.02),
                                         {0.2, 0.02},
                                         {0.1, 0.02},
                                         {0.05, 0.0125},
                                         {0.04, 0.01},
                                         {0.02, 0.005},
                                         {0.01, 0.0025},
                                         {5.0, 0.02}})
        for (const double sign : {-1.0, 1.0}) {
            EXPECT_NEAR(told(usual_s, sign * 0.95 * limit), sign * 0.95 * limit, 1e-6) << usual_s;
            EXPECT_NEAR(told(usual_s, sign * 1.05 * limit), 0.0, 1e-6) << usual_s;
        }
}

/// In steps of a millisecond, or of another resolution.
Rows rounded_to(Rows rows, std::int64_t resolution_ns = 1'000'000) {
    for (ScreenedEpoch& row : rows)
        row.time.nanoseconds =
            (row.time.nanoseconds + resolution_ns / 2) / resolution_ns * resolution_ns;
    return rows;
}

double departure(const Rows& rows) {
    return examine(rows, 0.0).departure_s.value();
}

TEST(TimeCheck, StampsOfEveryRateThatReceiversAreSetToStayAtIt) {
    for (const double rate_hz : {1.0,  2.0,  3.0,  4.0,  5.0,  6.0,  7.0,  8.0,  9.0,  10.0, 12.0,
                                 15.0, 16.0, 18.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0, 100.0}) {
        EXPECT_LE(departure(rounded_to(every(1.0 / rate_hz))), 1.001e-3) << rate_hz;
        EXPECT_LE(departure(rounded_to(every(1.0 / rate_hz), 10'000'000)), 1.0001e-2) << rate_hz;
        EXPECT_NEAR(*examine(every(1.0 / rate_hz), 0.0).usual_interval_s, 1.0 / rate_hz, 1e-9);
    }
    // Whole milliseconds that a receiver is told, and whole seconds.
    for (const double interval_s : {0.333, 0.167, 0.143, 0.111, 2.0, 5.0, 30.0})
        EXPECT_LE(departure(every(interval_s)), 1e-9) << interval_s;
}

TEST(TimeCheck, StepsThatNoReceiverMakesLeadAwayFromEveryRate) {
    for (const double interval_s : {0.098, 0.095, 0.0999, 0.102, 0.105, 0.196, 0.98, 0.995, 0.0392,
                                    0.0098, 0.49, 1.3, 0.055, 0.037})
        for (const std::int64_t resolution_ns : {1'000'000, 100'000})
            EXPECT_GT(departure(rounded_to(every(interval_s), resolution_ns)), 0.02) << interval_s;
}

TEST(TimeCheck, AWindowOfShortenedStepsIsFoundWithinALongRecording) {
    // 3 s of 10 Hz whose steps are 98 ms, or alternate between 97 and 99, or 95 and 101.
    for (const double other : {0.098, 0.097, 0.095}) {
        Rows rows = recording(600, 60.0);
        for (std::size_t k = 300; k < rows.size(); ++k) {
            const std::size_t steps = std::min<std::size_t>(k - 299, 30);
            const double taken_s =
                static_cast<double>(steps) * 0.002 + (steps % 2 == 1 ? 0.098 - other : 0.0);
            rows[k].time.nanoseconds -= std::llround(taken_s * 1e9);
        }
        EXPECT_NEAR(departure(rows), 0.0597, 0.002) << other;
    }
}

TEST(TimeCheck, SingleStampsThatAreOffAndBackAreNoRate) {
    // As solutions have them whose rover's clock is off at an epoch: RTKLIB and GINav, recorded.
    Rows rows = recording(2000, 20.0, 5.0);
    for (std::size_t k = 50; k < 1990; k += 37) {
        rows[k].time.nanoseconds += 6'000'000;
        rows[k + 1].time.nanoseconds += k % 2 == 0 ? 6'000'000 : 0;
    }
    EXPECT_LT(departure(rows), 1e-3);
    // Of GINav: each is early and back, so that no sum begins anew with it.
    Rows early = recording(1200, 20.0, 1.0);
    for (std::size_t k = 50; k < 1190; k += 17)
        early[k].time.nanoseconds -= k % 3 == 0 ? 10'000'000 : 6'000'000;
    EXPECT_EQ(departure(early), 0.0);
    // And a clock that drifts by 16 millionths.
    EXPECT_LT(departure(every(1.0 + 16e-6)), 1e-9);
}

TEST(TimeCheck, JitterIsTheStandardDeviationOfTheIntervals) {
    Rows rows = recording(20000, 0.0);
    RandomGenerator random(3);
    for (ScreenedEpoch& row : rows)
        row.time.nanoseconds += std::llround(2e6 * random.normal());
    const TimeStampSummary found = examine(rows);
    EXPECT_NEAR(found.jitter_s, 2e-3 * std::sqrt(2.0), 5e-5);
    expect_faults(found, {});
}

TEST(TimeCheck, CountsAreOfAllFaultsAndTheListOfTheFirstThousand) {
    Rows reversed = recording(1501, 0.0);
    std::reverse(reversed.begin(), reversed.end());
    const TimeStampSummary found = examine(reversed);
    EXPECT_EQ(found.backward, 1500);
    ASSERT_EQ(found.faults.size(), 1000U);
    EXPECT_EQ(found.faults.back().epoch, 1001);
}

TEST(TimeCheck, EveryFaultIsCountedOnceHoweverTheRowsAreMixed) {
    RandomGenerator random(5);
    for (int run = 0; run < 200; ++run) {
        Rows rows = recording(300, 20.0);
        for (int fault = 0; fault < 6; ++fault) {
            const auto row = static_cast<std::size_t>(random.uniform() * 250.0) + 10;
            switch (static_cast<int>(random.uniform() * 5.0)) {
                case 0:
                    lose(rows, row, 3);
                    break;
                case 1:
                    repeat(rows, row);
                    break;
                case 2:
                    swap_rows(rows, row);
                    break;
                case 3:
                    set_clock(rows, row, 400.0 * random.uniform() - 200.0);
                    break;
                default:
                    set_clock(rows, row, std::round(40.0 * random.uniform() - 20.0));
                    break;
            }
        }
        const TimeStampSummary found = examine(rows);
        EXPECT_EQ(static_cast<std::size_t>(found.gaps + found.duplicates + found.backward),
                  found.faults.size());
        EXPECT_TRUE(std::is_sorted(
            found.faults.begin(), found.faults.end(),
            [](const TimeFault& a, const TimeFault& b) { return a.epoch < b.epoch; }));
    }
}

TEST(TimeCheck, TooFewRows) {
    for (const std::size_t epochs : {0U, 1U, 2U}) {
        const TimeStampSummary found = examine(recording(epochs, 30.0), 0.0);
        expect_faults(found, {});
        EXPECT_EQ(found.rate_deviation, 0.0);
        EXPECT_EQ(found.jitter_s, 0.0);
    }
    Rows frozen = recording(3, 30.0);
    for (ScreenedEpoch& row : frozen)
        row.time.nanoseconds = 0;
    EXPECT_EQ(examine(frozen, 0.0).duplicates, 2);
}

TEST(TimeCheck, TheNominalIntervalIsFoundWhereItIsNotGiven) {
    Rows rows = recording(1000, 30.0);
    lose(rows, 500, 4);
    expect_faults(examine(rows, 0.0), {{501, TimeFaultKind::gap, 0.4}});
}

// What check_epochs and number_arcs make of such recordings.

ScreenConfig config() {
    ScreenConfig config;
    config.counted_fixes = {FixType::fixed};
    config.accuracy_min_m = 1e-4;
    config.accuracy_max_m = 10.0;
    config.gap_factor = 1.5;
    return config;
}

Rows checked(Rows rows) {
    number_epochs(rows);
    const TimeOrder order = order_by_time({rows.begin(), rows.end()}, {.interval_s = 0.1});
    Rows sorted;
    std::vector<TimeStanding> standing;
    std::vector<bool> seam;
    for (const std::size_t row : order.rows) {
        sorted.push_back(rows[row]);
        standing.push_back(order.standing[row]);
        seam.push_back(order.seam[row]);
    }
    check_epochs(sorted, standing, false, config());
    number_arcs(sorted, seam, 0.1, config());
    return sorted;
}

TEST(TimeCheckOfArcs, ASessionAfterALongGapBeginsAnArc) {
    Rows rows = recording(1000, 0.0);
    set_clock(rows, 500, 300.0);
    rows = checked(rows);
    EXPECT_EQ(summarise(rows).usable, 1000);
    EXPECT_EQ(rows[499].arc, 1);
    EXPECT_EQ(rows[500].arc, 2);
    EXPECT_EQ(rows[500].break_before, ArcBreak::gap);
    EXPECT_EQ(rows[999].arc, 2);
}

TEST(TimeCheckOfArcs, ASessionWithAnEarlierClockStandsBeforeAndIsNeverJoined) {
    Rows rows = recording(1000, 0.0);
    set_clock(rows, 500, -3600.0);
    rows = checked(rows);
    EXPECT_EQ(summarise(rows).usable, 1000);
    for (std::size_t k = 0; k < 1000; ++k) {
        EXPECT_EQ(rows[k].epoch, static_cast<std::int64_t>((k + 500) % 1000) + 1);
        EXPECT_EQ(rows[k].arc, k < 500 ? 1 : 2);
    }
}

/// A clock set back by a few seconds while the craft goes on: what both sides claim is one's alone,
/// and when the stamps have caught up, the craft is further than they say.
TEST(TimeCheckOfArcs, AClockSetBackEndsTheArcAlsoWhereItCatchesUp) {
    Rows rows = recording(1000, 30.0);
    set_clock(rows, 500, -5.0);
    rows = checked(rows);
    EXPECT_EQ(summarise(rows).usable, 950);
    EXPECT_EQ(summarise(rows).arcs, 2);
    std::int64_t latest_ns = -1;
    for (const ScreenedEpoch& row : rows) {
        if (!row.usable) continue;
        EXPECT_GT(row.time.nanoseconds, latest_ns);
        latest_ns = row.time.nanoseconds;
    }
}

/// One stamp an hour ahead: the rows after it are in time with those before.
TEST(TimeCheckOfArcs, OneStampFarAheadDoesNotCostTheRest) {
    Rows rows = recording(1000, 30.0);
    rows[500].time.nanoseconds += 3600 * second_ns;
    rows = checked(rows);
    EXPECT_FALSE(rows[500].usable);
    EXPECT_EQ(summarise(rows).usable, 999);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
