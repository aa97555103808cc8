#include "store/external_program.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* system_path = "/usr/bin:/bin:/usr/local/bin";
constexpr const char* other_path = "RUNCERT_EXTERNAL_PATH";
constexpr const char* bubblewrap = "bwrap";
constexpr const char* nothing = "/usr/bin/true";

using Arguments = std::vector<std::string>;

/// The first file of that name which may be run, in absolute folders of a path.
fs::path find_in(std::string_view path, std::string_view name) {
    while (!path.empty()) {
        const std::size_t end = std::min(path.find(':'), path.size());
        const fs::path file = fs::path(path.substr(0, end)) / name;
        std::error_code error;
        if (file.is_absolute() && fs::is_regular_file(file, error) &&
            access(file.c_str(), X_OK) == 0)
            return fs::canonical(file);
        path.remove_prefix(std::min(end + 1, path.size()));
    }
    return {};
}

bool is_below(const fs::path& file, std::string_view folder) {
    return file.string().starts_with(folder);
}

void append(Arguments& arguments, std::initializer_list<std::string> more) {
    arguments.insert(arguments.end(), more);
}

/// The system's programs and what they need to run; nothing of its people, services or devices.
Arguments system_binds() {
    Arguments arguments{"--ro-bind", "/usr", "/usr", "--dev", "/dev"};
    for (const char* name : {"/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32"}) {
        std::error_code error;
        if (fs::is_symlink(name, error))
            append(arguments, {"--symlink", fs::read_symlink(name).string(), name});
        else if (fs::is_directory(name, error))
            append(arguments, {"--ro-bind", name, name});
    }
    for (const char* name : {"/etc/alternatives", "/etc/ld.so.cache", "/etc/passwd", "/etc/group",
                             "/etc/fonts", "/var/cache/fontconfig", "/etc/ssl/openssl.cnf"})
        append(arguments, {"--ro-bind-try", name, name});
    return arguments;
}

/// How bubblewrap shuts in: an own everything, and another user, so that a program that asks who
/// it runs for finds one in /etc/passwd, and always the same.
Arguments shut_in(const fs::path& wrapper, const fs::path& folder, const Arguments& inputs) {
    Arguments arguments{
        wrapper.string(),    "--unshare-user", "--unshare-ipc", "--unshare-pid", "--unshare-net",
        "--unshare-uts",     "--uid",          "65534",         "--gid",         "65534",
        "--die-with-parent", "--hostname",     "runcert"};
    const Arguments system = system_binds();
    arguments.insert(arguments.end(), system.begin(), system.end());
    append(arguments, {"--bind", folder.string(), folder.string()});
    for (const std::string& input : inputs)
        append(arguments, {"--ro-bind", input, input});
    append(arguments,
           {"--remount-ro", "/", "--remount-ro", "/dev", "--chdir", folder.string(), "--"});
    return arguments;
}

struct Confinement {
    Isolation isolation = Isolation::full;
    fs::path wrapper = {};
    std::string obstacle = {};  ///< why it is not full
};

/// Why a trial of shutting nothing in failed; none where it did not.
std::optional<std::string> obstacle_to(const Arguments& command, bool no_network) {
    try {
        const ProcessResult result = run_process(
            command, {.closed_environment = true, .guarded = true, .no_network = no_network});
        if (result.exit_status == 0) return std::nullopt;
        const std::string_view said = trim(result.errors);
        return escape_for_message(said.substr(0, said.find('\n')), 200);
    } catch (const Failure& failure) {
        return failure.problem();
    }
}

Confinement found_by_trying() {
    Confinement found{.wrapper = find_in(system_path, bubblewrap)};
    std::optional<std::string> obstacle = "bubblewrap is not installed";
    if (!found.wrapper.empty()) {
        const TemporaryFolder folder;
        Arguments command = shut_in(found.wrapper, fs::canonical(folder.path()), {});
        command.emplace_back(nothing);
        obstacle = obstacle_to(command, false);
    }
    if (!obstacle) return found;
    const bool connected = obstacle_to({nothing}, true).has_value();
    return {.isolation = connected ? Isolation::limits_only : Isolation::no_network,
            .obstacle = *obstacle};
}

const Confinement& confinement() {
    static const Confinement found = found_by_trying();
    return found;
}

const ExternalProgram& known_program(std::string_view name) {
    const auto& all = external_programs();
    return *std::ranges::find(all, name, &ExternalProgram::name);
}

fs::path require_program(std::string_view name) {
    fs::path file = external_program_file(name);
    if (file.empty())
        throw Failure(std::string(name),
                      fmt::format("the program could not be started: it is not in {}",
                                  std::getenv(other_path) ? other_path : system_path),
                      fmt::format("Install the package {}", known_program(name).package));
    return file;
}

Arguments texts_of(const std::vector<fs::path>& paths) {
    Arguments texts;
    for (const fs::path& path : paths)
        texts.push_back(path.string());
    return texts;
}

Arguments command_line(const ExternalCall& call, const fs::path& program, const fs::path& folder) {
    Arguments command;
    if (isolation() == Isolation::full) {
        Arguments inputs = texts_of(call.inputs);
        if (!is_below(program, "/usr/")) inputs.push_back(program.parent_path().string());
        command = shut_in(confinement().wrapper, folder, inputs);
    }
    command.push_back(program.string());
    command.insert(command.end(), call.command.begin() + 1, call.command.end());
    return command;
}

ProcessResult run_in(const ExternalCall& call, const fs::path& program, const fs::path& folder) {
    ProcessOptions options{.environment = {{"HOME", folder.string()},
                                           {"TMPDIR", folder.string()},
                                           {"PATH", system_path},
                                           {"LC_ALL", "C.UTF-8"},
                                           {"TZ", "UTC"}},
                           .closed_environment = true,
                           .folder = folder,
                           .standard_input = call.standard_input,
                           .time_limit = call.limits.time,
                           .stop = call.stop,
                           .most_output = call.limits.output_bytes,
                           .guarded = true,
                           .most_memory = call.limits.memory_bytes,
                           .longest_file = call.limits.file_bytes,
                           .no_network = isolation() == Isolation::no_network};
    options.environment.insert(options.environment.end(), call.environment.begin(),
                               call.environment.end());
    return run_process(command_line(call, program, folder), options);
}

std::string_view words_of(Isolation isolation) {
    switch (isolation) {
        case Isolation::full:
            return "in a sandbox";
        case Isolation::no_network:
            return "without network";
        case Isolation::limits_only:
            return "not in a sandbox";
    }
    return {};
}

}  // namespace

const std::vector<ExternalProgram>& external_programs() {
    static const std::vector<ExternalProgram> all{
        {"gpsbabel", "gpsbabel"},      {"rnx2rtkp", "rtklib"},
        {"weasyprint", "weasyprint"},  {"pdfdetach", "poppler-utils"},
        {"pdfsig", "poppler-utils"},   {"pdfinfo", "poppler-utils"},
        {"pdffonts", "poppler-utils"}, {"pdftotext", "poppler-utils"},
        {"pdftoppm", "poppler-utils"}, {"podofosign", "libpodofo-utils"},
        {"openssl", "openssl"},        {"ssh-keygen", "openssh-client"}};
    return all;
}

std::filesystem::path external_program_file(std::string_view name) {
    const char* other = std::getenv(other_path);
    return find_in(other ? other : system_path, name);
}

std::string missing_program_words(std::string_view name) {
    if (!external_program_file(name).empty()) return {};
    return fmt::format("{} is not installed here (package {})", name, known_program(name).package);
}

std::string external_program_sha256(std::string_view name) {
    const fs::path file = external_program_file(name);
    return file.empty() ? std::string() : digest_file(file).sha256;
}

std::filesystem::path external_input(const std::filesystem::path& file) {
    std::error_code error;
    fs::path found = fs::canonical(file, error);
    if (error) throw Failure(file.string(), error.message(), "Check that it is there");
    return found;
}

ProcessResult run_external(const ExternalCall& call) {
    const fs::path program = require_program(call.command.front());
    if (!call.folder.empty()) return run_in(call, program, fs::canonical(call.folder));
    const TemporaryFolder folder;
    return run_in(call, program, fs::canonical(folder.path()));
}

std::string external_problem(const ExternalCall& call, const ProcessResult& result) {
    if (result.end == ProcessEnd::over_time)
        return fmt::format("it did not end within {} s", call.limits.time.count());
    if (result.end == ProcessEnd::over_output)
        return fmt::format("it said more than {} MiB", call.limits.output_bytes >> 20);
    const std::string_view said = trim(result.errors);
    return fmt::format("it ended with status {}: {}", result.exit_status,
                       said.empty() ? "it gave no reason" : escape_for_message(said, 200));
}

Isolation isolation() {
    return confinement().isolation;
}

std::string isolation_word() {
    switch (isolation()) {
        case Isolation::full:
            break;
        case Isolation::no_network:
            return "no_network";
        case Isolation::limits_only:
            return "limits_only";
    }
    return {};
}

std::string missing_sandbox() {
    if (isolation() == Isolation::full) return {};
    return fmt::format(
        "The sandbox is not in force ({}). Programs of others can read your files{}.",
        confinement().obstacle,
        isolation() == Isolation::no_network ? "" : ", and may reach the network");
}

std::string external_programs_text() {
    std::string text;
    for (const ExternalProgram& program : external_programs()) {
        const fs::path file = external_program_file(program.name);
        text += fmt::format("{:<11} ", program.name);
        text += file.empty()
                    ? fmt::format("missing: install the package {}\n", program.package)
                    : fmt::format("{}, SHA-256 {}..., {}\n", escape_for_message(file.string(), 200),
                                  digest_file(file).sha256.substr(0, 16), words_of(isolation()));
    }
    if (const std::string missing = missing_sandbox(); !missing.empty()) text += missing + "\n";
    return text;
}

}  // namespace runcert
