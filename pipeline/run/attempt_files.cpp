#include "run/attempt_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "core/failure.h"
#include "core/text.h"
#include "store/atomic_file.h"

namespace runcert {

namespace {

namespace fs = std::filesystem;

/// The extension of a file's name, with its point; ".dat" for one that is not plain.
std::string plain_extension(const std::string& original) {
    const std::string extension = fs::path(original).extension().string();
    const bool plain =
        extension.size() > 1 && extension.size() <= 9 &&
        std::all_of(extension.begin() + 1, extension.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
        });
    return plain ? extension : ".dat";
}

/// The path of a file that the attempt names, which must be inside the attempt's folder.
fs::path inside_folder(const std::string& named, const AttemptSource& source,
                       const std::string& place) {
    if (named.find('\0') != std::string::npos)  // where the system takes a path to end
        throw Failure(
            place, fmt::format("\"{}\" is not a path: it holds a NUL", escape_for_message(named)),
            "Write the file's name as it is");
    const fs::path folder =
        fs::weakly_canonical(fs::absolute(source.folder.empty() ? "." : source.folder));
    std::error_code error;
    const fs::path path = fs::weakly_canonical(folder / named, error);
    if (error)
        throw Failure(place,
                      fmt::format("\"{}\" is not a file that can be found: {}",
                                  escape_for_message(named), error.message()),
                      "Correct its name, which is relative to the attempt's folder");
    const auto [end, rest] = std::mismatch(folder.begin(), folder.end(), path.begin(), path.end());
    if (end == folder.end()) return source.folder / named;
    throw Failure(
        place,
        fmt::format("\"{}\" is outside of the attempt's folder{}", escape_for_message(named),
                    fs::path(named).is_absolute() || named.find("..") != std::string::npos
                        ? ""
                        : ", by a symbolic link"),
        "Copy the file into the attempt's folder, and name it relative to that");
}

/// A rule over a course needs one, of its length.
void require_course(const Profile& profile, const Attempt& attempt, const AttemptSource& source) {
    if (profile.window_kind != WindowKind::course) return;
    const auto& course = attempt.course;
    if (!course)
        throw Failure(source.file.string(),
                      fmt::format("the profile {} needs a surveyed course, and the attempt gives "
                                  "none",
                                  profile.id),
                      "Add course: {start, finish, length_m, length_expanded_uncertainty_m}");
    if (std::abs(course->length_m - profile.distance_m) > 0.02 * profile.distance_m)
        throw Failure(course->place,
                      fmt::format("the profile {} is for a course of {:g} m, this one has {:g} m",
                                  profile.id, profile.distance_m, course->length_m),
                      "Use a profile of that length, or correct length_m");
}

}  // namespace

std::vector<AttemptFile> files_of_receiver(const Receiver& receiver) {
    std::vector<AttemptFile> files;
    const auto add = [&](const std::string& role, const std::vector<std::string>& originals) {
        for (std::size_t i = 0; i < originals.size(); ++i)
            files.push_back(
                {.role = role,
                 .original = originals[i],
                 .name = fmt::format("{}.{}{}{}", role, receiver.id,
                                     originals.size() == 1 ? "" : fmt::format(".{}", i + 1),
                                     plain_extension(originals[i]))});
    };
    add("recording", receiver.recordings);
    if (!receiver.base.empty()) add("base", {receiver.base});
    add("navigation", receiver.navigation);
    if (!receiver.phase.empty()) add("phase", {receiver.phase});
    if (receiver.receipt) {
        add("receipt", {receiver.receipt->file});
        if (!receiver.receipt->time_stamp.empty())
            add("receipt_stamp", {receiver.receipt->time_stamp});
    }
    if (receiver.imu) add("imu", {receiver.imu->file});
    if (receiver.surface) {
        add("surface", {receiver.surface->file});
        if (!receiver.surface->triangles.empty()) add("triangles", {receiver.surface->triangles});
    }
    return files;
}

std::vector<AttemptFile> solution_files(const Receiver& receiver) {
    if (receiver.base.empty()) return {};
    return {{"configuration", {}, fmt::format("rtklib.{}.conf", receiver.id)},
            {"forward", {}, fmt::format("forward.{}.pos", receiver.id)},
            {"backward", {}, fmt::format("backward.{}.pos", receiver.id)}};
}

std::string profile_copy_name(const std::string& claimed) {
    return fmt::format("profile.{}.yaml", profile_name(claimed));
}

FileView open_attempt_file(const AttemptFile& file, const Receiver& receiver,
                           const AttemptSource& source) {
    const fs::path path = source.earlier_run ? *source.earlier_run / file.name
                                             : inside_folder(file.original, source, receiver.place);
    if (!fs::exists(path))
        throw Failure(
            receiver.place,
            fmt::format("the {} \"{}\" of receiver \"{}\" does not exist (looked "
                        "for {})",
                        file.role, escape_for_message(file.original), receiver.id, path.string()),
            fmt::format("Correct `{}:`, which is relative to the attempt's folder", file.role));
    return FileView(path);
}

std::string find_profile(const std::string& claimed, const AttemptSource& source) {
    if (source.earlier_run)
        return resolved_profile(read_handwritten(*source.earlier_run / profile_copy_name(claimed)),
                                claimed);
    if (const std::string_view text = builtin_profile(claimed); !text.empty())
        return std::string(text);
    const fs::path path = inside_folder(claimed, source, source.file.string());
    if (!claimed.ends_with(".yaml") || !std::filesystem::exists(path))
        throw Failure(source.file.string(), fmt::format("there is no profile \"{}\"", claimed),
                      fmt::format("Use one of {}; or give the path of a profile file (.yaml) "
                                  "relative to the attempt's folder",
                                  fmt::join(builtin_profiles(), ", ")));
    return resolved_profile(read_handwritten(path), claimed);
}

std::vector<AttemptFile> series_files(const Attempt& attempt) {
    std::vector<AttemptFile> files;
    for (const FieldRule& rule : attempt_schema().fields())
        if (const YamlValue series = attempt.resolved[rule.path];
            !rule.series.empty() && series.exists())
            files.push_back({.role = rule.path,
                             .original = series["file"].text(),
                             .name = rule.path + ".csv",
                             .place = series["file"].place()});
    return files;
}

MeasuredSeries read_series_of(const AttemptFile& file, std::string_view text,
                              const std::optional<GpsTime>& first_epoch) {
    return read_series(text, file.original, first_epoch, attempt_schema().find(file.role)->series);
}

std::string find_series(const AttemptFile& file, const AttemptSource& source) {
    const fs::path path = source.earlier_run ? *source.earlier_run / file.name
                                             : inside_folder(file.original, source, file.place);
    if (!fs::exists(path))
        throw Failure(file.place,
                      fmt::format("the file \"{}\" does not exist (looked for {})",
                                  escape_for_message(file.original), path.string()),
                      "Correct its name, which is relative to the attempt's folder");
    return read_file(path);
}

void bring_in_claim(const Attempt& attempt, std::string_view text, const AttemptSource& source,
                    const fs::path& run_dir) {
    std::vector<Profile> rules;
    for (const std::string& claimed : attempt.profiles) {
        const std::string profile = find_profile(claimed, source);
        Profile& rule = rules.emplace_back(read_profile(profile, claimed));
        require_own_id(rule, claimed);
        rule = with_replaced_figures(std::move(rule), attempt);
        if (!rule.evidence) require_course(rule, attempt, source);
        write_file_atomically(run_dir / profile_copy_name(claimed), profile);
    }
    (void)with_evidence(std::move(rules), source.file.string());
    for (const AttemptFile& file : series_files(attempt)) {
        const std::string series = find_series(file, source);
        // What is no such series is said before anything is computed. Whether its times fit those
        // of the recording, which are not known yet, the stage says that reads it.
        read_series_of(file, series, GpsTime{});
        write_file_atomically(run_dir / file.name, series);
    }
    write_file_atomically(run_dir / attempt_copy_name, text);
}

Profile with_replaced_figures(Profile profile, const Attempt& attempt) {
    for (const ReplacedFigure& figure : attempt.rules)
        if (figure.profile == profile.id)
            override_figure(profile, {.profile = figure.profile,
                                      .figure = figure.figure,
                                      .used = figure.value,
                                      .unit = {},
                                      .reason = figure.reason,
                                      .place = figure.place});
    return profile;
}

Profile read_claimed_profile(const std::filesystem::path& run_dir, const std::string& claimed,
                             const Attempt& attempt) {
    const std::filesystem::path path = run_dir / profile_copy_name(claimed);
    Profile profile = read_profile(read_handwritten(path), path.string());
    require_own_id(profile, path.string());
    if (profile.id != profile_name(claimed))
        throw Failure(path.string(),
                      fmt::format("the profile's id is \"{}\", its file is named \"{}\"",
                                  profile.id, profile_name(claimed)),
                      "Give the file the name of the id");
    return with_replaced_figures(std::move(profile), attempt);
}

std::vector<Profile> with_evidence(std::vector<Profile> claimed, const std::string& where) {
    std::vector<Profile> evidence;
    for (const Profile& profile : claimed)
        if (profile.evidence) evidence.push_back(profile);
    std::erase_if(claimed, [](const Profile& profile) { return profile.evidence; });
    if (claimed.empty())
        throw Failure(where, "the attempt claims evidence alone, which measures nothing",
                      "Add to profiles the rule whose record is claimed, e.g. nalsa");
    for (Profile& rule : claimed)
        for (const Profile& more : evidence) {
            for (const Clause& clause : more.clauses) {
                if (std::ranges::count(rule.clauses, clause.id, &Clause::id) > 0)
                    throw Failure(where,
                                  fmt::format("the rules {} and {} both have a clause \"{}\"",
                                              rule.id, more.id, escape_for_message(clause.id)),
                                  "Give the clause of your own rule another id");
                rule.clauses.push_back(clause);
                if (clause.looked_at.empty()) rule.clauses.back().looked_at = more.looked_at;
            }
            rule.questions.insert(rule.questions.end(), more.questions.begin(),
                                  more.questions.end());
            rule.signatures = combined(std::move(rule.signatures), more.signatures);
        }
    return claimed;
}

std::vector<Profile> read_claimed_rules(const fs::path& run_dir, const Attempt& attempt) {
    std::vector<Profile> claimed;
    for (const std::string& one : attempt.profiles)
        claimed.push_back(read_claimed_profile(run_dir, one, attempt));
    return with_evidence(std::move(claimed), (run_dir / attempt_copy_name).string());
}

}  // namespace runcert
