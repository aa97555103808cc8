#pragma once

#include <string>
#include <vector>

#include "draft/draft.h"

namespace runcert {

/// Whether somebody is at the terminal who can answer.
bool somebody_answers();

/// Asks for one thing until the answer is taken, or it is left out. Failure where the terminal is
/// closed: nothing was written then.
void ask(Draft& draft, const Gap& gap);

/// Asks for all that is not answered, each thing once.
void ask_all(Draft& draft);

/// Asks for a text; empty where it is left out.
std::string ask_line(const std::string& question);

}  // namespace runcert
