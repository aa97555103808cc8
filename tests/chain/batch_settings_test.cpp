// What of the attempt and of its profiles a step of a batch depends on: a key that is forgotten
// would have a stale file trusted.
#include "batch_settings_cases.h"
#include "batch_settings_support.h"
#include "core/text.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Twenty seconds of the example over a course, twice, and the series of wind and current.
void write_recordings(const fs::path& folder) {
    const std::vector<std::string> lines = lines_of(read_file(examples / "course/recording.pos"));
    std::string text;
    std::size_t row = 0;
    for (const std::string& line : lines)
        if (line.starts_with("%") || (++row > 400 && row <= 600)) text += line + "\n";
    fs::create_directories(folder);
    for (const char* name : {"a.pos", "b.pos"})
        write_file_atomically(folder / name, text);
    for (const char* name : {"wind.csv", "current.csv"})
        fs::copy_file(examples / "course" / name, folder / name);
    for (const auto& [name, speed] : {std::pair("wheel.csv", 25.0), {"other-wheel.csv", 26.0}}) {
        std::string speeds = "time_s,speed_m_s\n";
        for (int k = 0; k < 200; ++k)
            speeds += fmt::format("{:.1f},{:.2f}\n", 0.1 * k, speed + 0.01 * (k % 7));
        write_file_atomically(folder / name, speeds);
    }
    write_file_atomically(folder / "gates.csv", "time_s,distance_m\n2,0\n19,480\n");
    for (const auto& [name, speed] : {std::pair("trap.csv", 25.0), {"other-trap.csv", 26.0}}) {
        std::string speeds = "time_s,speed_m_s,expanded_uncertainty_m_s,length_m\n";
        for (int k = 0; k < 20; ++k)
            speeds += fmt::format("{},{:.2f},0.5,0\n", k, speed + 0.01 * (k % 7));
        write_file_atomically(folder / name, speeds);
    }
    for (const auto& [name, rate] : {std::pair("imu.csv", 0.01), {"other-imu.csv", 0.02}}) {
        std::string samples = "t,gx,gy,gz,ax,ay,az\n";
        for (int k = 0; k < 2000; ++k)
            samples += fmt::format("{:.2f},0,0,{:.5f},0,0,-9.8\n", 0.01 * k, rate + 1e-5 * (k % 7));
        write_file_atomically(folder / name, samples);
    }
    for (const auto& [name, height] : {std::pair("ground.csv", 27.55), {"other-ground.csv", 27.56}})
        write_file_atomically(
            folder / name, fmt::format("vertex,x,y,z\n1,439900,7465000,{0}\n2,440900,7465000,{0}\n"
                                       "3,440900,7465500,{0}\n4,439900,7465500,{0}\n",
                                       height));
    write_file_atomically(folder / "triangles.csv", "vertex_1,vertex_2,vertex_3\n1,2,3\n1,3,4\n");
    write_file_atomically(folder / "other-gates.csv", "time_s,distance_m\n2,0\n19,481\n");
}

/// Another legal value for a figure, a word or a text.
Json other_value(const FieldRule& rule, const Json& value) {
    if (!rule.values.empty())
        return *std::ranges::find_if(rule.values,
                                     [&](const auto& word) { return Json(word) != value; });
    if (value.is_boolean()) return !value.get<bool>();
    if (value.is_string()) return "other-" + value.get<std::string>();
    if (value.is_number_integer()) return value.get<int>() + 1;
    const double more = value.get<double>() * 1.1;
    return rule.maximum && more > *rule.maximum ? value.get<double>() * 0.9 : more;
}

/// The judged steps that a field is declared to be read by.
std::set<std::string> readers_of(const DocumentSchema& schema, const std::string& path) {
    std::set<std::string> readers;
    for (const std::string& step : judged_steps)
        if (schema.is_read_by(path, step)) readers.insert(step);
    return readers;
}

/// A change for every field whose value stands in a part of the document, or which has one that
/// stands where nothing is said, and of which nobody says otherwise: by another value of its kind,
/// the steps that its declaration says read it are done again.
std::vector<Change> declared_changes(const DocumentSchema& schema, const Json& document,
                                     const std::string& part, const std::vector<Change>& others) {
    std::vector<Change> changes;
    for (const FieldRule& rule : schema.fields()) {
        std::string pointer = part + "/" + rule.path;
        std::ranges::replace(pointer, '.', '/');
        for (std::size_t at; (at = pointer.find("[]")) != std::string::npos;)
            pointer.replace(at, 2, "/0");
        const Json::json_pointer at(pointer);
        const bool is_parameter = rule.path.starts_with("parameters.");
        if (rule.types.front() == "map" || rule.types.front() == "list" || rule.path == "schema" ||
            std::ranges::find(others, rule.path, &Change::key) != others.end() ||
            !(document.contains(at) || (rule.default_value.exists() &&
                                        (is_parameter || document.contains(at.parent_pointer())))))
            continue;
        const std::string craft = document.at("attempt").at("craft").at("class");
        const YamlValue& usual = rule.default_value;
        const Json value = document.contains(at)
                               ? document.at(at)
                               : json_from_yaml(usual.is_map() ? usual[craft] : usual);
        changes.push_back({.key = rule.path,
                           .edits = {{pointer, other_value(rule, value)}},
                           .redone = readers_of(schema, rule.path)});
    }
    return changes;
}

/// The points that the lines of a course end at, on the Earth and in a plane.
std::vector<Change> course_changes() {
    std::vector<Change> changes;
    for (const std::string point : {"start/left", "start/right", "finish/left", "finish/right"}) {
        std::string key = "course." + point;
        key[key.find('/')] = '.';
        const std::string at = "/attempt/course/" + point;
        const auto add = [&](const std::string& name, const std::string& pointer, Json value) {
            changes.push_back({.key = key + "." + name,
                               .edits = {{pointer, std::move(value)}},
                               .redone = {"window"}});
        };
        add("latitude_deg", at + "/latitude_deg", -22.9191);
        add("longitude_deg", at + "/longitude_deg", 14.4191);
        add("east_m", at, {{"east_m", 1.0}, {"north_m", 2.0}});
        add("north_m", at, {{"east_m", 1.0}, {"north_m", 3.0}});
    }
    return changes;
}

/// A change for each column that a CSV may name.
std::vector<Change> column_changes(const DocumentSchema& schema) {
    std::vector<Change> changes;
    const std::string prefix = "receivers[].columns.";
    for (const FieldRule& rule : schema.fields())
        if (rule.path.starts_with(prefix)) {
            const std::string name = rule.path.substr(prefix.size());
            const std::string at = "/attempt/receivers/0/columns/";
            changes.push_back({.key = rule.path,
                               .edits = {{at + "time", "another"}, {at + name, "another"}},
                               .redone = {"import"}});
        }
    return changes;
}

class BatchSettings : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        folder_ = new TemporaryFolder;
        write_recordings(files());
    }
    static void TearDownTestSuite() { delete folder_; }
    static fs::path files() { return folder_->path() / "files"; }

    AttemptCase case_of(const Json& document) {
        return {folder_->path() / fmt::format("case-{}", number_++), document, files()};
    }

    /// That each change has the steps done again that it should, and that it makes no difference
    /// to what the others write; of the latter as many changes at once as go together.
    void check(const Json& document, const std::vector<Change>& changes) {
        const AttemptCase base = case_of(document);
        const fs::path made = base.run_all();
        for (const Change& change : changes) {
            const AttemptCase other = case_of(with(document, {change}));
            EXPECT_EQ(redone(base, other), change.redone) << change.key;
        }
        for (const std::vector<Change>& group : together(changes)) {
            if (!differing_steps(base, made, document, group)) continue;
            for (const Change& change : group)
                if (const auto step = differing_steps(base, made, document, {change}))
                    ADD_FAILURE() << change.key << " changes what " << *step
                                  << " writes, and its settings are the same";
            ADD_FAILURE() << "a step whose settings are the same wrote something else";
        }
    }

  private:
    static Json with(Json document, const std::vector<Change>& changes) {
        for (const Change& change : changes)
            apply(document, change.edits);
        return document;
    }

    /// The first step with the same settings that writes something else from the same inputs.
    std::optional<std::string> differing_steps(const AttemptCase& base, const fs::path& made,
                                               const Json& document,
                                               const std::vector<Change>& changes) {
        const AttemptCase other = case_of(with(document, changes));
        const std::set<std::string> done_again = redone(base, other);
        for (const std::string& step : judged_steps) {
            if (done_again.contains(step)) continue;
            const fs::path run_dir = other.run(step, made);
            for (const std::string& name : outputs_of(step_named(step), base.attempt(), {}))
                if (!fs::exists(run_dir / name) ||
                    read_file(run_dir / name) != read_file(made / name))
                    return step;
        }
        return std::nullopt;
    }

    inline static TemporaryFolder* folder_ = nullptr;
    inline static int number_ = 0;
};

/// Every key of the table is in a change, or has keys below it that are, or is excused.
void expect_all_keys(const DocumentSchema& schema, const std::vector<Change>& changes,
                     const std::map<std::string, std::string>& excused) {
    std::set<std::string> known;
    for (const Change& change : changes)
        known.insert(change.key);
    for (const auto& [key, reason] : excused)
        known.insert(key);
    for (const FieldRule& rule : schema.fields()) {
        const bool has_keys_below =
            std::ranges::any_of(schema.fields(), [&](const FieldRule& other) {
                return other.path.starts_with(rule.path + ".") ||
                       other.path.starts_with(rule.path + "[]");
            });
        EXPECT_TRUE(has_keys_below || known.contains(rule.path))
            << rule.path << " of " << schema.name() << " is new: give another value for it in "
            << "batch_settings_cases.h, and say which steps depend on it";
        known.erase(rule.path);
    }
    for (const std::string& key : known)
        ADD_FAILURE() << key << " is no key of " << schema.name();
}

std::vector<Change> joined(std::initializer_list<std::vector<Change>> parts) {
    std::vector<Change> all;
    for (const std::vector<Change>& part : parts)
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

TEST_F(BatchSettings, NameEveryKeyOfAnAttemptThatAStepDependsOn) {
    const Json document = json_of(course_case);
    const DocumentSchema& schema = attempt_schema();
    std::vector<Change> changes = joined({changes_in(claim_changes), changes_in(receiver_changes),
                                          course_changes(), column_changes(schema)});
    changes = joined({changes, declared_changes(schema, document, "/attempt", changes)});
    check(document, changes);
    Json other_document = document;
    const Json edits = json_of(other_way);
    for (const auto& [pointer, value] : edits.items())
        apply(other_document, {{pointer, value}});
    std::vector<Change> other_changes = changes_in(other_way_changes);
    other_changes = joined({other_changes, declared_changes(schema, other_document, "/attempt",
                                                            joined({changes, other_changes}))});
    check(other_document, other_changes);
    expect_all_keys(schema, joined({changes, other_changes}),
                    {{"schema", "says what the file is, and nothing of the measurement"}});
}

TEST_F(BatchSettings, NameEveryKeyOfAProfileThatAStepDependsOn) {
    Json document = json_of(course_case);
    const Json rules = json_of(more_rules);
    for (const auto& [name, rule] : rules.items()) {
        document["rules"][name] = rule;
        document["attempt"]["profiles"].push_back(name + ".yaml");
    }
    const DocumentSchema& schema = profile_schema();
    std::vector<Change> changes = changes_in(profile_changes);
    changes = joined({changes, declared_changes(schema, document, "/rules/time", changes)});
    check(document, changes);
    expect_all_keys(
        schema, changes,
        {{"schema", "as of an attempt"},
         {"id", "it is the file's name, and another profile is claimed by another"},
         {"extends", "the rule is written out before any step sees it"},
         {"leaves_out[]", "as extends"},
         {"superseded_by", "what replaces a rule is named, and nothing of it is read"}});
}

TEST_F(BatchSettings, EachStepReadsAndWritesWhatItSays) {
    const AttemptCase base = case_of(json_of(course_case));
    const fs::path made = base.run_all();  // each step in a folder with its inputs alone
    for (const Step& step : steps()) {
        if (step.program.empty()) continue;
        std::set<std::string> said;
        for (const std::string& name : inputs_of(step, base.attempt()))
            said.insert(name);
        for (const std::string& name : outputs_of(step, base.attempt(), {.pages = {"report.html"}}))
            said.insert(name);
        for (const std::string& name : outputs_of(step_named("claim"), base.attempt(), {}))
            said.insert(name);
        std::set<std::string> there;
        for (const auto& [name, bytes] : contents_of(base.folder() / ("run-" + step.name)))
            there.insert(name);
        EXPECT_EQ(there, said) << step.name;
    }
    EXPECT_TRUE(fs::exists(made / "report.html"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
