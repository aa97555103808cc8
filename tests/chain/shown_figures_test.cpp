#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "chain_support.h"
#include "schemas/common/header.h"
#include "schemas/verdict/figures.h"

// A figure is decided once: whatever a person reads of a run, on its page, in its explanation and
// on the terminal, the speeds that decide stand there in one rounding. It is read as rendered, and
// not by what the document says of itself.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

/// A figure with its unit, as somebody reads it.
struct Read {
    std::string text;
    std::string unit;
    std::string around;
};

std::string unescaped(std::string text) {
    for (const auto& [entity, letter] : {std::pair{"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}})
        for (std::size_t at = 0; (at = text.find(entity, at)) != std::string::npos; ++at)
            text.replace(at, std::string(entity).size(), letter);
    return text;
}

void read_sentences(const std::string& text, std::vector<Read>& read) {
    static const std::regex figure(R"((^|[^0-9.])([0-9]+\.[0-9]+)\s+(km/h|m/s|kn|mph)\b)");
    for (std::sregex_iterator at(text.begin(), text.end(), figure), end; at != end; ++at) {
        const auto from =
            static_cast<std::size_t>(std::max<std::ptrdiff_t>(at->position() - 50, 0));
        read.push_back({at->str(2), at->str(3), text.substr(from, 90)});
    }
}

/// What stands between the tags of a page; pictures are long, and no expression is run over them.
std::string words_of(const std::string& html) {
    std::string words;
    bool in_tag = false;
    for (const char c : html) {
        if (c == '<') words += ' ';
        in_tag = in_tag || c == '<';
        if (!in_tag) words += c;
        in_tag = in_tag && c != '>';
    }
    return words;
}

/// The cells of tables whose columns are units.
void read_cells(const std::string& html, std::vector<Read>& read) {
    for (const char* unit : {"km/h", "m/s", "kn", "mph"}) {
        const std::string begin = fmt::format("data-label=\"{}\"><bdi>", unit);
        for (std::size_t at = html.find(begin); at != std::string::npos;
             at = html.find(begin, at + 1)) {
            const std::size_t from = at + begin.size();
            const std::string text = html.substr(from, html.find('<', from) - from);
            if (text.find('.') != std::string::npos) read.push_back({text, unit, "a table"});
        }
    }
}

/// Sentences of a page, and the cells beneath a unit.
void read_page(const std::string& page, std::vector<Read>& read) {
    const std::size_t from = page.find("<main id=\"report\">");
    const std::string main = page.substr(from, page.find("</main>", from) - from);
    read_cells(main, read);
    std::istringstream lines(unescaped(words_of(main)));
    for (std::string line; std::getline(lines, line);)
        if (line.size() < 20'000) read_sentences(line, read);
}

/// Every speed in the predicate, m/s.
void collect_speeds(const Json& json, std::set<double>& speeds) {
    if (!json.is_structured()) return;
    for (const auto& [name, value] : json.items()) {
        if (value.is_number() && (name.ends_with("_m_s") || name == "sensitivity" ||
                                  name == "estimate" || name == "standard_uncertainty"))
            speeds.insert(std::abs(value.get<double>()));
        collect_speeds(value, speeds);
    }
}

/// Whether the text may be that figure, rounded up, down or to the nearest at its own decimals.
bool is_rounding_of(const std::string& text, double value) {
    const auto decimals = static_cast<double>(text.size() - text.find('.') - 1);
    return std::abs(std::stod(text) - value) < std::pow(10.0, -decimals) * (1.0 - 1e-9);
}

/// Of one deciding speed, what is read of it in each unit; what is another speed's does not count.
void expect_one_rounding(const std::string& what, double speed_m_s, const std::set<double>& speeds,
                         const std::vector<Read>& read) {
    std::map<std::string, std::map<std::string, std::string>> roundings;
    for (const Read& one : read) {
        const double factor = speed_unit(one.unit).per_m_s;
        if (!is_rounding_of(one.text, speed_m_s * factor)) continue;
        const bool may_be_another = std::ranges::any_of(speeds, [&](double other) {
            return std::abs(other - speed_m_s) > 1e-9 && is_rounding_of(one.text, other * factor);
        });
        if (!may_be_another) roundings[one.unit].emplace(one.text, one.around);
    }
    for (const auto& [unit, texts] : roundings)
        EXPECT_LE(texts.size(), 1U)
            << what << ", " << speed_m_s << " m/s, is read as " << texts.begin()->first << " ("
            << texts.begin()->second << ") and as " << texts.rbegin()->first << " ("
            << texts.rbegin()->second << ")";
}

std::size_t decimals_of(const std::string& figure) {
    return figure.find('.') == std::string::npos ? 0 : figure.size() - figure.find('.') - 1;
}

/// "232.16 km/h ± 0.20 km/h": value and uncertainty have equal decimals wherever they are read.
void expect_equal_decimals(const std::string& text) {
    static const std::regex both(
        R"(([0-9]+\.?[0-9]*) (km/h|m/s|kn|mph) ± ([0-9]+\.?[0-9]*) (km/h|m/s|kn|mph))");
    for (std::sregex_iterator at(text.begin(), text.end(), both), end; at != end; ++at)
        EXPECT_EQ(decimals_of(at->str(1)), decimals_of(at->str(3))) << at->str();
}

void expect_one_figure_each(const fs::path& run, const std::string& said) {
    SCOPED_TRACE(run.filename().string());
    const std::string page = read_file(run / "report.html");
    const std::string explained = runcert({"explain", run.string(), "decision"}).output;
    const std::string audited = runcert({"audit", run.string()}).output;
    std::vector<Read> read;
    read_page(page, read);
    for (const std::string& text : {said, explained, audited}) {
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            read_sentences(line, read);
            expect_equal_decimals(line);
        }
    }
    const Json predicate = Json::parse(read_file(run / "report.json"))["predicate"];
    std::istringstream lines(predicate["document"].dump(1));
    for (std::string line; std::getline(lines, line);)
        expect_equal_decimals(line);
    std::set<double> speeds;
    collect_speeds(predicate, speeds);
    const std::string windows = (run / "5-windows.yaml").string();
    collect_speeds(body_of(read_file(windows), windows), speeds);
    ASSERT_GT(read.size(), 5U);
    for (const Json& profile : predicate["verdict"]["profiles"]) {
        std::set<double> others = speeds;
        if (profile.contains("decision"))  // less the required speed it is the guard band
            others.insert(profile["decision"]["acceptance_limit_m_s"].get<double>() -
                          profile["required_speed_m_s"].get<double>());
        // The record stands as it is stated; where no margin is asked it is the required speed.
        std::vector<Read> unstated = read;
        if (profile.contains("record"))
            std::erase_if(unstated, [&](const Read& one) {
                return one.text == fmt::format("{}", profile["record"]["speed"].get<double>());
            });
        for (const char* quantity : {"speed_m_s", "expanded_uncertainty_m_s", "required_speed_m_s"})
            if (profile.contains(quantity))
                expect_one_rounding(
                    fmt::format("{}, {}", profile["profile"].get<std::string>(), quantity),
                    profile[quantity].get<double>(), others, unstated);
    }
}

class ShownFigures : public testing::Test {
  protected:
    static void expect_of(const fs::path& attempt) {
        const TemporaryFolder folder;
        const fs::path run = folder.path() / attempt.parent_path().filename();
        const ProcessResult done = certify(attempt, run, {"--no-pdf"});
        ASSERT_LE(done.exit_status, 1) << done.errors;
        expect_one_figure_each(run, done.output);
    }
    /// A recording of others, under these rules.
    static void expect_of_recording(const std::string& file, const std::string& craft,
                                    const std::string& rules, const std::string& record) {
        if (!recordings()) GTEST_SKIP() << "RUNCERT_DATA is not set";
        const TemporaryFolder folder;
        const std::string name = bring(*recordings() / file, folder.path());
        write_file_atomically(
            folder.path() / "attempt.yaml",
            fmt::format("schema: attempt/1.0\nid: run\ncraft: {{name: craft, class: {}}}\n"
                        "receivers: [{{id: primary, recording: {}, solution: fixed, accuracy: "
                        "{{horizontal_m: 0.5, vertical_m: 1.0, velocity_mps: 0.1}}}}]\nprofiles: "
                        "[{}]\nrecord: {{speed: {}, unit: kn, source: an example's own}}\n",
                        craft, name, rules, record));
        expect_of(folder.path() / "attempt.yaml");
    }
};

TEST_F(ShownFigures, OfExamplesAreReadInOneRounding) {
    for (const char* example : {"land_yacht", "rejected", "course", "salt_lake"})
        expect_of(examples / example / "attempt.yaml");
}

TEST_F(ShownFigures, OfADriveAreReadInOneRounding) {
    expect_of_recording("rtk_imu_drive/rover.pos", "car", "nalsa, fisly", "20");
}

TEST_F(ShownFigures, OfADiveAreReadInOneRounding) {
    expect_of_recording("speed_skydive/flysight1_good.csv", "skydiver", "fai-speed-skydiving-2026",
                        "200");
}

TEST_F(ShownFigures, OfBoardsAreReadInOneRounding) {
    expect_of_recording("windsurf_loggers/head_left.oao", "board", "gps-speed-sailing", "30.5");
}

/// 448.8 km/h is 448.8 and some last bits by way of m/s, which must not make it 448.9.
TEST_F(ShownFigures, LastBitsAreNoDigit) {
    const TemporaryFolder folder;
    for (const auto& entry : fs::directory_iterator(examples / "salt_lake"))
        fs::copy_file(entry.path(), folder.path() / entry.path().filename());
    std::string attempt = read_file(folder.path() / "attempt.yaml");
    for (const auto& [from, to] :
         {std::pair{"speed: 222.43", "speed: 448.8"}, {"  - nalsa\n  - fisly", "  - plain.yaml"}})
        attempt.replace(attempt.find(from), std::string(from).size(), to);
    write_file_atomically(folder.path() / "attempt.yaml", attempt);
    write_file_atomically(
        folder.path() / "plain.yaml",
        "schema: profile/1.0\nid: plain\nrevision: 1\nbody: nobody\ntitle: the record itself\n"
        "window: {duration_s: 3, definition: displacement}\n"
        "margin: {kind: absolute, value: 0, unit: km/h}\nclauses:\n  - {id: margin, text: \"The "
        "speed reaches the record.\", source: this test, certainty: secondary, decided_by: "
        "margin}\n");
    const ProcessResult done =
        certify(folder.path() / "attempt.yaml", folder.path() / "run", {"--no-pdf"});
    ASSERT_LE(done.exit_status, 1) << done.errors;
    EXPECT_NE(done.output.find("required 448.80: "), std::string::npos) << done.output;
    expect_one_figure_each(folder.path() / "run", done.output);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
