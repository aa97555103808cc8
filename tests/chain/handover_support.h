#pragma once

#include <gtest/gtest.h>

#include <fstream>

#include "chain_support.h"

// A signed run, and what is made of it to be handed over.

namespace runcert::chain {

/// An example certified and signed by a key made for it.
class SignedRun {
  public:
    /// `pages`: how they are made, as certify is told.
    explicit SignedRun(const std::string& example, const std::string& pages = "--no-render") {
        EXPECT_EQ(runcert({"keygen", "--out", (path() / "measurer").string(), "--no-password"})
                      .exit_status,
                  0);
        const ProcessResult result = certify(examples / example / "attempt.yaml", run(),
                                             {"--key", (path() / "measurer.key").string(), pages});
        EXPECT_NE(result.exit_status, 2) << result.errors;
    }
    fs::path path() const { return folder_.path(); }
    fs::path run() const { return path() / "run"; }
    std::string public_key() const { return (path() / "measurer.pub").string(); }
    std::string public_line() const {
        const std::string text = read_file(public_key());
        const std::size_t line = text.find('\n') + 1;
        return text.substr(line, text.find('\n', line) - line);
    }

  private:
    TemporaryFolder folder_;
};

/// What a shell line does, in a folder.
inline ProcessResult shell(const fs::path& folder, const std::string& line) {
    return run_process({"bash", "-c", "set -eo pipefail; cd \"$0\"; " + line, folder.string()});
}

inline bool has_program(const std::string& name) {
    return run_process({"sh", "-c", "command -v " + name}).exit_status == 0;
}

/// Writes without a sync: thousands of times, that counts.
inline void write_quickly(const fs::path& file, const std::string& bytes) {
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

inline bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

/// A program's refusal: status 2 and three lines that say these words.
inline void expect_refused(const ProcessResult& result, const std::vector<std::string>& words) {
    EXPECT_EQ(result.exit_status, 2) << result.output << result.errors;
    for (const char* part : {"error: ", "where: ", "what to do: "})
        EXPECT_TRUE(holds(result.errors, part)) << result.errors;
    for (const std::string& word : words)
        EXPECT_TRUE(holds(result.errors, word)) << word << "\n" << result.errors;
    EXPECT_FALSE(holds(result.errors, "fault of the program")) << result.errors;
}

}  // namespace runcert::chain
