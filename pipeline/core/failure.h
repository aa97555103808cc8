#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace runcert {

/// The one exception type of the project: an operation could not be carried out.
///
/// `where` names the file and, if known, the line, column or byte. `what` says what was found and
/// what was expected. `remedy` says what the user can do. Each program catches it once, at the top,
/// prints all three and exits with status 2.
class Failure : public std::runtime_error {
  public:
    Failure(std::string where, std::string what, std::string remedy)
        : std::runtime_error(where + ": " + what + ". " + remedy),
          where_(std::move(where)),
          what_(std::move(what)),
          remedy_(std::move(remedy)) {}

    /// The file and, if known, the line, column or byte.
    const std::string& where() const { return where_; }
    /// The constructor's `what`: what was found and what was expected. what() returns all three
    /// parts.
    const std::string& problem() const { return what_; }
    /// What the user can do.
    const std::string& remedy() const { return remedy_; }

  private:
    std::string where_;
    std::string what_;
    std::string remedy_;
};

/// The computer could not do it: its disk is full or broken, its memory or its open files are used
/// up. What was read is not at fault, so nothing is found against it.
class ComputerFailure : public Failure {
  public:
    /// How the problem begins, by which a program knows it in what another one said.
    static constexpr const char* prefix = "this computer failed: ";

    ComputerFailure(std::string where, const std::string& what, std::string remedy)
        : Failure(std::move(where), prefix + what, std::move(remedy)) {}

    /// The problem without how it begins.
    std::string what_failed() const { return problem().substr(std::string(prefix).size()); }
};

}  // namespace runcert
