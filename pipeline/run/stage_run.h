#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/common/header.h"

namespace runcert {

/// What surrounds a stage: its attempt, its run folder, and the book of what it read.
///
/// Every file read is hashed. Where the header of one file claims the hash of another that is read
/// too, the two must agree; a mismatch is a Failure.
class StageRun {
  public:
    /// Reads and checks the attempt. The run folder is created if it is missing.
    StageRun(std::string stage, const std::filesystem::path& attempt_file,
             std::filesystem::path run_dir);

    const Attempt& attempt() const { return attempt_; }
    const std::filesystem::path& run_dir() const { return run_dir_; }
    const std::filesystem::path& attempt_path() const { return attempt_path_; }
    const std::string& attempt_text() const { return attempt_text_; }

    /// The attempt as an input of the stage; a stage that uses more of it than its parameters calls
    /// this to have it named in its header.
    void note_attempt();
    /// What the stage uses in place of the attempt's parameters of its name.
    void use_parameters(nlohmann::ordered_json parameters) { parameters_ = std::move(parameters); }
    /// Notes bytes that do not come from the run folder's products.
    void note_input(const std::string& role, const std::string& file, std::string_view bytes,
                    const std::string& original = {});

    /// Notes a file of the run folder, without keeping its bytes in memory.
    void note_file(const std::string& role, const std::string& file,
                   const std::string& original = {});
    /// All that was noted, in the order of noting.
    const std::vector<InputFile>& inputs() const { return inputs_; }

    /// The bytes of a file of the run folder, noted as an input.
    std::string read_text(const std::string& role, const std::string& file);

    /// A product of the run folder: `reader(text, where)` returns it, with its `header`.
    template <class Reader>
    auto read(const std::string& role, const std::string& file, Reader reader) {
        const std::string text = read_text(role, file);
        auto product = reader(text, (run_dir_ / file).string());
        note_claims(file, product.header);
        return product;
    }

    /// The header of what the stage writes: the inputs noted so far, and the stage's parameters.
    Header header() const;

    /// Writes a product into the run folder, whole or not at all.
    void write(const std::string& file, std::string_view text) const;

    /// Adds to what the stage says on standard output when it is done.
    void say(std::string line) { said_.push_back(std::move(line)); }
    const std::vector<std::string>& said() const { return said_; }

  private:
    struct Claim {
        std::string sha256;
        std::string claimed_by;
    };
    void note(const InputFile& input);
    void note_claims(const std::string& file, const Header& header);
    void check_claim(const std::string& file, const std::string& sha256) const;

    std::string stage_;
    std::filesystem::path attempt_path_;
    std::filesystem::path run_dir_;
    std::string attempt_text_;
    Attempt attempt_;
    nlohmann::ordered_json parameters_ = nlohmann::ordered_json::object();
    std::vector<InputFile> inputs_;
    std::map<std::string, Claim> claims_;
    std::vector<std::string> said_;
};

/// A run folder as a program reads it that writes nothing there. Failure where there is none.
StageRun open_run(const std::string& program, const std::filesystem::path& run_dir);

/// The receiver of that id, the first where it is empty. Failure (at "--receiver") where there is
/// none.
const Receiver& receiver_of(const Attempt& attempt, const std::string& id);

/// The name of a product: "2-enu.ecsv" for the first receiver of an attempt,
/// "2-enu.secondary.ecsv" for the receiver of that id otherwise.
std::string product_file(const Attempt& attempt, const Receiver& receiver, std::string_view stem,
                         std::string_view extension);

}  // namespace runcert
