#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "chain_support.h"
#include "core/text.h"
#include "day_outcomes.h"
#include "draws.h"
#include "reports/day/day_writing.h"
#include "reports/diff/day_difference.h"
#include "store/sha256.h"

// A day of many attempts, 2,000 in the study: its memory is printed, and bounded.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

/// Of an attempt beyond the first tenth. One whose report is kept takes five times as much.
constexpr long most_memory_kib = 100L * static_cast<long>(slower);

/// Run folders made of one run's verdict and report, with other ids and speeds.
class ManyAttempts : public testing::Test {
  protected:
    void SetUp() override {
        const fs::path run = folder_.path() / "run";
        ASSERT_NE(
            certify(examples / "salt_lake" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
        const std::string verdict = read_file(run / "6-verdict.yaml");
        const Json report = Json::parse(read_file(run / "report.json"));
        for (const char* day : {"old", "new"}) {
            for (int i = 0; i < attempts; ++i)
                make(day, i, verdict, report, std::string_view(day) == "new" ? 1e-4 : 0.0);
        }
    }

    void make(const std::string& day, int number, std::string verdict, Json report, double moved) {
        const std::string id = fmt::format("run-{:04}", number);
        const fs::path run = out(day) / id;
        fs::create_directories(run);
        replace(verdict, "attempt: salt-lake", "attempt: " + id);
        const double factor = 0.9 + 0.05 * number / attempts + moved;
        scale(verdict, "\n    speed_m_s: ", factor, 6);
        write(run / "6-verdict.yaml", verdict);
        report["predicate"]["attempt"]["id"] = id;
        for (Json& subject : report["subject"])
            if (subject["name"] == "6-verdict.yaml")
                subject["digest"]["sha256"] = sha256_hex(verdict);
        write(run / "report.json", report.dump());
    }
    fs::path out(const std::string& day) const { return folder_.path() / day; }

    /// Writes the results of so many attempts of a day; gives the peak memory in KiB.
    long run_day(const std::string& day, int count) const {
        const pid_t child = fork();
        if (child == 0) {
            std::vector<std::string> ids;
            for (int i = 0; i < count; ++i)
                ids.push_back(fmt::format("run-{:04}", i));
            const MadeDay made = made_day(out(day), ids);
            write_day(made.day, made.outcomes, out(day));
            _exit(0);
        }
        int status = -1;
        rusage used{};
        EXPECT_EQ(wait4(child, &status, 0, &used), child);
        EXPECT_EQ(status, 0);
        fmt::print("{} of {} attempts: {} KiB\n", count, attempts, used.ru_maxrss);
        return used.ru_maxrss;
    }

    static long own_peak_kib() {
        rusage used{};
        getrusage(RUSAGE_SELF, &used);
        return used.ru_maxrss;
    }

    /// Unsynced, since 4,000 syncs take minutes.
    static void write(const fs::path& file, const std::string& text) {
        std::ofstream(file, std::ios::binary) << text;
    }
    static void replace(std::string& text, const std::string& from, const std::string& to) {
        text.replace(text.find(from), from.size(), to);
    }
    static void scale(std::string& text, const std::string& key, double factor, int decimals) {
        for (std::size_t at = text.find(key); at != std::string::npos;
             at = text.find(key, at + 1)) {
            const std::size_t begin = at + key.size();
            const std::size_t length = text.find('\n', begin) - begin;
            const double value = parse_double(text.substr(begin, length)).value();
            text.replace(begin, length, format_fixed(value * factor, decimals));
        }
    }

    const int attempts = draws({.daily = 200, .study = 2000});
    TemporaryFolder folder_;
};

TEST_F(ManyAttempts, AreListedAndComparedInBoundedMemory) {
    const long tenth_kib = run_day("new", attempts / 10);
    const long most_kib = tenth_kib + attempts * 9 / 10 * most_memory_kib;
    EXPECT_LT(run_day("old", attempts), most_kib);
    EXPECT_LT(run_day("new", attempts), most_kib);
    const std::string page = read_file(out("old") / "day.html");
    EXPECT_NE(page.find(is_study() ? "The first 24 of 2,000 speeds are drawn"
                                   : "The first 24 of 200 speeds are drawn"),
              std::string::npos);
    EXPECT_NE(page.find(fmt::format("href=\"run-{:04}/report.json\"", attempts - 1)),
              std::string::npos);

    const long before_kib = own_peak_kib();
    const DayComparison found = compare_days(out("old"), out("new"));
    EXPECT_LT(own_peak_kib(), before_kib + attempts * most_memory_kib);
    // 1e-4 of 58 m/s is a quarter of the standard uncertainty.
    EXPECT_EQ(std::ssize(found.results), 2 * attempts);
    EXPECT_EQ(found.unchanged, 0);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
