#pragma once

#include <filesystem>
#include <string>

namespace runcert {

/// Renders the pages of a run again, which show who signed and answered, with the keys of a roster
/// where one is named; a sealed PDF goes to superseded/, since a seal is of the page as it was. The
/// exit status: 2 where they could not be, which is said with `done`, what was done all the same.
int render_pages(const std::filesystem::path& run_dir, const std::string& roster,
                 const std::string& done);

/// Whether a file lies in a run folder, or is the run itself: what it says is then the sender's
/// word.
bool lies_in(const std::filesystem::path& file, const std::filesystem::path& run_dir);

/// Failure where the roster named is one of the run: pages go by the reader's own. Empty is none.
void require_own_roster(const std::string& roster, const std::filesystem::path& run_dir);

}  // namespace runcert
