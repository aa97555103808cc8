#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "core/text.h"
#include "days/day_list.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/strict_texts.h"
#include "store/atomic_file.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
    return fmt::format("\"{}\"", plain_text(text));
}

/// One entry of a day file.
class EntryReader {
  public:
    EntryReader(const DayEntry& entry, const fs::path& file)
        : entry_(entry),
          folder_(folder_of(file)),
          file_name_(file.filename().string()),
          files_(named_files(YamlValue(entry.keys, file.string()))) {}

    ListedAttempt attempt(std::vector<std::string>& notes) const {
        GivenAttempt made{.id = id_from_name(name()), .source = source(), .folder = folder_};
        try {
            if (entry_.refused) throw Failure(*entry_.refused);
            if (!entry_.attempt.empty()) {
                refuse_pattern({"attempt", entry_.attempt});
                return attempt_of_file(folder_ / entry_.attempt, plain_text(entry_.attempt));
            }
            for (const NamedFile& file : files_)
                require_file(file);
            if (!entry_.id.empty() && !is_id(entry_.id))
                fail(fmt::format("\"{}\" cannot be an id", escape_for_message(entry_.id)),
                     "Use 1 to 64 letters, digits, - and _, not beginning with -");
            check_keys();
        } catch (const Failure& failure) {
            made.refused = failure;
            return {.attempt = std::move(made), .has_id = false};
        }
        if (made.id != name())
            notes.push_back(
                fmt::format("{}: {} as an id is {}", made.source, quoted(name()), made.id));
        // No line number, which moves with everything above it: a run is made again where the text
        // of its attempt has changed.
        const std::string comment = fmt::format("Made by runcert batch from {}, the attempt {}.",
                                                escape_for_message(file_name_, 255), made.id);
        made.text = attempt_text(made.id, entry_.keys, comment);
        return {.attempt = std::move(made)};
    }

  private:
    [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
        throw Failure(entry_.place, what, remedy);
    }

    std::string source() const { return fmt::format("{}:{}", plain_text(file_name_), entry_.line); }

    /// What its id is made of: its id, or the name of its first file.
    std::string name() const {
        if (!entry_.id.empty()) return entry_.id;
        if (!entry_.attempt.empty()) return fs::path(entry_.attempt).stem().string();
        return files_.empty() ? fmt::format("line-{}", entry_.line)
                              : fs::path(files_[0].name).stem().string();
    }

    void refuse_pattern(const NamedFile& file) const {
        std::error_code error;
        if (file.name.find_first_of("*?") != std::string::npos &&
            !fs::exists(folder_ / file.name, error))
            fail(fmt::format("{}: {} is a pattern, and an entry is one attempt", file.key,
                             quoted(file.name)),
                 "List the attempts; `runcert new --day` writes them out");
    }

    /// Failure if a file is not there, or outside of the day file's folder.
    void require_file(const NamedFile& file) const {
        const auto fail_of_file = [&](const char* what, const char* remedy) {
            fail(fmt::format("{}: {} {}", file.key, quoted(file.name), what), remedy);
        };
        constexpr const char* inside =
            "Name a file inside of the day file's folder, relative to it";
        const fs::path path(file.name);
        if (file.name.empty()) fail_of_file("is empty", inside);
        if (path.is_absolute() || std::ranges::find(path, "..") != path.end())
            fail_of_file("is outside of the day file's folder", inside);
        refuse_pattern(file);
        std::error_code error;
        if (!fs::exists(folder_ / path, error))
            fail_of_file("does not exist",
                         "Correct its name, which is relative to the day file's folder, or put the "
                         "file there");
        const fs::path root = fs::weakly_canonical(folder_, error);
        const fs::path whole = fs::weakly_canonical(folder_ / path, error);
        if (std::ranges::mismatch(root, whole).in1 != root.end())
            fail_of_file("is outside of the day file's folder, by a symbolic link", inside);
    }

    /// Failure in the words of the entry where its keys do not make an attempt.
    void check_keys() const {
        try {
            (void)read_attempt(attempt_text("x", entry_.keys, ""), file_name_);
        } catch (const Failure& failure) {
            std::string problem = failure.problem();
            if (entry_.short_form)
                for (const std::string_view part : {"receivers[0].", "receivers[]."})
                    if (const std::size_t at = problem.find(part); at != std::string::npos)
                        problem.erase(at, part.size());
            fail(problem, failure.remedy());
        }
    }

    const DayEntry& entry_;
    fs::path folder_;
    std::string file_name_;
    std::vector<NamedFile> files_;
};

}  // namespace

ListedAttempts attempts_of_day(const DayFile& day, const fs::path& file) {
    ListedAttempts all;
    for (const DayEntry& entry : day.entries)
        all.attempts.push_back(EntryReader(entry, file).attempt(all.notes));
    return all;
}

}  // namespace runcert
