#pragma once

#include <string>
#include <vector>

namespace runcert {

/// Prints, as JSON for another program, what a file is that is handed in, the one description that
/// `inspect` shows and `new` asks by: --describe FILE, and behind it KEYS, those of a receiver, as
/// JSON, that it is to be read by. Where NAVIGATION stands behind these, raw measurements are
/// described, too, with the orbits of that file, or of one of the same name beside them where it is
/// empty. Or a recording to be drawn: --track FILE, a list for each member of `RawTrack`.
///
/// Returns the exit status. Failure, with place, where the file cannot be read.
int describe_main(const std::vector<std::string>& words);

}  // namespace runcert
