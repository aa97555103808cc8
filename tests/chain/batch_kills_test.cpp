// kill -9 at random moments: of the batch, of its group, of one of its programs.
#include <gtest/gtest.h>

#include "batch_crash_support.h"
#include "core/random.h"
#include "draws.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

enum class Victim { batch, group, program, batch_when_a_run_ends };

/// A day that is killed again and again, always by the same seed.
class KilledDay {
  public:
    KilledDay(DisturbedDay& day, std::uint64_t seed, std::string last_step)
        : day_(day), random_(seed), last_step_(std::move(last_step)) {
        if (fs::exists(day_.out))
            fs::copy(day_.out, before_,
                     fs::copy_options::recursive | fs::copy_options::copy_symlinks);
    }

    /// So many kills, of each victim in turn.
    void kill_times(int wanted, int most_steps, double longest_s) {
        for (int i = 0; kills < wanted && i < 20 * wanted; ++i)
            kill_once(static_cast<Victim>(i % 4), most_steps, longest_s);
        EXPECT_EQ(kills, wanted) << "each day was over before it could be killed";
    }

    /// Starts the batch and kills at a moment: after as many steps as at most this and a time
    /// beyond. Steps and not seconds lead there, as a fast machine would have ended the day.
    void kill_once(Victim victim, int most_steps, double longest_s) {
        Started batch(day_.command(day_.programs.runcert(), day_.out, {"--jobs", "2"}), log_);
        if (victim == Victim::batch_when_a_run_ends) {
            wait_for(batch, "\"step\":\"" + last_step_ + "\",\"ran\":true", 1);
        } else {
            wait_for(batch, "\"ran\":true", static_cast<int>(random_.uniform() * (most_steps + 1)));
        }
        sleep(longest_s * random_.uniform());
        if (batch.has_ended()) return begin_anew();
        ++kills;
        if (victim == Victim::program) {
            for (const pid_t process : test::processes_with(day_.out.string()))
                if (process != batch.number()) ::kill(process, SIGKILL);
            sleep(0.2 * random_.uniform());
        }
        victim == Victim::group ? batch.send_to_group(SIGKILL) : batch.send(SIGKILL);
        EXPECT_NE(batch.exit_status(), -1) << "it hangs";
        EXPECT_TRUE(gone_soon(day_.out.string())) << "a program outlived the batch";
        begun = begun || count(batch.output(), "\"state\":\"done\"") > 0;
    }

    int kills = 0;
    bool begun = false;  ///< a batch that was killed had made a run of the day

  private:
    /// A busy machine may let a day end before the test gets its turn: the day is as it was.
    void begin_anew() {
        fs::remove_all(day_.out);
        if (fs::exists(before_))
            fs::copy(before_, day_.out,
                     fs::copy_options::recursive | fs::copy_options::copy_symlinks);
        begun = false;
    }
    static void sleep(double seconds) {
        std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    }

    /// Until the batch has said a text so many times.
    void wait_for(Started& batch, const std::string& text, int times) {
        while (!batch.has_ended() && count(batch.output(), text) < times)
            sleep(0.0005);
    }
    static int count(const std::string& said, const std::string& text) {
        int times = 0;
        for (auto at = said.find(text); at != std::string::npos; at = said.find(text, at + 1))
            ++times;
        return times;
    }

    DisturbedDay& day_;
    RandomGenerator random_;
    std::string last_step_;
    fs::path log_ = day_.folder.path() / "log";
    fs::path before_ = day_.folder.path() / "before";
};

void expect_the_same_in_the_end(DisturbedDay& day, const KilledDay& killed, int most_steps) {
    const ProcessResult last = day.batch();
    EXPECT_EQ(last.exit_status, 0) << last.errors << last.output;
    const Event end = events_in(last.output).back();
    if (killed.begun) {
        EXPECT_LT(end.at("steps_run").get<int>(), most_steps) << "begun from the start";
    }
    EXPECT_EQ(day.differing(), Words{});
    EXPECT_EQ(half_written(day.out), Words{});
}

TEST(BatchKills, AtRandomMomentsEndWithTheUndisturbedBytes) {
    // Two of each victim; what each of them must not break is also tested for certain, in
    // batch_crash_test.cpp and crash_points_test.cpp.
    const int kills = draws({.daily = 8, .study = 16});
    const int attempts = draws({.daily = 8, .study = 12});
    DisturbedDay day(attempts, 100);
    KilledDay killed(day, 20260314, "report");
    killed.kill_times(kills, 2, 0.03);
    expect_the_same_in_the_end(day, killed, attempts * 8);
}

TEST(BatchKills, WhilePagesAreMadeEndWithTheUndisturbedBytes) {
    DisturbedDay day(3, 100, {});
    KilledDay killed(day, 20260315, "render");
    killed.kill_times(draws({.daily = 4, .study = 6}), 2, 0.3);
    expect_the_same_in_the_end(day, killed, 3 * 9);
}

std::map<std::string, std::string> run_in(const std::map<std::string, std::string>& results,
                                          const std::string& id) {
    std::map<std::string, std::string> run;
    for (const auto& [name, bytes] : results)
        if (name.starts_with(id + "/") && !name.ends_with(".tmp")) run[name] = bytes;
    return run;
}

TEST(BatchKills, WhileADayIsMadeAnewLeaveNoReportAmongFilesOfAnother) {
    const int attempts = draws({.daily = 6, .study = 12});
    DisturbedDay day(attempts, 100);
    ASSERT_EQ(day.batch().exit_status, 0);
    const auto old = results_of(day.out);
    day.change_record();
    ASSERT_NE(day.expected(), old);

    KilledDay killed(day, 20260316, "report");
    const int wanted = draws({.daily = 4, .study = 8});
    for (int i = 0; killed.kills < wanted && i < 20 * wanted; ++i) {
        killed.kill_once(Victim::batch_when_a_run_ends, 0, 0.004);
        const auto now = results_of(day.out);
        for (int k = 1; k <= attempts; ++k) {
            const std::string id = fmt::format("run-{:04}", k);
            const auto run = run_in(now, id);
            const bool whole = run == run_in(old, id) || run == run_in(day.expected(), id);
            EXPECT_TRUE(whole || !run.contains(id + "/report.json")) << id;
        }
    }
    EXPECT_EQ(killed.kills, wanted) << "each day was over before it could be killed";
    expect_the_same_in_the_end(day, killed, attempts * 3);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
