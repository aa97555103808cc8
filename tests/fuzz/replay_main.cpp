// Runs a target of this program without libFuzzer: on every file of a folder and on mutations of
// each, drawn with a fixed seed, until a number of executions is reached. Exit status 1 for a
// finding.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "core/random.h"
#include "fuzz_target.h"
#include "guardian.h"
#include "store/atomic_file.h"

namespace runcert::fuzz {
namespace {

std::string target;

namespace fs = std::filesystem;

/// No single input may take more of the processor, sanitizers included: far more than the slowest
/// does, and far less than one that is read again and again.
constexpr double longest_s = 20.0;

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::string mutated(std::string bytes, const std::string& other, RandomGenerator& random) {
    static constexpr std::string_view pieces[] = {
        "\n", "\r",   "\t",    ",",       ":",    "*",    "$",  "<",   ">",   "\"", "-",
        "0",  "nan",  "1e400", "0x",      "9999", "\xff", "&a", "*a ", "[[[", "{",  "\xef\xbb\xbf",
        ".",  "-inf", "1,5",   "\xb5\x62"};
    for (std::uint64_t n = 1 + random.next() % 4; n > 0 && !bytes.empty(); --n) {
        const std::size_t at = random.next() % bytes.size();
        const std::size_t length = random.next() % 64;
        switch (random.next() % 7) {
            case 0:
                bytes[at] = static_cast<char>(random.next() % 256);
                break;
            case 1:
                bytes[at] =
                    static_cast<char>(bytes[at] ^ static_cast<char>(1U << random.next() % 8));
                break;
            case 2:
                bytes.erase(at, length);
                break;
            case 3:
                bytes.insert(at, bytes.substr(random.next() % bytes.size(), length));
                break;
            case 4:
                bytes.resize(at);
                break;
            case 5:
                bytes.insert(at, other.substr(0, length));
                break;
            default:
                bytes.insert(at, pieces[random.next() % std::size(pieces)]);
        }
    }
    return bytes;
}

/// What is being run, for a message from a signal's handler.
std::string running;

void say_and_end(int) {
    fmt::print(stderr, "finding: a signal, in {}\n", running);
    std::_Exit(1);
}

/// One execution; whether it is no finding.
bool run_one(const std::string& bytes) {
    const double begin = processor_seconds();
    try {
        run_target(bytes);
    } catch (const std::exception& error) {
        fmt::print(stderr, "finding: {}, in {}\n", error.what(), running);
        return false;
    }
    const double took = processor_seconds() - begin;
    if (took <= longest_s) return true;
    fmt::print(stderr, "finding: {:.1f} s of the processor, in {}\n", took, running);
    return false;
}

std::vector<fs::path> files_of(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

int replay(const fs::path& folder, std::uint64_t executions) {
    const std::vector<fs::path> files = files_of(folder);
    if (files.empty()) {
        fmt::print(stderr, "{} holds no files\n", folder.string());
        return 2;
    }
    std::vector<std::string> corpus;
    for (const fs::path& file : files)
        corpus.push_back(read_file(file));
    bool good = true;
    std::uint64_t run = 0;
    for (std::size_t i = 0; i < files.size(); ++i, ++run) {
        running = files[i].string();
        good = run_one(corpus[i]) && good;
    }
    for (std::uint64_t round = 0; run < executions; ++round)
        for (std::size_t i = 0; i < files.size() && run < executions; ++i, ++run) {
            RandomGenerator random(round * files.size() + i);
            const std::string& other = corpus[random.next() % corpus.size()];
            running = fmt::format("{}, mutation {}", files[i].string(), round);
            good = run_one(mutated(corpus[i], other, random)) && good;
        }
    fmt::print("{} executions from {} files, {}\n", run, files.size(),
               good ? "no finding" : "with findings");
    return good ? 0 : 1;
}

}  // namespace

const std::string& target_name() {
    return target;
}

}  // namespace runcert::fuzz

int main(int argc, char** argv) {
    std::uint64_t executions = 0;
    const std::string number = argc == 4 ? argv[3] : "";
    if (std::from_chars(number.data(), number.data() + number.size(), executions).ec !=
        std::errc{}) {
        fmt::print(stderr, "usage: replay TARGET CORPUS_FOLDER EXECUTIONS\n");
        return 2;
    }
    runcert::fuzz::target = argv[1];
    for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL})
        std::signal(signal, runcert::fuzz::say_and_end);
    return runcert::test::guarded(
        [argv, executions] { return runcert::fuzz::replay(argv[2], executions); });
}
