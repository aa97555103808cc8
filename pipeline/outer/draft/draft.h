#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "draft/arrange.h"

namespace runcert {

/// Something that an attempt may say, and that no recording answers.
struct Gap {
    std::string key;       ///< as `Draft::set` takes it: "place", "receivers.primary.solution"
    std::string question;  ///< "Name of the craft"
    std::string why;       ///< a sentence
    bool required = false;
    std::vector<std::string> values = {};  ///< what it may be, where that is known
    std::string proposal = {};  ///< what is taken where nothing is said; of required ones
    std::string example = {};   ///< as YAML has it, for a line that is left out
    bool at_prompt = true;      ///< whether it can be answered in a line
};

/// A file's name as an id: every other character becomes -. With its date and minute, where they
/// are given, so that two recordings of one name have two ids.
std::string id_of(const std::string& path, const std::optional<GpsTime>& first);

/// An attempt while it is written: what the recordings say, and what somebody answers.
class Draft {
  public:
    /// Of recordings that are arranged.
    Draft(std::vector<HandedIn> files, Arrangement arrangement);
    /// Of files that are an attempt each, and have what is answered in common. `id`: the day's.
    static Draft of_day(std::vector<HandedIn> files, const std::string& id);

    /// What is not answered, in the order in which one asks: recordings and rules that were chosen
    /// decide what.
    std::vector<Gap> gaps() const;

    /// Takes an answer, as a person writes it: "202.9 km/h" or "110 knots" for record.speed and
    /// records.PROFILE, "measurer Ann Lee, judge" or "measurer Lee, Ann; judge" for officials,
    /// "land yacht" for a class, "0 0 -5" for an arm, else the value as YAML has it. A key that is
    /// of receivers alone is the primary one's. Failure, with nothing taken, for a key that there
    /// is none of and for what it cannot be.
    void set(const std::string& key, const std::string& answer);

    /// Takes proposals for what is not answered. What was taken so, a line each, which stands in
    /// the file, too.
    const std::vector<std::string>& take_proposals();

    /// The keys of the attempt, or of the day's defaults.
    const nlohmann::ordered_json& keys() const { return keys_; }
    /// The rules that are claimed, each by itself.
    std::vector<std::string> profiles() const;
    /// How that receiver's recordings are read, as it is stated.
    nlohmann::ordered_json receiver(const std::string& id) const;
    const std::vector<HandedIn>& files() const { return files_; }
    const Arrangement& arrangement() const { return arrangement_; }

    /// The attempt's file, or the day's: what is not answered stands in lines that are left out,
    /// each with what it is for.
    std::string text() const;

  private:
    friend class DraftGaps;
    friend class DraftText;
    nlohmann::ordered_json* find_receiver(const std::string& id);
    /// A record under one rule, "PROFILE" or "PROFILE.source".
    void set_record(const std::string& path, const std::string& text);
    /// A rule that another replaces holds for runs before a day, so that the run's must be named.
    void set_date_of_superseded();

    std::vector<HandedIn> files_;
    Arrangement arrangement_;
    bool of_day_ = false;
    nlohmann::ordered_json keys_;
    std::vector<std::string> taken_{};  ///< proposals that nobody confirmed
};

}  // namespace runcert
