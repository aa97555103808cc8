// kill -9 at random moments over all that writes a run folder: never a lost signature, a mixed
// folder, or a report without its files. crash_points_test.cpp has those moments of one process
// that differ, each for certain; these have all processes and what lies between.
#include <set>

#include "batch_crash_support.h"
#include "core/random.h"
#include "draws.h"
#include "signatures_support.h"
#include "watched_run.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

std::chrono::duration<double> seconds_of(const Words& command) {
    const auto begin = std::chrono::steady_clock::now();
    const ProcessResult result = run_process(command);
    EXPECT_LT(result.exit_status, 2) << result.errors;
    return std::chrono::steady_clock::now() - begin;
}

class Kills : public SignedRuns {
  protected:
    /// Whether there is another kill to come of so many, in not too many tries: on a machine that
    /// became faster, programs end before they are killed.
    bool kills_are_left(int i, int wanted) {
        EXPECT_LT(i, 20 * wanted) << "too few of the programs could be killed";
        return kills_ < wanted && i < 20 * wanted;
    }
    /// Starts a program and kills it at a random moment, or soon after `when`. False where it had
    /// ended before.
    bool kill_once(const Words& command, std::chrono::duration<double> longest,
                   const std::function<bool()>& when = {}) {
        Started program(command, path("log"));
        if (when) {
            while (!program.has_ended() && !when())
                std::this_thread::sleep_for(std::chrono::microseconds(100));
            longest = std::chrono::milliseconds(6);
        }
        std::this_thread::sleep_for(longest * random_.uniform());
        if (program.has_ended()) return false;
        if (++kills_ % 2 == 0)
            program.send_to_group(SIGKILL);
        else
            program.send(SIGKILL);
        EXPECT_NE(program.exit_status(), -1) << "it hangs";
        return true;
    }
    /// A time stamp authority that openssl is: ca.pem is its root.
    void make_authority() const {
        write_file_atomically(path("ext"), "extendedKeyUsage=critical,timeStamping\n");
        write_file_atomically(path("serial"), "1000\n");
        write_file_atomically(path("cnf"),
                              fmt::format("[authority]\nserial={}\nsigner_digest=sha256\n"
                                          "default_policy=1.2.3.4\ndigests=sha512\n",
                                          path("serial").string()));
        const ProcessResult made = run_process(
            {"sh", "-c",
             fmt::format("cd '{}' && ec='-newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes' && "
                         "openssl req -x509 $ec -keyout ca.key -out ca.pem -subj /CN=root && "
                         "openssl req $ec -keyout tsa.key -out tsa.csr -subj /CN=stamps && "
                         "openssl x509 -req -in tsa.csr -CA ca.pem -CAkey ca.key -CAcreateserial "
                         "-extfile ext -out tsa.pem",
                         folder_.path().string())});
        ASSERT_EQ(made.exit_status, 0) << made.errors;
    }
    /// Its answer to a query, in the file "reply".
    void answer(const fs::path& query) const {
        const ProcessResult answered = run_process(
            {"openssl", "ts", "-reply", "-config", path("cnf").string(), "-section", "authority",
             "-queryfile", query.string(), "-signer", path("tsa.pem").string(), "-inkey",
             path("tsa.key").string(), "-out", path("reply").string()});
        ASSERT_EQ(answered.exit_status, 0) << answered.errors;
    }
    /// Each signature beside the report holds, and its files, but for what a kill left half
    /// written, which is named.
    void expect_signatures_hold() {
        const auto found =
            verify_json({"--pubkey", public_key("measurer"), "--pubkey", public_key("judge")});
        for (const std::string detail : layer(found, "files")["details"])
            EXPECT_NE(detail.find("left by a program that was killed"), std::string::npos)
                << found.dump(1);
        for (const auto& one : found["signers"])
            EXPECT_EQ(one["valid"], true) << one.dump(1);
    }
    static Words program(Words words) {
        words.insert(words.begin(), RUNCERT_PROGRAMS "/runcert");
        return words;
    }
    void expect_done(const Words& command) const {
        const ProcessResult result = run_process(command);
        EXPECT_LT(result.exit_status, 2) << command[1] << ": " << result.errors;
        expect_nothing_left();
    }

    RandomGenerator random_{20260317};
    int kills_ = 0;
};

TEST_F(Kills, Files08OfCertifyLeaveTheEarlierRunOrTheNewOne) {
    fs::copy(examples / "salt_lake", path("other"), fs::copy_options::recursive);
    write_file_atomically(path("other") / "attempt.yaml",
                          read_file(path("other") / "attempt.yaml") + "attempts_made: 2\n");
    const std::array<std::string, 2> attempts{(examples / "salt_lake/attempt.yaml").string(),
                                              (path("other") / "attempt.yaml").string()};
    const auto command = [&](int i) {
        return program({"certify", attempts[static_cast<std::size_t>(i / 2 % 2)], "--out",
                        run().string(), "--no-render", "--key", key("measurer")});
    };
    Watched watched(run());
    must_sign("judge", "judge");
    const auto longest = seconds_of(command(0));
    watched.note();
    const auto about_to_publish = [&] {
        for (const auto& entry : fs::directory_iterator(run().parent_path()))
            if (entry.path().filename().string().starts_with(".runcert-") &&
                fs::exists(entry.path() / "run/run.yaml"))
                return true;
        return false;
    };
    std::set<std::string> reports;
    const int kills = draws({.daily = 8, .study = 70});
    for (int i = 0; kills_are_left(i, kills); ++i) {
        SCOPED_TRACE(i);
        if (i % 2 == 0)
            kill_once(command(i), longest);
        else
            kill_once(command(i), longest, about_to_publish);
        watched.expect_whole();
        watched.note();
        expect_signatures_hold();
        reports.insert(read_file(run() / "report.json"));
        if (i % 4 == 3) {
            expect_done(command(i));
            watched.expect_whole();
        }
    }
    EXPECT_EQ(reports.size(), 2U);
}

// With the user's own folder in it, a run folder is not exchanged.
TEST_F(Kills, Files08OfCertifyInPlaceLoseNothing) {
    must_sign("judge", "judge");
    fs::create_directory(run() / "photos");
    fs::copy(examples / "salt_lake", path("other"), fs::copy_options::recursive);
    const std::string text = read_file(path("other") / "attempt.yaml");
    const Words command = program({"certify", (path("other") / "attempt.yaml").string(), "--out",
                                   run().string(), "--no-render", "--key", key("measurer")});
    Watched watched(run());
    watched.note();
    const int kills = draws({.daily = 2, .study = 10});
    for (int i = 0; kills_are_left(i, kills); ++i) {
        SCOPED_TRACE(i);
        write_file_atomically(path("other") / "attempt.yaml",
                              fmt::format("{}attempts_made: {}\n", text, 2 + i));
        kill_once(command, {}, [this] {
            for (const auto& entry : fs::directory_iterator(run()))
                if (fs::exists(entry.path() / "run/run.yaml")) return true;
            return false;
        });
        if (fs::exists(run() / "report.json")) watched.expect_whole();
        watched.expect_evidence();
        watched.note();
        expect_done(command);
        watched.expect_whole();
    }
}

TEST_F(Kills, Files08OfSignLoseNoSignatureAndNoStamp) {
    const auto sign_words = [&](const std::string& name) {
        return program({"sign", run().string(), "--key", key(name), "--role", name, "--no-render",
                        "--no-recompute"});
    };
    Watched watched(run());
    must_sign("measurer", "measurer");
    const auto longest = seconds_of(sign_words("judge"));
    const fs::path stamp = run() / "report.json.judge.minisig.tsr";
    const int kills = draws({.daily = 6, .study = 40});
    for (int i = 0; kills_are_left(i, kills); ++i) {
        SCOPED_TRACE(i);
        // A stamp goes with the signature that it is of.
        if (!fs::exists(stamp)) write_file_atomically(stamp, fmt::format("stamp {}", i));
        watched.note();
        const Words command = sign_words(i % 3 == 0 ? "measurer" : "judge");
        if (i % 2 == 0)
            kill_once(command, longest);
        else
            kill_once(command, longest, [this] { return fs::exists(run() / "superseded"); });
        watched.expect_whole();
        watched.note();
        expect_signatures_hold();
        if (i % 5 == 4) expect_done(sign_words("judge"));
        watched.expect_whole();
    }
}

TEST_F(Kills, Files08OfTimestampLeaveTheWholeStampOrNone) {
    make_authority();
    must_sign("measurer", "measurer");
    const fs::path query = run() / "report.json.minisig.tsq";
    const fs::path stamp = run() / "report.json.minisig.tsr";
    const Words asks = program({"timestamp", run().string()});
    const Words takes = program({"timestamp", run().string(), "--reply", path("reply").string(),
                                 "--ca", path("ca.pem").string()});
    Watched watched(run());
    watched.note();
    const auto longest = seconds_of(asks);
    answer(query);
    const auto longest_taking = seconds_of(takes);
    const int kills = draws({.daily = 6, .study = 30});
    for (int i = 0; kills_are_left(i, kills); ++i) {
        SCOPED_TRACE(i);
        fs::remove(stamp);
        if (i % 2 == 0) {
            fs::remove(query);
            kill_once(asks, longest);
            expect_done(asks);
            answer(query);
        } else {
            kill_once(takes, longest_taking);
        }
        if (fs::exists(stamp)) {
            EXPECT_EQ(read_file(stamp), read_file(path("reply")));
        }
        watched.expect_whole();
        expect_done(takes);
        EXPECT_EQ(read_file(stamp), read_file(path("reply")));
    }
}

TEST_F(Kills, Files08OfBundleLeaveTheEarlierBundleOrTheNewOne) {
    must_sign("measurer", "measurer");
    const auto before = contents_of(run());
    const std::string bundle = path("run.tar.zst").string();
    const Words command = program({"bundle", run().string(), "--out", bundle, "--force"});
    const auto longest = seconds_of(command);
    const std::string whole = read_file(bundle);
    const int kills = draws({.daily = 4, .study = 20});
    for (int i = 0; kills_are_left(i, kills); ++i) {
        SCOPED_TRACE(i);
        if (i % 2 == 0) fs::remove(bundle);
        kill_once(command, longest);
        EXPECT_EQ(contents_of(run()), before);
        if (fs::exists(bundle)) {
            EXPECT_EQ(read_file(bundle), whole);
        }
        if (i % 4 == 3) {
            EXPECT_EQ(run_process(command).exit_status, 0);
            EXPECT_EQ(read_file(bundle), whole);
        }
    }
}

TEST_F(Kills, Files08OfBatchLeaveEachRunAsItWasOrNew) {
    DisturbedDay day(2, 60, {"--no-render", "--key", key("measurer")});
    const Words command = day.command(day.programs.runcert(), day.out, {"--jobs", "2"});
    auto longest = seconds_of(command);
    std::vector<Watched> runs;
    for (const char* id : {"run-0001", "run-0002"})
        runs.emplace_back(day.out / id).note();
    const auto about_to_publish = [&] {
        for (const auto& entry : fs::directory_iterator(day.out))
            if (entry.path().filename().string().starts_with(".runcert-")) return true;
        return false;
    };
    const std::string text = read_file(day.day / "day.yaml");
    const int kills = draws({.daily = 6, .study = 40});
    for (int i = 0; kills_are_left(i, kills); ++i) {
        SCOPED_TRACE(i);
        std::string changed = text;
        changed.replace(changed.find("202.9"), 5, i / 2 % 2 == 0 ? "190.5" : "202.9");
        write_file_atomically(day.day / "day.yaml", changed);
        if (i % 2 == 0)
            kill_once(command, longest);
        else
            kill_once(command, longest, about_to_publish);
        for (Watched& run : runs) {
            run.expect_whole();
            run.note();
        }
        if (i % 4 != 3) continue;
        const ProcessResult done = run_process(command);
        EXPECT_EQ(done.exit_status, 0) << done.output << done.errors;
        for (const auto& entry : fs::recursive_directory_iterator(day.out))
            EXPECT_FALSE(entry.path().filename().string().starts_with(".runcert-")) << entry;
        for (Watched& run : runs)
            run.expect_whole();
    }
    for (const char* id : {"run-0001", "run-0002"})
        EXPECT_EQ(runcert({"verify", (day.out / id).string(), "--pubkey", public_key("measurer")})
                      .exit_status,
                  0);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
