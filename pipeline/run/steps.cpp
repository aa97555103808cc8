#include "run/steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <nlohmann/json.hpp>

#include "run/attempt_files.h"
#include "schemas/common/header.h"
#include "schemas/profile/profile.h"

namespace runcert {
namespace {

using Names = std::vector<std::string>;

void append(Names& names, const Names& more) {
    names.insert(names.end(), more.begin(), more.end());
}

/// Recordings, and what import makes of them beside its table.
Names recorded_files(const Receiver& receiver) {
    Names names;
    for (const auto& files : {files_of_receiver(receiver), solution_files(receiver)})
        for (const AttemptFile& file : files)
            names.push_back(file.name);
    return names;
}

/// What the attempt claims by: itself, rules, series.
Names claim_files(const Attempt& attempt) {
    Names names{std::string(attempt_copy_name)};
    for (const std::string& claimed : attempt.profiles)
        names.push_back(profile_copy_name(claimed));
    for (const AttemptFile& file : series_files(attempt))
        names.push_back(file.name);
    return names;
}

/// The files of the products that a receiver has, of that receiver alone.
Names files_of(const std::vector<ProductFile>& products, const Attempt& attempt,
               const Receiver& receiver) {
    Names names;
    for (const ProductFile& product : products)
        if ((!product.of_phases || has_phases(receiver)) &&
            (!product.of_imu || has_imu(receiver)) &&
            (!product.of_surface || has_surface(receiver)))
            names.push_back(product_file(attempt, receiver, product));
    return names;
}

/// Whether a step hears an IMU, and of a surface only what it says of that.
bool uses_imu(const Step& step) {
    return std::ranges::any_of(step.products, &ProductFile::of_imu) && !step.made_from.empty();
}

/// What a step makes one of its products from: an IMU's are no part of the others.
std::vector<ProductFile> made_from(const Step& step, const ProductFile& product) {
    std::vector<ProductFile> products = step.made_from;
    if (product.of_imu) return products;
    std::erase_if(products, [&](const ProductFile& one) {
        return one.of_imu || (one.of_surface && uses_imu(step));
    });
    return products;
}

/// The series that the step reads as witnesses.
Names witness_files(const Step& step, const Attempt& attempt) {
    Names names;
    for (const AttemptFile& file : series_files(attempt))
        if (attempt_schema().is_read_by(file.role + ".file", step.name)) names.push_back(file.name);
    return names;
}

/// Whether what a stage writes is of the whole run.
bool is_of_run(const Step& step) {
    return !step.products.empty() && !step.products.front().each_receiver;
}

}  // namespace

const std::vector<Step>& steps() {
    using namespace products;
    static const std::vector<Step> all{
        {.name = "claim"},
        {.name = "import",
         .program = "runcert-import",
         .calls = {"gpsbabel", "rnx2rtkp"},
         .products = {observations, phase, imu, surface}},
        {.name = "enu",
         .program = "runcert-enu",
         .products = {products::enu},
         .made_from = {observations}},
        {.name = "screen",
         .program = "runcert-screen",
         .products = {screened, screened_phase},
         .made_from = {products::enu, phase, surface}},
        {.name = "smooth",
         .program = "runcert-smooth",
         .products = {trajectory, attitude},
         .made_from = {screened, imu, surface}},
        {.name = "window",
         .program = "runcert-window",
         .products = {windows},
         .made_from = {screened, trajectory, phase, screened_phase, imu, attitude}},
        {.name = "check",
         .program = "runcert-check",
         .products = {verdict},
         .made_from = {observations, surface, products::enu, screened, trajectory, windows}},
        {.name = "report", .program = "runcert-report", .options = {"--no-render"}},
        {.name = "sign"},
        {.name = "render",
         .program = "runcert-report",
         .options = {"--render-only"},
         .calls = {"weasyprint"}}};
    return all;
}

bool reads_part(std::string_view stage) {
    const auto found = std::ranges::find(steps(), stage, &Step::name);
    return found != steps().end() && !found->products.empty() && !is_of_run(*found);
}

StagePart part_of_stage(const Attempt& attempt, std::string_view stage) {
    StagePart part{part_read_by(attempt, stage), settings_of(attempt, stage)};
    // Of figures that replace a profile's, those of the fields of a profile that the stage reads.
    const auto is_read = [stage](std::string figure) {
        if (figure.starts_with("clauses.")) figure = "clauses[]" + figure.substr(figure.rfind('.'));
        return profile_schema().is_read_by(figure, stage);
    };
    if (part.attempt.rules.empty()) return part;
    std::erase_if(part.attempt.rules,
                  [&](const ReplacedFigure& rule) { return !is_read(rule.figure); });
    auto rules = nlohmann::ordered_json::array();
    for (const auto& rule : part.settings->at("rules"))
        if (is_read(rule.at("figure"))) rules.push_back(rule);
    part.settings["rules"] = rules;
    return part;
}

OpaqueJson profiles_of_stage(const std::vector<YamlValue>& profiles, std::string_view stage) {
    auto parts = nlohmann::ordered_json::array();
    for (const YamlValue& profile : profiles)
        parts.push_back(json_from_yaml(
            YamlValue(profile_schema().part_read_by(profile, stage), profile.where())));
    return parts;
}

const Step& step_named(std::string_view name) {
    const auto found = std::ranges::find(steps(), name, &Step::name);
    assert(found != steps().end());
    return *found;
}

bool is_step_of(const Step& step, const ReportChoice& choice) {
    if (step.name == "sign") return !choice.signer.empty();
    return step.name != "render" || !choice.pages.empty();
}

Names inputs_of(const Step& step, const Attempt& attempt) {
    if (step.name == "sign" || step.name == "render") return {"report.json"};
    if (step.name == "report") return inventory_of(attempt).files;
    if (step.made_from.empty()) return {};  // they read what is outside
    Names names;
    if (is_of_run(step)) {
        names = claim_files(attempt);
        for (const Step& other : steps())
            for (const std::string& file : witness_files(other, attempt))
                std::erase(names, file);
    }
    append(names, witness_files(step, attempt));
    for (const Receiver& receiver : attempt.receivers) {
        std::vector<ProductFile> products = step.made_from;
        if (uses_imu(step) && !has_imu(receiver)) std::erase_if(products, &ProductFile::of_surface);
        append(names, files_of(products, attempt, receiver));
    }
    return names;
}

Names outputs_of(const Step& step, const Attempt& attempt, const ReportChoice& choice) {
    if (step.name == "claim") return claim_files(attempt);
    if (step.name == "report") return {"report.json"};
    if (step.name == "render") return choice.pages;
    if (is_of_run(step)) return files_of(step.products, attempt, attempt.receivers.front());
    Names names;
    if (step.products.empty()) return names;
    for (const Receiver& receiver : attempt.receivers) {
        if (step.made_from.empty()) append(names, recorded_files(receiver));
        append(names, files_of(step.products, attempt, receiver));
    }
    return names;
}

std::string product_file(const Attempt& attempt, const Receiver& receiver,
                         const ProductFile& product) {
    if (!product.each_receiver || receiver.id == attempt.receivers.front().id)
        return fmt::format("{}.{}", product.stem, product.extension);
    return fmt::format("{}.{}.{}", product.stem, receiver.id, product.extension);
}

Names product_files(const Attempt& attempt) {
    Names names;
    for (const ProductFile& product : products::all) {
        const std::size_t count = product.each_receiver ? attempt.receivers.size() : 1;
        for (std::size_t i = 0; i < count; ++i)
            append(names, files_of({product}, attempt, attempt.receivers[i]));
    }
    return names;
}

RunInventory inventory_of(const Attempt& attempt) {
    RunInventory inventory{.claim = claim_files(attempt)};
    inventory.files = inventory.claim;
    for (const Receiver& receiver : attempt.receivers) {
        const Names recorded = recorded_files(receiver);
        append(inventory.files, recorded);
        for (const Step& step : steps()) {
            if (is_of_run(step)) continue;
            for (const ProductFile& product : step.products)
                for (const std::string& file : files_of({product}, attempt, receiver)) {
                    inventory.files.push_back(file);
                    Names& needed = inventory.made_from[file];
                    needed = step.made_from.empty()
                                 ? recorded
                                 : files_of(made_from(step, product), attempt, receiver);
                    append(needed, witness_files(step, attempt));
                }
        }
    }
    for (const Step& step : steps()) {
        if (!is_of_run(step)) continue;
        const std::string file = outputs_of(step, attempt, {}).front();
        inventory.files.push_back(file);
        inventory.made_from[file] = inputs_of(step, attempt);
    }
    return inventory;
}

Names command_of(const Step& step, const StepCall& call, const std::filesystem::path& programs) {
    assert(!step.program.empty());
    Names command{(programs / step.program).string(), "--attempt", call.attempt.string(),
                  "--run-dir", call.run_dir.string()};
    append(command, step.options);
    if (step.name == "import") append(command, call.import_options);
    if (step.name == "render")
        for (const std::string& page : call.pages)
            command.insert(command.end(), {"--page", page});
    if (step.name == "render" && call.waits) command.emplace_back("--wait");
    if (step.name == "render" && !call.roster.empty())
        command.insert(command.end(), {"--roster", call.roster.string()});
    return command;
}

}  // namespace runcert
