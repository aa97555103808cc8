#pragma once

#include <string>
#include <vector>

#include "draft/draft.h"

namespace runcert {

/// What a file is, in a line.
std::string file_text(const Recognition& is);

/// Prints how a table is read, why, and its first rows so.
void show_description(const HandedIn& file);

/// Prints what the recordings are, and what they are to each other.
void show_recordings(const Draft& draft);

/// Prints all that is not answered, in the order in which it is asked. With keys, it says how each
/// is answered by --set, and why.
void show_gaps(const Draft& draft, const std::string& title, bool with_keys);

/// Prints the keys of the attempt with what was answered.
void show_answers(const Draft& draft);

/// Prints a list under a title; nothing for an empty one.
void show_list(const std::string& title, std::vector<std::string> items);

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
