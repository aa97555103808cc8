// What commands do where a disk or the memory fails: the n-th write, sync, rename, new folder,
// removal or allocation of a command and of all programs that it starts fails, for one n after the
// other. Each time nothing that was there is lost, what is there is whole, and the exit status
// says which it is.
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <regex>
#include <set>
#include <thread>

#include "core/random.h"
#include "draws.h"
#include "failing_calls.h"
#include "signatures_support.h"
#include "watched_run.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Words = std::vector<std::string>;
using Contents = std::map<std::string, std::string>;

/// The state that is shared with the programs that a test starts.
class SharedFaults {
  public:
    explicit SharedFaults(const fs::path& file) : file_(file) {
        write_file_atomically(file, std::string(sizeof(FaultState), '\0'));
        const int number = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
        mapped_ =
            ::mmap(nullptr, sizeof(FaultState), PROT_READ | PROT_WRITE, MAP_SHARED, number, 0);
        ::close(number);
        if (mapped_ == MAP_FAILED) throw std::runtime_error("no memory is shared here");
    }
    ~SharedFaults() { ::munmap(mapped_, sizeof(FaultState)); }
    SharedFaults(const SharedFaults&) = delete;
    SharedFaults& operator=(const SharedFaults&) = delete;

    FaultState& state() const { return *static_cast<FaultState*>(mapped_); }
    Environment environment() const {
        return {{"LD_PRELOAD", RUNCERT_FAILING_CALLS}, {fault_variable, file_.string()}};
    }

  private:
    fs::path file_;
    void* mapped_ = nullptr;
};

/// A kind of call that fails, and how.
struct Kind {
    char letter;
    const char* name;
    bool from_then_on = false;
};

/// A command in a folder that holds all it reads and writes.
struct Command {
    std::string name;
    Words words;  ///< as given to runcert, in that folder
    /// Files that begin so say what failed.
    std::string results = "none";
    friend void PrintTo(const Command& one, std::ostream* out) { *out << one.name; }
};

class Faults : public SignedRuns {
  protected:
    void SetUp() override {
#ifdef RUNCERT_ADDRESS_SANITIZER
        GTEST_SKIP() << "the sanitizer's allocations are its own";
#endif
        SignedRuns::SetUp();
        must_sign("measurer", "measurer");
        fs::create_directories(prepared());
        for (const char* name :
             {"measurer.key", "measurer.pub", "judge.key", "judge.pub", "roster"})
            fs::copy_file(shared_->path() / name, prepared() / name);
        for (const char* name : {"salt_lake", "rejected"}) {
            fs::create_directory(prepared() / name);
            for (const char* file : {"attempt.yaml", "recording.pos", "spec.yaml"})
                fs::copy_file(examples / name / file, prepared() / name / file);
        }
        fs::rename(run(), prepared() / "run");
        fs::copy(prepared() / "salt_lake", prepared() / "changed", fs::copy_options::recursive);
        write_file_atomically(
            prepared() / "changed/attempt.yaml",
            read_file(prepared() / "changed/attempt.yaml") + "attempts_made: 2\n");
    }

    fs::path prepared() const {
        return path("prepared");
    }
    fs::path work() const {
        return path("work");
    }

    void begin() const {
        fs::remove_all(work());
        fs::copy(prepared(), work(), fs::copy_options::recursive);
    }
    /// All that is in the folder but what the program remembers for itself.
    Contents now() const {
        static const std::regex answer("answer-[0-9a-f]{16}");  // named by what is in it
        Contents contents;
        for (auto& [name, bytes] : contents_of(work()))
            if (!name.starts_with("state/"))
                contents[std::regex_replace(name, answer, "answer")] = std::move(bytes);
        return contents;
    }
    ProcessResult call(const Command& command, char kind, long at, bool from_then_on) const {
        FaultState& state = faults_->state();
        state.kind = kind;
        state.from_then_on = from_then_on;
        for (auto& one : state.calls)
            one = 0;
        state.at = at;
        Words words{RUNCERT_PROGRAMS "/runcert"};
        words.insert(words.end(), command.words.begin(), command.words.end());
        Environment environment = faults_->environment();
        environment.emplace_back("XDG_STATE_HOME", (work() / "state").string());
        ProcessResult result = run_process(
            words,
            {.environment = environment, .folder = work(), .time_limit = std::chrono::minutes(5)});
        EXPECT_EQ(result.end == ProcessEnd::over_time, false) << "it hangs";
        return result;
    }

    /// What a command makes where nothing fails: twice, as keys and times are others each time.
    struct Expected {
        Contents before, after;
        std::set<std::string> varying, beside;
        std::map<char, long> calls;  ///< how many there are of each kind
        ProcessResult result;
        std::string results;
    };
    Expected expected_of(const Command& command) const {
        Expected expected;
        expected.results = command.results;
        begin();
        expected.before = now();
        call(command, 0, 0, false);
        const Contents other = now();
        if (std::ranges::find(command.words, "--key") != command.words.end())
            std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // signatures say it
        begin();
        expected.result = call(command, 0, 0, false);
        for (const char kind : std::string("whsrmua"))
            expected.calls[kind] = calls_of(kind);
        expected.after = now();
        EXPECT_LT(expected.result.exit_status, 2) << expected.result.errors;
        for (const auto& [name, bytes] : expected.after) {
            if (name.starts_with("run/")) expected.beside.insert(name.substr(4));
            const auto same = other.find(name);
            EXPECT_NE(same, other.end()) << name;
            if (same != other.end() && same->second != bytes) expected.varying.insert(name);
        }
        return expected;
    }

    static bool is_of_program(const std::string& name) {
        return name.find("/.runcert-") != std::string::npos || name.starts_with(".runcert-");
    }
    /// Empty where the folder is as it was before or as it is after, or each file one of both;
    /// else what is not.
    static std::string what_is_wrong(const Expected& expected, Contents found, bool any_left) {
        for (const auto& [name, bytes] : found) {
            if (is_of_program(name)) {
                if (!any_left) return name + " is left";
                continue;
            }
            const auto before = expected.before.find(name), after = expected.after.find(name);
            if (name.starts_with(expected.results)) continue;
            if (before == expected.before.end() && after == expected.after.end())
                return name + " is new";
            const bool as_before = before != expected.before.end() && before->second == bytes;
            // What is another each time, such as a signature, has at least its length.
            const bool as_after =
                after != expected.after.end() &&
                (after->second == bytes ||
                 (expected.varying.contains(name) && bytes.size() + 64 > after->second.size()));
            if (!as_before && !as_after) return name + " is neither the old one nor the new one";
        }
        for (const auto& [name, bytes] : expected.before)
            if (expected.after.contains(name) && !found.contains(name)) return name + " is lost";
        return {};
    }
    static bool is_after(const Expected& expected, const Contents& found) {
        for (const auto& [name, bytes] : expected.after) {
            const auto one = found.find(name);
            if (one == found.end()) return false;
            if (one->second != bytes && !expected.varying.contains(name)) return false;
        }
        return true;
    }

    /// Lets one call fail. False where the command has no such call any more.
    bool fails_well(const Command& command, const Expected& expected, const Kind& kind, long at) {
        SCOPED_TRACE(fmt::format("{}: {} {}{}", command.name, kind.name, at,
                                 kind.from_then_on ? " and all after it" : ""));
        begin();
        const ProcessResult result = call(command, kind.letter, at, kind.from_then_on);
        if (calls_of(kind.letter) < at) return false;
        ++faults_made_;
        const Contents found = now();
        const bool memory = kind.letter == 'a';
        const std::string said = result.output + result.errors;
        EXPECT_EQ(what_is_wrong(expected, found, memory || kind.letter == 'u'), "") << said;
        std::set<std::string> beside = expected.beside;
        for (const auto& [name, bytes] : contents_of(work() / "run/attestations"))
            beside.insert("attestations/" + name);
        Watched(work() / "run").expect_whole(beside);
        const bool done = result.exit_status == expected.result.exit_status;
        const bool aborted = memory && result.signal == SIGABRT;
        EXPECT_TRUE(done || aborted || result.exit_status == 2) << result.exit_status << said;
        if (aborted) ++aborts_;
        if (done) {
            ++borne_;
            EXPECT_TRUE(is_after(expected, found)) << said;
        } else if (!aborted) {
            EXPECT_NE(said, "");
        }
        // The same command again does what it would have done.
        if (!done && at % 5 == 1 && !is_after(expected, found)) {
            const ProcessResult again = call(command, 0, 0, false);
            if (again.exit_status == expected.result.exit_status)
                EXPECT_TRUE(is_after(expected, now())) << again.output << again.errors;
            else
                ADD_FAILURE() << again.exit_status << again.output << again.errors << said;
        }
        return true;
    }

    long calls_of(char kind) const {
        return faults_->state().calls[static_cast<std::size_t>(kind)];
    }
    /// All calls of a kind; in the daily set one in the middle and the last.
    void fail_each(const Command& command, const Expected& expected, const Kind& kind) {
        const long all = expected.calls.at(kind.letter);
        for (long at = 1; at <= all; ++at)
            if (is_study() || at == all || at == (all + 1) / 2)
                fails_well(command, expected, kind, at);
    }
    /// Allocations: the first ones, and some drawn over all.
    void fail_allocations(const Command& command, const Expected& expected, bool from_then_on) {
        const Kind kind{'a', "allocation", from_then_on};
        const long all = expected.calls.at(kind.letter);
        RandomGenerator random(20261201);
        const long first = draws({.daily = 1, .study = 2000}),
                   drawn = draws({.daily = 2, .study = 500});
        for (long at = 1; at <= std::min(first, all); ++at)
            fails_well(command, expected, kind, at);
        for (long i = 0; i < drawn; ++i)
            fails_well(command, expected, kind,
                       1 + static_cast<long>(random.uniform() * static_cast<double>(all)));
    }

    void fail_files(const Command& command, const Expected& expected) {
        for (const Kind& kind : {Kind{'w', "write"}, Kind{'w', "write", true},
                                 Kind{'h', "half a write"}, Kind{'s', "sync"}, Kind{'r', "rename"},
                                 Kind{'m', "new folder"}, Kind{'u', "removal"}})
            if (is_study() || (kind.letter != 'h' && !kind.from_then_on))
                fail_each(command, expected, kind);
    }
    void fail_memory(const Command& command, const Expected& expected) {
        for (const bool from_then_on : {false, true})
            fail_allocations(command, expected, from_then_on);
    }
    void print_counts(const Command& command, const char* what) const {
        fmt::print("{:<28} {:<12} {:>6} faults, {:>5} borne, {:>5} aborts\n", command.name, what,
                   faults_made_, borne_, aborts_);
    }

    std::unique_ptr<SharedFaults> faults_ = std::make_unique<SharedFaults>(path("faults"));
    int faults_made_ = 0, borne_ = 0, aborts_ = 0;
};

const std::vector<Command> all_commands{
    {"certify", {"certify", "changed/attempt.yaml", "--out", "new", "--no-render"}},
    {"certify_signed_over_a_run",
     {"certify", "changed/attempt.yaml", "--out", "run", "--no-render", "--key", "measurer.key"}},
    {"sign",
     {"sign", "run", "--key", "judge.key", "--role", "judge", "--no-render", "--no-recompute"}},
    {"attest",
     {"attest", "run", "observers", "--role", "judge", "--key", "judge.key", "--yes", "--evidence",
      "roster", "--no-render"}},
    {"timestamp", {"timestamp", "run"}},
    {"verify", {"verify", "run", "--roster", "roster"}},
    {"bundle", {"bundle", "run", "--roster", "roster", "--out", "run.zip", "--zip"}},
    {"keygen", {"keygen", "--out", "observer", "--role", "observer", "--no-password"}},
    {"new", {"new", "salt_lake/recording.pos", "--out", "salt_lake/other.yaml", "--no-questions"}},
    {"receive", {"receive", "salt_lake/recording.pos", "--key", "judge.key", "--role", "judge"}},
    {"sign_and_log",
     {"sign", "run", "--key", "judge.key", "--role", "judge", "--no-render", "--no-recompute",
      "--log", "body.log"}},
    {"roster", {"roster", "roster", "--key", "judge.key", "--role", "judge"}},
    {"inspect", {"inspect", "salt_lake/recording.pos"}},
    {"inspect_plot", {"inspect", "salt_lake/recording.pos", "--plot", "plot.html"}},
    {"audit", {"audit", "run"}},
    {"explain", {"explain", "run"}},
    {"diff", {"diff", "run", "run"}},
    {"export", {"export", "run", "--format", "csv", "--out", "run.csv"}},
    {"simulate", {"simulate", "salt_lake/spec.yaml", "--out", "simulated"}},
    {"compare", {"compare", "run"}},
    {"batch",
     {"batch", "salt_lake/attempt.yaml", "rejected/attempt.yaml", "--out", "out", "--no-render",
      "--jobs", "1"},
     "out/day."},
};

class FaultsOf : public Faults, public testing::WithParamInterface<Command> {};

TEST_P(FaultsOf, FilesThatCannotBeWrittenOrRemoved) {
    const Expected expected = expected_of(GetParam());
    if (HasFailure()) return;
    fail_files(GetParam(), expected);
    print_counts(GetParam(), "files");
    // Not of a command that writes none.
    EXPECT_TRUE(faults_made_ > 3 || expected.calls.at('w') == 0);
}

TEST_P(FaultsOf, MemoryThatIsUsedUp) {
    const Expected expected = expected_of(GetParam());
    if (HasFailure()) return;
    fail_memory(GetParam(), expected);
    print_counts(GetParam(), "memory");
    EXPECT_GE(faults_made_, 6);
}

INSTANTIATE_TEST_SUITE_P(Commands, FaultsOf, testing::ValuesIn(all_commands),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
