#pragma once

#include <string>
#include <vector>

#include "reports/audit/record.h"
#include "reports/words/figures.h"

// The sections of a walk; `walk_through` puts them together.

namespace runcert {

/// A stage's section where its product is there; else one that says that it is not.
Section import_section(const RunRecord& record, const ReceiverRecord& one, bool all);
Section enu_section(const RunRecord& record, const ReceiverRecord& one, bool all);
Section screen_section(const RunRecord& record, const ReceiverRecord& one, bool all);
Section smooth_section(const RunRecord& record, const ReceiverRecord& one, bool all);
Section window_section(const RunRecord& record, const ReceiverRecord& one, bool all);
Section check_section(const RunRecord& record, bool all);

/// The head of a stage's section: where its product comes from and what became of it, as a table of
/// its inputs and the facts of its own file. `contents` says what is in it ("601 epochs").
Section product_section(const RunRecord& record, const std::string& title, const Header& header,
                        const std::string& file, const std::string& contents, bool all);

/// The parameters of a stage that are not the default, each with it; with `all` every one.
std::vector<Block> parameter_blocks(const Attempt& attempt, const Header& header, bool all);

/// A section that says that the product is missing.
Section missing_section(const std::string& title, const std::string& file);

/// "3. screen, receiver primary"
std::string stage_title(const std::string& stage, const std::string& receiver);

/// A speed as the file holds it, which is not how it is to be read: "62.130412 m/s".
std::string file_speed_text(double speed_m_s);
/// "3.000 s from 57.000 s on (epochs 571 to 601; 2026-03-14T04:05:57.000Z)"
std::string span_text(const WindowSpan& span);

}  // namespace runcert
