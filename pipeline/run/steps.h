#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"

namespace runcert {

/// A step in which a run is made. "claim" brings in the attempt and what it names beside
/// recordings; then come the stages; then "report" (report.json), "sign", and "render" (the pages).
struct Step {
    std::string name;
    std::string program = {};                 ///< "runcert-smooth"; empty where none does it
    std::vector<std::string> options = {};    ///< of the program, always given
    std::vector<std::string> calls = {};      ///< programs of others that it may run
    std::vector<ProductFile> products = {};   ///< what a stage writes, its own first
    std::vector<ProductFile> made_from = {};  ///< the products that it reads at least
};

/// The steps, in their order: the one list that certify, batch, verify and the inventory go by.
const std::vector<Step>& steps();

/// Whether a program is a stage that gets of the attempt only what the fields declare for it.
bool reads_part(std::string_view stage);

/// What such a stage gets of the attempt, and the same as its header and the record of the step
/// state it: what its files depend on beside the files that it reads.
struct StagePart {
    Attempt attempt;
    OpaqueJson settings;
};
StagePart part_of_stage(const Attempt& attempt, std::string_view stage);

/// What a stage reads of the profiles that an attempt claims.
OpaqueJson profiles_of_stage(const std::vector<YamlValue>& profiles, std::string_view stage);

/// The step of that name, which must be one.
const Step& step_named(std::string_view name);

/// How a run is reported.
struct ReportChoice {
    std::vector<std::string> pages = {page_names.begin(), page_names.end()};
    std::string signer = {};  ///< key id and role; empty for no signature
};

/// Whether the step is part of a run that is reported so.
bool is_step_of(const Step& step, const ReportChoice& choice);

/// The files of the run folder that a step reads and that earlier steps wrote. Recordings, and what
/// else import and claim read from outside, are among what these two write.
std::vector<std::string> inputs_of(const Step& step, const Attempt& attempt);

/// The files that a step writes; of "sign" none, whose name is known when it is written.
std::vector<std::string> outputs_of(const Step& step, const Attempt& attempt,
                                    const ReportChoice& choice);

/// The name of a product in the run folder: "2-enu.ecsv" for the first receiver of an attempt,
/// "2-enu.secondary.ecsv" for the receiver of that id otherwise; of the verdict, "6-verdict.yaml".
std::string product_file(const Attempt& attempt, const Receiver& receiver,
                         const ProductFile& product);

/// The names of all products of an attempt's run, in the order of the chain.
std::vector<std::string> product_files(const Attempt& attempt);

/// What a whole run folder holds beside its report.
struct RunInventory {
    std::vector<std::string> claim{};  ///< attempt, rules, series of wind and current
    std::vector<std::string> files{};  ///< these, recordings, stage files
    /// For each stage file those that it is made from at least; its header may name more.
    std::map<std::string, std::vector<std::string>> made_from{};
};

/// The files that the chain makes and keeps for an attempt.
RunInventory inventory_of(const Attempt& attempt);

/// How the program of a step is called.
struct StepCall {
    std::filesystem::path attempt;
    std::filesystem::path run_dir;
    /// For import: where what the attempt names is to be found ("--earlier-run", "--folder").
    std::vector<std::string> import_options = {};
    std::vector<std::string> pages = {};  ///< for render: which of `page_names`
    bool waits = false;                   ///< for render: begins by a byte on standard input
    std::filesystem::path roster = {};    ///< for render: whose keys count; may be empty
};

/// The command line of a step that a program in that folder does.
std::vector<std::string> command_of(const Step& step, const StepCall& call,
                                    const std::filesystem::path& programs);

}  // namespace runcert
