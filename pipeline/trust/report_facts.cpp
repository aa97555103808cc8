#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/common/members.h"
#include "schemas/products/products.h"
#include "schemas/verdict/declared.h"
#include "store/archive.h"
#include "store/atomic_file.h"
#include "store/yaml_output.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/roster.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr std::size_t most_subjects = 10'000;
constexpr std::string_view predicate_prefix = "urn:runcert:measurement-report:";

const char* const take_original = "The file was changed or cut off; take the original";

std::string read_report(const fs::path& file) {
    if (!fs::exists(file))
        throw Failure(file.string(), "there is no report in this folder",
                      "Give the folder that runcert certify wrote");
    if (fs::is_regular_file(file) && fs::file_size(file) > most_bytes_of("report.json"))
        throw Failure(file.string(), "the file is longer than any report", take_original);
    std::string text = read_file(file);
    // Some programs read past a byte order mark, others refuse the file.
    if (text.starts_with("\xEF\xBB\xBF"))
        throw Failure(file.string(), "it begins with a byte order mark, as no report does",
                      take_original);
    return text;
}

/// Refuses a second member of the same name in one object, and nesting so deep that reading it
/// would take all of the stack.
class UniqueKeys {
  public:
    explicit UniqueKeys(std::string where) : where_(std::move(where)) {}

    bool operator()(int depth, Json::parse_event_t event, Json& parsed) {
        constexpr int deepest = 64;
        if (depth > deepest)
            throw Failure(where_, "its lists and objects are nested deeper than in any report",
                          take_original);
        if (event == Json::parse_event_t::object_start) open_.emplace_back();
        if (event == Json::parse_event_t::object_end) open_.pop_back();
        if (event == Json::parse_event_t::key &&
            !open_.back().insert(parsed.get<std::string>()).second)
            throw Failure(where_,
                          fmt::format("the key \"{}\" stands twice in one object",
                                      escape_for_message(parsed.get<std::string>())),
                          take_original);
        return true;
    }

  private:
    std::string where_;
    std::vector<std::set<std::string>> open_;
};

/// An id goes into the trusted comment of signatures, whose fields blanks separate: with a blank in
/// it, a report could put words into its signers' mouths.
std::string read_id(const Json& value, const std::string& what, const std::string& where) {
    constexpr std::size_t longest = 200;
    const std::string id = value.get<std::string>();
    if (id.empty() || id.size() > longest || !is_printable_ascii(id) ||
        id.find_first_of(" =") != std::string::npos)
        throw Failure(where,
                      fmt::format("\"{}\" cannot be the {}", escape_for_message(id, 100), what),
                      take_original);
    return id;
}

/// Where a program is to be had goes into instructions: one word, which is read and not run.
std::string read_home(const Json& program, const std::string& where) {
    constexpr std::size_t longest = 200;
    if (!program.contains("home")) return {};
    const std::string home = program.at("home").get<std::string>();
    if (!(home.starts_with("https://") || home.starts_with("http://")) || home.size() > longest ||
        !is_printable_ascii(home) || home.find(' ') != std::string::npos)
        throw Failure(
            where, fmt::format("\"{}\" is no address of a program", escape_for_message(home, 100)),
            take_original);
    return home;
}

/// Of another version nothing else of the report can be understood.
void require_known_version(const Json& json, const std::string& where) {
    if (json.at("_type").get<std::string>() != statement_type)
        throw Failure(where, "this is no in-toto statement of version 1, as every report is",
                      take_original);
    const std::string type = json.at("predicateType").get<std::string>();
    if (!type.starts_with(predicate_prefix))
        throw Failure(where,
                      fmt::format("this is not a measurement report of runcert, its predicate is "
                                  "\"{}\"",
                                  escape_for_message(type, 80)),
                      "Give the folder that runcert certify wrote");
    const std::string& own = report_field_table().version();
    for (const std::string& version :
         {type.substr(predicate_prefix.size()),
          json.at("predicate").at("schema").at("version").get<std::string>()})
        if (version != own)
            throw Failure(where,
                          fmt::format("the report is of version \"{}\", this program knows {}",
                                      escape_for_message(version), own),
                          "Certify the recording again with this program");
}

/// Of a time in UTC with a fraction of a second, which is cut off.
std::optional<UtcSecond> whole_second(const std::string& time) {
    constexpr std::size_t whole = 19;  // YYYY-MM-DDTHH:MM:SS
    return parse_iso_utc(time.substr(0, whole) + "Z");
}

struct Subjects {
    std::map<std::string, std::string> sha256{};
    std::vector<std::string> names{};
};

Subjects subjects_of(const Json& json, const std::string& where) {
    Subjects subjects;
    const Json& list = json.at("subject");
    if (!list.is_array() || list.size() > most_subjects)
        throw Failure(where,
                      fmt::format("its subjects are no list of at most {} files", most_subjects),
                      take_original);
    std::set<std::string> seen;
    for (const Json& subject : list) {
        const std::string name = subject.at("name").get<std::string>();
        if (!is_plain_name(name) || name.find('/') != std::string::npos)
            throw Failure(where,
                          fmt::format("the subject \"{}\" is not a file of the run folder",
                                      escape_for_message(name)),
                          "This is not a report of this program, or it was changed");
        if (!seen.insert(lower_case(name)).second)
            throw Failure(
                where, fmt::format("the subject \"{}\" is named twice", escape_for_message(name)),
                take_original);
        subjects.sha256[name] = subject.at("digest").at("sha256").get<std::string>();
        subjects.names.push_back(name);
    }
    if (subjects.names.empty()) throw Failure(where, "the report names no files", take_original);
    return subjects;
}

/// The verdict that it holds, by its declaration.
Verdict verdict_of(const Json& predicate, const std::string& where) {
    const YamlValue held(yaml_node_of(nlohmann::ordered_json(predicate.at("verdict"))), where);
    Verdict verdict;
    member::take(held, "attempt", verdict.attempt);
    member::take(held, "receiver", verdict.receiver);
    member::take(held, "profiles", verdict.profiles);
    member::take(held, "with_files", verdict.with_files);
    member::take(held, "second_files", verdict.second_files);
    return verdict;
}

std::vector<RequiredSignatures> required_of(const Json& predicate, const std::string& where) {
    constexpr std::size_t most = 100;
    std::vector<RequiredSignatures> required;
    for (const Json& entry : predicate.at("signatures_required")) {
        RequiredSignatures one{.role = entry.at("role").get<std::string>()};
        require_role(one.role, where + ", signatures_required");
        const Json& count = entry.contains("count") ? entry.at("count") : Json(1U);
        if (!count.is_number_unsigned() || count.get<std::size_t>() == 0 ||
            count.get<std::size_t>() > most)
            throw Failure(where,
                          fmt::format("the count of signatures required in the role {} is {}, "
                                      "expected 1 to {}",
                                      one.role, escape_for_message(count.dump()), most),
                          take_original);
        one.count = count.get<std::size_t>();
        required.push_back(std::move(one));
    }
    return required;
}

}  // namespace

ReportFacts read_report_facts(const fs::path& run_dir) {
    if (!fs::is_directory(run_dir))
        throw Failure(run_dir.string(), "this is not a folder",
                      "Give the folder of a certified run");
    const std::string where = (run_dir / "report.json").string();
    ReportFacts facts;
    facts.text = read_report(where);
    try {
        facts.json = std::make_shared<Json>(Json::parse(facts.text, UniqueKeys(where)));
        require_known_version(*facts.json, where);
        const Json& predicate = facts.json->at("predicate");
        facts.report_id = read_id(predicate.at("report_id"), "id of a report", where);
        facts.attempt_id = read_id(predicate.at("attempt").at("id"), "id of an attempt", where);
        facts.program_version = predicate.at("program").at("version").get<std::string>();
        facts.source_revision = predicate.at("program").at("source_revision").get<std::string>();
        facts.program_home = read_home(predicate.at("program"), where);
        facts.arithmetic = predicate.at("program").at("arithmetic").get<std::string>();
        Subjects subjects = subjects_of(*facts.json, where);
        facts.subjects = std::move(subjects.sha256);
        facts.subject_names = std::move(subjects.names);
        facts.required = required_of(predicate, where);
        facts.verdict = std::make_shared<Verdict>(verdict_of(predicate, where));
        if (const Json& end = predicate.at("certificate"); end.contains("end_performance"))
            facts.recorded_until = whole_second(end.at("end_performance").get<std::string>());
    } catch (const nlohmann::json::exception& error) {
        throw Failure(where, fmt::format("not a report: {}", escape_for_message(error.what(), 200)),
                      take_original);
    }
    return facts;
}

}  // namespace runcert
