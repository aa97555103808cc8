#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "cli/recognised.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "draft/draft.h"
#include "new_dialogue.h"
#include "outer_commands.h"
#include "reports/document/document_text.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
    std::vector<std::string> recordings;
    std::string day;
    std::string out;
    std::vector<std::string> rules, officials, set;
    std::string craft, kind, pilot, place, record, source;
    bool no_questions = false;

    bool asks() const { return !no_questions && somebody_answers(); }
};

/// An option with the key of the attempt that it answers, and the answer.
struct GivenAnswer {
    std::string option, key, value;
};

GivenAnswer answer_of_set(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
        throw Failure("--set", fmt::format("\"{}\" is not a key and its value", shown(text)),
                      "Write it as KEY=VALUE: --set solution=fixed");
    return {"--set " + text.substr(0, equals), text.substr(0, equals), text.substr(equals + 1)};
}

std::vector<GivenAnswer> answers_of(const NewOptions& options) {
    std::string officials;
    for (const std::string& one : options.officials)
        officials += one + ";";
    std::vector<GivenAnswer> answers{
        {"--craft", "craft.name", options.craft},
        {"--class", "craft.class", options.kind},
        {"--pilot", "pilot", options.pilot},
        {"--place", "place", options.place},
        {"--official", "officials", officials},
        {"--record", "record.speed", options.record},
        {"--source", "record.source", options.source},
        {"--rule", "profiles", fmt::format("{}", fmt::join(options.rules, ","))}};
    std::erase_if(answers, [](const GivenAnswer& one) { return one.value.empty(); });
    for (const std::string& text : options.set)
        answers.push_back(answer_of_set(text));
    return answers;
}

void take(const std::vector<GivenAnswer>& answers, Draft& draft) {
    for (const GivenAnswer& answer : answers) {
        try {
            draft.set(answer.key, answer.value);
        } catch (const Failure& failure) {
            throw Failure(escape_for_message(answer.option, 80), failure.problem(),
                          failure.remedy());
        }
    }
}

fs::path real_path(const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path));
}

/// Before anything is asked: whether the file can be written.
void require_new(const fs::path& file) {
    const fs::path folder = folder_of(file);
    if (fs::exists(fs::symlink_status(file)))
        throw Failure(file.string(), "there is such a file already, and it is not written over",
                      fmt::format("Certify that one, or give another name: --out {}",
                                  shell_word((file.parent_path() / file.stem())
                                                 .concat("-2" + file.extension().string())
                                                 .string())));
    if (!fs::is_directory(folder))
        throw Failure(folder.string(), "there is no such folder", "Make it, or give another --out");
    if (access(folder.c_str(), W_OK) != 0)
        throw Failure(folder.string(), "you may not write files in this folder",
                      "Copy the recordings to a folder of your own, and name them there");
}

void require_recordings(const std::vector<std::string>& recordings) {
    std::set<fs::path> names;
    for (const std::string& name : recordings) {
        if (!names.insert(real_path(name)).second)
            throw Failure(name, "this file is named twice", "Name each file once");
        const std::string suffix = lower_case(fs::path(name).extension().string());
        if (fs::is_directory(name))
            throw Failure(name, "this is a folder, and no recording",
                          fmt::format("Name the recordings in it, or make a day of it: runcert new "
                                      "--day {}",
                                      shell_word(plain_text(name))));
        if (suffix == ".yaml" || suffix == ".yml")
            throw Failure(name, "this is a YAML file, and no recording",
                          fmt::format("An attempt is there already: runcert certify {}",
                                      shell_word(plain_text(name))));
    }
}

/// The folder that all recordings are in, as it is typed where that is one for all.
fs::path folder_of_all(const std::vector<std::string>& recordings) {
    const fs::path first = folder_of(recordings.front());
    fs::path common = real_path(first);
    bool same = true;
    for (const std::string& recording : recordings) {
        const fs::path other = real_path(folder_of(recording));
        same = same && other == common;
        while (std::ranges::mismatch(common, other).in1 != common.end())
            common = common.parent_path();
    }
    return same ? first : common;
}

/// A recording as an attempt in that folder names it. Failure where it lies outside.
std::string name_in(const fs::path& folder, const std::string& recording) {
    const fs::path name = real_path(recording).lexically_relative(real_path(folder));
    if (name.empty() || *name.begin() == "..")
        throw Failure(recording,
                      "an attempt names recordings in its own folder, and in those below it alone",
                      "Give an --out in the folder of the recordings, or above it");
    if (!is_printable_line(name.string()))
        throw Failure(plain_text(recording),
                      "the file's name holds a character that cannot be written in an attempt",
                      "Give the file a name of letters and digits");
    return name.string();
}

/// What a table's columns are, as the options say or somebody at the terminal does.
void complete_table(const NewOptions& options, HandedIn& file, const std::string& path) {
    nlohmann::ordered_json columns = nlohmann::ordered_json::object();
    const auto add = [&](std::string_view key, const std::string& value) {
        columns[std::string(key.substr(key.find('.') + 1))] = value;
    };
    for (const ProposedKey& one : file.is.proposed)
        if (one.key.starts_with("columns.")) add(one.key, one.value);
    bool said = false;
    for (const GivenAnswer& answer : answers_of(options)) {
        std::string_view key = answer.key;
        constexpr std::string_view of_primary = "receivers.primary.";
        if (key.starts_with(of_primary)) key.remove_prefix(of_primary.size());
        if (!key.starts_with("columns.")) continue;
        add(key, answer.value);
        said = true;
    }
    if (!said && options.asks()) {
        fmt::print("{}\n", wrapped(fmt::format("{}: {} Its first row is: {}", path, file.is.problem,
                                               fmt::join(file.is.rows, "")),
                                   2, 0, terminal_columns()));
        for (const NeededKey& needed : file.is.needed) {
            if (!needed.key.starts_with("columns.")) continue;
            const std::string answer = ask_line(
                fmt::format("Column that holds the {}, by its name or number (Enter: none does)",
                            needed.key.substr(needed.key.find('.') + 1)));
            if (answer.empty()) return;
            add(needed.key, answer);
            said = true;
        }
    }
    if (!said || !columns.contains("time")) return;
    const Recognised again =
        recognise(path, nlohmann::ordered_json{{"columns", columns}}.dump(-1, ' ', true));
    if (again.said.exit_status == 0)
        file.is = again.is;
    else
        file.is.problem = again.said.errors;
}

/// What a table holds that cannot be read, and what to do.
void require_read(const HandedIn& file, const std::string& path) {
    if (file.is.kind != RecordingKind::table) return;
    std::vector<std::string> columns;
    for (const NeededKey& one : file.is.needed)
        if (one.key.starts_with("columns."))
            columns.push_back(fmt::format("--set {}=NAME", one.key));
    if (!columns.empty())
        throw Failure(
            path,
            fmt::format("this is a table, and nothing says which columns hold its positions; its "
                        "first row is {}",
                        fmt::join(file.is.rows, "")),
            fmt::format("Name columns by their names or numbers: {}. The series of a wheel, of "
                        "gates or of the wind has columns such as time_s,speed_m_s, and is named "
                        "beside a recording",
                        fmt::join(columns, " ")));
    show_description(file);
    throw Failure(path, "this is a table that cannot be read as it is", file.is.problem);
}

/// Why a receiver's recording cannot be read as the draft says; empty where it can.
std::string trouble_in(const Draft& draft, const fs::path& folder) {
    for (const ArrangedReceiver& receiver : draft.arrangement().receivers) {
        const HandedIn& file = draft.files()[receiver.recordings.front()];
        if (file.is.kind != RecordingKind::positions) continue;
        const Recognised again = recognise((folder / file.path).string(),
                                           draft.receiver(receiver.id).dump(-1, ' ', true));
        if (again.said.exit_status != 0) return again.said.errors;
    }
    return {};
}

/// Answers a draft, writes it, and says what comes next.
int finish(const NewOptions& options, Draft& draft, const fs::path& out,
           const std::string& certify) {
    take(answers_of(options), draft);
    show_recordings(draft);
    if (options.asks()) {
        show_gaps(draft, "What the recordings do not say", false);
        fmt::print(stderr, "Enter leaves out what is not required, or takes what is in [ ].\n");
        ask_all(draft);
        fmt::print("\n");
        show_answers(draft);
        const std::string written = lower_case(ask_line("Write this? [Y/n]"));
        if (!written.empty() && !std::string_view("yes").starts_with(written)) {
            fmt::print("nothing was written\n");
            return 1;
        }
    } else {
        show_list("Taken without an answer", draft.take_proposals());
    }
    const std::vector<Gap> left = draft.gaps();
    const bool readable = std::ranges::none_of(
        left, [](const Gap& gap) { return gap.required && gap.key.starts_with("receivers."); });
    const std::string trouble =
        readable && options.day.empty() ? trouble_in(draft, folder_of(out)) : "";
    write_new_file(out, draft.text());
    show_gaps(draft, "Left open, in lines of the file that begin with #", true);
    fmt::print("written  {}\n", plain_text(out.string()));
    if (!trouble.empty())
        fmt::print("not yet  So described, a recording cannot be read:\n{}", trouble);
    const bool lacks = std::ranges::any_of(left, &Gap::required);
    fmt::print("next     {}{} {}\n", lacks ? "complete what is required, then " : "", certify,
               shell_word(plain_text(out.string())));
    return 0;
}

/// Takes the navigation file that stands beside raw signals under the same name, where none is
/// named.
void add_orbits_beside(const std::vector<std::string>& recordings, const fs::path& folder,
                       std::vector<HandedIn>& files) {
    for (const HandedIn& file : files)
        if (file.is.kind == RecordingKind::orbits) return;
    for (std::size_t i = 0; i < files.size(); ++i) {
        if (files[i].is.kind != RecordingKind::signals) continue;
        for (const char* suffix : {".nav", ".NAV", ".rnx"}) {
            const fs::path beside = fs::path(recordings[i]).replace_extension(suffix);
            if (beside == recordings[i] || !fs::is_regular_file(beside)) continue;
            const Recognised recognised = recognise(beside.string());
            if (recognised.said.exit_status != 0 || recognised.is.kind != RecordingKind::orbits)
                continue;
            files.push_back({.path = name_in(folder, beside.string()), .is = recognised.is});
            return;
        }
    }
}

int new_attempt(const NewOptions& options) {
    require_recordings(options.recordings);
    const fs::path out = options.out.empty() ? folder_of_all(options.recordings) / "attempt.yaml"
                                             : fs::path(options.out);
    require_new(out);
    std::vector<HandedIn> files;
    for (const std::string& path : options.recordings) {
        HandedIn file{.path = name_in(folder_of(out), path)};
        const Recognised recognised = recognise(path);
        if (recognised.said.exit_status != 0) {
            fmt::print(stderr, "{}", recognised.said.errors);
            return 2;
        }
        file.is = recognised.is;
        if (file.is.kind == RecordingKind::table) complete_table(options, file, path);
        require_read(file, path);
        files.push_back(std::move(file));
    }
    add_orbits_beside(options.recordings, folder_of(out), files);
    Arrangement arrangement = arrange(files);
    Draft draft(std::move(files), std::move(arrangement));
    return finish(options, draft, out, "runcert certify");
}

/// The files of a folder that are recordings; the others are said to be left out.
std::vector<HandedIn> recordings_in(const fs::path& folder) {
    std::vector<fs::path> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file() && !entry.path().filename().string().starts_with('.'))
            names.push_back(entry.path());
    std::ranges::sort(names);
    std::vector<HandedIn> files;
    std::vector<std::string> left_out;
    for (const fs::path& path : names) {
        const std::string name = path.filename().string();
        const Recognised recognised = recognise(path.string());
        if (recognised.said.exit_status != 0) {
            const std::vector<std::string> lines = lines_of(recognised.said.errors);
            std::string why = lines.empty() ? "It cannot be read." : lines.front();
            if (why.starts_with("error: ")) why.erase(0, 7);
            left_out.push_back(fmt::format("{}: {}", name, why));
        } else if (recognised.is.kind != RecordingKind::positions) {
            left_out.push_back(fmt::format("{}: {}. Make an attempt of it by itself.", name,
                                           file_text(recognised.is)));
        } else {
            files.push_back({.path = name, .is = recognised.is});
        }
    }
    show_list("Left out", std::move(left_out));
    return files;
}

int new_day(const NewOptions& options) {
    const fs::path folder = options.day;
    if (!fs::is_directory(folder))
        throw Failure(options.day, "this is no folder", "Name the folder of the day's recordings");
    const fs::path out = options.out.empty() ? folder / "day.yaml" : fs::path(options.out);
    if (real_path(folder_of(out)) != real_path(folder))
        throw Failure(out.string(), "a day lies in the folder of its recordings",
                      "Give an --out in that folder");
    require_new(out);
    std::vector<HandedIn> files = recordings_in(folder);
    if (files.empty())
        throw Failure(options.day, "no file in the folder is a recording of positions",
                      "Name the folder of the day's recordings");
    Draft draft = Draft::of_day(std::move(files), real_path(folder).filename().string());
    return finish(options, draft, out, "runcert batch");
}

int make_new(const NewOptions& options) {
    if (options.recordings.empty() && options.day.empty())
        throw Failure("the command line", "RECORDING or --day is required", "See --help");
    return options.day.empty() ? new_attempt(options) : new_day(options);
}

}  // namespace

void add_new(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<NewOptions>(
        app, chosen, "new", "Write an attempt from recordings: asks what they do not say",
        make_new);
    line.texts(
        "RECORDING", options.recordings,
        "recordings of one attempt: of its receivers, or following each other; with orbits, raw "
        "signals and series that belong to it");
    line.text("--day", options.day,
              "write a day instead: each recording in this folder is an attempt");
    line.exclude("RECORDING", {"--day"});
    line.text("--out", options.out,
              "file to write (default: attempt.yaml or day.yaml beside the recordings)");
    line.texts("--rule", options.rules, "rule that it is judged by; may be repeated");
    line.text("--craft", options.craft, "name of the craft");
    line.text("--class", options.kind, "its kind: land-yacht, car, board, ...");
    line.text("--pilot", options.pilot, "who sailed, drove or flew");
    line.text("--place", options.place, "where");
    line.texts("--official", options.officials,
               "\"ROLE NAME\" of one who is responsible; may be repeated");
    line.text("--record", options.record, "record to beat: \"202.9 km/h\"");
    line.text("--source", options.source, "where that record is published");
    line.texts("--set", options.set,
               "KEY=VALUE: any key of an attempt, or of its primary receiver; may be repeated");
    line.flag("--no-questions", options.no_questions, "ask nothing, and leave lines to complete");
    line.footer(
        "A recording says what it is, when it was made and how sure it is: nothing of that is "
        "asked.\nOf a table that no format recognises it says which column is taken for what, and "
        "why.\nWithout a terminal nothing is asked; what no option answers stands in lines that "
        "begin\nwith #, and in one list on standard output. Nothing is ever written over, and "
        "nothing is\nwritten before the last answer.\n\n"
        "  runcert new run.ubx\n"
        "  runcert new run.ubx imu.csv course.xml    with an IMU and the surface of the course\n"
        "  runcert new log.csv --class land-yacht --craft Greenbird --rule nalsa \\\n"
        "      --record \"202.9 km/h\" --source \"NALSA, 2009\" --set solution=fixed \\\n"
        "      --set accuracy.horizontal_m=0.02\n"
        "  runcert new --day recordings\n\n"
        "Exit status: 0 written, 1 not wanted, 2 it could not be.");
}

}  // namespace runcert
