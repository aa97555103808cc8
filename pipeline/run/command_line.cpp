#include "run/command_line.h"

#include <CLI/CLI.hpp>

namespace runcert {

void CommandLine::text(const std::string& name, std::string& value, const std::string& about,
                       Need need) {
    app_.add_option(name, value, about)->required(need == Need::required);
}

void CommandLine::word(const std::string& name, std::string& value, const std::string& about,
                       const std::vector<std::string>& words, Need need) {
    app_.add_option(name, value, about)
        ->required(need == Need::required)
        ->check(CLI::IsMember(words));
}

void CommandLine::texts(const std::string& name, std::vector<std::string>& values,
                        const std::string& about) {
    app_.add_option(name, values, about)->allow_extra_args(false);
}

void CommandLine::integer(const std::string& name, std::int64_t& value, const std::string& about,
                          std::int64_t least, std::int64_t most) {
    app_.add_option(name, value, about)->check(CLI::Range(least, most));
}

void CommandLine::flag(const std::string& name, bool& value, const std::string& about) {
    app_.add_flag(name, value, about);
}

void CommandLine::exclude(const std::string& one, const std::string& other) {
    app_.get_option(one)->excludes(app_.get_option(other));
}

}  // namespace runcert
