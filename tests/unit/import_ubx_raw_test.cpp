#include <bit>

#include "import_ubx_test_support.h"
#include "stages/import/ubx/raw.h"

namespace runcert::ubx_test {
namespace RUNCERT_FILE {

struct Measured {
    double range_m = 2.2e7, cycles = 1.15e8;
    int system = 0, satellite = 5, signal = 0;
    int lock_ms = 64'500;
    int state = 0b0111;
};

Payload real_number(Payload payload, std::size_t at, double value) {
    return payload.put(at, std::bit_cast<std::int64_t>(value), 8);
}

/// RXM-RAWX of GPS week 2409.
std::string raw_frame(double of_week_s, const std::vector<Measured>& all, int week = 2409) {
    Payload payload(16 + 32 * all.size());
    payload = real_number(payload, 0, of_week_s).put(8, week, 2).put(10, 18, 1);
    payload.put(11, static_cast<std::int64_t>(all.size()), 1).put(12, 1, 1).put(13, 1, 1);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::size_t at = 16 + 32 * i;
        payload = real_number(payload, at, all[i].range_m);
        payload = real_number(payload, at + 8, all[i].cycles).real(at + 16, -527.25F);
        payload.put(at + 20, all[i].system, 1).put(at + 21, all[i].satellite, 1);
        payload.put(at + 22, all[i].signal, 1).put(at + 24, all[i].lock_ms, 2).put(at + 26, 45, 1);
        payload.put(at + 30, all[i].state, 1);
    }
    return frame(0x02, 0x15, payload.bytes());
}

struct RawRead {
    ubx::RawFile file;
    std::vector<MeasuredEpoch> epochs;
};

RawRead read_all(const std::string& bytes) {
    RawRead read;
    read.file = ubx::read_raw(
        {.name = "f", .bytes = bytes},
        TakeMeasurements([&](MeasuredEpoch& epoch) { read.epochs.push_back(epoch); }));
    return read;
}

TEST(UbxRaw, SignalsHaveTheirRinexNames) {
    const RawRead read = read_all(raw_frame(530'418.25, {{.signal = 0},
                                                         {.signal = 3},
                                                         {.signal = 7},
                                                         {.system = 2, .signal = 1},
                                                         {.system = 2, .signal = 4},
                                                         {.system = 2, .signal = 6},
                                                         {.system = 2, .signal = 8},
                                                         {.system = 2, .signal = 30},
                                                         {.system = 6}}));
    ASSERT_EQ(read.epochs.size(), 1U);
    std::string names;
    for (const SignalMeasurement& each : read.epochs[0].measurements)
        names += to_text(each.satellite) + to_text(each.signal) + " ";
    // 8 of Galileo is E6.
    EXPECT_EQ(names, "G051C G052L G055Q E051B E055Q E056B E057Q ");
    EXPECT_EQ(to_iso(read.epochs[0].time), "2026-03-14T03:20:18.250");
    EXPECT_EQ(read.file.facts.set_aside.at(SatelliteSystem::glonass), 1);
    EXPECT_EQ(read.file.facts.notes.back(),
              "Measurements of signals that are not known were left out: 1.");
}

TEST(UbxRaw, WhatIsNotValidIsMissing) {
    const auto one = [](int state) {
        return read_all(raw_frame(530'418.0, {{.state = state}})).epochs[0].measurements[0];
    };
    EXPECT_FALSE(one(0b0000).phase_cycles || one(0b0000).pseudorange_m);
    EXPECT_TRUE(one(0b0001).pseudorange_m && !one(0b0001).phase_cycles);
    EXPECT_TRUE(one(0b0011).half_cycle) << "half a cycle is not resolved";
    EXPECT_FALSE(one(0b0111).half_cycle);
}

TEST(UbxRaw, ALockTimeThatWentDownHasLostThePhase) {
    std::string log;
    for (const int lock_ms : {1000, 1250, 1500, 100, 350, 64'500, 64'500, 200})
        log += raw_frame(530'418.0 + 0.25 * static_cast<double>(log.size()) /
                                         static_cast<double>(raw_frame(0.0, {{}}).size()),
                         {{.lock_ms = lock_ms}});
    std::string lost;
    for (const MeasuredEpoch& epoch : read_all(log).epochs)
        lost += epoch.measurements[0].loss_of_lock ? '1' : '0';
    EXPECT_EQ(lost, "00010001");
}

TEST(UbxRaw, DamagedMessagesAreBadRecords) {
    const std::string good = raw_frame(530'418.0, {{}, {.satellite = 7}});
    const std::string later = raw_frame(530'419.0, {{}});
    // Shorter than its measurements, of no week, not later, a signal twice.
    const std::string cut = frame(0x02, 0x15, good.substr(6, 16 + 40));
    for (const std::string& bad : {cut, raw_frame(530'418.5, {{}}, 0), raw_frame(530'417.0, {{}}),
                                   raw_frame(530'418.5, {{}, {}}), raw_frame(-1.0, {{}})}) {
        const RawRead read = read_all(good + bad + later);
        EXPECT_EQ(read.epochs.size(), 2U);
        EXPECT_EQ(read.file.facts.records.bad, 1);
        EXPECT_EQ(read.file.facts.records.bad_records[0].byte,
                  static_cast<std::int64_t>(good.size()));
    }
    EXPECT_THROW((void)read_all(pvt_frame()), Failure);
}

}  // namespace RUNCERT_FILE
}  // namespace runcert::ubx_test
