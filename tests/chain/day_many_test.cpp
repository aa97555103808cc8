#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <regex>

#include "chain_support.h"
#include "core/text.h"
#include "files/sha256.h"
#include "reports/diff/day_difference.h"

// A day of 2,000 attempts: memory and time are printed, and bounded.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

constexpr int attempts = 2000;
constexpr long most_memory_kib = 200L * 1024 * static_cast<long>(slower);

/// 2,000 run folders made of one run's verdict and report, with other ids and speeds.
class ManyAttempts : public testing::Test {
  protected:
    void SetUp() override {
        const fs::path run = folder_.path() / "run";
        ASSERT_NE(
            certify(examples / "salt_lake" / "attempt.yaml", run, {"--no-render"}).exit_status, 2);
        const std::string verdict = read_file(run / "6-verdict.yaml");
        const Json report = Json::parse(read_file(run / "report.json"));
        for (const char* day : {"old", "new"}) {
            Json list{{"day", "many"}, {"attempts", Json::array()}, {"notes", Json::array()}};
            for (int i = 0; i < attempts; ++i)
                list["attempts"].push_back(
                    make(day, i, verdict, report, std::string_view(day) == "new" ? 1e-4 : 0.0));
            write_file_atomically(folder_.path() / (std::string(day) + ".json"), list.dump());
        }
    }

    Json make(const std::string& day, int number, std::string verdict, Json report, double moved) {
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
        const std::string report_text = report.dump();
        write(run / "report.json", report_text);
        return {{"id", id},
                {"source", "many.yaml"},
                {"state", "done"},
                {"verdict", file_json(id + "/6-verdict.yaml", verdict)},
                {"report", file_json(id + "/report.json", report_text)},
                {"pages", Json::array()},
                {"notes", Json::array()}};
    }
    fs::path out(const std::string& day) const { return folder_.path() / day; }

    /// Runs runcert-day; gives its peak memory in KiB, and its time in `seconds`.
    long run_day(const std::string& day) {
        const auto begin = std::chrono::steady_clock::now();
        const pid_t child = fork();
        if (child == 0) {
            execl(RUNCERT_PROGRAMS "/runcert-day", "runcert-day", "--out", out(day).c_str(),
                  "--list", (folder_.path() / (day + ".json")).c_str(), nullptr);
            _exit(127);
        }
        int status = -1;
        rusage used{};
        EXPECT_EQ(wait4(child, &status, 0, &used), child);
        EXPECT_EQ(status, 0);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
        fmt::print("runcert-day, {} attempts: {:.1f} s, {} MiB\n", attempts, took.count(),
                   used.ru_maxrss / 1024);
        return used.ru_maxrss;
    }

    static Json file_json(const std::string& file, const std::string& text) {
        return {{"file", file}, {"sha256", sha256_hex(text)}, {"bytes", text.size()}};
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

    TemporaryFolder folder_;
};

TEST_F(ManyAttempts, AreListedAndComparedInBoundedMemory) {
    EXPECT_LT(run_day("old"), most_memory_kib);
    EXPECT_LT(run_day("new"), most_memory_kib);
    const std::string page = read_file(out("old") / "day.html");
    EXPECT_NE(page.find("The first 24 of 2,000 speeds are drawn"), std::string::npos);
    EXPECT_NE(page.find("href=\"run-1999/report.json\""), std::string::npos);

    const auto begin = std::chrono::steady_clock::now();
    const DayComparison found = compare_days(out("old"), out("new"));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    fmt::print("comparison: {:.1f} s, {} MiB\n", took.count(), used.ru_maxrss / 1024);
    EXPECT_LT(used.ru_maxrss, most_memory_kib);
    // 1e-4 of 58 m/s is a quarter of the standard uncertainty.
    EXPECT_EQ(found.results.size(), std::size_t{2} * attempts);
    EXPECT_EQ(found.unchanged, 0);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
