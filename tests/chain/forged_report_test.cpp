#include <functional>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "signatures_support.h"
#include "store/sha256.h"
#include "trust/signature.h"
#include "trust/signing.h"

// Reports that a dishonest signer wrote by hand: their signatures hold, what they say does not.

namespace runcert::chain::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

class ForgedReport : public SignedRuns {
  protected:
    Json report() const { return Json::parse(read_file(run() / "report.json")); }
    void write_signed(const std::string& text, const std::string& comment = "of no form") const {
        write_file_atomically(run() / "report.json", text);
        const SecretKey secret = parse_secret_key(read_file(key("measurer")), std::nullopt, "key");
        write_file_atomically(run() / "report.json.minisig", runcert::sign(text, secret, comment));
    }
    /// Writes the report with the id that belongs to its subjects.
    void forge(Json report) const {
        std::string lines;
        for (const Json& subject : report["subject"])
            lines += fmt::format("{}  {}\n", subject["digest"]["sha256"].get<std::string>(),
                                 subject["name"].get<std::string>());
        report["predicate"]["report_id"] = sha256_hex(lines).substr(0, 16);
        write_signed(report.dump(2) + "\n");
    }
    void forge_predicate(const std::function<void(Json&)>& change) const {
        Json changed = report();
        change(changed["predicate"]);
        forge(changed);
    }
    /// Rewrites a file of the folder, and the report's hash of it.
    void forge_file(const std::string& file, const std::string& text) const {
        write_file_atomically(run() / file, text);
        Json changed = report();
        const std::string sha256 = sha256_hex(text);
        for (Json& subject : changed["subject"])
            if (subject["name"] == file) subject["digest"]["sha256"] = sha256;
        for (Json& shown : changed["predicate"]["files"])
            if (shown["file"] == file) shown["sha256"] = sha256;
        forge(changed);
    }
    nlohmann::json found() const { return verify_json({"--pubkey", public_key("measurer")}); }
    void expect_no(const std::string& layer_name, const std::string& said) const {
        const auto result = found();
        EXPECT_EQ(result["exit_status"], 1) << said;
        EXPECT_EQ(layer(result, layer_name)["passed"], false) << result.dump(1);
        EXPECT_TRUE(says(layer(result, layer_name), said)) << said << result.dump(1);
        EXPECT_EQ(layer(result, "signatures")["passed"], true) << "the signature holds";
    }
    void expect_refused(const std::string& said) const {
        const ProcessResult result = verify({"--pubkey", public_key("measurer")});
        EXPECT_EQ(result.exit_status, 2) << result.output;
        EXPECT_NE(result.errors.find(said), std::string::npos) << result.errors;
    }
};

TEST_F(ForgedReport, AsItWasMadeIsVerifiedAndOtherwiseWrittenIsNot) {
    must_sign("measurer", "measurer");
    auto result = found();
    EXPECT_EQ(result["exit_status"], 0) << result.dump(1);
    // The same values, without the white space that the program writes.
    forge(report());
    result = found();
    EXPECT_EQ(result["exit_status"], 1);
    EXPECT_TRUE(says(layer(result, "contents"), "other text than recomputed, of the same values"))
        << result.dump(1);
    EXPECT_EQ(layer(result, "report")["passed"], true);
}

TEST_F(ForgedReport, ThatSaysOtherThanItsVerdictIsFound) {
    const std::string whole = read_file(run() / "report.json");
    const auto expect_found = [&](const std::string& said,
                                  const std::function<void(Json&)>& change) {
        forge_predicate([&](Json& predicate) { change(predicate["verdict"]["profiles"][0]); });
        expect_no("report", said);
        write_file_atomically(run() / "report.json", whole);
    };
    expect_found("verdict.profiles.0.speed_km_h is \\\"255.5\\\"",
                 [](Json& rule) { rule["speed_km_h"] = 255.5; });
    expect_found("speed_mph is \\\"absent\\\"", [](Json& rule) { rule.erase("speed_mph"); });
    expect_found("expanded_uncertainty_m_s",
                 [](Json& rule) { rule["expanded_uncertainty_m_s"] = 0.01; });
    expect_found("required_speed_km_h", [](Json& rule) { rule["required_speed_km_h"] = 100.0; });
    expect_found("coverage_factor", [](Json& rule) { rule["coverage_factor"] = 1.0; });
    expect_found("speed is \\\"255.5\\\"", [](Json& rule) { rule["shown"]["speed"] = "255.5"; });
    // Neither does a word stand for what is not there, nor one value for its text.
    expect_found("extra is \\\"absent\\\"", [](Json& rule) { rule["extra"] = "absent"; });
    expect_found("speed_km_h is", [](Json& rule) {
        const std::string text = rule["speed_km_h"].dump();
        rule["speed_km_h"] = text;
    });
    expect_found("outcome is \\\"not_proven\\\"",
                 [](Json& rule) { rule["outcome"] = "not_proven"; });
    expect_found("reason", [](Json& rule) { rule["reason"] = "Everybody saw it."; });
    expect_found("requirements.0.status",
                 [](Json& rule) { rule["requirements"][0]["status"] = "attest"; });
    expect_found("decision.probability is \\\"0.5\\\"",
                 [](Json& rule) { rule["decision"]["probability"] = 0.5; });
    expect_found("decision.level is \\\"absent\\\"",
                 [](Json& rule) { rule["decision"].erase("level"); });
    expect_found("verdict.profiles.0.requirements is",
                 [](Json& rule) { rule["requirements"].erase(0); });
}

// What people are shown stands in its document, beside figures that are the verdict's.
TEST_F(ForgedReport, WhoseDocumentSaysOtherThanItsVerdictIsFound) {
    const std::string whole = read_file(run() / "report.json");
    const auto expect_found = [&](const std::string& said,
                                  const std::function<void(Json&)>& change) {
        forge_predicate([&](Json& predicate) {
            for (Json& section : predicate["document"]["sections"])
                for (Json& block : section["blocks"])
                    if (block.value("slot", "") == "outcome/nalsa") change(block);
        });
        expect_no("report", said);
        write_file_atomically(run() / "report.json", whole);
    };
    expect_found("nalsa, outcome_title is \\\"nalsa: World record\\\"",
                 [](Json& block) { block["text"] = "nalsa: World record"; });
    expect_found("nalsa, outcome_mark", [](Json& block) { block["sign"] = "✗"; });
    expect_found("nalsa, tone is \\\"outcome_yes\\\"",
                 [](Json& block) { block["look"] = "outcome_yes"; });
    forge_predicate([](Json& predicate) {
        predicate["document"]["sections"][0]["blocks"].push_back(
            {{"kind", "headline"}, {"text", "255.50 km/h ± 0.01 km/h"}});
    });
    expect_no("report", "its headline is \\\"255.50 km/h");
    write_file_atomically(run() / "report.json", whole);
    // All else of it is found where the report is made again.
    forge_predicate([](Json& predicate) {
        predicate["document"]["sections"][1]["blocks"][1]["text"] = "Everybody saw it.";
    });
    expect_no("contents", "Everybody saw it.");
}

// A signer may send readers to a verifier of the signer's own.
TEST_F(ForgedReport, WhereItSaysThatTheProgramIsIsSaidToBeItsWord) {
    const std::string whole = read_file(run() / "report.json");
    forge_predicate(
        [](Json& predicate) { predicate["program"]["home"] = "https://example.org/other"; });
    EXPECT_TRUE(says(layer(found(), "report"),
                     "note: it says that its program is to be had at https://example.org/other; "
                     "of this one, "));
    for (const char* home : {"runcert", "https://a b", "https://a\nb", "javascript:x", ""}) {
        write_file_atomically(run() / "report.json", whole);
        forge_predicate([&](Json& predicate) { predicate["program"]["home"] = home; });
        expect_refused("no address of a program");
    }
}

TEST_F(ForgedReport, ThatLeavesARuleOutIsFound) {
    forge_predicate([](Json& predicate) { predicate["verdict"]["profiles"].erase(1); });
    expect_no(
        "report",
        "verdict.profiles is \\\"a list of 1\\\", in 6-verdict.yaml it is \\\"a list of 2\\\"");
}

TEST_F(ForgedReport, ThatLeavesAFileOutIsFound) {
    for (const char* file : {"recording.primary.pos", "6-verdict.yaml", "profile.fisly.yaml"}) {
        Json changed = report();
        const std::string text = read_file(run() / file);
        for (auto* list : {&changed["subject"], &changed["predicate"]["files"]})
            for (std::size_t i = list->size(); i-- > 0;)
                if (list->at(i).value("name", list->at(i).value("file", "")) == file)
                    list->erase(i);
        const std::string whole = read_file(run() / "report.json");
        forge(changed);
        fs::remove(run() / file);
        expect_no("report", std::string(file) + ": the attempt needs it");
        write_file_atomically(run() / file, text);
        write_file_atomically(run() / "report.json", whole);
    }
}

TEST_F(ForgedReport, ThatVouchesForATextAloneIsFound) {
    Json changed = report();
    for (const Json& subject : changed["subject"])
        fs::remove(run() / subject["name"].get<std::string>());
    write_file_atomically(run() / "x.txt", "x");
    changed["subject"] =
        Json::array({{{"name", "x.txt"}, {"digest", {{"sha256", sha256_hex("x")}}}}});
    changed["predicate"]["files"] = Json::array();
    forge(changed);
    expect_no("report", "attempt.yaml: the report does not name it");
    expect_no("chain", "attempt.yaml");
}

TEST_F(ForgedReport, ThatTakesInFilesOfAnotherRunIsFound) {
    Json changed = report();
    const std::string text = read_file(run() / "6-verdict.yaml");
    write_file_atomically(run() / "6-verdict.other.yaml", text);
    changed["subject"].push_back(
        {{"name", "6-verdict.other.yaml"}, {"digest", {{"sha256", sha256_hex(text)}}}});
    forge(changed);
    expect_no("report", "6-verdict.other.yaml: the report names it, nothing");
    expect_no("chain", "shows 10 files, it is signed for 11");
}

TEST_F(ForgedReport, WithAnIdOfItsOwnIsFound) {
    Json changed = report();
    changed["predicate"]["report_id"] = "0123456789abcdef";
    write_signed(changed.dump(2));
    expect_no("report", "its id is \\\"0123456789abcdef\\\"");
}

TEST_F(ForgedReport, OfAStageFileThatDoesNotSayWhatItWasMadeFromIsFound) {
    std::string text = read_file(run() / "6-verdict.yaml");
    const std::size_t begin = text.find("inputs:\n");
    const std::size_t end = text.find("\nparameters:", begin);
    ASSERT_NE(end, std::string::npos);
    forge_file("6-verdict.yaml", text.replace(begin, end - begin, "inputs: []"));
    expect_no("chain", "6-verdict.yaml: does not say from which 4-trajectory.ecsv");
}

TEST_F(ForgedReport, ThatAsksForFewerSignaturesThanItsRulesIsFound) {
    forge_file("attempt.yaml",
               read_file(run() / "attempt.yaml") + "signatures: [{role: judge, count: 2}]\n");
    expect_no("report", "asks for 0 signatures in the role judge, attempt and rules ask for 2");
    require_signatures(R"({"role": "judge", "count": 2})");
    EXPECT_FALSE(says(layer(found(), "report"), "role judge"));
}

TEST_F(ForgedReport, ThatProgramsReadDifferentlyIsRefused) {
    const std::string whole = read_file(run() / "report.json");
    write_signed("\xEF\xBB\xBF" + whole);
    expect_refused("byte order mark");
    Json changed = Json::parse(whole);
    changed["_type"] = "another";
    forge(changed);
    expect_refused("in-toto");
    for (const std::string& name :
         {std::string("attempt.yaml\0x", 14), std::string("Attempt.yaml"), std::string(".hidden"),
          std::string("caf\xC3\xA9"), std::string("a\\b")}) {
        changed = Json::parse(whole);
        changed["subject"].push_back(
            {{"name", name}, {"digest", {{"sha256", std::string(64, '0')}}}});
        forge(changed);
        expect_refused("The subject \"");
    }
}

TEST_F(ForgedReport, WhoseVerdictCannotBeReadIsNeverVerified) {
    const std::string whole = read_file(run() / "report.json");
    const auto refused = [&](const std::function<void(Json&)>& change) {
        write_file_atomically(run() / "report.json", whole);
        forge_predicate([&](Json& predicate) { change(predicate["verdict"]); });
        const ProcessResult result = verify({"--pubkey", public_key("measurer")});
        // Where it can be read at all it is not what the file says.
        EXPECT_TRUE(result.exit_status == 1 || result.exit_status == 2) << result.exit_status;
        EXPECT_NE((result.errors + result.output).find("report.json"), std::string::npos)
            << result.errors;
    };
    refused([](Json& verdict) { verdict = Json::array(); });
    refused([](Json& verdict) { verdict["profiles"] = "nalsa"; });
    refused([](Json& verdict) { verdict["profiles"][0]["outcome"] = "won"; });
    refused([](Json& verdict) { verdict["profiles"][0]["rule"] = Json::array({1}); });
    refused([](Json& verdict) {
        verdict["profiles"][0]["requirements"][0]["answered_by"] = {{"role", "judge"},
                                                                    {"count", "many"}};
    });
}

TEST_F(ForgedReport, LongerThanAnyIsRefusedAtOnce) {
    fs::resize_file(run() / "report.json", std::uintmax_t{65} << 20U);
    expect_refused("longer than 16777216 bytes");
}

TEST_F(ForgedReport, IsNotSigned) {
    forge_predicate(
        [](Json& predicate) { predicate["verdict"]["profiles"][0]["speed_km_h"] = 255.5; });
    const ProcessResult result = sign("judge", "judge");
    EXPECT_EQ(result.exit_status, 2);
    EXPECT_NE(result.errors.find("speed_km_h is \"255.5\""), std::string::npos) << result.errors;
}

TEST_F(ForgedReport, PutInPlaceOfTheCheckedOneIsNotSigned) {
    const ReportFacts checked = read_report_facts(run());
    forge_predicate(
        [](Json& predicate) { predicate["verdict"]["profiles"][0]["speed_km_h"] = 255.5; });
    fs::remove(run() / "report.json.minisig");
    const SecretKey secret = parse_secret_key(read_file(key("judge")), std::nullopt, "key");
    EXPECT_THROW(sign_report(run(), checked, secret, "judge"), Failure);
    EXPECT_FALSE(fs::exists(run() / "report.json.minisig"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
