#include "store/external_program.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>

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
Arguments shut_in(const fs::path& wrapper, const fs::path& folder,
                  const std::vector<fs::path>& inputs) {
    Arguments arguments{
        wrapper.string(),    "--unshare-user", "--unshare-ipc", "--unshare-pid", "--unshare-net",
        "--unshare-uts",     "--uid",          "65534",         "--gid",         "65534",
        "--die-with-parent", "--hostname",     "runcert"};
    const Arguments system = system_binds();
    arguments.insert(arguments.end(), system.begin(), system.end());
    append(arguments, {"--bind", folder.string(), folder.string()});
    for (const fs::path& input : inputs)
        append(arguments, {"--ro-bind", input.string(), input.string()});
    append(arguments,
           {"--remount-ro", "/", "--remount-ro", "/dev", "--chdir", folder.string(), "--"});
    return arguments;
}

/// What a program that failed said, for a message.
std::string reason_in(std::string_view said) {
    return said.empty() ? "it gave no reason" : escape_for_message(said, 200);
}

struct Sandbox {
    fs::path wrapper = find_program(system_path, bubblewrap);
    std::string obstacle = "bubblewrap is not installed";  ///< why there is none; else empty
};

/// Found by trying it on nothing.
Sandbox found_sandbox() {
    Sandbox found;
    if (found.wrapper.empty()) return found;
    const TemporaryFolder folder;
    Arguments command = shut_in(found.wrapper, fs::canonical(folder.path()), {});
    command.emplace_back(nothing);
    const ProcessResult result =
        run_process(command, {.closed_environment = true, .guarded = true});
    const std::string_view said = trim(result.errors);
    found.obstacle = result.exit_status == 0 ? "" : reason_in(said.substr(0, said.find('\n')));
    return found;
}

const Sandbox& sandbox() {
    static const Sandbox found = found_sandbox();
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

/// One of the limits of a call, as prlimit takes it; no higher than the caller's own.
std::string limit(const char* name, __rlimit_resource_t resource, std::uint64_t most) {
    rlimit own{};
    getrlimit(resource, &own);
    return fmt::format("--{}={}", name, std::min<rlim_t>(own.rlim_cur, most));
}

Arguments command_line(const ExternalCall& call, const fs::path& program, const fs::path& folder) {
    Arguments command{"/usr/bin/prlimit", limit("as", RLIMIT_AS, call.limits.memory_bytes),
                      limit("fsize", RLIMIT_FSIZE, call.limits.file_bytes),
                      limit("core", RLIMIT_CORE, 0), "--"};
    if (has_sandbox()) {
        std::vector<fs::path> inputs = call.inputs;
        if (!is_below(program, "/usr/")) inputs.push_back(program.parent_path());
        const Arguments wrapped = shut_in(sandbox().wrapper, folder, inputs);
        command.insert(command.end(), wrapped.begin(), wrapped.end());
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
                           .guarded = true};
    options.environment.insert(options.environment.end(), call.environment.begin(),
                               call.environment.end());
    return run_process(command_line(call, program, folder), options);
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
    const fs::path file = find_program(other ? other : system_path, name);
    return file.empty() ? file : fs::canonical(file);
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
    return fmt::format("it ended with status {}: {}", result.exit_status,
                       reason_in(trim(result.errors)));
}

bool has_sandbox() {
    return sandbox().obstacle.empty();
}

std::string isolation_word() {
    return has_sandbox() ? "" : "limits_only";
}

std::string missing_sandbox() {
    if (has_sandbox()) return {};
    return fmt::format(
        "The sandbox is not in force ({}). Programs of others can read your files and may reach "
        "the network, and what they start may outlive this program.",
        sandbox().obstacle);
}

std::string external_programs_text() {
    std::string text;
    for (const ExternalProgram& program : external_programs()) {
        const fs::path file = external_program_file(program.name);
        text += fmt::format("{:<11} ", program.name);
        text += file.empty()
                    ? fmt::format("missing: install the package {}\n", program.package)
                    : fmt::format("{}, SHA-256 {}..., {}\n", escape_for_message(file.string(), 200),
                                  digest_file(file).sha256.substr(0, 16),
                                  has_sandbox() ? "in a sandbox" : "not in a sandbox");
    }
    if (const std::string missing = missing_sandbox(); !missing.empty()) text += missing + "\n";
    return text;
}

}  // namespace runcert
