#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace runcert {

/// What a program's command line may hold. A face of CLI11, whose header takes longer to compile
/// than most of the programs. Names are as CLI11 has them: "--out", or "RUN_DIR" for a place.
class CommandLine {
  public:
    enum class Need { optional, required };

    explicit CommandLine(CLI::App& app) : app_(app) {}

    void text(const std::string& name, std::string& value, const std::string& about,
              Need need = Need::optional);
    /// A text that is one of these words.
    void word(const std::string& name, std::string& value, const std::string& about,
              const std::vector<std::string>& words, Need need = Need::optional);
    /// An option that may be repeated.
    void texts(const std::string& name, std::vector<std::string>& values, const std::string& about);
    /// A whole number from `least` to `most`.
    void integer(const std::string& name, std::int64_t& value, const std::string& about,
                 std::int64_t least, std::int64_t most);
    void flag(const std::string& name, bool& value, const std::string& about);
    /// One cannot be given with the other, which was added before.
    void exclude(const std::string& one, const std::string& other);

  private:
    CLI::App& app_;
};

}  // namespace runcert
