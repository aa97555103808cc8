#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/attitude/declared.h"
#include "schemas/day/day.h"
#include "schemas/day_results/day_results.h"
#include "schemas/enu/declared.h"
#include "schemas/generator/declaration.h"
#include "schemas/imu/declared.h"
#include "schemas/observations/observations.h"
#include "schemas/phase/declared.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/screened_phase/declared.h"
#include "schemas/simulation/simulation.h"
#include "schemas/surface/declared.h"
#include "schemas/trajectory/declared.h"
#include "schemas/verdict/declared.h"
#include "schemas/windows/windows.h"

namespace runcert::golden {

inline std::string slurp(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    EXPECT_TRUE(in.good()) << path;
    return {std::istreambuf_iterator<char>(in), {}};
}

/// The text of a file, "v1.0/2-enu.ecsv".
inline std::string text_of(const std::string& file) {
    return slurp(std::string(RUNCERT_SOURCE_DIR) + "/tests/golden/" + file);
}

/// The normative field table of a schema; of one that is a declaration, as the build makes it.
inline std::string field_table(const std::string& schema) {
    const std::string folder = std::string(RUNCERT_SOURCE_DIR) + "/schemas";
    std::string path = folder + "/" + schema + "/v1.yaml";
    if (!std::filesystem::exists(path)) path = folder + "/outer/" + schema + "/v1.yaml";
    std::string text = slurp(path);
    if (text.find("\nuses:") == std::string::npos && text.find("\nmaps:") == std::string::npos)
        return text;
    return field_table_text(Declaration(path, folder));
}

/// A product or an input, which has one file. What cannot stand together in one input stands in a
/// second one, which is of a kind of its own.
struct GoldenKind {
    const char* name;
    const char* schema;
    /// Reads it, and gives the text that writing it again makes; empty for what people write.
    std::string (*again)(const std::string& text, const std::string& where);
};

inline constexpr GoldenKind kinds[] = {
    {"1-observations.ecsv", "observations",
     [](const std::string& text, const std::string& where) {
         return write_observations(read_observations(text, where));
     }},
    {"1-phase.ecsv", "phase",
     [](const std::string& text, const std::string& where) {
         return write_phase(read_phase(text, where));
     }},
    {"1-imu.ecsv", "imu",
     [](const std::string& text, const std::string& where) {
         return write_imu(read_imu(text, where));
     }},
    {"1-surface.ecsv", "surface",
     [](const std::string& text, const std::string& where) {
         return write_surface(read_surface(text, where));
     }},
    {"2-enu.ecsv", "enu",
     [](const std::string& text, const std::string& where) {
         return write_enu(read_enu(text, where));
     }},
    {"3-screened.ecsv", "screened",
     [](const std::string& text, const std::string& where) {
         return write_screened(read_screened(text, where));
     }},
    {"3-phase.ecsv", "screened_phase",
     [](const std::string& text, const std::string& where) {
         return write_screened_phase(read_screened_phase(text, where));
     }},
    {"4-trajectory.ecsv", "trajectory",
     [](const std::string& text, const std::string& where) {
         return write_trajectory(read_trajectory(text, where));
     }},
    {"4-attitude.ecsv", "attitude",
     [](const std::string& text, const std::string& where) {
         return write_attitude(read_attitude(text, where));
     }},
    {"5-windows.yaml", "windows",
     [](const std::string& text, const std::string& where) {
         return write_windows(read_windows(text, where));
     }},
    {"6-verdict.yaml", "verdict",
     [](const std::string& text, const std::string& where) {
         return write_verdict(read_verdict(text, where));
     }},
    {"day_results.yaml", "day_results",
     [](const std::string& text, const std::string& where) {
         return write_day_results(read_day_results(text, where));
     }},
    {"attempt.yaml", "attempt",
     [](const std::string& text, const std::string& where) {
         (void)read_attempt(text, where);
         return std::string();
     }},
    {"attempt.plane.yaml", "attempt",
     [](const std::string& text, const std::string& where) {
         (void)read_attempt(text, where);
         return std::string();
     }},
    {"profile.yaml", "profile",
     [](const std::string& text, const std::string& where) {
         (void)read_profile(text, where);
         return std::string();
     }},
    {"profile.course.yaml", "profile",
     [](const std::string& text, const std::string& where) {
         (void)read_profile(text, where);
         return std::string();
     }},
    {"profile.evidence.yaml", "profile",
     [](const std::string& text, const std::string& where) {
         (void)read_profile(text, where);
         return std::string();
     }},
    {"profile.extends.yaml", "profile",
     [](const std::string& text, const std::string& where) {
         (void)read_profile(text, where);
         return std::string();
     }},
    {"profile.part.yaml", "profile",
     [](const std::string& text, const std::string& where) {
         (void)read_profile(text, where);
         return std::string();
     }},
    {"simulation.yaml", "simulation",
     [](const std::string& text, const std::string& where) {
         (void)read_simulation(text, where);
         return std::string();
     }},
    {"simulation.lake.yaml", "simulation",
     [](const std::string& text, const std::string& where) {
         (void)read_simulation(text, where);
         return std::string();
     }},
    {"day.yaml", "day",
     [](const std::string& text, const std::string& where) {
         for (const DayEntry& entry : read_day_file(text, where).entries)
             if (entry.refused) throw Failure(*entry.refused);
         return std::string();
     }},
};

struct GoldenFile {
    std::string path;  ///< "v1.0/2-enu.ecsv"
    GoldenKind kind;
    bool is_table;
};

/// Every golden file, by kind.
inline std::vector<GoldenFile> all_files() {
    std::vector<GoldenFile> files;
    for (const GoldenKind& kind : kinds)
        files.push_back(
            {std::string("v1.0/") + kind.name, kind, std::string(kind.name).ends_with(".ecsv")});
    return files;
}

}  // namespace runcert::golden
